//! Which numbers of a robot depend on the conditions of its runs: session, floor, load, temperature.
//!
//! Each run says by itself, with its information, where the numbers of the model are (`of_runs`). A number differs between the levels of a
//! condition if the runs' own values differ by more than runs of one level do among themselves, and depends on an amount if its slope does:
//!
//! ```text
//! θ_r = level of run r + Σ other conditions,    tested by T² with the runs as clusters
//! ```
//!
//! All numbers may differ at once, so a difference of one is not taken for one of another. No noise model enters: what a run says is
//! compared with other runs (`clusters`). A condition that is the same in whole sessions, and in several of them, is compared with sessions.
//! p is adjusted for all numbers and all conditions by Holm.
//!
//! Source: Holm (1979), Scandinavian Journal of Statistics 6, 65; the tests' own are named beside them.

mod ask;
mod between;
mod clusters;
mod numbers;
mod of_runs;
mod words;

#[cfg(test)]
mod tests;

use crate::dataset::{Dataset, stated};
use crate::diagnose::Options;
use crate::effect::Model;
use crate::evidence::{FitError, Level, robot_of};
use crate::stats::{Interval, student_t_quantile};
use crate::watch::Watch;
use ask::All;
use clusters::Combined;
use of_runs::Runs;

pub use crate::dataset::stated::{Condition, Kind, SESSION};
pub use between::Between;
pub(crate) use between::{between, mean_and_deviation};
pub use numbers::Number;

/// A difference as large as this share of tests would have found is told as what could be seen.
pub const POWER: f64 = 0.8;

/// Why conditions cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionsError {
    /// Nothing is stated.
    #[error(
        "nothing is stated of the conditions of the runs: write conditions.csv beside robot.toml, or give several datasets, each a session"
    )]
    NothingStated,
    /// All runs were driven alike.
    #[error("{} the same in all {runs} runs, so nothing can be compared: drive under other conditions too", is(.same))]
    AllTheSame {
        /// The conditions.
        same: Vec<String>,
        /// How many runs there are.
        runs: usize,
    },
    /// Runs that cannot be fitted.
    #[error("{}{source}", of_group(.group))]
    Fit {
        /// Their levels; `None` of all runs.
        group: Option<String>,
        /// Why.
        source: FitError,
    },
    /// Too few runs.
    #[error(
        "{runs} runs do not show whether a number differs: each level needs two runs or more, in each direction where only return poses are known"
    )]
    TooFew {
        /// How many there are.
        runs: usize,
    },
    /// Stopped by the user.
    #[error("stopped before all runs were fitted")]
    Stopped,
}

fn is(same: &[String]) -> String {
    format!("{} {}", same.join(", "), if same.len() == 1 { "is" } else { "are" })
}

fn of_group(group: &Option<String>) -> String {
    group.as_ref().filter(|group| !group.is_empty()).map_or(String::new(), |group| format!("runs with {group}: "))
}

/// What differences are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// What differs from run to run.
    Runs,
    /// What differs from session to session.
    Sessions,
}

impl Against {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Against::Runs => "runs",
            Against::Sessions => "sessions",
        }
    }
}

/// A condition, and how it was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedCondition {
    /// The condition.
    pub condition: Condition,
    /// Number of runs of each level; of an amount, of all runs of which it is known.
    pub runs: Vec<usize>,
    /// Other conditions whose effect was fitted along.
    pub beside: Vec<String>,
    /// Conditions of which it cannot be told in these runs.
    pub like: Vec<String>,
    /// What differences are compared with.
    pub against: Against,
}

/// A value with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// ν of Student's t.
    pub degrees_of_freedom: f64,
    /// Its interval.
    pub interval: Interval,
}

/// The value of a number at a level.
#[derive(Clone, Debug, PartialEq)]
pub struct AtLevel {
    /// The level.
    pub level: String,
    /// By the runs of this level, the other conditions at their mean.
    pub own: Estimate,
    /// Drawn towards the mean of all levels by what its error leaves open.
    pub pooled: f64,
}

/// The largest difference between two levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The level with the larger value.
    pub high: String,
    /// The other one.
    pub low: String,
    /// By how much it is larger.
    pub by: Estimate,
}

/// Whether a number depends on a condition, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The number.
    pub number: Number,
    /// What it is, in words.
    pub meaning: String,
    /// The place of the condition.
    pub condition: usize,
    /// p of no difference.
    pub p: f64,
    /// p adjusted for all numbers and conditions.
    pub p_adjusted: f64,
    /// The values at the levels that show it; none of an amount.
    pub levels: Vec<AtLevel>,
    /// Standard deviation between levels.
    pub between: Option<Between>,
    /// Of levels, the largest difference.
    pub largest: Option<Difference>,
    /// Of an amount, the change by one of its units.
    pub slope: Option<Estimate>,
    /// The smallest difference between two levels, or the smallest slope, that 80 % of such tests show.
    pub seen: f64,
    errors: Vec<f64>,
    freedom: f64,
}

/// The value of a number under all conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// The number.
    pub number: Number,
    /// What it is, in words.
    pub meaning: String,
    /// Its value; that of numbers which differ at the mean of the conditions on which they depend.
    pub value: Estimate,
    /// The places of the conditions on which it depends.
    pub depends_on: Vec<usize>,
}

/// Which numbers of a robot depend on which conditions.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// What was asked.
    pub conditions: Vec<AskedCondition>,
    /// Conditions that are the same in all runs: nothing is known of others.
    pub same: Vec<String>,
    /// Every number under every condition.
    pub asked: Vec<Asked>,
    /// The numbers.
    pub numbers: Vec<Shared>,
    /// Number of runs.
    pub runs: usize,
    /// How much of the runs was observed.
    pub level: Level,
    /// Whether the sessions are known to drive different paths.
    pub other_paths: bool,
    /// Family-wise false-alarm rate; intervals hold with the rest.
    pub size: f64,
}

