//! `umbmark.Model`.

use std::collections::BTreeMap;
use std::ffi::CString;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use toml::{Table, Value};
use umbmark_core::likelihood::Noise;
use umbmark_core::monte_carlo::Draw;
use umbmark_core::{dataset, drive, effect, result};
use umbmark_io::{Doubt, ModelFile};

use crate::robot::Robot;
use crate::{as_python, hash_of, keys, refused};

/// A nominal robot and the effects that make it err. Models are frozen: each change gives another one.
///
/// Parameters
/// ----------
/// robot : Robot, optional
///     The nominal robot; the paper's LabMate where none is given.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import umbmark
/// >>> model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002)
/// >>> model = model.add("wheelbase", e_b={"mean": 1.01, "sd": 0.002})  # drawn anew for each trial
/// >>> model.get("wheelbase", "e_b")
/// 1.01
/// >>> own = model.add(
/// ...     "carpet",
/// ...     acts_on="heading_per_metre",
/// ...     formula=lambda at, k, h0: k * np.sin(at.heading - h0),
/// ...     parameters={"k": 0.001, "h0": 0.5},
/// ... )
/// >>> print(own.to_toml().split("\n\n")[-1], end="")
/// [[effect]]
/// name = "carpet"
/// acts_on = "heading_per_metre"
/// formula = "k * sin(heading - h0)"
/// parameters = { k = 0.001, h0 = 0.5 }
#[pyclass(frozen, eq, module = "umbmark", from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Model {
    /// The effects.
    pub model: effect::Model,
    /// Parameters that differ from trial to trial.
    pub draws: Vec<Draw>,
    /// The noise that was fitted with it.
    pub noise: Option<Noise>,
    /// What speaks against its values.
    pub doubt: Option<Doubt>,
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (robot=None))]
    fn new(robot: Option<&Robot>) -> Model {
        effect::Model::new(&nominal(robot)).into()
    }

    /// Read the text of a model.toml, for a robot, or for the one it names, or the paper's LabMate.
    #[staticmethod]
    #[pyo3(signature = (text, robot=None))]
    fn from_toml(py: Python<'_>, text: &str, robot: Option<&Robot>) -> PyResult<Model> {
        let file = ModelFile::parse("model.toml", text, robot.map(|robot| &robot.0)).map_err(refused)?;
        Model::of_file(py, file, "model.toml")
    }

    /// Read a model.toml, for a robot, or for the one it names, or the paper's LabMate.
    ///
    /// A file that names another robot than the given one is converted, with a ``ConversionWarning`` that says what changed.
    #[staticmethod]
    #[pyo3(signature = (file, robot=None))]
    fn read(py: Python<'_>, file: std::path::PathBuf, robot: Option<&Robot>) -> PyResult<Model> {
        let read = ModelFile::read(&file, robot.map(|robot| &robot.0)).map_err(refused)?;
        Model::of_file(py, read, &file.display().to_string())
    }

    /// Add an effect of the catalogue, or one of your own, or change one that is there.
    ///
    /// Parameters
    /// ----------
    /// name : str, or a law of a result
    ///     Name of the effect; ``umbmark.effects()`` has the catalogue. Or a law that ``learn`` or ``diagnose`` found: the
    ///     ``suggestion`` of ``unlisted``, ``repeats``, the ``law`` of a step, or one of its ``others``.
    /// **keys
    ///     The keys of ``[[effect]]`` in a model.toml: the effect's parameters (a number, a word where it takes words,
    ///     ``{"mean": .., "sd": ..}`` or ``{"min": .., "max": ..}`` for one that is drawn), and ``free=True`` for
    ///     effects to be fitted. An effect of your own has ``acts_on``, ``formula`` (text, or a function of the quantities
    ///     and the parameters, written with NumPy) and ``parameters`` (a dict of start values).
    ///
    /// Returns
    /// -------
    /// Model
    ///     This one with the effect.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the catalogue, a range or the language of formulas refuses it, in the words of the file's reader.
    /// TypeError
    ///     If a function cannot be written as a formula.
    #[pyo3(signature = (name, **keys))]
    fn add(&self, py: Python<'_>, name: &Bound<'_, PyAny>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Model> {
        if let Some(laws) = laws_of(name)? {
            let mut effects = self.tables()?;
            effects.retain(|table| laws.iter().all(|law| law.get("name") != table.get("name")));
            effects.extend(laws);
            return self.with(effects)?.changed(py, keys);
        }
        let Ok(given) = name.extract::<String>() else {
            let got = (name.repr()?, name.get_type().name()?);
            let words = "name must be that of an effect, a function, or a suggestion";
            return Err(PyTypeError::new_err(format!("{words}, got {} ({})", got.0, got.1)));
        };
        let name: &str = &given;
        let keys = match keys {
            Some(keys) => py.import("umbmark._formula")?.call_method1("as_text", (keys,))?.cast_into::<PyDict>()?,
            None => PyDict::new(py),
        };
        let given = keys::table(Some(&keys))?;
        let mut effects = self.tables()?;
        let place = effects.iter().position(|table| table.get("name").and_then(Value::as_str) == Some(name));
        let place = place.unwrap_or_else(|| {
            effects.push(Table::from_iter([("name".to_owned(), Value::String(name.to_owned()))]));
            effects.len() - 1
        });
        effects[place].extend(given);
        self.with(effects)
    }

    /// Take an effect away.
    fn remove(&self, name: &str) -> PyResult<Model> {
        let mut effects = self.tables()?;
        let before = effects.len();
        effects.retain(|table| table.get("name").and_then(Value::as_str) != Some(name));
        if effects.len() == before {
            return Err(PyValueError::new_err(format!("there is no effect \"{name}\" in the model")));
        }
        self.with(effects)
    }

    /// Value of a parameter of an effect, the middle of its distribution where it is drawn; None without the effect.
    fn get(&self, effect: &str, parameter: &str) -> Option<f64> {
        self.model.get(effect, parameter)
    }

    /// Sizes of the noise that was fitted to tracks with it, under the keys of ``[noise]`` in a model.toml; None without.
    #[getter]
    fn noise(&self) -> Option<BTreeMap<&'static str, f64>> {
        let sizes = |noise: Noise| Noise::WRITTEN.iter().map(|size| size.name).zip(noise.written()).collect();
        self.noise.map(sizes)
    }

    /// What speaks against its values, in a sentence or more, as ``learn`` and ``solve`` found it; None without.
    #[getter]
    fn doubt(&self) -> Option<&str> {
        self.doubt.as_ref().map(|doubt| doubt.because.as_str())
    }

    /// The nominal robot.
    #[getter]
    fn robot(&self) -> Robot {
        Robot(self.model.robot().clone())
    }

    /// Names of the effects, in the order in which they act.
    #[getter]
    fn effects(&self) -> Vec<String> {
        self.model.parts().iter().map(|part| part.effect.name().to_owned()).collect()
    }

    /// Write it as the text of a model.toml with its robot, which reads back to the last bit.
    fn to_toml(&self) -> String {
        let Model { model, draws, noise, doubt } = self.clone();
        ModelFile { draws, noise, doubt, ..ModelFile::new(model) }.text()
    }

    /// Give its effects, as results have them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &result::Model::with_noise(&self.model, self.noise.as_ref()))
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.to_toml())
    }

    fn __repr__(&self) -> String {
        let effects = self.to_toml().replace("[[effect]]\nname = ", "").replace("\n\n", "\0");
        let lines = effects.split('\0').skip(1).map(|effect| effect.trim().replace('\n', ", ").replacen('"', "", 2));
        let lines: String = lines.filter(|line| !line.is_empty()).map(|line| format!("\n    {line}")).collect();
        format!("Model({}){lines}", self.model.robot().name)
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String, Robot))> {
        Ok((slf.getattr("from_toml")?.unbind(), (slf.get().to_toml(), slf.get().robot())))
    }
}

