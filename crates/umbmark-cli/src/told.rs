//! What verbs print on a standard output that is no terminal, for programs that have the results themselves.

use umbmark_core::calibrate::Calibration;
use umbmark_core::changed::Changed;
use umbmark_core::compare::Compared;
use umbmark_core::conditions::Conditions;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Diagnosis, Options};
use umbmark_core::drift::{Arrived, Watched};
use umbmark_core::drive::Robot;
use umbmark_core::evidence::Fit;
use umbmark_core::learn::GearCalibration;
use umbmark_core::monte_carlo::{Ensemble, Metric, Sweep, SweepPoint};
use umbmark_core::result::{Paper, Study};
use umbmark_core::score::{Convention, Score};
use umbmark_core::solve::Solution;
use umbmark_core::survey::Survey;
use umbmark_plot::render::terminal::Look;

pub use crate::plan_report::{Known, Report as Plan, Separation};
pub use crate::sensitivity_report::SensitivityReport as Sensitivity;
pub use crate::verb::tolerance::Report as Tolerance;

pub use crate::words::ACTIONS;

use crate::answer::answer_text;
use crate::ensemble_report::Report;
use crate::plan_report;
use crate::sweep::SweepReport;
use crate::tracks_report;
use crate::verb::{
    calibrate as calibrating, changed as changing, compare as comparing, conditions as dividing,
    diagnose as diagnosing, fit as fitting, paper as publishing,
};
use crate::verb::{inspect as inspecting, learn as learning, score as scoring, survey as surveying, watch as watching};

/// Of `score`; without a dataset, the return errors are not drawn.
pub fn score(data: Option<&Dataset>, score: &Score, convention: Convention) -> String {
    scoring::told(data, score, convention, Look::default())
}

/// Of `calibrate`, beside what `solve` would answer to tests of this size.
pub fn calibration(robot: &Robot, found: &Calibration, answer: Option<&Solution>, level: f64, size: f64) -> String {
    calibrating::told(robot, found, answer, level, size)
}

/// Of `calibrate` for drives other than the differential one, beside what `solve` would answer to tests of this size.
pub fn gears(robot: &Robot, found: &GearCalibration, answer: Option<&Solution>, level: f64, size: f64) -> String {
    calibrating::gears::told(robot, found, answer, level, size)
}

/// Of `paper`.
pub fn paper(found: &Paper) -> String {
    publishing::told(found)
}

/// Of `compare`.
pub fn comparison(compared: &Compared, options: &Options) -> String {
    match compared {
        Compared::Ends(comparison) => comparing::text(comparison, options, false),
        Compared::Tracks(comparison) => {
            tracks_report::text(comparison, options, tracks_report::Look { terminal: false, verbose: false })
        }
    }
}

/// Of `diagnose`.
pub fn diagnosis(data: &Dataset, diagnosis: &Diagnosis, options: &Options) -> String {
    diagnosing::text(data, diagnosis, options, (false, false))
}

/// Of `fit`, with intervals that hold with probability `level`.
pub fn fit(fit: &Fit, level: f64) -> String {
    fitting::told(fit, level)
}

/// Of `learn`.
pub fn learnt(data: &Dataset, solution: &Solution, options: &Options) -> String {
    learning::told(data, solution, options, false)
}

/// Of `solve`.
pub fn solution(solution: &Solution, options: &Options) -> String {
    answer_text(solution, 1.0 - options.size)
}

/// Of `changed`.
pub fn changed(found: &Changed) -> String {
    changing::told(found)
}

/// Of `conditions`.
pub fn conditions(found: &Conditions) -> String {
    dividing::told(found)
}

/// Of `survey`.
pub fn survey(found: &Survey) -> String {
    surveying::told(found, surveying::MOST_ROWS)
}

/// Of `watch`.
pub fn watched(watched: &Watched, arrived: &Arrived) -> String {
    watching::told(watched, arrived, false)
}

/// Of `mc` and `merge`; `took` is how long it took \[s\], and for how many trials.
pub fn ensemble(study: &Study, seed: u64, ensemble: &Ensemble, partial: bool, took: Option<(f64, u64)>) -> String {
    Report { study, seed, ensemble, partial, took }.text(false)
}

/// Of `mc --sweep`.
pub fn sweep(sweep: &Sweep, points: &[SweepPoint], metric: Metric) -> String {
    SweepReport { sweep, points, metric, assumed: &[] }.text(false)
}

/// Of `plan`.
pub fn plan(plan: &Plan) -> String {
    plan_report::text(plan)
}

/// Of `inspect` where the robot of all logs is known.
pub fn inspection(data: &Dataset, inspection: &umbmark_core::inspect::Inspection) -> String {
    inspecting::text(data, inspection, false)
}
