//! `compare` along the way.

use schemars::JsonSchema;
use serde::Serialize;

use super::remains::least_left;
use super::{Keyed, Leaves, Setup, Taken, finite, reasons, taken};
use crate::compare::tracks::{self, By};
use crate::diagnose::Options;
use crate::path::Direction;
use crate::stats::Interval;

/// Root mean square errors.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RootMeanSquare {
    /// Of positions, in m.
    pub rmse_m: Option<f64>,
    /// Of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
}

impl From<&tracks::Rms> for RootMeanSquare {
    fn from(rms: &tracks::Rms) -> Self {
        RootMeanSquare { rmse_m: finite(rms.position), heading_rmse_rad: rms.heading }
    }
}

/// A mean over runs with its interval, and the scatter of the runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Mean {
    /// The mean; null without runs.
    pub mean: Option<f64>,
    /// Its interval, with null for an open end; null for a single run.
    pub interval: Option<[Option<f64>; 2]>,
    /// Number of runs.
    pub runs: usize,
    /// Standard deviation of the runs; null with a single one.
    pub sd: Option<f64>,
}

/// Share of a part of the path in the squared error.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PartShare {
    /// Of positions along the path.
    pub position: Option<f64>,
    /// Of headings along the path.
    pub heading: Option<f64>,
    /// Of positions at its end.
    pub end: Option<f64>,
}

/// Error that a part of the path adds.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Part {
    /// Ahead, in m.
    pub forward_m: Mean,
    /// To the left, in m.
    pub sideways_m: Mean,
    /// In heading, in rad.
    pub heading_rad: Mean,
    /// Its name.
    pub name: String,
    /// "cw" or "ccw"; null for both together.
    pub direction: Option<&'static str>,
    /// How many there are.
    pub count: usize,
    /// Its share in the squared error.
    pub share: PartShare,
}

impl From<&tracks::Part> for Part {
    fn from(part: &tracks::Part) -> Self {
        let mean = |k: usize| {
            let mean = &part.mean[k];
            Mean {
                mean: finite(mean.value),
                interval: mean.interval.map(half_open),
                runs: mean.runs,
                sd: part.spread.and_then(|spread| finite(spread[k])),
            }
        };
        let share = part.share;
        Part {
            forward_m: mean(0),
            sideways_m: mean(1),
            heading_rad: mean(2),
            name: part.name.clone(),
            direction: part.direction.map(Direction::name),
            count: part.count,
            share: PartShare {
                position: finite(share.position),
                heading: finite(share.heading),
                end: finite(share.end),
            },
        }
    }
}

/// Mean rate of an error over the whole path.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Overall {
    /// The mean; null without runs.
    pub mean: Option<f64>,
    /// Its interval, with null for an open end; null for a single run.
    pub interval: Option<[Option<f64>; 2]>,
    /// Number of runs.
    pub runs: usize,
    /// p of a rate of zero; null if it was not tested.
    pub p: Option<f64>,
    /// Share by which the error of runs left out falls if the mean rate is taken off; null if it was not tested.
    pub gain: Option<f64>,
}

impl From<&tracks::Overall> for Overall {
    fn from(overall: &tracks::Overall) -> Self {
        let mean = &overall.mean;
        Overall {
            mean: finite(mean.value),
            interval: mean.interval.map(half_open),
            runs: mean.runs,
            p: overall.test.map(|test| test.p),
            gain: overall.test.map(|test| test.gain),
        }
    }
}

/// Mean rate of an error while a quantity is between two values, for one sense or both.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Bin {
    /// The mean; null without runs.
    pub mean: Option<f64>,
    /// Its interval, with null for an open end; null for fewer than two runs.
    pub interval: Option<[Option<f64>; 2]>,
    /// Number of runs.
    pub runs: usize,
    /// Least value of the quantity.
    pub low: f64,
    /// Largest value of the quantity; null if it is open.
    pub high: Option<f64>,
    /// 1 counter-clockwise, -1 clockwise, 0 both.
    pub sense: f64,
    /// Amount of driving in this bin, in the unit of the rate.
    pub amount: f64,
}

impl From<&tracks::Bin> for Bin {
    fn from(bin: &tracks::Bin) -> Self {
        let mean = bin.mean.as_ref();
        Bin {
            mean: mean.and_then(|mean| finite(mean.value)),
            interval: mean.and_then(|mean| mean.interval).map(half_open),
            runs: mean.map_or(0, |mean| mean.runs),
            low: bin.span.low,
            high: finite(bin.span.high),
            sense: bin.span.sense,
            amount: bin.amount,
        }
    }
}

