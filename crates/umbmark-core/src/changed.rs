//! What changed of a robot between two tests.
//!
//! A model is learnt from either test. Effects that one of them shows are fitted to both, so that the same numbers are compared; clock and
//! mounting of a reference belong to its test. A number x changed if
//!
//! ```text
//! t = (x_after - x_before) / √(s²_before + s²_after)
//! ```
//!
//! is larger than chance makes: Student's t with the degrees of freedom of Welch and Satterthwaite, and p adjusted for all numbers of the
//! robot by Holm. What the runs leave is compared as well, by the logarithms of the runs' own errors.
//!
//! Sources: Welch (1947), Biometrika 34, 28; Holm (1979), Scandinavian Journal of Statistics 6, 65.

mod alone;
mod model;
mod quantities;
mod scatter;
mod start;
mod words;

#[cfg(test)]
mod tests;

use crate::dataset::Dataset;
use crate::diagnose::{Options, Verdict};
use crate::effect::Model;
use crate::evidence::{self, AnyEvidence, FitError, Level, robot_of};
use crate::learn::learn_from;
use crate::setup::Fault;
use crate::solve::Meter;
use crate::stats::{Interval, student_t_quantile, t_two_sided};
use crate::watch::Watch;

pub use alone::Alone;
pub(crate) use model::is_of_test;
pub use quantities::{Of, Quantity};
pub use start::StartMoved;

/// A change as large as this share of tests would have found is told as what could be seen.
pub const POWER: f64 = 0.8;

/// Why two tests cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChangeError {
    /// Robots of two kinds.
    #[error(
        "the robot before has drive = \"{before}\", and that after drive = \"{after}\"; compare tests of one robot"
    )]
    Drive {
        /// Its kind before.
        before: &'static str,
        /// Its kind after.
        after: &'static str,
    },
    /// One test that cannot be fitted.
    #[error("{test}: {source}")]
    Fit {
        /// Which: "before" or "after".
        test: &'static str,
        /// Why.
        source: FitError,
    },
    /// Nothing that both tests show.
    #[error("no number of the robot is shown by both tests: drive the same path in both, in both directions")]
    NothingInCommon,
}

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// ν of Student's t.
    pub degrees_of_freedom: f64,
}

/// A number before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    /// What it is.
    pub quantity: Quantity,
    /// Before.
    pub before: Value,
    /// After.
    pub after: Value,
    /// After less before; of the scatter, after over before.
    pub change: f64,
    /// Its interval.
    pub interval: Interval,
    /// p of no change.
    pub p: f64,
    /// p adjusted for all numbers of its table.
    pub p_adjusted: f64,
    /// The smallest change that 80 % of such pairs of tests show; of the scatter, the smallest factor above 1.
    pub seen: f64,
}

/// What one test says by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// The verdict of its own model.
    pub verdict: Verdict,
    /// Why that model must not be used as it is; `None` where nothing speaks against it.
    pub doubt: Option<String>,
    /// Number of runs.
    pub runs: usize,
    /// The fit of all that is compared.
    pub fit: evidence::Fit,
}

/// What changed of a robot between two tests.
#[derive(Clone, Debug)]
pub struct Changed {
    /// The first test.
    pub before: Test,
    /// The second test.
    pub after: Test,
    /// Numbers of the robot and of its effects, and the scatter.
    pub robot: Vec<Moved>,
    /// Clock and mounting of the reference: not the robot's.
    pub reference: Vec<Moved>,
    /// Where return poses show ratios only, and these changed: each length that accounts for it by itself.
    pub alone: Vec<Alone>,
    /// Where START lies elsewhere in the second test, if that accounts for the change of the return poses, too.
    pub start: Option<StartMoved>,
    /// Effects that one of the tests does not show, or with which it cannot be fitted; they are taken to be in it as in the other.
    pub assumed: Vec<&'static str>,
    /// Error of the second test with the robot's numbers of before, and with those of after \[m\]; `None` where it is not known.
    pub costs: Option<[f64; 2]>,
    /// Family-wise false-alarm rate; intervals hold with the rest.
    pub size: f64,
}

