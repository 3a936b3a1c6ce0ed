//! Several datasets of one robot as one.

use crate::dataset::{Dataset, ReferenceFrame, Session};
use crate::drive::Robot;
use crate::effect::differences;
use crate::geometry::wrap;
use crate::run::dead_reckoning::computed_end;
use crate::run::{ReturnError, Run};
use crate::setup::{Mounting, Setup};
use crate::stats::Measured;
use std::collections::HashMap;

/// Two datasets that are not of one robot, or cannot be told of each other's runs.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JoinError {
    /// One has a robot, and the other has none.
    #[error("{set}: has no robot.toml, and {other} has one; give both the same")]
    NoRobot {
        /// The dataset without one.
        set: String,
        /// The one with one.
        other: String,
    },
    /// Robots of two kinds.
    #[error(
        "{set}: is of a {drive} drive, and {first} of a {other} drive; datasets that are read together are of one robot"
    )]
    Drive {
        /// The dataset.
        set: String,
        /// The first one.
        first: String,
        /// Its drive.
        drive: &'static str,
        /// That of the first.
        other: &'static str,
    },
    /// Robots with other numbers.
    #[error(
        "{set}: {key} = {here}, and {there} in {first}; datasets that are read together are of one robot: write the same numbers into both robot.toml"
    )]
    Number {
        /// The dataset.
        set: String,
        /// The first one.
        first: String,
        /// The key in robot.toml.
        key: &'static str,
        /// Its value here.
        here: f64,
        /// That of the first.
        there: f64,
    },
    /// Return poses without counts, of two paths.
    #[error(
        "{set}: the path differs from that of {first}, and {run} has no counts, so its way is not known; read them one by one"
    )]
    Path {
        /// The dataset.
        set: String,
        /// The first one.
        first: String,
        /// The run.
        run: String,
    },
}

/// Mountings differ if they do by more than so many standard errors, and by more than 10 mm, 1 degree or 20 ms.
const BEYOND: f64 = 4.0;
const APART: [f64; 3] = [0.01, 0.0175, 0.02];

impl Dataset {
    /// Datasets of one robot, each with its name, as one: their runs are called NAME/RUN, and each is a session. One alone is itself.
    ///
    /// The nominal robot is that of the first. Where a wheelbase or a diameter of another differs, its counts are read by the robot of the first, and its
    /// return errors are those that the odometry of the first would have had.
    ///
    /// The path is kept if it is the same in all. Their references are taken to be mounted alike and to tell of one room; where the motion shows that
    /// they are not mounted alike, a warning says so.
    ///
    /// # Errors
    /// [`JoinError`] if they are not of the same nominal robot, and for return poses without counts of different paths.
    pub fn joined(sets: Vec<(String, Dataset)>) -> Result<Dataset, JoinError> {
        let mut sets = sets.into_iter();
        let Some((first, mut joined)) = sets.next() else { return Ok(Dataset::default()) };
        let mut rest: Vec<(String, Dataset)> = sets.collect();
        if rest.is_empty() {
            return Ok(joined);
        }
        let mut same_path = true;
        let mut warnings = Vec::new();
        for (set, data) in &mut rest {
            warnings.extend(of_one_robot((&first, joined.robot.as_ref()), set, data)?);
            same_path &= data.path == joined.path;
        }
        let way_unknown = |(set, data): (&String, &Dataset)| {
            let run = data.runs.iter().find(|run| run.log.is_none())?;
            Some(JoinError::Path { set: set.clone(), first: first.clone(), run: run.name.clone() })
        };
        let mut all = std::iter::once((&first, &joined)).chain(rest.iter().map(|(set, data)| (set, data)));
        if let Some(error) = all.find_map(way_unknown).filter(|_| !same_path) {
            return Err(error);
        }
        if let Some(robot) = &joined.robot {
            let mounting = |data: &Dataset| Setup::of_tracks(&data.runs, robot).mounting;
            let of_first = mounting(&joined);
            for (set, data) in &rest {
                warnings.extend(of_first.zip(mounting(data)).and_then(|both| apart((&first, set), both)));
            }
        }
        let mut taken = HashMap::new();
        let mut parts = vec![(first, std::mem::take(&mut joined.runs), false)];
        named(&mut joined, &parts[0].0);
        for (set, mut data) in rest {
            named(&mut data, &set);
            joined.clocks.append(&mut data.clocks);
            joined.topics.append(&mut data.topics);
            joined.conditions.append(&mut data.conditions);
            joined.warnings.append(&mut data.warnings);
            if data.reference_frame != joined.reference_frame {
                joined.reference_frame = ReferenceFrame::default();
            }
            if data.columns != joined.columns {
                joined.columns.clear();
            }
            let other_path = data.path.is_some() && joined.path.is_some() && data.path != joined.path;
            parts.push((set, data.runs, other_path));
        }
        joined.path = joined.path.filter(|_| same_path);
        for (name, runs, other_path) in parts {
            joined.sessions.push(Session { first: joined.runs.len(), name: name.clone(), other_path });
            joined.runs.extend(runs.into_iter().map(|run| {
                let number = taken.entry((run.test, run.direction)).or_insert(0);
                *number += 1;
                Run { name: in_set(&name, &run.name), number: *number, ..run }
            }));
        }
        joined.warnings.extend(warnings);
        Ok(joined)
    }
}

