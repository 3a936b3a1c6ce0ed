//! `conditions`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{ends, finite};
use crate::conditions::{self, Kind};

/// A value with its error.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ValueWithError {
    /// The value, in the unit that the catalogue states.
    pub value: f64,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// Its interval.
    pub interval: Option<[f64; 2]>,
    /// Degrees of freedom of Student's t.
    pub degrees_of_freedom: f64,
}

/// A level of a condition.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LevelOfRuns {
    /// Its word.
    pub level: String,
    /// Number of runs.
    pub runs: usize,
}

/// A condition that was asked for.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AskedCondition {
    /// Its name, and those of others that divide the runs in the same way.
    pub names: Vec<String>,
    /// What it is: "levels", with a value each, or "amount", on which numbers depend by a slope.
    pub kind: &'static str,
    /// Its levels; none of an amount.
    pub levels: Vec<LevelOfRuns>,
    /// Of an amount, its smallest and largest value.
    pub range: Option<[f64; 2]>,
    /// Number of runs of which it is stated.
    pub runs: usize,
    /// Other conditions whose effect was fitted along.
    pub beside: Vec<String>,
    /// Conditions of which its effect cannot be told in these runs.
    pub like: Vec<String>,
    /// What differences are compared with: those between "runs", or those between "sessions".
    pub against: &'static str,
}

/// The value of a number at a level of a condition.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AtLevel {
    /// The level.
    pub level: String,
    /// The value by the runs of this level, other conditions at their mean.
    pub own: ValueWithError,
    /// The value drawn towards the mean of all levels by what its error leaves open.
    pub pooled: f64,
}

/// The largest difference between two levels.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LargestDifference {
    /// The level with the larger value.
    pub high: String,
    /// The other level.
    pub low: String,
    /// By how much it is larger.
    pub by: ValueWithError,
}

/// Whether a number depends on a condition, and how.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ByCondition {
    /// The number, EFFECT.PARAMETER.
    pub key: String,
    /// What it is, in words.
    pub meaning: String,
    /// The condition, by its first name.
    pub condition: String,
    /// Whether it depends on the condition by more than chance.
    pub differs: bool,
    /// p of no difference.
    pub p: f64,
    /// p adjusted for all numbers and conditions (Holm).
    pub p_adjusted: f64,
    /// Its values at the levels that show it; none of an amount.
    pub levels: Vec<AtLevel>,
    /// Standard deviation between levels (restricted maximum likelihood); null of an amount.
    pub sd_between: Option<f64>,
    /// Interval of that; its upper end is null where the levels leave it open.
    pub sd_between_interval: Option<[Option<f64>; 2]>,
    /// Of levels, the largest difference; null of an amount.
    pub largest: Option<LargestDifference>,
    /// Of an amount, the change by one of its units; null of levels.
    pub slope: Option<ValueWithError>,
    /// The smallest difference between two levels, or the smallest slope, that 80 % of such tests show.
    pub seen: Option<f64>,
}

/// A number of the robot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct NumberOfRobot {
    /// The number, EFFECT.PARAMETER.
    pub key: String,
    /// What it is, in words.
    pub meaning: String,
    /// Its value; that of a number which differs at the mean of the conditions on which it depends.
    pub value: ValueWithError,
    /// The conditions on which it depends, by their first names; none of a number that is one value for all runs.
    pub depends_on: Vec<String>,
}

/// Which numbers of a robot depend on which conditions.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Conditions {
    /// Whether a number depends on a condition by more than chance.
    pub differs: bool,
    /// The answer in words.
    pub sentence: String,
    /// What has to be known of the answer, a sentence each.
    pub remarks: Vec<String>,
    /// The numbers of the robot.
    pub numbers: Vec<NumberOfRobot>,
    /// Every number under every condition.
    pub asked: Vec<ByCondition>,
    /// The conditions.
    pub conditions: Vec<AskedCondition>,
    /// Conditions that are the same in all runs.
    pub same: Vec<String>,
    /// Number of runs.
    pub runs: usize,
    /// What was observed: "tracks" or "end_poses".
    pub observed: &'static str,
    /// Probability with which something is said to differ of a robot that is the same everywhere; intervals hold with the rest.
    pub size: f64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Conditions {
    /// What was found.
    pub fn new(found: &conditions::Conditions) -> Conditions {
        let name = |place: &usize| found.conditions[*place].condition.names[0].clone();
        let number = |shared: &conditions::Shared| NumberOfRobot {
            key: shared.number.key(),
            meaning: shared.meaning.clone(),
            value: ValueWithError::from(&shared.value),
            depends_on: shared.depends_on.iter().map(name).collect(),
        };
        let asked = |asked: &conditions::Asked| ByCondition {
            key: asked.number.key(),
            meaning: asked.meaning.clone(),
            condition: name(&asked.condition),
            differs: asked.is_shown(found.size),
            p: asked.p,
            p_adjusted: asked.p_adjusted,
            levels: asked.levels.iter().map(AtLevel::from).collect(),
            sd_between: asked.between.as_ref().and_then(|between| finite(between.deviation)),
            sd_between_interval: asked
                .between
                .as_ref()
                .map(|between| [finite(between.interval.low), finite(between.interval.high)]),
            largest: asked.largest.as_ref().map(|largest| LargestDifference {
                high: largest.high.clone(),
                low: largest.low.clone(),
                by: ValueWithError::from(&largest.by),
            }),
            slope: asked.slope.as_ref().map(ValueWithError::from),
            seen: finite(asked.seen),
        };
        Conditions {
            differs: found.differs(),
            sentence: found.sentence(),
            remarks: found.remarks(),
            numbers: found.numbers.iter().map(number).collect(),
            asked: found.asked.iter().map(asked).collect(),
            conditions: found.conditions.iter().map(AskedCondition::from).collect(),
            same: found.same.clone(),
            runs: found.runs,
            observed: found.level.name(),
            size: found.size,
            version: crate::VERSION,
        }
    }
}

impl From<&conditions::Estimate> for ValueWithError {
    fn from(estimate: &conditions::Estimate) -> Self {
        ValueWithError {
            value: estimate.value,
            standard_error: finite(estimate.standard_error),
            interval: ends(estimate.interval),
            degrees_of_freedom: estimate.degrees_of_freedom,
        }
    }
}

impl From<&conditions::AtLevel> for AtLevel {
    fn from(at: &conditions::AtLevel) -> Self {
        AtLevel { level: at.level.clone(), own: ValueWithError::from(&at.own), pooled: at.pooled }
    }
}

impl From<&conditions::AskedCondition> for AskedCondition {
    fn from(of: &conditions::AskedCondition) -> Self {
        let (kind, levels, range) = match &of.condition.kind {
            Kind::Levels(levels) => {
                let level = |(level, runs): (&String, &usize)| LevelOfRuns { level: level.clone(), runs: *runs };
                ("levels", levels.iter().zip(&of.runs).map(level).collect(), None)
            }
            Kind::Amount(range) => ("amount", Vec::new(), Some(*range)),
        };
        AskedCondition {
            names: of.condition.names.clone(),
            kind,
            levels,
            range,
            runs: of.runs.iter().sum(),
            beside: of.beside.clone(),
            like: of.like.clone(),
            against: of.against.name(),
        }
    }
}
