//! Keyword arguments as the tables of `robot.toml` and `model.toml`, so that keys, ranges and messages are those of the files.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};
use umbmark_io::DatasetError;

/// The keywords of a call as a table; what is None is left out.
pub fn table(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, value) in keywords.into_iter().flatten() {
        if !value.is_none() {
            let key: String = key.extract()?;
            let value = self::value(&key, &value)?;
            table.insert(key, value);
        }
    }
    Ok(table)
}

/// The keys and values of the text of a table, as they are written in a call.
pub fn written(text: &str) -> String {
    let lines = text.lines().filter_map(|line| line.split(" # ").next()?.trim().split_once(" = "));
    lines.map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(", ")
}

/// A value of a key.
fn value(key: &str, given: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(text) = given.cast::<PyString>() {
        Ok(Value::String(text.extract()?))
    } else if let Ok(flag) = given.cast::<PyBool>() {
        Ok(Value::Boolean(flag.is_true()))
    } else if given.is_instance_of::<PyInt>() {
        Ok(Value::Integer(given.extract()?))
    } else if let Ok(keywords) = given.cast::<PyDict>() {
        Ok(Value::Table(table(Some(keywords))?))
    } else if given.is_instance_of::<PyFloat>() || given.hasattr("__float__")? && !given.hasattr("__len__")? {
        Ok(Value::Float(given.extract()?))
    } else if given.is_instance_of::<PyList>() || given.is_instance_of::<PyTuple>() || given.hasattr("tolist")? {
        let items = if given.hasattr("tolist")? { given.call_method0("tolist")? } else { given.clone() };
        let items: PyResult<Vec<Value>> = items.try_iter()?.map(|item| value(key, &item?)).collect();
        Ok(Value::Array(items?))
    } else {
        let kind = given.get_type();
        let words =
            format!("{key} must be a number, text, true or false, or a dict or list of these, got {}", kind.name()?);
        Err(PyTypeError::new_err(words))
    }
}

/// What the reader of a table refuses, without the line, because there is no file.
pub fn refused(error: &DatasetError) -> PyErr {
    let text = error.to_string();
    PyValueError::new_err(error.at().map_or(text.clone(), |at| text.replacen(&at.to_string(), &at.file, 1)))
}
