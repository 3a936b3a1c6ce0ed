//! Models that are tried one after the other on evidence that is kept.

use super::story::{Error, Step};
use super::{ends, tracks};
use crate::dataset::Dataset;
use crate::diagnose::Options;
use crate::effect::Model;
use crate::evidence::{AnyEvidence, Fit, FitError, Level, robot_of};

/// The measured runs of a robot, ready for one model after the other.
///
/// ```no_run
/// use umbmark_core::{dataset::Dataset, diagnose::{Options, first_model}, learn::Kept};
/// # let data = Dataset::default();
/// let kept = Kept::new(&data, &Options::default())?;
/// let mut model = first_model(&data)?;
/// model.add("floor_slope_yaw")?.free = true;
/// let (fit, step) = kept.fit(&model)?;
/// println!("{:.1} mm held out with {:?}", 1e3 * step.held_out.position, fit.model.parts());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Kept(AnyEvidence);

impl std::fmt::Debug for Kept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Kept").field(&self.level()).finish()
    }
}

impl Kept {
    /// The runs of a dataset.
    pub fn new(data: &Dataset, options: &Options) -> Result<Kept, FitError> {
        robot_of(data)?;
        Ok(Kept(AnyEvidence::of(data, options.level(data))?))
    }

    /// How much of the runs was observed.
    pub fn level(&self) -> Level {
        self.0.level()
    }

    /// The error of a model with the values that it has; nothing is fitted.
    pub fn error(&self, model: &Model) -> Result<Error, FitError> {
        model.check_robot(self.0.robot())?;
        self.0.check(model)?;
        match &self.0 {
            AnyEvidence::Ends(ends) => Ok(ends::error(ends, model)),
            AnyEvidence::Tracks(observed) => tracks::error(observed, model),
        }
    }

    /// The step that a model is with the values that it has.
    pub fn as_it_is(&self, model: &Model) -> Result<Step, FitError> {
        model.check_robot(self.0.robot())?;
        self.0.check(model)?;
        match &self.0 {
            AnyEvidence::Ends(ends) => Ok(ends::as_it_is(ends, model)),
            AnyEvidence::Tracks(observed) => tracks::as_it_is(observed, model),
        }
    }

    /// Fits the free parameters of a model as [`fit`](crate::evidence::fit) does, with the errors of the step that adds them to the
    /// story of [`learn`](super::learn).
    pub fn fit(&self, model: &Model) -> Result<(Fit, Step), FitError> {
        model.check_robot(self.0.robot())?;
        match &self.0 {
            AnyEvidence::Ends(ends) => ends::fit(ends, model),
            AnyEvidence::Tracks(observed) => tracks::fit_whole(observed, model),
        }
    }
}