fn in_set(set: &str, run: &str) -> String {
    format!("{set}/{run}")
}

/// Calls what was noticed of runs by the names that they get.
fn named(data: &mut Dataset, set: &str) {
    data.clocks.iter_mut().for_each(|clock| clock.run = in_set(set, &clock.run));
    data.topics.iter_mut().for_each(|topics| topics.run = in_set(set, &topics.run));
    data.conditions.iter_mut().for_each(|stated| stated.run = in_set(set, &stated.run));
}

/// Makes a dataset one of the robot of the first; says what was different.
fn of_one_robot(
    (first, theirs): (&str, Option<&Robot>),
    set: &str,
    data: &mut Dataset,
) -> Result<Option<String>, JoinError> {
    let (set, first) = (set.to_owned(), first.to_owned());
    let (theirs, own) = match (theirs, &data.robot) {
        (None, None) => return Ok(None),
        (Some(_), None) => return Err(JoinError::NoRobot { set, other: first }),
        (None, Some(_)) => return Err(JoinError::NoRobot { set: first, other: set }),
        (Some(theirs), Some(own)) => (theirs, own.clone()),
    };
    let Some(differs) = differences(&own, theirs) else {
        let [drive, other] = [&own, theirs].map(|robot| robot.drive.kind().name());
        return Err(JoinError::Drive { set, first, drive, other });
    };
    let Some(&(key, here, there)) = differs.first() else { return Ok(None) };
    let same_counters = own.encoder.ticks_per_revolution() == theirs.encoder.ticks_per_revolution();
    let of_counts = same_counters && own.drive.kind().has_axle_wheels() && data.runs.iter().all(is_counted);
    let seen = of_counts.then(|| data.runs.iter().map(|run| seen_by(run, &own, theirs)).collect::<Option<Vec<_>>>());
    let Some(seen) = seen.flatten() else { return Err(JoinError::Number { set, first, key, here, there }) };
    for (run, returned) in data.runs.iter_mut().zip(seen) {
        run.returned = returned;
    }
    data.robot = Some(theirs.clone());
    let told: Vec<String> =
        differs.iter().map(|(key, here, there)| format!("{key} = {here} ({there} in {first})")).collect();
    Ok(Some(format!("{set} is of a robot with {}; its counts are read by the robot of {first}", told.join(", "))))
}

/// Whether a run has counts as they were read; what follows from speeds or angles is no whole count.
fn is_counted(run: &Run) -> bool {
    run.log.as_ref().is_some_and(|log| {
        let counts: Vec<[f64; 2]> = log.left.iter().zip(&log.right).map(|(left, right)| [*left, *right]).collect();
        // Of a robot that stands at START, all counts are whole.
        let changed = || counts.windows(2).filter(|pair| pair[0] != pair[1]).map(|pair| pair[1]);
        let whole = changed().filter(|now| now.iter().all(|count| count.fract() == 0.0));
        100 * whole.count() > changed().count()
    })
}

