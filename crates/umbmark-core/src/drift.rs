//! A robot that is tested again and again: does it change, since when, and what of it?
//!
//! Each new run is compared with what the earlier runs of its direction predict. Its scores are standard normal while nothing changes, whatever the
//! robot, its path and its noise are (`scores`). The likelihood ratios of a change before any of the runs (`statistic`) raise an alarm where they
//! exceed limits that were simulated once (`limits`), so that the false-alarm rate is as stated, the same with every run
//! from the first that is scored.
//!
//! | what changed | seen in |
//! |---|---|
//! | E_d and E_b; E_s too where runs were tracked | a shift of the return errors of both directions that these numbers make |
//! | the place | any other shift of the return errors of either direction |
//! | the scatter | larger scores in any direction |
//!
//! Held: runs are independent, and normal while nothing changes. A run that lies far out counts as if it lay where one good run in 200 does, so one bad
//! run is outlying, and no change.

mod delay;
mod found;
mod limits;
mod observation;
mod record;
mod scores;
mod statistic;
mod words;

#[cfg(test)]
mod tests;

use crate::drive::Robot;
use crate::evidence::FitError;
use crate::path::{Direction, Path};
use crate::stats::chi_squared_upper_tail;
use scores::{COMPONENTS, Scorer, Vector, reach};
use statistic::{Scan, Signature};

pub use delay::{DELAYS, Delay};
pub use found::{Alone, Change, MovedNumber, MovedPlace, MovedScatter, Value};
pub use observation::{NUMBERS, Observation};
pub use record::{Arrived, Known, Rate, Record, Restart};
pub use statistic::Kind;

/// Why a robot cannot be watched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriftError {
    /// A rate out of its range.
    #[error(
        "the false-alarm rate must be above 0 and at most 0.5 a month, and the runs 1 to 100000 a month; got {rate} and {runs}"
    )]
    Rate {
        /// False alarms a month.
        rate: f64,
        /// Runs a month.
        runs: u32,
    },
    /// A drive without two wheels on an axle.
    #[error("a robot with drive = \"{drive}\" cannot be watched: E_d and E_b are numbers of two wheels on an axle")]
    OtherDrive {
        /// Its kind.
        drive: &'static str,
    },
    /// Return errors of different paths.
    #[error("the datasets drive different paths, whose return errors cannot be compared; watch each path by itself")]
    OtherPaths,
    /// A record of another robot or path.
    #[error("the state is of another robot or path: it has {difference}; watch this one with a state of its own")]
    Foreign {
        /// What differs.
        difference: String,
    },
    /// A record that was watched at another rate.
    #[error(
        "the state is watched with {} false alarms a month of {} runs, and not with {} of {}; give the same, or begin a new state",
        there.false_alarms_per_month, there.runs_per_month, here.false_alarms_per_month, here.runs_per_month
    )]
    OtherRate {
        /// Of the record.
        there: Rate,
        /// What was asked for.
        here: Rate,
    },
    /// A run that is not known.
    #[error("no run is called \"{name}\"; {}", last.as_ref().map_or("there is none yet".to_owned(), |last| format!("the last one is \"{last}\"")))]
    NoSuchRun {
        /// The name.
        name: String,
        /// The last run that is known.
        last: Option<String>,
    },
    /// A record that says what no record can.
    #[error("{what}")]
    Damaged {
        /// What.
        what: String,
    },
    /// Data that cannot be used.
    #[error(transparent)]
    Data(#[from] FitError),
}

/// What a run is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Nothing: it was driven before the baseline begins.
    Earlier,
    /// The first runs of its direction, with which later ones are compared.
    Baseline,
    /// It was compared with the earlier runs.
    Compared,
    /// It cannot be compared, and why.
    LeftOut(&'static str),
}

impl Use {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Use::Earlier => "earlier",
            Use::Baseline => "baseline",
            Use::Compared => "compared",
            Use::LeftOut(_) => "left_out",
        }
    }
}

