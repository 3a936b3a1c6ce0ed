//! Models compared with measured runs: what each explains and what it does not, direction by direction.
//!
//! Every statistic of a test (mean end pose, spread, correlation; for each direction) is compared with many simulated tests of the same
//! size. Each has its own p; the p of the whole comparison is that of the smallest.

mod replicas;
mod returns;
mod statistics;
pub mod tracks;

use crate::dataset::Dataset;
use crate::diagnose::{Options, base_model, first_model};
use crate::effect::Model;
use crate::evidence::{AnyEvidence, FitError, Level, robot_of};

pub use replicas::NoiseSource;
pub use returns::{Comparison, Judged, compare_returns};
pub use statistics::{Quantity, Statistic};
pub use tracks::{TrackComparison, compare_tracks, track_errors};

/// The models that are compared with data where none is given: the nominal robot, and that with its first effects fitted, if the data has
/// no faults. Each has a name.
pub fn usual_models(data: &Dataset, options: &Options) -> Result<Vec<(String, Model)>, FitError> {
    let (robot, level) = (robot_of(data)?, options.level(data));
    let mut models = vec![("nominal robot".to_owned(), Model::new(robot))];
    let of_paper = robot.drive.kind().has_axle_wheels();
    let (name, first) = match level {
        Level::Ends if of_paper => ("E_d and E_b, fitted to these runs", base_model(robot)?),
        Level::Ends => ("its first two effects, fitted to these runs", base_model(robot)?),
        Level::Tracks if of_paper => ("E_d, E_b, E_s fitted", first_model(data)?),
        Level::Tracks => ("its first three effects fitted", first_model(data)?),
    };
    match AnyEvidence::of(data, level)?.fit(&first) {
        Ok(fitted) => models.push((name.to_owned(), fitted.model)),
        // The report lists the faults together with the nominal robot.
        Err(FitError::Faulty { .. }) => {}
        Err(error) => return Err(error),
    }
    Ok(models)
}

/// Models side by side, on either kind of evidence.
#[derive(Clone, Debug)]
pub enum Compared {
    /// On return poses.
    Ends(Comparison),
    /// On whole tracks.
    Tracks(TrackComparison),
}

/// Compares the predictions of models, with the values that they have, with measured runs.
///
/// ```no_run
/// use umbmark_core::{compare::{Compared, compare}, dataset::Dataset, diagnose::Options, effect::Model};
/// # let data = Dataset::default();
/// let nominal = Model::new(data.nominal_robot()?);
/// match compare(&data, &[("nominal".into(), nominal)], &Options::default())? {
///     Compared::Ends(comparison) => println!("{}", comparison.models[0].sentences.join("\n")),
///     Compared::Tracks(comparison) => println!("{}", comparison.models[0].sentences.join("\n")),
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare(data: &Dataset, models: &[(String, Model)], options: &Options) -> Result<Compared, FitError> {
    Ok(match AnyEvidence::of(data, options.level(data))? {
        AnyEvidence::Ends(ends) => Compared::Ends(returns::compare(ends, data, models, options)?),
        AnyEvidence::Tracks(observed) => Compared::Tracks(tracks::compare(&observed, data, models, options)?),
    })
}
