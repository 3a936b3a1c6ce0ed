//! Datasets are written whole or not at all, and read back as they were.

use std::path::Path;
use umbmark_core::dataset::{Dataset, ReferencePose, ReturnError, Run, RunConditions, Stated, TickLog};
use umbmark_core::drive::{DifferentialDrive, Encoder, Robot};
use umbmark_core::effect::TestKind;
use umbmark_core::path::{self, Direction, SpeedProfile};
use umbmark_core::random::Stream;
use umbmark_io::{DatasetError, Existing, Layout, template, write_template};

/// A dataset of awkward numbers; some runs without log, without return, without heading, without direction.
fn awkward(seed: u64) -> Dataset {
    let mut stream = Stream::new(seed, 0, 0);
    let drive = DifferentialDrive::new(0.1 + stream.uniform(), 0.1 + stream.uniform() / 3.0, 0.15).unwrap();
    let bits = [None, Some(16)][seed as usize % 2];
    let robot = Robot {
        name: "a \"robot\" \\ of\nJörg".into(),
        drive: drive.into(),
        encoder: Encoder::new(64.0 * 43.7, Some(100.0 / 3.0), bits).unwrap(),
    };
    let speed = SpeedProfile::new(0.1 + stream.uniform(), 0.3, 0.0).unwrap();
    let points = [stream.uniform(), -1.0 / 3.0, 1e-7, 2.0];
    let mut runs = Vec::new();
    for test in [TestKind::Systematic, TestKind::Bumps] {
        for direction in [None, Some(Direction::Cw), Some(Direction::Ccw)] {
            for number in 1..=2 {
                let heading = (number == 1).then(|| stream.uniform() - 0.5);
                let returned = ReturnError { x: stream.normal() * 1e-3, y: -stream.normal() / 3.0, heading };
                let log = (direction.is_some() || number == 1).then(|| walk(&mut stream, bits.is_none()));
                runs.push(Run { name: String::new(), number, direction, test, log, returned: Some(returned) });
            }
        }
    }
    let path = Some(path::Path::new(&path::WAYPOINTS, &points, speed).unwrap());
    Dataset { robot: Some(robot), path, runs, ..Dataset::default() }
}

fn walk(stream: &mut Stream, fractions: bool) -> TickLog {
    let mut log = TickLog::default();
    let (mut time, mut left, mut right) = (1.7e9, 0.0, 0.0);
    for sample in 0..300 {
        log.time.push(time);
        log.left.push(left);
        log.right.push(right);
        if sample == 0 {
            // Where the robot stood; without it the reader infers START.
            log.reference.push(ReferencePose { sample, x: 1e-3 * stream.normal(), y: -1e-3 / 3.0, heading: None });
        } else if sample % 7 == 0 {
            let heading = (sample % 2 == 0).then(|| stream.normal());
            log.reference.push(ReferencePose { sample, x: stream.normal(), y: stream.normal(), heading });
        }
        time += 0.01 + 0.01 * stream.uniform();
        left += if fractions { 900.0 * stream.uniform() } else { (900.0 * stream.uniform()).round() };
        right += (900.0 * stream.uniform()).round();
    }
    log
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn what_is_written_is_read_back_to_the_last_bit() {
    for seed in 0..6 {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("data");
        let mut data = awkward(seed);
        umbmark_io::save(&data, &folder, Existing::Keep).unwrap();
        assert_eq!(names(&folder), ["returns.csv", "robot.toml", "runs"]);
        assert_eq!(names(place.path()), ["data"]);
        let read = umbmark_io::load(&folder).unwrap();
        assert_eq!(read.robot, data.robot);
        let (written, path) = (data.path.take().unwrap(), read.path.unwrap());
        assert_eq!((path.values(), path.speed), (written.values(), written.speed));
        data.runs.sort_by_key(|run| (run.test, run.direction, run.number));
        for (read, written) in read.runs.iter().zip(&data.runs) {
            // Counters of few bits are written as they roll over, which the reader undoes and says.
            let mended = read.log.as_ref().map(|log| log.mended).unwrap_or_default();
            let written_log = written.log.clone().map(|log| TickLog { mended, ..log });
            assert_eq!((read.returned, &read.log), (written.returned, &written_log), "{}", read.name);
            assert_eq!((read.test, read.direction, read.number), (written.test, written.direction, written.number));
        }
        assert_eq!(read.runs.len(), data.runs.len());
    }
}

#[test]
fn files_that_are_there_stay_unless_they_may_be_replaced() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("data");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("robot.toml"), "precious").unwrap();
    std::fs::write(folder.join("notes.txt"), "mine").unwrap();
    let error = umbmark_io::save(&awkward(1), &folder, Existing::Keep).unwrap_err();
    assert!(matches!(error, DatasetError::AlreadyThere { .. }), "{error}");
    assert_eq!(names(&folder), ["notes.txt", "robot.toml"]);
    assert_eq!(std::fs::read_to_string(folder.join("robot.toml")).unwrap(), "precious");
    umbmark_io::save(&awkward(1), &folder, Existing::Replace).unwrap();
    umbmark_io::save(&awkward(2), &folder, Existing::Replace).unwrap();
    assert_eq!(umbmark_io::load(&folder).unwrap().robot, awkward(2).robot);
    assert_eq!(std::fs::read_to_string(folder.join("notes.txt")).unwrap(), "mine");
    assert_eq!(names(place.path()), ["data"]);
}

