//! The whole loop: fit, diagnose, add the effect that is certified as missing, and fit again, until none is missing.
//!
//! An effect is added when both hold: its class is certified among all that were tested
//! ([`Diagnosis::certified`](crate::diagnose::Diagnosis::certified)), and the cross-validated error falls. The cross-validation is
//! nested: without each run in turn, the effect is chosen again and the model fitted again. AICc and BIC are reported but decide
//! nothing: with many effects on offer they accept a false one in half of all tests.

mod ends;
mod gears;
mod tracks;

pub use gears::{GearCalibration, GearError, calibrate_gears};

use crate::dataset::Dataset;
use crate::diagnose::{self, Diagnosis, Repeated, Verdict};
use crate::effect::Model;
use crate::evidence::{AnyEvidence, Evidence, FitError, robot_of};
use crate::watch::Watch;

/// No model is given more effects than this.
const MAX_EFFECTS: usize = 6;

/// Root mean square errors of predicted poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Distance of observed from predicted positions \[m\].
    pub position: f64,
    /// Observed minus predicted headings \[rad\], where they were measured.
    pub heading: Option<f64>,
    /// Both together, weighted by the shape of the noise: it must fall for an effect to stay.
    pub weighted: f64,
}

/// One step of learning.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The effect that was added; `None` for the nominal robot.
    pub added: Option<&'static str>,
    /// All effects that the data cannot distinguish from it, itself included.
    pub class: Vec<&'static str>,
    /// p of its class, corrected for all classes that were tested; `None` for an effect that was fitted without a test.
    pub p_adjusted: Option<f64>,
    /// For a law outside the catalogue: how it was found, the alternatives, and its fitted formula.
    pub law: Option<Box<Repeated>>,
    /// In the runs that the model was fitted to.
    pub error: Error,
    /// In runs that were left out.
    pub held_out: Error,
    /// Akaike's criterion with its small-sample correction; `None` for too few runs.
    pub aicc: Option<f64>,
    /// Bayes' criterion.
    pub bic: Option<f64>,
}

/// What was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    /// From the nominal robot to the final model.
    pub steps: Vec<Step>,
    /// The verdict of the last diagnosis.
    pub verdict: Verdict,
    /// The model, its free parameters fitted.
    pub model: Model,
    /// The last diagnosis: of the model that was learnt.
    pub diagnosis: Diagnosis,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// Whether it was stopped while a certified effect could still be added.
    pub partial: bool,
}

impl Learnt {
    /// Columns that are not what they are called teach nothing of the robot.
    fn of_faults(evidence: &dyn Evidence, steps: Vec<Step>) -> Learnt {
        let model = Model::new(evidence.robot());
        let diagnosis = Diagnosis::of_faults(evidence, &model);
        Learnt { steps, verdict: diagnosis.verdict, model, diagnosis, remarks: Vec::new(), partial: false }
    }
}

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
pub fn learn(data: &Dataset, options: &diagnose::Options) -> Result<Learnt, FitError> {
    let robot = robot_of(data)?;
    Watch::nobody(|watch| learn_from(data, &Model::new(robot), options, watch))
}

/// [`learn`] that starts with the effects of a model, such as a formula to try. Free effects are fitted after E_d, E_b and (from
/// tracks) E_s. Once stopped, it ends with its current step.
pub fn learn_from(
    data: &Dataset,
    start: &Model,
    options: &diagnose::Options,
    watch: &Watch,
) -> Result<Learnt, FitError> {
    start.check_robot(robot_of(data)?)?;
    match AnyEvidence::of(data, options.level(data))? {
        AnyEvidence::Ends(ends) => ends::learn(&ends, start, options, watch),
        AnyEvidence::Tracks(observed) => tracks::learn(&observed, start, options, watch),
    }
}

#[cfg(test)]
mod tests;
