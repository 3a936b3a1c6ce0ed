//! The remaining error of a model.

use schemars::JsonSchema;
use serde::Serialize;

use super::finite;
use crate::stats::Interval;
use crate::{diagnose, likelihood};

/// Lower bound of the part of an error that is the same in every run of a path.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Repeats {
    /// Root mean square, in m or rad.
    pub value: f64,
    /// Lower end of its 95 % interval; null for fewer than three runs.
    pub low: Option<f64>,
    /// Upper end of its 95 % interval; null for fewer than three runs.
    pub high: Option<f64>,
}

impl Repeats {
    /// That of a remaining error; nothing if no two runs drive one path.
    pub(super) fn of(left: &diagnose::Left) -> Option<Repeats> {
        let repeats = left.repeats?;
        let [low, high] = [|i: Interval| i.low, |i: Interval| i.high].map(|end| repeats.interval.map(end));
        Some(Repeats { value: repeats.value, low, high })
    }
}

/// A source of noise, and the error that it alone would cause.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Chance {
    /// Its name.
    pub source: &'static str,
    /// Root mean square error of positions, in m.
    pub position_m: f64,
    /// Root mean square error of headings, in rad.
    pub heading_rad: f64,
}

/// A place where a run is disturbed by more than its noise.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Disturbance {
    /// Name of the run.
    pub run: String,
    /// Time since START, in s.
    pub t_s: f64,
    /// How far the wheels have rolled by then, in m.
    pub rolled_m: f64,
    /// Whether the robot was displaced for good, as by a bump; otherwise the reference was wrong for a moment.
    pub lasts: bool,
    /// Displacement ahead in the robot's frame, in m.
    pub forward_m: f64,
    /// Displacement to the left in the robot's frame, in m.
    pub left_m: f64,
    /// Rotation to the left, in rad; 0 if headings were not measured.
    pub heading_rad: f64,
    /// The same in standard deviations of the noise.
    pub standard_deviations: f64,
}

/// The remaining error of a model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Remains {
    /// Root mean square error of positions, in m.
    pub left_m: Option<f64>,
    /// The part that is the same in every run: the root of the mean product of the residuals of two runs at the same share of the path;
    /// null if no two runs drive one path.
    pub repeats_m: Option<Repeats>,
    /// Root mean square error of headings, in rad; null where none were measured.
    pub left_rad: Option<f64>,
    /// The part of it that is the same in every run; null if no two runs drive one path or no headings were measured.
    pub repeats_rad: Option<Repeats>,
    /// Number of pairs of runs for these.
    pub pairs_of_one_path: usize,
    /// Mean duration, in s, of the pieces of long runs that these are errors of, each from a START of its own; null for whole runs.
    pub piece_s: Option<f64>,
    /// Error that each source of noise alone would cause; empty for return poses.
    pub chance: Vec<Chance>,
    /// Accidental bumps and slips, and wrong poses of the reference.
    pub disturbances: Vec<Disturbance>,
}

impl From<&diagnose::Remains> for Remains {
    fn from(remains: &diagnose::Remains) -> Self {
        let chance = |chance: &diagnose::Chance| Chance {
            source: chance.source,
            position_m: chance.position,
            heading_rad: chance.heading,
        };
        let disturbance = |at: &likelihood::Disturbance| Disturbance {
            run: at.run.clone(),
            t_s: at.time,
            rolled_m: at.rolled,
            lasts: at.lasts,
            forward_m: at.by[0],
            left_m: at.by[1],
            heading_rad: at.by[2],
            standard_deviations: at.deviations,
        };
        let heading = remains.heading.as_ref();
        Remains {
            left_m: finite(remains.position.rms),
            repeats_m: Repeats::of(&remains.position),
            left_rad: heading.and_then(|left| finite(left.rms)),
            repeats_rad: heading.and_then(Repeats::of),
            pairs_of_one_path: remains.pairs,
            piece_s: remains.piece,
            chance: remains.chance.iter().map(chance).collect(),
            disturbances: remains.disturbances.iter().map(disturbance).collect(),
        }
    }
}

/// The remaining error of a model, as the last keys of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Leaves {
    /// Remaining error, in m.
    pub left_m: Option<f64>,
    /// The part of it that is the same in every run of one path, in m; null if no two runs drive one path.
    pub repeats_m: Option<Repeats>,
    /// The same in detail, with the sources of noise; null if columns contradict their names.
    pub remains: Option<Remains>,
}

impl From<Option<&diagnose::Remains>> for Leaves {
    fn from(remains: Option<&diagnose::Remains>) -> Self {
        Leaves {
            left_m: remains.and_then(|remains| finite(remains.position.rms)),
            repeats_m: remains.and_then(|remains| Repeats::of(&remains.position)),
            remains: remains.map(Remains::from),
        }
    }
}

/// That of the model with the smallest remaining error.
pub(super) fn least_left<'a>(of: impl Iterator<Item = &'a diagnose::Remains>) -> Option<&'a diagnose::Remains> {
    of.min_by(|a, b| a.position.rms.total_cmp(&b.position.rms))
}