/// Compares two tests of one robot. `start` holds further effects that are fitted to both; both are of its nominal robot or converted.
///
/// ```
/// use umbmark_core::{dataset::{Dataset, ReturnError, Run}, diagnose::Options, drive::Robot, path::{Direction, Path}};
/// use umbmark_core::{calibrate::{Correction, drive_again}, changed::changed, effect::{Model, TestKind}, watch::Watch};
/// let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let test = |e_d: f64, seed: u32| {
///     let truth = Correction { e_d, e_b: 0.99, e_s: 1.0 };
///     let run = |number: u32| {
///         let direction = Direction::BOTH[number as usize % 2];
///         let error = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
///         let scatter = |k: u32| 2e-3 * (f64::from((number * number + seed * number + k) % 11) - 5.0);
///         let returned = Some(ReturnError { x: error.x + scatter(0), y: error.y + scatter(4), heading: None });
///         Run { name: format!("run {number}"), number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
///     };
///     let (robot, path) = (Some(robot.clone()), Some(path.clone()));
///     Dataset { robot, path, runs: (0..10).map(run).collect(), ..Dataset::default() }
/// };
/// let start = Model::new(&robot);
/// let compared = |after| Watch::nobody(|watch| changed(&test(1.002, 1), &after, &start, &Options::default(), watch));
/// let worn = compared(test(1.001, 2))?;
/// assert_eq!(worn.moved().map(|moved| moved.quantity.key.as_str()).collect::<Vec<_>>(), ["wheel_diameter_ratio"]);
/// assert!(!compared(test(1.002, 3))?.is_changed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn changed(
    before: &Dataset,
    after: &Dataset,
    start: &Model,
    options: &Options,
    watch: &Watch,
) -> Result<Changed, ChangeError> {
    let [of_before, of_after] = [("before", before), ("after", after)];
    let kinds = [of_before, of_after].map(|(test, data)| {
        robot_of(data).map(|robot| robot.drive.kind().name()).map_err(|source| ChangeError::Fit { test, source })
    });
    let [before_kind, after_kind] = kinds;
    let (before_kind, after_kind) = (before_kind?, after_kind?);
    if before_kind != after_kind {
        return Err(ChangeError::Drive { before: before_kind, after: after_kind });
    }
    // Numbers of tracks and of return poses are not weighed alike.
    let ends_only = [before, after].iter().any(|data| options.level(data) == Level::Ends);
    let options = Options { ends_only, ..*options };
    let tests = [of_before, of_after].map(|(test, data)| {
        Learned::of(data, start, &options, watch).map_err(|source| ChangeError::Fit { test, source })
    });
    let [before, after] = tests;
    Learned::compared([before?, after?], &options)
}

/// A test, and what was learnt from it.
struct Learned<'a> {
    data: &'a Dataset,
    evidence: AnyEvidence,
    model: Model,
    verdict: Verdict,
    doubt: Option<String>,
}

impl<'a> Learned<'a> {
    fn of(data: &'a Dataset, start: &Model, options: &Options, watch: &Watch) -> Result<Self, FitError> {
        let (start, _) = start.converted(robot_of(data)?)?;
        let learnt = learn_from(data, &start, options, watch)?;
        let faults: Vec<Fault> = learnt.diagnosis.setup.all_faults().cloned().collect();
        if !faults.is_empty() {
            return Err(FitError::Faulty { faults });
        }
        let doubt = learnt.is_in_doubt().then(|| {
            let reasons = learnt.diagnosis.reasons.iter().map(|reason| reason.sentence());
            reasons.chain([format!("the verdict is \"{}\"", learnt.verdict.name())]).next().unwrap_or_default()
        });
        let evidence = AnyEvidence::of(data, options.level(data))?;
        Ok(Learned { data, evidence, model: learnt.model, verdict: learnt.verdict, doubt })
    }

