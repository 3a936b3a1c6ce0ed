//! A class of effects that may be missing.

use crate::drive::Robot;
use crate::effect::Model;
use crate::evidence::Estimate;

/// A class of effects that may be missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// All effects that this data cannot separate from the best, including the best.
    pub class: Vec<&'static str>,
    /// The effect of the class that fits best.
    pub best: &'static str,
    /// Its F (t² for one size).
    pub f: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// p of this class alone.
    pub p: f64,
    /// p corrected for all classes that were tested (the greatest of them).
    pub p_adjusted: f64,
    /// p of the largest statistic under sign flips of the runs' scores, if there are enough runs; it needs no noise model.
    pub p_flips: Option<f64>,
    /// Sizes of the best effect after one step from zero.
    pub estimate: Vec<Estimate>,
    /// Expected decrease of the misfit, in units of the noise variance: it ranks the classes.
    pub expected_drop: f64,
}

impl Suspect {
    /// The meaning of the best effect for the robot at its estimated size, in a sentence; `None` where it has none or cannot have
    /// that size.
    pub fn meaning(&self, robot: &Robot) -> Option<String> {
        let mut model = Model::new(robot);
        for e in &self.estimate {
            model.set(e.effect, e.parameter, e.value).ok()?;
        }
        model.meaning(self.best)
    }
}
