//! The whole loop: fit, diagnose, add the effect that is certified as missing, and fit again, until none is missing.
//!
//! An effect is added when both hold: its class is certified among all that were tested
//! ([`Diagnosis::certified`](crate::diagnose::Diagnosis::certified)), and the cross-validated error falls. The cross-validation is nested:
//! without each run in turn, the effect is chosen again and the model fitted again. AICc and BIC are reported but decide nothing: among
//! many effects they accept a wrong one in half of all tests.

mod ends;
mod gears;
mod kept;
mod misfits;
mod story;
mod tracks;

pub(crate) use ends::criteria as criteria_of_ends;
pub use gears::{GearCalibration, GearError, calibrate_gears};
pub use kept::Kept;
pub use story::{Crossed, Error, Learnt, Step};

use crate::dataset::Dataset;
use crate::diagnose::Options;
use crate::effect::Model;
use crate::evidence::{AnyEvidence, FitError, robot_of};
use crate::watch::Watch;

/// Learns which effects a robot has.
///
/// ```no_run
/// use umbmark_core::{dataset::Dataset, diagnose::Options, learn::learn};
/// # let data = Dataset::default();
/// let learnt = learn(&data, &Options::default())?;
/// for step in &learnt.steps {
///     println!("{:?}: {:.1} mm held out", step.added, 1e3 * step.held_out.position);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn learn(data: &Dataset, options: &Options) -> Result<Learnt, FitError> {
    let robot = robot_of(data)?;
    Watch::nobody(|watch| learn_from(data, &Model::new(robot), options, watch))
}

/// [`learn`] that starts with the effects of a model, such as a formula to try. Free effects are fitted after E_d, E_b and (from
/// tracks) E_s. Once stopped, it ends with its current step.
pub fn learn_from(data: &Dataset, start: &Model, options: &Options, watch: &Watch) -> Result<Learnt, FitError> {
    start.check_robot(robot_of(data)?)?;
    match AnyEvidence::of(data, options.level(data))? {
        AnyEvidence::Ends(ends) => ends::learn(&ends, start, options, watch),
        AnyEvidence::Tracks(observed) => tracks::learn(&observed, start, options, watch),
    }
}

#[cfg(test)]
mod tests;