/// Rate of an error as a function of a quantity.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Against {
    /// The rate.
    pub rate: &'static str,
    /// The quantity.
    pub covariate: &'static str,
    /// Unit of the quantity.
    pub unit: &'static str,
    /// p of no dependence; null if it was not tested.
    pub p: Option<f64>,
    /// Share by which the error of runs left out falls if the dependence is taken off; null if it was not tested.
    pub gain: Option<f64>,
    /// The rate in each span of the quantity.
    pub bins: Vec<Bin>,
}

impl From<&tracks::Against> for Against {
    fn from(against: &tracks::Against) -> Self {
        Against {
            rate: against.rate.key(),
            covariate: against.covariate.name,
            unit: against.covariate.units[usize::from(against.rate.of_turns())],
            p: against.test.map(|test| test.p),
            gain: against.test.map(|test| test.gain),
            bins: against.bins.iter().map(Bin::from).collect(),
        }
    }
}

/// Result of one model along the path, and at its end.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct JudgedAlong {
    /// Its name.
    pub name: String,
    /// Whether it explains the tracks; null if nothing was tested.
    pub explains: Option<bool>,
    /// p of all tests together: the smallest of those with a gain of at least 0.02, times the number of all; null if nothing was tested.
    pub p: Option<f64>,
    /// Number of these tests.
    pub tests: usize,
    /// Errors along the path.
    pub along: RootMeanSquare,
    /// Errors at its end.
    pub end: RootMeanSquare,
    /// Error that each part of the path adds, for each way of grouping parts.
    pub parts: Keyed<Vec<Part>>,
    /// Mean rates of the error.
    pub overall: Keyed<Overall>,
    /// Rates of the error as functions of driving quantities.
    pub against: Vec<Against>,
    /// Findings, a sentence each.
    pub sentences: Vec<String>,
    /// Effects of the reference whose values were estimated from the motion.
    pub taken: Vec<Taken>,
    /// Why the model does not explain the tracks, a sentence each.
    pub reasons: Vec<String>,
    /// The remaining error of the model.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl JudgedAlong {
    fn new(judged: &tracks::TracksJudged, options: &Options) -> JudgedAlong {
        let parts = |by: By| judged.errors.parts.iter().filter(|part| part.by == by).map(Part::from).collect();
        JudgedAlong {
            name: judged.errors.name.clone(),
            explains: judged.explains(options.size),
            p: judged.errors.p,
            tests: judged.errors.tests,
            along: (&judged.errors.along).into(),
            end: (&judged.errors.end).into(),
            parts: By::ALL.into_iter().map(|by| (by.key(), parts(by))).collect(),
            overall: judged.errors.overall.iter().map(|overall| (overall.rate.key(), overall.into())).collect(),
            against: judged.errors.against.iter().map(Against::from).collect(),
            sentences: judged.sentences.clone(),
            taken: taken(&judged.errors.taken),
            reasons: reasons(&judged.reasons),
            leaves: judged.remains.as_ref().into(),
        }
    }
}

/// Models compared with tracks: where along the path the error arises, and what it depends on.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TrackComparison {
    /// "tracks".
    pub observed: &'static str,
    /// Number of clockwise runs.
    pub n_cw: usize,
    /// Number of counter-clockwise runs.
    pub n_ccw: usize,
    /// Number of runs of neither direction.
    pub n_other: usize,
    /// Number of observations.
    pub poses: usize,
    /// The models, in the order in which they were given.
    pub models: Vec<JudgedAlong>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// False-alarm rate: probability that a correct model is rejected.
    pub size: f64,
    /// Version of umbmark.
    pub version: &'static str,
    /// The remaining error of the best model.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl TrackComparison {
    /// A comparison that was asked for with `options`.
    pub fn new(comparison: &tracks::TrackComparison, options: &Options) -> TrackComparison {
        let [n_cw, n_ccw, n_other] = comparison.runs;
        TrackComparison {
            observed: "tracks",
            n_cw,
            n_ccw,
            n_other,
            poses: comparison.poses,
            models: comparison.models.iter().map(|judged| JudgedAlong::new(judged, options)).collect(),
            remarks: comparison.remarks.clone(),
            setup: comparison.setup.as_ref().into(),
            size: options.size,
            version: crate::VERSION,
            leaves: least_left(comparison.models.iter().filter_map(|model| model.remains.as_ref())).into(),
        }
    }
}

/// The ends of an interval; nothing for one that is open.
fn half_open(interval: Interval) -> [Option<f64>; 2] {
    [finite(interval.low), finite(interval.high)]
}