/// A run and what it says.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its name.
    pub name: String,
    /// Its direction.
    pub direction: Direction,
    /// What it is used for.
    pub used: Use,
    /// How far it lies from what the earlier runs predict: the probability that a good run lies as far.
    pub p: Option<f64>,
    /// Largest likelihood ratio of each kind of change, its logarithm, as of this run.
    pub heights: Option<[f64; 3]>,
    /// Limits of those.
    pub limits: Option<[f64; 3]>,
}

impl Point {
    /// Kinds of change whose limit is exceeded.
    fn alarms(&self) -> impl Iterator<Item = Kind> + '_ {
        let both = self.heights.zip(self.limits);
        let above =
            move |kind: &Kind| both.is_some_and(|(heights, limits)| heights[*kind as usize] > limits[*kind as usize]);
        Kind::ALL.into_iter().filter(above)
    }
}

/// What is known of a robot that is watched.
#[derive(Clone, Debug, PartialEq)]
pub struct Watched {
    /// All runs in the order in which they arrived.
    pub runs: Vec<Point>,
    /// Place of the run with which the baseline begins.
    pub begins: usize,
    /// The false-alarm rate.
    pub rate: Rate,
    /// The change, if there is an alarm.
    pub change: Option<Change>,
    /// Places of runs that lie by themselves.
    pub outlying: Vec<usize>,
    /// Runs that the baseline still needs, clockwise and counter-clockwise; of a direction in which no run was driven, 0.
    pub missing: [usize; 2],
    /// How soon changes would be found that happened now; empty while there is no baseline, and after an alarm.
    pub delays: Vec<Delay>,
    /// Seed of these.
    pub seed: u64,
}

/// A run of the baseline or after it, in the components that all of them have.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Place among all runs.
    place: usize,
    direction: usize,
    components: Vector,
}

/// All that is worked out of the runs since the baseline began.
struct Course {
    signature: Signature,
    steps: Vec<Step>,
    /// Why runs are not among the steps.
    left: Vec<(usize, &'static str)>,
    directions: usize,
}

/// Ways that differ by this share are of different paths.
const OTHER_WAY: f64 = 0.1;

impl Course {
    /// The runs from the one with which the baseline begins; the first decides what all must have.
    fn of(record: &Record) -> Course {
        let since = &record.runs[record.begins.min(record.runs.len())..];
        let first = since.first();
        let heading = first.is_some_and(|run| run.heading_rad.is_some());
        let scale = heading && first.is_some_and(|run| run.scale.is_some());
        let rows: Vec<usize> =
            (0..4).filter(|row| *row < 2 || (*row == 2 && heading) || (*row == 3 && scale)).collect();
        let numbers = if scale { NUMBERS } else { NUMBERS - 1 };
        let mut signature = Signature { components: rows.len(), numbers, ..Signature::default() };
        let mut ways: [Option<Option<f64>>; 2] = [None; 2];
        let (mut steps, mut left) = (Vec::new(), Vec::new());
        for (place, run) in since.iter().enumerate().map(|(i, run)| (record.begins + i, run)) {
            let direction = run.direction as usize;
            let values = [Some(run.x_m), Some(run.y_m), run.heading_rad, run.scale];
            if heading && run.heading_rad.is_none() {
                left.push((place, "it has no heading, as the first run has"));
            } else if scale && run.scale.is_none() {
                left.push((place, "it was not tracked, as the first run was"));
            } else if !alike(*ways[direction].get_or_insert(run.way_m), run.way_m) {
                left.push((place, "its way is not as long as that of the first run of its direction"));
            } else {
                let mut components = [0.0; COMPONENTS];
                for (component, row) in rows.iter().enumerate() {
                    components[component] = values[*row].unwrap_or(0.0);
                    if !steps.iter().any(|step: &Step| step.direction == direction) {
                        signature.slopes[direction][component][..NUMBERS].copy_from_slice(&run.slopes[*row]);
                    }
                }
                steps.push(Step { place, direction, components });
            }
        }
        let directions = (0..2).filter(|direction| steps.iter().any(|step| step.direction == *direction)).count();
        Course { signature, steps, left, directions }
    }

    fn scorers(&self) -> [Scorer; 2] {
        [Scorer::new(self.signature.components), Scorer::new(self.signature.components)]
    }
}

fn alike(one: Option<f64>, other: Option<f64>) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() <= OTHER_WAY * one.max(other),
        _ => true,
    }
}

