//! `changed`.

use schemars::JsonSchema;
use serde::Serialize;

use super::fitted::{Estimate, estimates};
use super::{ends, finite};
use crate::changed;
use crate::diagnose::Options;

/// A number before and after.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Moved {
    /// Its key: of robot.toml, with its unit; EFFECT.PARAMETER in the unit that the catalogue states; "wheel_diameter_ratio" (right over left) and
    /// "wheelbase_over_diameter" where the mean diameter is not shown; "scatter", the root mean square error that the median run leaves, in m.
    pub key: String,
    /// What it is, in words.
    pub meaning: String,
    /// What it belongs to: "robot", "effect", "scatter" or "reference".
    pub of: &'static str,
    /// Its value before.
    pub before: f64,
    /// Standard error of that; of the scatter, of its logarithm.
    pub before_standard_error: f64,
    /// Its value after.
    pub after: f64,
    /// Standard error of that; of the scatter, of its logarithm.
    pub after_standard_error: f64,
    /// After less before; of the scatter, after over before.
    pub change: f64,
    /// Interval of the change.
    pub interval: Option<[f64; 2]>,
    /// p of no change.
    pub p: f64,
    /// p adjusted for all numbers of its table (Holm).
    pub p_adjusted: f64,
    /// Whether it changed by more than chance.
    pub changed: bool,
    /// The smallest change that 80 % of such pairs of tests show; of the scatter, the smallest factor above 1.
    pub seen: Option<f64>,
}

/// A length that accounts for a change of ratios by itself.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Alone {
    /// Its key in robot.toml.
    pub key: &'static str,
    /// Change of it as a share of itself.
    pub share: f64,
    /// Standard error of that.
    pub standard_error: Option<f64>,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// Where START lies elsewhere in the second test.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct StartMoved {
    /// Along the first leg, in m.
    pub x_m: f64,
    /// To its left, in m.
    pub y_m: f64,
    /// Counter-clockwise, in rad; null where the returns have no headings.
    pub heading_rad: Option<f64>,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// What one of the two tests says by itself.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TestBeside {
    /// The verdict of its own model, in the words of `Diagnosis`.
    pub verdict: &'static str,
    /// Why that model must not be used as it is; null where nothing speaks against it.
    pub doubt: Option<String>,
    /// Number of runs.
    pub runs: usize,
    /// All that was fitted to it.
    pub fitted: Vec<Estimate>,
}

/// What changed of a robot between two tests.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Changed {
    /// Whether something of the robot changed by more than chance.
    pub changed: bool,
    /// Whether nothing changed by more than chance, and the test after is explained if the one before is.
    pub as_before: bool,
    /// The answer in words.
    pub sentence: String,
    /// Numbers of the robot and of its effects, and the scatter of its runs.
    pub robot: Vec<Moved>,
    /// Clock and mounting of the reference: not the robot's.
    pub reference: Vec<Moved>,
    /// Where return poses show ratios only, and these changed: each length that accounts for it by itself.
    pub alone: Vec<Alone>,
    /// Where START lies elsewhere in the second test, if that accounts for the change of the return poses, too; else null.
    pub start: Option<StartMoved>,
    /// Effects that one of the tests does not show, or with which it cannot be fitted; they are taken to be in it as in the other.
    pub assumed: Vec<&'static str>,
    /// Error of the second test with the robot's numbers of before, in m; null where it is not known.
    pub with_before_m: Option<f64>,
    /// Error of the second test with its own numbers, in m; null where it is not known.
    pub with_after_m: Option<f64>,
    /// Why the answer is in doubt, a sentence each.
    pub doubts: Vec<String>,
    /// The first test.
    pub before: TestBeside,
    /// The second test.
    pub after: TestBeside,
    /// Probability with which something is said to have changed of a robot that did not; intervals hold with the rest.
    pub size: f64,
    /// Simulated tests for p-values that have no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Changed {
    /// Two tests that were compared with `options`.
    pub fn new(found: &changed::Changed, options: &Options) -> Changed {
        let table = |table: &[changed::Moved]| table.iter().map(|moved| Moved::new(moved, found.size)).collect();
        let test = |test: &changed::Test| TestBeside {
            verdict: test.verdict.name(),
            doubt: test.doubt.clone(),
            runs: test.runs,
            fitted: estimates(&test.fit.estimates, 1.0 - found.size),
        };
        Changed {
            changed: found.is_changed(),
            as_before: found.is_as_before(),
            sentence: found.sentence(),
            robot: table(&found.robot),
            reference: table(&found.reference),
            alone: found.alone.iter().map(Alone::from).collect(),
            start: found.start.as_ref().map(StartMoved::from),
            assumed: found.assumed.clone(),
            with_before_m: found.costs.and_then(|[old, _]| finite(old)),
            with_after_m: found.costs.and_then(|[_, new]| finite(new)),
            doubts: found.doubts(),
            before: test(&found.before),
            after: test(&found.after),
            size: found.size,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
        }
    }
}

impl From<&changed::StartMoved> for StartMoved {
    fn from(start: &changed::StartMoved) -> Self {
        let &changed::StartMoved { x, y, heading, p } = start;
        StartMoved { x_m: x, y_m: y, heading_rad: heading, p }
    }
}

impl From<&changed::Alone> for Alone {
    fn from(alone: &changed::Alone) -> Self {
        let &changed::Alone { key, share, standard_error, p, .. } = alone;
        Alone { key, share, standard_error: finite(standard_error), p }
    }
}

impl Moved {
    fn new(moved: &changed::Moved, size: f64) -> Moved {
        Moved {
            key: moved.quantity.key.clone(),
            meaning: moved.quantity.meaning.clone(),
            of: moved.quantity.of.name(),
            before: moved.before.value,
            before_standard_error: moved.before.standard_error,
            after: moved.after.value,
            after_standard_error: moved.after.standard_error,
            change: moved.change,
            interval: ends(moved.interval),
            p: moved.p,
            p_adjusted: moved.p_adjusted,
            changed: moved.is_shown(size),
            seen: finite(moved.seen),
        }
    }
}
