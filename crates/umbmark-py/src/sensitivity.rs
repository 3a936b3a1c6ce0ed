//! `sensitivity`.

use std::sync::Arc;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::monte_carlo::{Distribution, Metric, Quantity};
use umbmark_core::result::Found;
use umbmark_core::sensitivity::{
    Correlation, Inputs, Noise, SensitivityError, SobolDesign, SobolOptions, SobolSums, Tests, local_derivatives,
    screen, sobol_indices,
};

use crate::arguments::threads;
use crate::monte_carlo::Study;
use crate::work::watched;
use crate::{choice, json, parameters, refused};

#[derive(Clone, Copy)]
enum Method {
    Sobol,
    Morris,
    Local,
}

const METHODS: [(&str, Method); 3] = [("sobol", Method::Sobol), ("morris", Method::Morris), ("local", Method::Local)];

/// Tests, and what is varied in them.
struct Varied {
    tests: Tests,
    parameters: Vec<(Quantity, Distribution)>,
    correlations: Vec<Correlation>,
    inputs: Inputs,
    noise: Noise,
    seed: u64,
}

impl Varied {
    /// What a study draws, and what stands in a file or a table of parameters, which comes later and overrides.
    fn new(study: &Study, given: Option<&Bound<'_, PyAny>>, noise_free: bool) -> PyResult<Varied> {
        let study = study.core();
        let mut varied: Vec<(Quantity, Distribution)> = Vec::new();
        let mut place = |quantity: Quantity, distribution: Distribution| {
            let known = varied.iter().position(|(other, _)| other.key() == quantity.key());
            let place = known.unwrap_or(varied.len());
            match known {
                Some(place) => varied[place].1 = distribution,
                None => varied.push((quantity, distribution)),
            }
            place
        };
        for draw in &study.draws {
            let name = format!("{}.{}", draw.effect(), draw.parameter().name);
            place(Quantity::find(&name, study).map_err(refused)?, draw.distribution());
        }
        let mut correlations = Vec::new();
        if let Some(given) = given {
            let file = parameters::read(given, study)?;
            let grades = file.parameters.iter().map(|one| (one.quantity, one.grades[0].distribution));
            let places: Vec<usize> = grades.map(|(quantity, distribution)| place(quantity, distribution)).collect();
            let moved = |c: Correlation| Correlation { of: c.of.map(|i| places[i]), value: c.value };
            correlations = parameters::correlations(&file).into_iter().map(moved).collect();
        }
        if varied.is_empty() {
            return Err(PyValueError::new_err(
                "nothing is varied; give parameters of the model a distribution, or say which with parameters",
            ));
        }
        let noise = if noise_free { Noise::Absent } else { Noise::Simulated };
        let tests = Tests::new(study, &varied, noise).map_err(refused)?;
        let inputs = Inputs::new(Tests::inputs(&varied), &correlations).map_err(refused)?;
        Ok(Varied { tests, parameters: varied, correlations, inputs, noise, seed: study.seed })
    }

    /// The document, and what the command prints.
    fn document(&self, found: &Found) -> PyResult<(String, String)> {
        let report = told::Sensitivity {
            found,
            parameters: &self.parameters,
            correlations: &self.correlations,
            metrics: self.tests.metrics(),
            metric: self.shown(),
            study: self.tests.study(),
            noisy: self.noise == Noise::Simulated,
            assumed: &[],
            unicode: false,
        };
        Ok((json(&report.result())?, report.text()))
    }

    /// The metric that words are about: E_max,sys where both directions are driven.
    fn shown(&self) -> Metric {
        let metrics = self.tests.metrics();
        metrics.iter().copied().find(|metric| *metric == Metric::EMaxSys).unwrap_or(metrics[0])
    }
}

/// Sensitivities of a study to the parameters that its model draws, or that are given.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn sensitivity(
    py: Python<'_>,
    study: &Study,
    parameters: Option<&Bound<'_, PyAny>>,
    method: &str,
    effort: u64,
    second_order: bool,
    noise_free: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let method = choice("method", method, &METHODS)?;
    let varied = Varied::new(study, parameters, noise_free)?;
    let found = watched(py, threads, progress, move |watch| -> Result<_, SensitivityError> {
        let Varied { tests, inputs, seed, .. } = &varied;
        let found = watch.work(|watch| match method {
            Method::Sobol => {
                let options = SobolOptions { base_points: effort, second_order, seed: *seed };
                sobol_indices(tests, inputs, &options, watch).map(Found::Sobol)
            }
            Method::Morris => screen(tests, inputs, effort, *seed, watch).map(Found::Morris),
            Method::Local => local_derivatives(tests, inputs, effort, watch).map(Found::Local),
        })?;
        Ok(varied.document(&found))
    })?;
    found.map_err(refused)?
}

/// Sobol indices in blocks that can be done anywhere.
#[pyclass(frozen, module = "umbmark._umbmark")]
pub struct Sobol {
    varied: Arc<Varied>,
    options: SobolOptions,
}

#[pymethods]
impl Sobol {
    #[new]
    fn new(
        study: &Study,
        parameters: Option<&Bound<'_, PyAny>>,
        base_points: u64,
        second_order: bool,
        noise_free: bool,
    ) -> PyResult<Sobol> {
        let varied = Arc::new(Varied::new(study, parameters, noise_free)?);
        let options = SobolOptions { base_points, second_order, seed: varied.seed };
        let sobol = Sobol { varied, options };
        sobol.blocks()?;
        Ok(sobol)
    }

    /// How many blocks there are.
    #[getter]
    fn blocks(&self) -> PyResult<usize> {
        let Varied { tests, inputs, .. } = &*self.varied;
        SobolDesign::new(tests, inputs, &self.options).map(|design| design.blocks()).map_err(refused)
    }

    /// What blocks first to end - 1 come to, as numbers.
    fn sums<'py>(&self, py: Python<'py>, first: usize, end: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (varied, options) = (Arc::clone(&self.varied), self.options);
        let sums = watched(py, 1, None, move |told| {
            let design = SobolDesign::new(&varied.tests, &varied.inputs, &options)?;
            told.work(|watch| design.sums(first..end, watch)).map(|sums| sums.numbers())
        })?;
        Ok(PyArray1::from_vec(py, sums.map_err(refused)?))
    }

    /// The document of all blocks, in their order, and its words.
    fn document(&self, numbers: PyReadonlyArray1<'_, f64>) -> PyResult<(String, String)> {
        let Varied { tests, inputs, .. } = &*self.varied;
        let design = SobolDesign::new(tests, inputs, &self.options).map_err(refused)?;
        let sums = SobolSums::from_numbers(&design, numbers.as_slice()?);
        self.varied.document(&Found::Sobol(design.indices(&sums).map_err(refused)?))
    }
}
