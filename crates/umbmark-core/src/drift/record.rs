//! What is known of a robot that is watched: all that is kept from one look to the next.

use super::DriftError;
use super::observation::{Observation, of};
use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::evidence::{FitError, robot_of};
use crate::path::Path;
use crate::setup::{Fault, Setup};
use serde::{Deserialize, Serialize};

/// How often a good robot may be accused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Probability of a false alarm in a month.
    pub false_alarms_per_month: f64,
    /// Runs in a month.
    pub runs_per_month: u32,
}

impl Default for Rate {
    /// One false alarm in a hundred months of two runs a day.
    fn default() -> Rate {
        Rate { false_alarms_per_month: 0.01, runs_per_month: 60 }
    }
}

impl Rate {
    /// Probability of a false alarm with each run: 1 - (1 - P)^(1/n).
    pub fn per_run(&self) -> f64 {
        -libm::expm1(libm::log1p(-self.false_alarms_per_month) / f64::from(self.runs_per_month))
    }

    /// Refuses a rate out of its range.
    ///
    /// # Errors
    /// [`DriftError::Rate`].
    pub fn checked(self) -> Result<Rate, DriftError> {
        let Rate { false_alarms_per_month: rate, runs_per_month: runs } = self;
        if rate > 0.0 && rate <= 0.5 && (1..=100_000).contains(&runs) {
            Ok(self)
        } else {
            Err(DriftError::Rate { rate, runs })
        }
    }
}

/// Where the baseline begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Restart {
    /// With the next run that arrives.
    Now,
    /// With the run of this name.
    At(String),
}

/// The numbers of a robot and its path, to know them again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Kind of its drive.
    pub drive: String,
    /// Its numbers, each by its key in robot.toml.
    pub numbers: Vec<(String, f64)>,
    /// Shape and sizes of its path, where it is known.
    pub path: Option<(String, Vec<f64>)>,
}

impl Known {
    fn of(robot: &Robot, path: Option<&Path>) -> Known {
        let kind = robot.drive.kind();
        let own = kind.parameters().iter().map(|parameter| parameter.name).zip(robot.drive.values());
        let all = own.chain([("ticks_per_revolution", robot.encoder.ticks_per_revolution())]);
        Known {
            drive: kind.name().to_owned(),
            numbers: all.map(|(key, value)| (key.to_owned(), value)).collect(),
            path: path.map(|path| (path.shape().name.to_owned(), path.values().to_vec())),
        }
    }

    /// What differs, in words.
    fn difference(&self, data: &Known) -> Option<String> {
        if self.drive != data.drive {
            return Some(format!("drive = \"{}\", and the data drive = \"{}\"", self.drive, data.drive));
        }
        let differs = |((key, there), (_, here)): (&(String, f64), &(String, f64))| {
            (there != here).then(|| format!("{key} = {there}, and the data {key} = {here}"))
        };
        let number = self.numbers.iter().zip(&data.numbers).find_map(differs);
        let path = |known: &Known| {
            let named =
                known.path.as_ref().map(|(shape, sizes)| format!("a path of shape \"{shape}\" with sizes {sizes:?}"));
            named.unwrap_or_else(|| "no path".to_owned())
        };
        number.or_else(|| (self.path != data.path).then(|| format!("{}, and the data {}", path(self), path(data))))
    }
}

/// All that is kept of a robot that is watched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The robot and its path.
    pub known: Known,
    /// How often a good robot may be accused.
    pub rate: Rate,
    /// Place of the run with which the baseline begins.
    pub begins: usize,
    /// All runs in the order in which they arrived.
    pub runs: Vec<Observation>,
}

/// What a dataset brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrived {
    /// Number of runs that are new.
    pub new: usize,
    /// Runs that were known and are not in the data any more.
    pub vanished: Vec<String>,
    /// Runs that were known and have other values now; the values that they had are kept.
    pub changed: Vec<String>,
    /// Runs of the data that cannot be watched, and why.
    pub left_out: Vec<(String, &'static str)>,
}

impl Record {
    /// Nothing known yet of the robot of a dataset.
    ///
    /// # Errors
    /// As of [`Record::add`]; [`DriftError::Rate`] for a rate out of its range.
    pub fn new(data: &Dataset, rate: Rate) -> Result<Record, DriftError> {
        let robot = usable(data)?;
        let known = Known::of(robot, data.path.as_ref());
        Ok(Record { known, rate: rate.checked()?, begins: 0, runs: Vec::new() })
    }

