//! `sensitivity`.

use std::sync::atomic::Ordering;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::document::{self, Asked, Found};
use umbmark_core::monte_carlo::{Distribution, Quantity, QuantityError};
use umbmark_core::sensitivity::{
    Inputs, Noise, SensitivityError, SobolOptions, Tests, Watch, local_derivatives, screen, sobol_indices,
};

use crate::monte_carlo::Study;
use crate::work::watched;
use crate::{choice, refused};

/// Steps that progress is told in.
const STEPS: f64 = 1000.0;

#[derive(Clone, Copy)]
enum Method {
    Sobol,
    Morris,
    Local,
}

const METHODS: [(&str, Method); 3] = [("sobol", Method::Sobol), ("morris", Method::Morris), ("local", Method::Local)];

/// Sensitivities of a study to the parameters that its model draws.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn sensitivity(
    py: Python<'_>,
    study: &Study,
    method: &str,
    effort: u64,
    second_order: bool,
    noise_free: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let method = choice("method", method, &METHODS)?;
    let study = study.core().clone();
    let varied = varied(&study).map_err(refused)?;
    if varied.is_empty() {
        return Err(PyValueError::new_err("nothing is varied; give parameters of the model a distribution"));
    }
    let noise = if noise_free { Noise::Absent } else { Noise::Simulated };
    let tests = Tests::new(&study, &varied, noise).map_err(refused)?;
    let inputs = Inputs::new(Tests::inputs(&varied), &[]).map_err(refused)?;
    let document = watched(py, threads, progress, move |told| -> Result<_, SensitivityError> {
        let tell = |share: f64| told.done.store((share * STEPS) as u64, Ordering::Relaxed);
        let watch = Watch { stop: &told.stop, progress: &tell };
        let seed = study.seed;
        let found = match method {
            Method::Sobol => {
                let options = SobolOptions { base_points: effort, second_order, seed };
                sobol_indices(&tests, &inputs, &options, &watch).map(Found::Sobol)
            }
            Method::Morris => screen(&tests, &inputs, effort, seed, &watch).map(Found::Morris),
            Method::Local => local_derivatives(&tests, &inputs, effort, &watch).map(Found::Local),
        }?;
        let asked = Asked {
            varied: &varied,
            correlations: &[],
            metrics: tests.metrics(),
            study: tests.study(),
            noisy: noise == Noise::Simulated,
            assumed: &[],
        };
        Ok(document::sensitivity(&found, &asked))
    })?;
    Ok(document.map_err(refused)?.to_string())
}

/// The parameters that a study draws, with their distributions.
fn varied(study: &umbmark_core::monte_carlo::Study) -> Result<Vec<(Quantity, Distribution)>, QuantityError> {
    let one = |draw: &umbmark_core::monte_carlo::Draw| {
        let name = format!("{}.{}", draw.effect(), draw.parameter().name);
        Ok((Quantity::find(&name, study)?, draw.distribution()))
    };
    study.draws.iter().map(one).collect()
}
