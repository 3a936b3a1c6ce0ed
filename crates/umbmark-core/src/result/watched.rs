//! `watch`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{ends, finite};
use crate::drift::{self, Arrived, Kind, Use};

/// A run of a robot that is watched.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedRun {
    /// Its name.
    pub run: String,
    /// "cw" or "ccw".
    pub direction: &'static str,
    /// What it is used for: "earlier" than the baseline, "baseline", "compared" or "left_out".
    pub used: &'static str,
    /// Why it is left out; null where it is not.
    pub reason: Option<&'static str>,
    /// Whether it lies farther out than one good run in 200, and belongs to no lasting change.
    pub outlying: bool,
    /// Probability that a good run lies as far from what the earlier runs predict; null where it was not compared.
    pub p: Option<f64>,
    /// Logarithm of the likelihood ratio of a change of E_d, E_b and E_s, as of this run; null where it was not compared.
    pub numbers: Option<f64>,
    /// Its limit.
    pub numbers_limit: Option<f64>,
    /// The same of any other change of the return errors.
    pub place: Option<f64>,
    /// Its limit.
    pub place_limit: Option<f64>,
    /// The same of larger scatter.
    pub scatter: Option<f64>,
    /// Its limit.
    pub scatter_limit: Option<f64>,
}

/// A number of the robot before and after a change.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedNumber {
    /// "e_d", "e_b" or "e_s"; where runs were not tracked, "e_b" is that for E_s = 1.
    pub key: &'static str,
    /// True over nominal before, as the return errors show it if nothing else makes them.
    pub before: f64,
    /// Half the width of the 95 % interval of that.
    pub before_half: Option<f64>,
    /// True over nominal after.
    pub after: f64,
    /// Half the width of the 95 % interval of that.
    pub after_half: Option<f64>,
    /// After less before.
    pub change: f64,
    /// 95 % interval of the change.
    pub interval: Option<[f64; 2]>,
    /// p of no change, adjusted for all numbers (Holm).
    pub p_adjusted: f64,
    /// Whether it moved by more than chance.
    pub moved: bool,
}

/// A length that accounts for a change of the numbers by itself.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedLength {
    /// Its key in robot.toml.
    pub key: &'static str,
    /// Change of it as a share of itself.
    pub share: f64,
    /// Half the width of its 95 % interval.
    pub half: Option<f64>,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// The mean return error of a direction, after a change less before.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedPlace {
    /// "cw" or "ccw".
    pub direction: &'static str,
    /// Along the START heading, in m.
    pub x_m: f64,
    /// Half the width of its 95 % interval, in m.
    pub x_half_m: Option<f64>,
    /// To the left, in m.
    pub y_m: f64,
    /// Half the width of its 95 % interval, in m.
    pub y_half_m: Option<f64>,
    /// Heading, in rad; null where it was not measured.
    pub heading_rad: Option<f64>,
    /// Half the width of its 95 % interval, in rad.
    pub heading_half_rad: Option<f64>,
}

/// A change of a robot that is watched.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedChange {
    /// What changed: "numbers" of the robot, "place" of the return errors, or "scatter" of the runs.
    pub kind: &'static str,
    /// The first run after the change.
    pub since: String,
    /// The first run after the change lies between this one,
    pub earliest: String,
    /// and this one, with 95 % probability.
    pub latest: String,
    /// The run with which the alarm was raised.
    pub seen: String,
    /// Runs from the first after the change to that.
    pub runs_until_seen: usize,
    /// The numbers of the robot.
    pub numbers: Vec<WatchedNumber>,
    /// Lengths of which each accounts for the change of the numbers by itself, the best first.
    pub alone: Vec<WatchedLength>,
    /// p of what the numbers leave of the change of the return errors; null where they leave nothing to compare.
    pub p_left: Option<f64>,
    /// The mean return errors.
    pub places: Vec<WatchedPlace>,
    /// Scatter after over before, as a ratio of standard deviations; null where it is not known.
    pub scatter_ratio: Option<f64>,
    /// 95 % interval of that.
    pub scatter_interval: Option<[f64; 2]>,
}

/// How soon a change would be found that happened now.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WatchedDelay {
    /// The key of a length in robot.toml.
    pub key: &'static str,
    /// The share by which it grows.
    pub share: f64,
    /// Runs after which half of such changes are found; null for more than 60.
    pub half: Option<usize>,
    /// Runs after which nine of ten are; null for more than 60.
    pub most: Option<usize>,
}