#[test]
fn logs_of_other_runs_are_neither_mixed_in_nor_deleted() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("data");
    umbmark_io::save(&awkward(1), &folder, Existing::Keep).unwrap();
    std::fs::write(folder.join("runs/cw_09.csv"), "another day").unwrap();
    let before = std::fs::read(folder.join("robot.toml")).unwrap();
    let error = umbmark_io::save(&awkward(2), &folder, Existing::Replace).unwrap_err().to_string();
    assert!(
        error.ends_with(
            "cw_09.csv: is there already; it is the log of another run: choose another folder, or delete it"
        ),
        "{error}"
    );
    assert_eq!(std::fs::read(folder.join("robot.toml")).unwrap(), before);
}

#[test]
fn what_would_be_read_back_as_something_else_is_not_written() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("data");
    let refused = |change: &dyn Fn(&mut Dataset)| {
        let mut data = awkward(1);
        change(&mut data);
        let error = umbmark_io::save(&data, &folder, Existing::Keep).unwrap_err().to_string();
        assert!(names(place.path()).is_empty(), "{error}");
        error.replace(&folder.display().to_string(), "data")
    };
    let first_log = |data: &mut Dataset, change: &dyn Fn(&mut TickLog)| {
        change(data.runs.iter_mut().find_map(|run| run.log.as_mut()).unwrap());
    };
    assert!(refused(&|d| d.runs[0].returned.as_mut().unwrap().x = f64::NAN).contains("must be a finite number in m"));
    assert!(refused(&|d| d.runs[1].number = 1).contains("stands twice"));
    assert!(refused(&|d| d.robot = None).starts_with("the nominal robot is not known"));
    assert!(refused(&|d| (d.runs[1].log, d.runs[1].returned) = (None, None)).contains("neither log nor return"));
    assert!(refused(&|d| first_log(d, &|log| log.time[5] = 0.0)).contains("must increase"));
    assert!(refused(&|d| first_log(d, &|log| log.left[5] = 0.5)).contains("whole number of ticks"));
    assert!(refused(&|d| first_log(d, &|log| log.reference[2].sample = 7)).contains("would not be read back as it is"));
    let misplaced = ReferencePose { sample: 0, x: 0.5, y: 0.0, heading: Some(0.0) };
    let said = refused(&|d| first_log(d, &|log| log.reference[0] = misplaced));
    assert!(said.contains("the reader says: the track starts 0.500 m and 0.0 deg from the origin"), "{said}");
}

#[test]
fn a_place_that_does_not_exist_is_named() {
    let place = tempfile::tempdir().unwrap();
    let error = umbmark_io::save(&awkward(1), place.path().join("no/where"), Existing::Keep).unwrap_err().to_string();
    assert!(error.ends_with("no: cannot be written: there is no such folder"), "{error}");
}

#[test]
fn the_files_of_init_are_read_once_they_are_filled_in() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("mine");
    let [robot, returns] = write_template(&folder, Existing::Keep).unwrap();
    assert!(write_template(&folder, Existing::Keep).is_err());
    let empty = umbmark_io::load(&folder).unwrap_err().to_string();
    assert!(empty.ends_with("returns.csv: there are no rows; add the measurements, one a line"), "{empty}");
    let text = std::fs::read_to_string(&returns).unwrap();
    let example = text.lines().rev().find_map(|line| line.strip_prefix("# cw,")).unwrap();
    std::fs::write(&returns, format!("{text}cw,{example}\nccw,{example}\n")).unwrap();
    let untouched = umbmark_io::load(&folder).unwrap();
    assert!(
        untouched.warnings[0].starts_with("robot.toml still has the numbers of the example"),
        "{:?}",
        untouched.warnings
    );
    let mine =
        std::fs::read_to_string(&robot).unwrap().replace("# counter_bits", "counter_bits").replace("my robot", "R2");
    std::fs::write(&robot, mine).unwrap();
    let data = umbmark_io::load(&folder).unwrap();
    assert_eq!((data.runs.len(), data.warnings.len()), (2, 0));
    assert_eq!(data.runs[0].returned.unwrap().x, -0.012 - 0.001);
    assert_eq!(data.robot.unwrap().encoder.counter_bits(), Some(16));
    assert_eq!(data.path.unwrap().values(), [4.0]);
    assert!(template().iter().all(|text| text.lines().all(|line| line.len() <= 120)));
}