/// Asks of each number of a model that is the robot's whether it depends on a condition of the runs. `start` has the free effects.
///
/// ```
/// use umbmark_core::{calibrate::{Correction, drive_again}, conditions::conditions, diagnose::{Options, first_model}};
/// use umbmark_core::{dataset::{Dataset, Run, RunConditions, Stated}, drive::Robot, effect::TestKind, path::{Direction, Path}};
/// use umbmark_core::watch::Watch;
/// let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let floor = |number: u32| if number % 4 < 2 { ("tile", 0.99) } else { ("carpet", 1.01) };
/// let run = |number: u32| {
///     let direction = Direction::BOTH[number as usize % 2];
///     let truth = Correction { e_d: 1.002, e_b: floor(number).1, e_s: 1.0 };
///     let error = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
///     let scatter = |k: u32| 2e-3 * (f64::from((number * number + 3 * number + k) % 11) - 5.0);
///     let returned = Some(umbmark_core::dataset::ReturnError { x: error.x + scatter(0), y: error.y + scatter(4), heading: None });
///     Run { name: format!("run {number}"), number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
/// };
/// let stated = |number: u32| RunConditions {
///     run: format!("run {number}"),
///     stated: vec![("floor".into(), Stated::Word(floor(number).0.into()))],
/// };
/// let data = Dataset {
///     robot: Some(robot.clone()), path: Some(path.clone()),
///     runs: (0..20).map(run).collect(), conditions: (0..20).map(stated).collect(), ..Dataset::default()
/// };
/// let found = Watch::nobody(|watch| conditions(&data, &first_model(&data)?, &Options::default(), watch).map_err(Box::<dyn std::error::Error>::from))?;
/// let differs: Vec<String> = found.differing().map(|asked| asked.number.key()).collect();
/// assert_eq!(differs, ["wheelbase.e_b"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConditionsError`] if nothing is stated or differs, if the runs are too few, or if a model cannot be fitted to them.
pub fn conditions(
    data: &Dataset,
    start: &Model,
    options: &Options,
    watch: &Watch,
) -> Result<Conditions, ConditionsError> {
    let unfit = |source| ConditionsError::Fit { group: None, source };
    start.check_robot(robot_of(data).map_err(unfit)?).map_err(|error| unfit(error.into()))?;
    let level = options.level(data);
    let runs = Runs::of(data, level).map_err(unfit)?;
    let (found, same) = stated::conditions(data, &runs.names);
    if found.is_empty() {
        return Err(match same.is_empty() {
            true => ConditionsError::NothingStated,
            false => ConditionsError::AllTheSame { same, runs: runs.names.len() },
        });
    }
    let (numbers, said) = runs.said(start, &found, watch)?;
    let described = |number: &Number| (*number, words::meaning(start, number));
    let numbers: Vec<(Number, String)> = numbers.iter().map(described).collect();
    let all = All { conditions: &found, numbers: &numbers, said: &said, options };
    let mut asked = Vec::new();
    let mut conditions = Vec::new();
    for condition in 0..found.len() {
        let (of, answers) = all.ask(condition);
        conditions.push(of);
        asked.extend(answers);
    }
    if asked.is_empty() {
        return Err(ConditionsError::TooFew { runs: runs.names.len() });
    }
    adjust(&mut asked, options.size);
    let numbers = all.numbers_of(&asked).ok_or(ConditionsError::TooFew { runs: runs.names.len() })?;
    let (runs, other_paths) = (runs.names.len(), data.drives_other_paths());
    Ok(Conditions { conditions, same, asked, numbers, runs, level, other_paths, size: options.size })
}

impl Estimate {
    fn of(found: &Combined, level: f64) -> Estimate {
        let value = found.values[0];
        Estimate {
            value,
            standard_error: found.standard_error(),
            degrees_of_freedom: found.freedom,
            interval: Interval::around(value, found.half_width(level)),
        }
    }
}

impl Asked {
    /// Whether the number depends on the condition by more than chance.
    pub fn is_shown(&self, size: f64) -> bool {
        self.p_adjusted < size
    }
}

/// Adjusts p for all that is asked (Holm), and settles what could be seen.
fn adjust(asked: &mut [Asked], size: f64) {
    let n = asked.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| asked[*a].p.total_cmp(&asked[*b].p));
    let mut least = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        least = least.max((n - rank) as f64 * asked[index].p).min(1.0);
        asked[index].p_adjusted = least;
    }
    for own in asked {
        let pairs = own.errors.len().max(1);
        let error = own.errors.iter().copied().fold(0.0, f64::max);
        let share = 0.5 * size / (n * pairs) as f64;
        own.seen = error * (student_t_quantile(1.0 - share, own.freedom) + student_t_quantile(POWER, own.freedom));
    }
}

impl Conditions {
    /// What depends on a condition by more than chance.
    pub fn differing(&self) -> impl Iterator<Item = &Asked> {
        self.asked.iter().filter(|asked| asked.is_shown(self.size))
    }

    /// Whether something does.
    pub fn differs(&self) -> bool {
        self.differing().next().is_some()
    }

    /// The answer in words.
    pub fn sentence(&self) -> String {
        words::sentence(self)
    }

    /// What has to be known of the answer, a sentence each.
    pub fn remarks(&self) -> Vec<String> {
        words::remarks(self)
    }
}