impl Watched {
    /// What the runs of a record say. `seed` is that of the delays, which are simulated.
    ///
    /// ```
    /// use umbmark_core::{calibrate::{Correction, drive_again}, dataset::{Dataset, ReturnError, Run}, drift::{Rate, Record, Watched}};
    /// use umbmark_core::{drive::Robot, effect::TestKind, path::{Direction, Path}};
    /// let (robot, path) = (Robot::labmate(), Path::umbmark());
    /// let run = |number: u32| {
    ///     let direction = Direction::BOTH[number as usize % 2];
    ///     let truth = Correction { e_d: if number < 20 { 1.001 } else { 0.999 }, ..Correction::NONE };
    ///     let error = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
    ///     let scatter = |k: u32| 4e-3 * (f64::from((number * number + k * number) % 11) - 5.0);
    ///     let returned = Some(ReturnError { x: error.x + scatter(3), y: error.y + scatter(7), heading: None });
    ///     Run { name: format!("run {number}"), number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
    /// };
    /// let until = |last| Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs: (0..last).map(run).collect(), ..Dataset::default() };
    /// let mut record = Record::new(&until(20), Rate::default())?;
    /// record.add(&until(20))?;
    /// assert!(Watched::of(&record, &robot, Some(&path), 1).change.is_none());
    /// assert_eq!(record.add(&until(26))?.new, 6);
    /// let change = Watched::of(&record, &robot, Some(&path), 1).change.unwrap();
    /// assert_eq!(change.since, 20);
    /// assert!((change.numbers[0].change + 0.002).abs() < 0.0004);
    /// # Ok::<(), umbmark_core::drift::DriftError>(())
    /// ```
    pub fn of(record: &Record, robot: &Robot, path: Option<&Path>, seed: u64) -> Watched {
        let course = Course::of(record);
        let per_run = record.rate.per_run();
        let (mut scorers, mut scan) = (course.scorers(), Scan::new(&course.signature));
        let used = |place: usize| match course.left.iter().find(|(left, _)| *left == place) {
            Some((_, reason)) => Use::LeftOut(reason),
            None if place < record.begins => Use::Earlier,
            None => Use::Baseline,
        };
        let point = |(place, run): (usize, &Observation)| Point {
            name: run.name.clone(),
            direction: run.direction,
            used: used(place),
            p: None,
            heights: None,
            limits: None,
        };
        let mut runs: Vec<Point> = record.runs.iter().enumerate().map(point).collect();
        let mut outlying = Vec::new();
        for step in &course.steps {
            let scored = scorers[step.direction].add(&step.components);
            scan.add(step.direction, scored.as_ref());
            let Some(scored) = scored else { continue };
            let run = &mut runs[step.place];
            let count = course.signature.components;
            run.used = Use::Compared;
            run.p = Some(chi_squared_upper_tail(scored.distance * scored.distance, count as f64));
            run.heights = Some(scan.peaks().map(|peak| peak.height));
            run.limits = Some(limits::limits(&course.signature, course.directions, scan.scored(), per_run));
            if scored.distance > reach(count) {
                outlying.push(step.place);
            }
        }
        let seen = runs.iter().position(|run| run.alarms().next().is_some());
        let change = seen.and_then(|seen| found::change(&course, &scan, &runs, seen, robot, path));
        if let Some(change) = &change {
            outlying.retain(|place| *place < change.since);
            outlying.extend(change.outlying.iter().filter(|place| **place >= change.since));
        }
        let missing = scorers.each_ref().map(|scorer| match scorer.runs {
            0 if course.directions > 0 => 0,
            runs => Scorer::baseline(course.signature.components.max(2)).saturating_sub(runs),
        });
        let is_ready = change.is_none() && course.directions > 0 && missing == [0; 2];
        let delays = if is_ready { delay::delays(&course, &scorers, &scan, per_run, seed) } else { Vec::new() };
        Watched { runs, begins: record.begins, rate: record.rate, change, outlying, missing, delays, seed }
    }

    /// The answer in words.
    pub fn sentence(&self, arrived: &Arrived) -> String {
        words::sentence(self, arrived)
    }
}