    /// A record that is taken up, or a new one where there is none, at this rate; what is not given is as it was, or the [default](Rate::default).
    ///
    /// # Errors
    /// [`DriftError::OtherRate`] for another rate than it was begun with, and as of [`Record::new`].
    pub fn resumed(
        known: Option<Record>,
        data: &Dataset,
        false_alarms_per_month: Option<f64>,
        runs_per_month: Option<u32>,
    ) -> Result<Record, DriftError> {
        let there = known.as_ref().map_or_else(Rate::default, |known| known.rate);
        let here = Rate {
            false_alarms_per_month: false_alarms_per_month.unwrap_or(there.false_alarms_per_month),
            runs_per_month: runs_per_month.unwrap_or(there.runs_per_month),
        };
        match known {
            Some(_) if here != there => Err(DriftError::OtherRate { there, here }),
            Some(known) => Ok(known),
            None => Record::new(data, here),
        }
    }

    /// Adds the runs of a dataset that are new.
    ///
    /// # Errors
    /// [`DriftError`] for another robot, path or rate, and for data that cannot be used.
    pub fn add(&mut self, data: &Dataset) -> Result<Arrived, DriftError> {
        let robot = usable(data)?;
        if let Some(difference) = self.known.difference(&Known::of(robot, data.path.as_ref())) {
            return Err(DriftError::Foreign { difference });
        }
        let (seen, left_out) = of(data, robot);
        let mut arrived = Arrived { left_out, ..Arrived::default() };
        let known = self.runs.len();
        let mut found = vec![false; known];
        let mut rest = Vec::new();
        for run in seen {
            let alike = |place: &usize| !found[*place] && self.runs[*place].is_named_as(&run);
            match (0..known).filter(alike).find(|place| self.runs[*place].has_values_of(&run)) {
                Some(place) => found[place] = true,
                None => rest.push(run),
            }
        }
        for run in rest {
            let alike = |place: &usize| !found[*place] && self.runs[*place].is_named_as(&run);
            match (0..known).find(alike) {
                Some(place) => {
                    found[place] = true;
                    arrived.changed.push(run.name);
                }
                None => self.runs.push(run),
            }
        }
        arrived.new = self.runs.len() - known;
        arrived.vanished =
            (0..known).filter(|place| !found[*place]).map(|place| self.runs[place].name.clone()).collect();
        Ok(arrived)
    }

    /// Begins the baseline anew.
    ///
    /// # Errors
    /// [`DriftError::NoSuchRun`].
    pub fn restart(&mut self, at: &Restart) -> Result<(), DriftError> {
        self.begins = match at {
            Restart::Now => self.runs.len(),
            Restart::At(name) => {
                let place = self.runs.iter().rposition(|run| run.name == *name);
                place.ok_or_else(|| DriftError::NoSuchRun {
                    name: name.clone(),
                    last: self.runs.last().map(|run| run.name.clone()),
                })?
            }
        };
        Ok(())
    }

    /// Refuses what cannot have been written by [`Record::add`].
    ///
    /// # Errors
    /// [`DriftError::Damaged`] with what is wrong.
    pub fn checked(self) -> Result<Record, DriftError> {
        let damaged = |what: String| Err(DriftError::Damaged { what });
        self.rate.checked()?;
        if self.begins > self.runs.len() {
            return damaged(format!("the baseline begins with run {} of {}", self.begins + 1, self.runs.len()));
        }
        for run in &self.runs {
            let values = [Some(run.x_m), Some(run.y_m), run.heading_rad, run.scale, run.way_m];
            let slopes = run.slopes.as_flattened().iter().copied().map(Some);
            if run.name.is_empty() || !values.into_iter().chain(slopes).flatten().all(|value: f64| value.abs() < 1e12) {
                return damaged(format!("the numbers of run {:?} are no return error", run.name));
            }
        }
        Ok(self)
    }
}

impl Observation {
    /// Whether the names can be of one run: a run of several datasets is called by its dataset, too.
    fn is_named_as(&self, other: &Observation) -> bool {
        let ends = |long: &str, short: &str| {
            long.strip_suffix(short).is_some_and(|rest| rest.is_empty() || rest.ends_with('/'))
        };
        self.direction == other.direction && (ends(&self.name, &other.name) || ends(&other.name, &self.name))
    }

    fn has_values_of(&self, other: &Observation) -> bool {
        self.values() == other.values()
    }

    fn values(&self) -> [Option<f64>; 4] {
        [Some(self.x_m), Some(self.y_m), self.heading_rad, self.scale]
    }
}

/// The robot of data that can be watched.
fn usable(data: &Dataset) -> Result<&Robot, DriftError> {
    let robot = robot_of(data)?;
    if !robot.drive.kind().has_axle_wheels() {
        return Err(DriftError::OtherDrive { drive: robot.drive.kind().name() });
    }
    if data.drives_other_paths() {
        return Err(DriftError::OtherPaths);
    }
    let setup = Setup::of(&data.runs, robot, data.path.as_ref());
    let faults: Vec<Fault> = setup.all_faults().cloned().collect();
    if faults.is_empty() { Ok(robot) } else { Err(FitError::Faulty { faults }.into()) }
}