impl Model {
    /// The paper's LabMate, its runs scattering about as in the paper.
    pub fn noisy_labmate() -> Result<effect::Model, effect::ModelError> {
        let mut model = effect::Model::new(&drive::Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3)?;
        Ok(model)
    }

    /// The same, with keys of its last effect changed.
    fn changed(self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Model> {
        let last = self.model.parts().last().map(|part| part.effect.name());
        match (keys.filter(|keys| !keys.is_empty()), last) {
            (Some(keys), Some(last)) => self.add(py, PyString::new(py, last).as_any(), Some(keys)),
            _ => Ok(self),
        }
    }

    /// Its effects as in a file.
    fn tables(&self) -> PyResult<Vec<Table>> {
        let file: Table = self.to_toml().parse().map_err(|error: toml::de::Error| refused(error))?;
        let effects = file.get("effect").and_then(Value::as_array);
        Ok(effects.into_iter().flatten().filter_map(|effect| effect.as_table().cloned()).collect())
    }

    /// The same robot with these effects.
    fn with(&self, effects: Vec<Table>) -> PyResult<Model> {
        let effects = Value::Array(effects.into_iter().map(Value::Table).collect());
        let text = Table::from_iter([("effect".to_owned(), effects)]).to_string();
        let file = ModelFile::parse("Model", &text, Some(self.model.robot()));
        let ModelFile { model, draws, .. } = file.map_err(|error| keys::refused(&error))?;
        Ok(Model { model, draws, ..self.clone() })
    }

    /// What was read, with a warning of what was converted.
    fn of_file(py: Python<'_>, file: ModelFile, name: &str) -> PyResult<Model> {
        let ModelFile { model, draws, conversion, noise, doubt } = file;
        if let Some(conversion) = conversion {
            warn(py, &format!("{name} {conversion}"))?;
        }
        Ok(Model { model, draws, noise, doubt })
    }

    /// The effects for the robot of a dataset, with a warning of what was converted.
    pub fn of_data(&self, py: Python<'_>, data: &dataset::Dataset) -> PyResult<effect::Model> {
        let Some(robot) = &data.robot else { return Ok(self.model.clone()) };
        let (model, conversion) = self.model.converted(robot).map_err(refused)?;
        if let Some(conversion) = conversion {
            warn(py, &format!("the model {conversion}"))?;
        }
        Ok(model)
    }
}

impl From<effect::Model> for Model {
    fn from(model: effect::Model) -> Model {
        Model { model, draws: Vec::new(), noise: None, doubt: None }
    }
}

/// The effects of a law that a result holds as the text of a model file; nothing for a name.
fn laws_of(given: &Bound<'_, PyAny>) -> PyResult<Option<Vec<Table>>> {
    let Some(text) = given.getattr_opt("toml")? else { return Ok(None) };
    if text.is_none() {
        return Err(PyValueError::new_err("this law has no formula that a model could hold"));
    }
    let file: Table = text.extract::<String>()?.parse().map_err(|error: toml::de::Error| refused(error))?;
    let effects = file.get("effect").and_then(Value::as_array);
    Ok(Some(effects.into_iter().flatten().filter_map(|effect| effect.as_table().cloned()).collect()))
}

fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text).map_err(refused)?;
    PyErr::warn(py, &py.import("umbmark._warnings")?.getattr("ConversionWarning")?, &text, 1)
}

fn nominal(robot: Option<&Robot>) -> drive::Robot {
    robot.map_or_else(drive::Robot::labmate, |robot| robot.0.clone())
}