/// What is known of a robot that is watched.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Watched {
    /// Whether something changed.
    pub changed: bool,
    /// The answer in words.
    pub sentence: String,
    /// The change; null where nothing changed.
    pub change: Option<WatchedChange>,
    /// Number of runs that are new.
    pub new: usize,
    /// All runs in the order in which they arrived.
    pub runs: Vec<WatchedRun>,
    /// Runs that the baseline still needs, clockwise and counter-clockwise.
    pub missing: [usize; 2],
    /// How soon changes would be found that happened now; empty while there is no baseline, and after an alarm.
    pub delays: Vec<WatchedDelay>,
    /// Runs that were watched before and are not in the data any more.
    pub vanished: Vec<String>,
    /// Runs that were watched before and have other values in the data now.
    pub altered: Vec<String>,
    /// Runs of the data that cannot be watched.
    pub left_out: Vec<String>,
    /// Probability of a false alarm in a month.
    pub false_alarms_per_month: f64,
    /// Runs in a month.
    pub runs_per_month: u32,
    /// Seed of the delays.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Watched {
    /// A robot that is watched, and what the data brought.
    pub fn new(watched: &drift::Watched, arrived: &Arrived) -> Watched {
        let left = watched.runs.iter().filter(|run| matches!(run.used, Use::LeftOut(_))).map(|run| run.name.clone());
        let run = |(place, point): (usize, &drift::Point)| WatchedRun::new(point, watched.outlying.contains(&place));
        let delay = |delay: &drift::Delay| {
            let &drift::Delay { key, share, half, most } = delay;
            WatchedDelay { key, share, half, most }
        };
        Watched {
            changed: watched.change.is_some(),
            sentence: watched.sentence(arrived),
            change: watched.change.as_ref().map(|change| WatchedChange::new(change, &watched.runs)),
            new: arrived.new,
            runs: watched.runs.iter().enumerate().map(run).collect(),
            missing: watched.missing,
            delays: watched.delays.iter().map(delay).collect(),
            vanished: arrived.vanished.clone(),
            altered: arrived.changed.clone(),
            left_out: arrived.left_out.iter().map(|(name, _)| name.clone()).chain(left).collect(),
            false_alarms_per_month: watched.rate.false_alarms_per_month,
            runs_per_month: watched.rate.runs_per_month,
            seed: watched.seed,
            version: crate::VERSION,
        }
    }
}

impl WatchedRun {
    fn new(point: &drift::Point, outlying: bool) -> WatchedRun {
        let height = |kind: Kind| point.heights.and_then(|all| finite(all[kind as usize]));
        let limit = |kind: Kind| point.limits.and_then(|all| finite(all[kind as usize]));
        let reason = match point.used {
            Use::LeftOut(reason) => Some(reason),
            _ => None,
        };
        WatchedRun {
            run: point.name.clone(),
            direction: point.direction.name(),
            used: point.used.name(),
            reason,
            outlying,
            p: point.p,
            numbers: height(Kind::Numbers),
            numbers_limit: limit(Kind::Numbers),
            place: height(Kind::Place),
            place_limit: limit(Kind::Place),
            scatter: height(Kind::Scatter),
            scatter_limit: limit(Kind::Scatter),
        }
    }
}

impl WatchedChange {
    fn new(change: &drift::Change, runs: &[drift::Point]) -> WatchedChange {
        let name = |place: usize| runs[place].name.clone();
        let moved = |number: &drift::MovedNumber| WatchedNumber {
            key: number.key,
            before: number.before.value,
            before_half: finite(number.before.half),
            after: number.after.value,
            after_half: finite(number.after.half),
            change: number.change,
            interval: ends(number.interval),
            p_adjusted: number.p_adjusted,
            moved: change.moved().any(|moved| moved.key == number.key),
        };
        let length = |alone: &drift::Alone| {
            let &drift::Alone { key, share, half, p, .. } = alone;
            WatchedLength { key, share, half: finite(half), p }
        };
        let place = |place: &drift::MovedPlace| WatchedPlace {
            direction: place.direction.name(),
            x_m: place.x.value,
            x_half_m: finite(place.x.half),
            y_m: place.y.value,
            y_half_m: finite(place.y.half),
            heading_rad: place.heading.map(|heading| heading.value),
            heading_half_rad: place.heading.and_then(|heading| finite(heading.half)),
        };
        WatchedChange {
            kind: change.kind.name(),
            since: name(change.since),
            earliest: name(change.earliest),
            latest: name(change.latest),
            seen: name(change.seen),
            runs_until_seen: change.runs_until_seen(runs),
            numbers: change.numbers.iter().map(moved).collect(),
            alone: change.alone.iter().map(length).collect(),
            p_left: change.p_left,
            places: change.places.iter().map(place).collect(),
            scatter_ratio: change.scatter.map(|scatter| scatter.ratio),
            scatter_interval: change.scatter.and_then(|scatter| ends(scatter.interval)),
        }
    }
}
