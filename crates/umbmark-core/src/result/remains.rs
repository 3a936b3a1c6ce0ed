//! What a model leaves.

use schemars::JsonSchema;
use serde::Serialize;

use super::finite;
use crate::stats::Interval;
use crate::{diagnose, likelihood};

/// How much of an error is the same in every run of a path, at least.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Repeats {
    /// Root mean square, in m or rad.
    pub value: f64,
    /// Lower end of its 95 % interval; null below three runs.
    pub low: Option<f64>,
    /// Upper end of its 95 % interval; null below three runs.
    pub high: Option<f64>,
}

impl Repeats {
    /// That of what is left; nothing where no two runs drive one path.
    pub(super) fn of(left: &diagnose::Left) -> Option<Repeats> {
        let repeats = left.repeats?;
        let [low, high] = [|i: Interval| i.low, |i: Interval| i.high].map(|end| repeats.interval.map(end));
        Some(Repeats { value: repeats.value, low, high })
    }
}

/// A source of chance, and the error that it alone would leave.
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
    /// Whether the robot was moved and stayed so, as by a bump; else the reference was off for a moment.
    pub lasts: bool,
    /// By how much ahead, as the robot sees it, in m.
    pub forward_m: f64,
    /// By how much to the left, as the robot sees it, in m.
    pub left_m: f64,
    /// By how much it turned to the left, in rad; 0 where headings were not measured.
    pub heading_rad: f64,
    /// The same in standard deviations of the noise.
    pub standard_deviations: f64,
}

/// What a model leaves.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Remains {
    /// Root mean square error of positions, in m.
    pub left_m: Option<f64>,
    /// How much of it is the same in every run: the root of the mean product of what is left in two runs at the same share of one path;
    /// null where no two runs drive one path.
    pub repeats_m: Option<Repeats>,
    /// Root mean square error of headings, in rad; null where none were measured.
    pub left_rad: Option<f64>,
    /// How much of that is the same in every run; null where no two runs drive one path or no headings were measured.
    pub repeats_rad: Option<Repeats>,
    /// How many pairs of runs that rests on.
    pub pairs_of_one_path: usize,
    /// What each source of noise would leave; empty for return poses.
    pub chance: Vec<Chance>,
    /// Bumps and slips met by chance, and poses of the reference that are off.
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
            chance: remains.chance.iter().map(chance).collect(),
            disturbances: remains.disturbances.iter().map(disturbance).collect(),
        }
    }
}

/// What a model leaves, as the last keys of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Leaves {
    /// Error that is left, in m.
    pub left_m: Option<f64>,
    /// How much of it is the same in every run of one path, in m; null where no two runs drive one path.
    pub repeats_m: Option<Repeats>,
    /// The same in detail, with what chance there is; null where columns are not what they are called.
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

/// Of several models that which leaves least.
pub(super) fn least_left<'a>(of: impl Iterator<Item = &'a diagnose::Remains>) -> Option<&'a diagnose::Remains> {
    of.min_by(|a, b| a.position.rms.total_cmp(&b.position.rms))
}
