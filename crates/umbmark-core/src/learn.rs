//! The whole loop: fit, diagnose, add what is certified as missing, fit again, until nothing is.
//!
//! An effect is added when both hold: its class is certified among all that were asked
//! ([`Diagnosis::certified`](crate::diagnose::Diagnosis::certified)), and the error of runs that were left out falls. Leaving out is
//! nested: without each run in turn, the choice of the effect is made anew and the model fitted anew. AICc and BIC are told and
//! decide nothing: with many effects on offer they accept a false one in half of all tests.

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
const MOST: usize = 6;

/// Root mean square errors of predicted poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Distance of observed from predicted positions \[m\].
    pub position: f64,
    /// Observed less predicted headings \[rad\], where they were measured.
    pub heading: Option<f64>,
    /// Both together, in units of the noise's shape: what has to fall for an effect to stay.
    pub weighted: f64,
}

/// One line of the story.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The effect that was added; `None` for the nominal robot.
    pub added: Option<&'static str>,
    /// All effects that the data could not tell from it, itself included.
    pub class: Vec<&'static str>,
    /// p of its class among all that were asked; `None` for what was not asked but fitted.
    pub p_adjusted: Option<f64>,
    /// Of a law that no catalogue lists: how it was found, what else it may be, and its formula as it was fitted.
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
    /// From the nominal robot to the model.
    pub steps: Vec<Step>,
    /// What the last diagnosis says.
    pub verdict: Verdict,
    /// The model, its free parameters fitted.
    pub model: Model,
    /// The last diagnosis: of the model that was learnt.
    pub diagnosis: Diagnosis,
    /// What else should be said, a sentence each.
    pub remarks: Vec<String>,
    /// Whether it was stopped while an effect was certified that may have been added.
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

/// [`learn`], with the effects of a `start` model in the story from the beginning: a formula to try, say. They are fitted
/// where they are free, after E_d, E_b and (from tracks) E_s. Once stopped, it ends with the step that it is at.
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
