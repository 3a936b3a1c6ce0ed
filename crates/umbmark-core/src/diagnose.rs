//! Which class of effects a model is missing, how sure that is, and what this data cannot see.
//!
//! Two kinds of evidence, one answer: return poses alone (`ends`), where a square driven both ways shows six numbers and exact small-sample
//! tests exist; and tick logs with absolute poses on the way (`tracks`), where almost every effect leaves a trace of its own. Effects that
//! the data cannot separate are named together, as a class.

mod candidates;
pub mod classes;
mod confounder;
mod diagnosis;
pub(crate) mod ends;
pub(crate) mod experiments;
mod identifiability;
mod likeness;
mod options;
mod reason;
mod remains;
mod suspect;
pub(crate) mod tracks;
mod unseen;

use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::effect::{Model, ModelError, find};
use crate::evidence::{AnyEvidence, Ends, FitError, Level, robot_of};

pub(crate) use candidates::missing;
pub use candidates::{Candidate, Size, candidates, columns};
pub use confounder::{Bias, Confounder};
pub use diagnosis::{Diagnosis, GoodnessOfFit, Verdict};
pub use ends::{Contrast, OnCircle};
pub use experiments::Experiment;
pub use identifiability::{Identifiability, Share, identifiability};
pub use likeness::Likeness;
pub use options::Options;
pub use reason::Reason;
pub use remains::{Chance, Left, Remains, Repeating};
pub use suspect::Suspect;
pub use tracks::{Curve, CurvePoint, Dependence, OddRun, Repeated, Suggestion, Unequal, UnlistedLaw, what_repeats};
pub use unseen::{Detectable, Unseen, Why};

/// The usual first model: E_d and E_b and, with tracks that show distances, E_s, all free.
pub fn first_model(data: &Dataset) -> Result<Model, FitError> {
    let robot = robot_of(data)?;
    let mut model = base_model(robot)?;
    if Level::of(data) == Level::Tracks && !headings_only(data) {
        model.add(robot.drive.first_effects()[2])?.free = true;
    }
    Ok(model)
}

/// Whether all that was measured on the way is headings, which do not show E_s.
fn headings_only(data: &Dataset) -> bool {
    data.runs
        .iter()
        .filter_map(|run| run.log.as_ref())
        .filter(|log| !log.reference.is_empty())
        .all(|log| log.headings_only)
}

/// The model of the paper: E_d and E_b, both free; for other drives, the two effects with the same result on a square.
pub fn base_model(robot: &Robot) -> Result<Model, ModelError> {
    let mut model = Model::new(robot);
    for effect in &robot.drive.first_effects()[..2] {
        model.add(effect)?.free = true;
    }
    Ok(model)
}

/// Fits a model's free parameters and tests every other effect of the catalogue.
///
/// ```
/// use umbmark_core::diagnose::{Options, Verdict, base_model, diagnose};
/// # use umbmark_core::{dataset::{Dataset, Run}, drive::Robot, effect::TestKind, path::{Direction, Path}};
/// # use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};
/// # let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let mut truth = base_model(&robot)?;
/// truth.set("wheel_diameter_ratio", "e_d", 1.00121)?;
/// truth.set("wheel_noise", "k_sqrt_m", 1e-3)?;
/// # let mut simulator = Simulator::new(&robot, &path, Odometry::Continuous, Phase::Edge)?;
/// # let mut truth = Truth::new(&truth);
/// # simulator.open(&mut truth, 2, 0);
/// # let mut runs = Vec::new();
/// # for direction in Direction::BOTH {
/// #     for number in 1..=5 {
/// #         let returned = Some(simulator.run(&mut truth, direction, TestKind::Systematic));
/// #         let name = format!("{}_{number}", direction.name());
/// #         runs.push(Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: None, returned });
/// #     }
/// # }
/// # let data = Dataset { robot: Some(robot.clone()), path: Some(path), runs, ..Dataset::default() };
/// // `data`: five simulated runs each way of the robot above.
/// let diagnosis = diagnose(&data, &base_model(&robot)?, &Options::default())?;
/// assert_eq!(diagnosis.verdict, Verdict::Explained);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(data: &Dataset, model: &Model, options: &Options) -> Result<Diagnosis, FitError> {
    model.check_robot(robot_of(data)?)?;
    let level = options.level(data);
    let of_evidence = || match AnyEvidence::of(data, level)? {
        evidence if !evidence.is_sound() => Ok(Diagnosis::of_faults(&*evidence, model)),
        AnyEvidence::Ends(ends) => ends::diagnose(&ends, model, options),
        AnyEvidence::Tracks(observed) => tracks::diagnose(&observed, model, options),
    };
    if level == Level::Ends {
        return of_evidence();
    }
    // Where return poses tell of the same runs, what they alone would have said stands beside it.
    let of_returns = || ends::Beside::new(&Ends::new(data)?, &base_model(model.robot())?, options);
    let (diagnosis, returns) = rayon::join(of_evidence, of_returns);
    let mut diagnosis = diagnosis?;
    if let Ok(returns) = returns {
        diagnosis.contrasts = returns.contrasts;
        diagnosis.circle = returns.circle;
        let renamed = |test| GoodnessOfFit { name: "E_d and E_b for the return poses alone", ..test };
        diagnosis.goodness_of_fit.extend(returns.goodness_of_fit.map(renamed));
    }
    Ok(diagnosis)
}

/// Every available experiment that separates two effects, together with this data; the most informative per minute first.
///
/// What the model has is fitted to the data: to whole tracks, where the runs were observed on the way, and further drives are then
/// watched as these were. Each effect is taken at its usual size, the hardest of its sizes. None where the runs have no
/// scatter to judge by.
pub fn separating(data: &Dataset, model: &Model, pair: [&str; 2]) -> Result<Vec<Experiment>, FitError> {
    let rivals = [find(pair[0])?, find(pair[1])?];
    let model = experiments::with_one_of(model, rivals)?;
    match AnyEvidence::of(data, Level::of(data))? {
        AnyEvidence::Ends(ends) => experiments::separating(&ends, &model, rivals),
        AnyEvidence::Tracks(observed) => tracks::separating(&observed, &model, rivals),
    }
}

#[cfg(test)]
pub(crate) mod tests;