    fn compared(tests: [Learned; 2], options: &Options) -> Result<Changed, ChangeError> {
        let (fits, assumed) = model::fitted(&tests)?;
        let mut robot = Vec::new();
        let mut reference = Vec::new();
        for (quantity, [before, after]) in quantities::of(&fits) {
            let table = if quantity.of == Of::Reference { &mut reference } else { &mut robot };
            table.extend(Moved::of(quantity, before, after, options.size));
        }
        robot.extend(scatter::of(&tests, &fits, options.size));
        if robot.iter().all(|moved| moved.quantity.of == Of::Scatter) {
            return Err(ChangeError::NothingInCommon);
        }
        [&mut robot, &mut reference].into_iter().for_each(|table| adjust(table, options.size));
        let [before, after] = &tests;
        let costs = Meter::new(after.data, &after.evidence).and_then(|meter| {
            let old = model::with_numbers_of(&fits[1].model, &fits[0].model).ok()?;
            Some([meter.off(&old), meter.off(&fits[1].model)])
        });
        let is_moved = |moved: &Moved| moved.quantity.of == Of::Robot && moved.is_shown(options.size);
        let alone = if robot.iter().any(is_moved) { alone::of(&fits, options.size) } else { Vec::new() };
        let is_changed = robot.iter().any(|moved| moved.quantity.of != Of::Scatter && moved.is_shown(options.size));
        let start = if is_changed { start::of(&tests, options.size) } else { None };
        let [of_before, of_after] = fits;
        let test = |test: &Learned, fit: evidence::Fit| Test {
            verdict: test.verdict,
            doubt: test.doubt.clone(),
            runs: test.data.runs.len(),
            fit,
        };
        let (before, after) = (test(before, of_before), test(after, of_after));
        Ok(Changed { before, after, robot, reference, alone, start, assumed, costs, size: options.size })
    }
}

impl Moved {
    /// A difference of two values; `None` where an error is not known.
    fn of(quantity: Quantity, before: Value, after: Value, size: f64) -> Option<Moved> {
        let [a, b] = [before, after].map(|value| value.standard_error * value.standard_error);
        let error = (a + b).sqrt();
        if !(error.is_finite() && error > 0.0) {
            return None;
        }
        let freedom = freedom([(a, before.degrees_of_freedom), (b, after.degrees_of_freedom)]);
        let change = after.value - before.value;
        let p = t_two_sided(change / error, freedom);
        let half = student_t_quantile(1.0 - 0.5 * size, freedom) * error;
        let interval = Interval::around(change, half);
        // The smallest that is seen is settled once it is known how many numbers are asked.
        let seen = error;
        Some(Moved { quantity, before, after, change, interval, p, p_adjusted: p, seen })
    }

    /// Whether it changed by more than chance.
    pub fn is_shown(&self, size: f64) -> bool {
        self.p_adjusted < size
    }
}

/// ν of a sum of variances of means (Welch and Satterthwaite).
fn freedom(variances: [(f64, f64); 2]) -> f64 {
    let all: f64 = variances.iter().map(|(variance, _)| variance).sum();
    let each = variances.iter().map(|(variance, freedom)| variance * variance / freedom.max(1.0)).sum::<f64>();
    (all * all / each).max(1.0)
}

/// Adjusts p for all numbers of a table (Holm), and settles what could be seen.
fn adjust(table: &mut [Moved], size: f64) {
    let n = table.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| table[*a].p.total_cmp(&table[*b].p));
    let mut least = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        least = least.max((n - rank) as f64 * table[index].p).min(1.0);
        table[index].p_adjusted = least;
    }
    for moved in table {
        let [a, b] = [moved.before, moved.after].map(|v| (v.standard_error.powi(2), v.degrees_of_freedom));
        let freedom = freedom([a, b]);
        let sure = student_t_quantile(1.0 - 0.5 * size / n as f64, freedom) + student_t_quantile(POWER, freedom);
        moved.seen = match moved.quantity.of {
            Of::Scatter => libm::exp(sure * moved.seen),
            _ => sure * moved.seen,
        };
    }
}

impl Changed {
    /// Numbers of the robot that changed by more than chance.
    pub fn moved(&self) -> impl Iterator<Item = &Moved> {
        self.robot.iter().filter(|moved| moved.is_shown(self.size))
    }

    /// Whether something of the robot changed by more than chance.
    pub fn is_changed(&self) -> bool {
        self.moved().next().is_some()
    }

    /// Whether nothing changed by more than chance, and the test after is explained if the one before is.
    pub fn is_as_before(&self) -> bool {
        !self.is_changed() && (self.after.doubt.is_none() || self.before.doubt.is_some())
    }

    /// Why the answer is in doubt, a sentence each: a test that no model explains.
    pub fn doubts(&self) -> Vec<String> {
        let of = |(name, test): (&str, &Test)| {
            let why = test.doubt.as_ref()?;
            Some(format!("No model explains the test {name}: {why}."))
        };
        [("before", &self.before), ("after", &self.after)].into_iter().filter_map(of).collect()
    }

    /// What changed, in words.
    pub fn sentence(&self) -> String {
        words::sentence(self)
    }
}