#[cfg(unix)]
#[test]
fn written_folders_have_the_rights_of_other_folders() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().unwrap();
    let (ours, other) = (place.path().join("ours"), place.path().join("other"));
    write_template(&ours, Existing::Keep).unwrap();
    std::fs::create_dir(&other).unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&other));
}

/// A table has no column for them.
#[test]
fn durations_by_the_clock_of_the_reference_are_said_to_be_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut data = awkward(2);
    let lost = |data: &Dataset, name: &str| {
        Layout::named("csv").unwrap().write(data, folder.path().join(name), Existing::Keep).unwrap()
    };
    assert_eq!(lost(&data, "as_it_was"), Vec::<String>::new());
    for run in data.runs.iter_mut().filter(|run| run.number == 2) {
        run.log.iter_mut().for_each(|log| log.clock_excess = 0.11);
    }
    let count = data.runs.iter().filter(|run| run.log.as_ref().is_some_and(|log| log.clock_excess > 0.0)).count();
    let said = format!("{count} durations by the reference's clock: lost_cycles cannot be told from the copy");
    assert_eq!(lost(&data, "timed"), [said]);
}

/// Where a counter shows parts of a revolution, wheels roll back by less than a count.
#[test]
fn counts_a_little_below_zero_are_read_back_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut data = awkward(2);
    for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        log.left.iter_mut().for_each(|ticks| *ticks *= -1e-6 / 3.0);
    }
    umbmark_io::save(&data, folder.path(), Existing::Replace).unwrap();
    let read = umbmark_io::load(folder.path()).unwrap();
    let lefts = |data: &Dataset| {
        let logs = data.runs.iter().filter_map(|run| run.log.as_ref());
        logs.map(|log| log.left.clone()).collect::<Vec<_>>()
    };
    let (mut read, mut written) = (lefts(&read), lefts(&data));
    read.sort_by(|a, b| a[299].total_cmp(&b[299]));
    written.sort_by(|a, b| a[299].total_cmp(&b[299]));
    assert_eq!(read, written);
}

#[test]
fn conditions_are_read_written_and_read_back_and_what_would_become_a_number_is_not_written() {
    let place = tempfile::tempdir().unwrap();
    let (first, again) = (place.path().join("first"), place.path().join("again"));
    umbmark_io::save(&awkward(1), &first, Existing::Keep).unwrap();
    let names: Vec<String> = umbmark_io::load(&first).unwrap().runs.iter().map(|run| run.name.clone()).collect();
    let rows = format!("Run,Floor,load_kg\n{},\"felt, thick\",2.5\n{},tile,\n", names[1], names[0]);
    std::fs::write(first.join("conditions.csv"), rows).unwrap();
    let mut read = umbmark_io::load(&first).unwrap();
    let (word, number) = (|word: &str| Stated::Word(word.into()), Stated::Number(2.5));
    let stated = |run: usize, stated: &[(&str, &Stated)]| RunConditions {
        run: names[run].clone(),
        stated: stated.iter().map(|(name, value)| ((*name).to_owned(), (*value).clone())).collect(),
    };
    assert_eq!(
        read.conditions,
        [stated(0, &[("floor", &word("tile"))]), stated(1, &[("floor", &word("felt, thick")), ("load_kg", &number)])]
    );
    assert!(read.warnings.iter().any(|warning| warning.contains("have no row")), "{:?}", read.warnings);
    umbmark_io::save(&read, &again, Existing::Keep).unwrap();
    assert_eq!(umbmark_io::load(&again).unwrap().conditions, read.conditions);
    read.conditions[0].stated[0].1 = word("7");
    let refused = umbmark_io::save(&read, place.path().join("third"), Existing::Keep).unwrap_err();
    assert!(refused.to_string().contains("a number stands where a word is meant"), "{refused}");
    // Of all runs.
    std::fs::write(first.join("conditions.csv"), "floor\nstone\n").unwrap();
    let read = umbmark_io::load(&first).unwrap();
    assert_eq!(read.conditions.len(), read.runs.len());
    assert!(read.conditions.iter().all(|run| run.stated == [("floor".to_owned(), word("stone"))]));
}
