//! How a robot like the model would score: many simulated tests.

use std::ops::ControlFlow;

use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{self, Ensemble, Metric};
use umbmark_core::simulate::{Odometry, Phase};

use super::{Absent, Study};

/// Simulated tests of a model, each with as many runs as were measured.
#[derive(Debug)]
pub struct Chance {
    /// What came out.
    pub ensemble: Ensemble,
    /// The wheel noise \[m^0.5\] that gives simulated tests the measured scatter; `None` where the model has its own.
    pub matched_noise: Option<f64>,
}

/// The noise that is tried \[m^0.5\], and in how many tests.
const TRIED: (f64, u64) = (1e-3, 200);

impl Chance {
    pub(super) fn new(study: &Study) -> Result<Chance, Absent> {
        let mut model = study.model()?.clone();
        let sigma = study.score()?.summary.sigma_axis();
        let own = model.get("wheel_noise", "k_sqrt_m").is_some_and(|k| k > 0.0);
        let mut matched_noise = None;
        if !own {
            let sigma = sigma.ok_or_else(|| Absent("One run in each direction has no scatter to simulate.".into()))?;
            let found = run(study, with_noise(&model, TRIED.0)?, TRIED.1)?;
            let found = found.get(Metric::Sigma).map(|s| s.quantile(0.5)).filter(|found| *found > 0.0);
            let found = found.ok_or_else(|| Absent("Simulated runs have no scatter.".into()))?;
            let k = TRIED.0 * sigma / found;
            model = with_noise(&model, k)?;
            matched_noise = Some(k);
        }
        Ok(Chance { ensemble: run(study, model, study.options.trials)?, matched_noise })
    }
}

fn with_noise(model: &Model, k: f64) -> Result<Model, Absent> {
    let mut noisy = model.clone();
    noisy.set("wheel_noise", "k_sqrt_m", k).map_err(Absent::because)?;
    Ok(noisy)
}

fn run(study: &Study, model: Model, trials: u64) -> Result<Ensemble, Absent> {
    let path = study.data.path.clone();
    let path = path.ok_or_else(|| Absent("The path is not known: put a [path] into robot.toml.".into()))?;
    let made = monte_carlo::Study {
        path,
        odometry: Odometry::Continuous,
        phase: Phase::Edge,
        runs: study.counts(),
        ..monte_carlo::Study::new(model, trials, study.options.diagnose.seed)
    };
    let go_on = |_: &monte_carlo::Batch| match study.begin() {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    let ensemble = made.run(go_on).map_err(Absent::because)?;
    study.begin().map(|()| ensemble)
}