/// The return error of a run, if its odometry were that of another nominal robot; `None` where its counts cannot be followed.
fn seen_by(run: &Run, own: &Robot, other: &Robot) -> Option<Option<ReturnError>> {
    let Some(error) = run.returned else { return Some(None) };
    let end = |robot: &Robot| computed_end(run.log.as_ref()?, robot).0;
    let (own, other) = (end(own)?, end(other)?);
    let heading = error.heading.map(|heading| wrap(heading + own.heading - other.heading));
    Some(Some(ReturnError { x: error.x + own.x - other.x, y: error.y + own.y - other.y, heading }))
}

/// Says in what two references differ that should be mounted alike.
fn apart((first, set): (&str, &str), (there, here): (Mounting, Mounting)) -> Option<String> {
    let differs = |of: fn(&Mounting) -> Option<Measured>, least: f64| {
        let (there, here) = (of(&there)?, of(&here)?);
        let off = wrap(here.value - there.value);
        let is_apart = off.abs() > least && off.abs() > BEYOND * there.std_error.hypot(here.std_error);
        is_apart.then_some(off)
    };
    let [length, angle, time] = APART;
    let ahead = differs(|mounting| mounting.ahead, length).map(|off| format!("{:.0} mm farther ahead", 1e3 * off));
    let left = differs(|mounting| mounting.left, length).map(|off| format!("{:.0} mm farther to the left", 1e3 * off));
    let yaw = differs(|mounting| mounting.yaw, angle).map(|off| format!("turned by {:.1} deg", off.to_degrees()));
    let delay = differs(|mounting| Some(mounting.delay), time).map(|off| format!("{:.0} ms later", 1e3 * off));
    let all: Vec<String> = [ahead, left, yaw, delay].into_iter().flatten().collect();
    (!all.is_empty()).then(|| {
        format!(
            "the reference of {set} is {} than that of {first}: one model cannot hold for both, learn them one by one",
            all.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{DifferentialDrive, Encoder};
    use crate::effect::Model;
    use crate::likelihood::watched::{watched, watched_on};
    use crate::path::{CIRCLE, Path, SQUARE, SpeedProfile};

    fn truth(effects: &[(&str, &str, f64)]) -> Model {
        let mut model = Model::new(&Robot::labmate());
        let usual = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99)];
        for (effect, parameter, value) in usual.iter().chain(effects) {
            model.set(effect, parameter, *value).unwrap();
        }
        model
    }

    fn both(a: Dataset, b: Dataset) -> Result<Dataset, JoinError> {
        Dataset::joined(vec![("a".into(), a), ("b".into(), b)])
    }

    #[test]
    fn two_sets_are_one_with_the_runs_of_both() {
        let circle = Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap();
        let (squares, circles) = (watched(&truth(&[]), 2, 1), watched_on(&circle, &truth(&[]), 2, 2));
        let runs = [squares.runs.len(), circles.runs.len()];
        let joined = both(squares.clone(), circles).unwrap();
        assert_eq!(joined.runs.len(), runs[0] + runs[1]);
        assert_eq!(
            joined.sessions.iter().map(|s| (s.name.as_str(), s.first)).collect::<Vec<_>>(),
            [("a", 0), ("b", runs[0])]
        );
        assert!(
            joined.drives_other_paths() && joined.path.is_none() && joined.warnings.is_empty(),
            "{:?}",
            joined.warnings
        );
        assert!(joined.runs[0].name.starts_with("a/") && joined.runs[runs[0]].name.starts_with("b/"));
        let mut numbers: Vec<_> = joined.runs.iter().map(|run| (run.test, run.direction, run.number)).collect();
        numbers.sort();
        numbers.dedup();
        assert_eq!(numbers.len(), joined.runs.len());
        let alone = Dataset::joined(vec![("a".into(), squares.clone())]).unwrap();
        assert_eq!((alone.runs, alone.sessions), (squares.runs, vec![]));
    }

    fn with_wheelbase(mut data: Dataset, wheelbase: f64) -> Dataset {
        data.robot.as_mut().unwrap().drive = DifferentialDrive::new(wheelbase, 0.15, 0.15).unwrap().into();
        data
    }

    /// The counts are those of one robot, whatever wheelbase stands in the second robot.toml.
    #[test]
    fn counts_are_read_by_the_robot_of_the_first_set() {
        let [a, b] = [1, 2].map(|seed| watched(&truth(&[]), 2, seed));
        let own = both(a.clone(), b.clone()).unwrap();
        let mut other = with_wheelbase(b, 0.35);
        for run in &mut other.runs {
            run.returned = seen_by(run, &Robot::labmate(), other.robot.as_ref().unwrap()).unwrap();
        }
        let joined = both(a, other.clone()).unwrap();
        assert_eq!(joined.robot, own.robot);
        assert!(joined.warnings[0].contains("wheelbase_m = 0.35 (0.34 in a)"), "{:?}", joined.warnings);
        for (joined, own) in joined.runs.iter().zip(&own.runs) {
            let [joined, own] = [joined, own].map(|run| run.returned.unwrap());
            assert!((joined.x - own.x).abs() < 1e-9 && (joined.heading.unwrap() - own.heading.unwrap()).abs() < 1e-9);
        }
        assert!(
            other
                .runs
                .iter()
                .zip(&own.runs[4..])
                .all(|(a, b)| (a.returned.unwrap().x - b.returned.unwrap().x).abs() > 1e-3)
        );
    }

    #[test]
    fn sets_of_two_robots_are_refused_by_the_number_that_differs() {
        let data = watched(&truth(&[]), 1, 1);
        let mut speeds = with_wheelbase(data.clone(), 0.35);
        for log in speeds.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
            // At rest at START for half of the log, and then what follows from speeds.
            let rest = log.time.len();
            log.time = (0..2 * rest).map(|sample| 0.05 * sample as f64).collect();
            for counts in [&mut log.left, &mut log.right] {
                let driven = counts.iter().map(|count| count * 1.000_13);
                *counts = std::iter::repeat_n(0.0, rest).chain(driven).collect();
            }
            log.reference.iter_mut().for_each(|pose| pose.sample += rest);
        }
        let refused = both(data.clone(), speeds.clone()).unwrap_err();
        assert!(matches!(refused, JoinError::Number { key: "wheelbase_m", here, .. } if here == 0.35), "{refused}");
        speeds.robot = None;
        assert!(matches!(both(data.clone(), speeds.clone()), Err(JoinError::NoRobot { .. })));
        speeds.robot = Some(crate::preset::Preset::find("clapper").unwrap().robot());
        assert!(matches!(both(data.clone(), speeds), Err(JoinError::Drive { .. })));
        let mut counted = data.clone();
        counted.robot.as_mut().unwrap().encoder = Encoder::new(500.0, None, None).unwrap();
        assert!(matches!(both(data, counted), Err(JoinError::Number { key: "ticks_per_revolution", .. })));
    }

    #[test]
    fn return_poses_of_two_paths_are_refused() {
        let of = |side: f64| {
            let path = Path::new(&SQUARE, &[side], SpeedProfile::default()).unwrap();
            let mut data = watched_on(&path, &truth(&[]), 1, 1);
            data.runs.iter_mut().for_each(|run| run.log = None);
            data
        };
        assert!(matches!(both(of(4.0), of(2.0)), Err(JoinError::Path { .. })));
        let same = both(of(4.0), of(4.0)).unwrap();
        assert!(same.path == of(4.0).path && !same.drives_other_paths());
        let unknown = || Dataset { path: None, ..of(4.0) };
        assert!(!both(unknown(), unknown()).unwrap().drives_other_paths());
    }

    #[test]
    fn a_reference_that_is_mounted_elsewhere_is_told() {
        let moved = truth(&[("marker_offset", "forward_m", 0.06)]);
        let joined = both(watched(&truth(&[]), 3, 1), watched(&moved, 3, 2)).unwrap();
        assert_eq!(joined.warnings.len(), 1);
        assert!(joined.warnings[0].contains("mm farther ahead"), "{:?}", joined.warnings);
    }
}
