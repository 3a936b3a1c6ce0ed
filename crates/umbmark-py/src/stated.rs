//! The conditions of runs, as Python states them.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};
use umbmark_core::dataset::{Dataset, Run, RunConditions, Stated};

/// Each condition with its value of every run.
pub fn told<'py>(py: Python<'py>, data: &Dataset) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (name, _) in data.conditions.iter().flat_map(|stated| &stated.stated) {
        let of_run = |run: &Run| {
            let stated = data.conditions.iter().find(|stated| stated.run == run.name)?;
            let (_, value) = stated.stated.iter().find(|(own, _)| own == name)?;
            Some(match value {
                Stated::Word(word) => Given::Word(word.clone()),
                Stated::Number(number) => Given::Number(*number),
            })
        };
        columns.set_item(name, PyList::new(py, data.runs.iter().map(of_run))?)?;
    }
    Ok(columns)
}

/// The same dataset with conditions of its runs, each given for all or for one run after the other.
pub fn with_conditions(data: &Dataset, conditions: Option<&Bound<'_, PyDict>>) -> PyResult<Dataset> {
    let mut data = data.clone();
    let find = |data: &Dataset, run: &str| {
        let stated = data.conditions.iter().find(|stated| stated.run == run);
        stated.map_or_else(Vec::new, |stated| stated.stated.clone())
    };
    let mut stated: Vec<RunConditions> =
        data.runs.iter().map(|run| RunConditions { run: run.name.clone(), stated: find(&data, &run.name) }).collect();
    for (name, values) in conditions.into_iter().flatten() {
        let name: String = name.extract()?;
        for (run, value) in stated.iter_mut().zip(given(&name, &values, data.runs.len())?) {
            run.stated.retain(|(own, _)| *own != name);
            run.stated.extend(value.map(|value| (name.clone(), value)));
        }
    }
    stated.retain(|run| !run.stated.is_empty());
    data.conditions = stated;
    Ok(data)
}

/// A condition as Python has it.
#[derive(IntoPyObject)]
enum Given {
    Word(String),
    Number(f64),
}

/// The values of a condition, one a run.
fn given(name: &str, values: &Bound<'_, PyAny>, runs: usize) -> PyResult<Vec<Option<Stated>>> {
    if values.is_instance_of::<PyString>() || values.is_none() || !values.hasattr("__iter__")? {
        return Ok(vec![one(name, values)?; runs]);
    }
    let all = values.try_iter()?.map(|value| one(name, &value?)).collect::<PyResult<Vec<_>>>()?;
    if all.len() != runs {
        return Err(PyValueError::new_err(format!(
            "{name} must have one value for each of {runs} runs, got {}",
            all.len()
        )));
    }
    Ok(all)
}

fn one(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Stated>> {
    if value.is_none() {
        return Ok(None);
    }
    if let Ok(word) = value.extract::<String>() {
        return Ok((!word.is_empty()).then_some(Stated::Word(word)));
    }
    let number: f64 = value
        .extract()
        .map_err(|_| PyTypeError::new_err(format!("{name} must be words or numbers, got {}", value.get_type())))?;
    match number {
        _ if number.is_nan() => Ok(None),
        _ if number.is_finite() => Ok(Some(Stated::Number(number))),
        _ => Err(PyValueError::new_err(format!("{name} must be finite, got {number}"))),
    }
}
