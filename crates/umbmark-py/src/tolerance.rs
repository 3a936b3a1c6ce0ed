//! `tolerance`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::monte_carlo::Metric;
use umbmark_core::result::{self, Wanted};
use umbmark_core::sensitivity::tolerance::{Target, Tolerances};
use umbmark_core::sensitivity::{Noise, SensitivityError, Tests};

use crate::arguments::threads;
use crate::monte_carlo::Study;
use crate::work::watched;
use crate::{json, parameters, probability, refused};

/// How many robots keep a target, and the cheapest grades that make it enough: the document, its words, and the sizes of the robots as
/// they are now, in order.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn tolerance(
    py: Python<'_>,
    study: &Study,
    parameters: &Bound<'_, PyAny>,
    metric: &str,
    target: (f64, f64),
    robots: u64,
    with_noise: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String, Vec<f64>)> {
    let (at_most, share) = target;
    probability("share", share)?;
    if !(at_most > 0.0 && at_most.is_finite()) {
        return Err(PyValueError::new_err(format!("target must be positive and finite, got {at_most}")));
    }
    let metric = Metric::named(metric).map_err(refused)?;
    let study = study.core().clone();
    let file = parameters::read(parameters, &study)?;
    let noise = if with_noise { Noise::Simulated } else { Noise::Absent };
    let first: Vec<_> = file.parameters.iter().map(|one| (one.quantity, one.grades[0].distribution)).collect();
    let tests = Tests::new(&study, &first, noise).map_err(refused)?;
    let Some(output) = tests.metrics().iter().position(|one| *one == metric) else {
        return Err(PyValueError::new_err(format!("{} is not a metric of these tests", metric.name())));
    };
    let target = Target { output, at_most, share };
    let found = watched(py, threads, progress, move |watch| -> Result<_, SensitivityError> {
        let correlations = parameters::correlations(&file);
        let (parameters, seed) = (file.parameters.as_slice(), study.seed);
        let tolerances = Tolerances { tests: &tests, parameters, correlations: &correlations, robots, seed };
        let findings = watch.work(|watch| tolerances.search(&target, watch))?;
        let wanted = Wanted { parameters, metric, target: &target, noise, seed, assumed: &[] };
        let report = told::Tolerance {
            findings: &findings,
            parameters,
            target: &target,
            metric,
            assumed: &[],
            with_noise,
            seed,
        };
        let found = result::Tolerance::new(&findings, &wanted);
        Ok((found, report.text(false), findings.now.robots.sizes().to_vec()))
    })?;
    let (found, text, sizes) = found.map_err(refused)?;
    Ok((json(&found)?, text, sizes))
}
