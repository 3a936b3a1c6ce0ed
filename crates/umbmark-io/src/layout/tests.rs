use super::*;
use crate::source::Source;
use umbmark_core::dataset::{ReferencePose, ReturnError, Run};
use umbmark_core::drive::{Encoder, Robot};
use umbmark_core::effect::TestKind;
use umbmark_core::geometry::wrap;
use umbmark_core::path::{Direction, Path as DrivenPath};

/// Both ways round, twice each, with awkward numbers and a pose with heading at every sample, or at every `every`-th.
fn dataset(every: usize) -> Dataset {
    let run = |direction: Direction, number: u32| {
        let sign = direction.sign();
        let ticks = |i: usize, sign: f64| 37.0 * i as f64 + sign * (i * i) as f64;
        let pose = |sample: usize| ReferencePose {
            sample,
            x: 0.001 / 3.0 * sample as f64,
            y: sign * 1e-5 * (sample * sample) as f64,
            heading: Some(sign * 0.031 * sample as f64),
        };
        let log = TickLog {
            time: (0..120).map(|i| 0.1 * i as f64 + f64::from(number)).collect(),
            left: (0..120).map(|i| ticks(i, -sign)).collect(),
            right: (0..120).map(|i| ticks(i, sign)).collect(),
            reference: (0..120).step_by(every).map(pose).collect(),
            ..TickLog::default()
        };
        let name = format!("{}_{number:02}", direction.name());
        let returned = Some(ReturnError { x: 0.1, y: -0.2 / 3.0, heading: Some(0.01) });
        Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: Some(log), returned }
    };
    let runs = [(Direction::Cw, 1), (Direction::Cw, 2), (Direction::Ccw, 1), (Direction::Ccw, 2)];
    let mut robot = Robot::labmate();
    robot.encoder = Encoder::new(2796.8, Some(20.0), None).unwrap();
    Dataset {
        robot: Some(robot),
        path: Some(DrivenPath::umbmark()),
        runs: runs.into_iter().map(|(direction, number)| run(direction, number)).collect(),
        ..Dataset::default()
    }
}

fn layout(name: &str) -> &'static Layout {
    Layout::named(name).unwrap()
}

/// What is read back, and what was lost.
fn round_trip(data: &Dataset, name: &str) -> (Dataset, Vec<String>) {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("out");
    let lost = layout(name).write(data, &folder, Existing::Keep).unwrap();
    (crate::load(&folder).unwrap_or_else(|error| panic!("{name}: {error}")), lost)
}

fn logs(data: &Dataset) -> Vec<&TickLog> {
    super::logs(data).map(|(_, log)| log).collect()
}

#[test]
fn every_layout_keeps_what_is_there_unless_it_may_be_replaced() {
    let data = dataset(1);
    for layout in Layout::written() {
        let place = tempfile::tempdir().unwrap();
        let convert = |existing| layout.write(&data, place.path().join("out"), existing);
        convert(Existing::Keep).unwrap();
        assert!(convert(Existing::Keep).is_err(), "{}", layout.name);
        convert(Existing::Replace).unwrap();
    }
}

#[test]
fn the_own_layout_loses_nothing() {
    let data = dataset(3);
    let (read, lost) = round_trip(&data, "csv");
    assert!(lost.is_empty());
    assert_eq!(read.runs, {
        let mut runs = data.runs.clone();
        runs.sort_by_key(|run| (run.test, run.direction, run.number));
        runs
    });
    assert_eq!(read.robot, data.robot);
}

/// A dataset in the own layout whose columns go by other names, in a unit of their own, with the lines of `[columns]`.
fn called_otherwise(folder: &Path, lines: &str) {
    layout("csv").write(&dataset(1), folder, Existing::Keep).unwrap();
    let robot = folder.join("robot.toml");
    let text = std::fs::read_to_string(&robot).unwrap();
    std::fs::write(&robot, format!("{text}\n[columns]\n{lines}")).unwrap();
    for entry in std::fs::read_dir(folder.join("runs")).unwrap() {
        let file = entry.unwrap().path();
        let text = std::fs::read_to_string(&file).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        assert_eq!(header, "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad");
        std::fs::write(&file, format!("Stamp,\"Enc L\",Enc R,x_ref_m,pos_y,yaw\n{rows}")).unwrap();
    }
}

const NAMES: &str = "t_s = \"stamp\"\nticks_left = \"enc l\"\nticks_right = \"Enc R\"\ny_ref_m = \"pos_y\"\n\
    theta_ref_rad = \"yaw\"\n";

#[test]
fn columns_that_are_called_otherwise_are_read_by_the_names_of_the_robot_file() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("own");
    called_otherwise(&folder, NAMES);
    let (own, usual) = (crate::load(&folder).unwrap(), round_trip(&dataset(1), "csv").0);
    assert_eq!(own.runs, usual.runs);
    assert!(own.warnings.is_empty(), "{:?}", own.warnings);
    let one = crate::load(folder.join("runs").join("cw_01.csv")).unwrap();
    assert_eq!(logs(&one), [logs(&usual)[0]]);
    // What is written beside them reads the same tables.
    let text = RobotFile::beside(&own, own.robot.clone().unwrap()).text();
    std::fs::write(folder.join("robot.toml"), text).unwrap();
    assert_eq!(crate::load(&folder).unwrap().runs, usual.runs);
    // Converted, they have their usual names.
    let (converted, _) = round_trip(&own, "csv");
    assert_eq!((converted.runs, converted.columns.len()), (usual.runs, 0));
}

#[test]
fn a_name_that_no_table_has_or_that_is_given_twice_is_refused() {
    let refused = |lines: &str| {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("own");
        called_otherwise(&folder, lines);
        let message = crate::load(&folder).unwrap_err().to_string();
        message.rsplit_once("/own/").unwrap().1.to_owned()
    };
    let line = |text: &str| {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("own");
        called_otherwise(&folder, text);
        let whole = std::fs::read_to_string(folder.join("robot.toml")).unwrap();
        whole.lines().count()
    };
    let lost = format!("{NAMES}gyro_rad_s = \"wz\"\n");
    let at = line(&lost);
    let words = "gyro_rad_s must be what stands above a column, got \"wz\"; no table of this dataset has it";
    assert_eq!(refused(&lost), format!("robot.toml:{at}: {words}"));
    let twice = format!("{NAMES}x_ref_m = \"POS_Y\"\n");
    assert!(refused(&twice).contains("a column that no other line names"), "{}", refused(&twice));
    let typed = NAMES.replace("ticks_left", "tick_left");
    assert!(refused(&typed).contains("there is no column ticks_left; is it \"tick_left\"?"), "{}", refused(&typed));
    let number = format!("{NAMES}x_ref_m = 4\n");
    assert!(refused(&number).contains("put it in quotation marks"), "{}", refused(&number));
    let doubled = NAMES.replace("y_ref_m", "x_ref_m");
    assert!(refused(&doubled).contains("x_ref_m"), "{}", refused(&doubled));
}

/// The same in the tables of a track, of returns and of marks.
#[test]
fn a_track_that_is_called_otherwise_is_read_by_the_names_of_the_robot_file() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("own");
    let robot = "[robot]\nwheelbase_m = 0.34\nwheel_diameter_m = 0.15\nticks_per_revolution = 2000\n\n[columns]\nx_ref_mm = \"px\"\ny_ref_mm = \"py\"\nx_abs_m = \"end x\"\n";
    std::fs::create_dir_all(folder.join("runs")).unwrap();
    std::fs::create_dir_all(folder.join("reference")).unwrap();
    std::fs::write(folder.join("robot.toml"), robot).unwrap();
    std::fs::write(folder.join("returns.csv"), "direction,run,end x,y_abs_m,x_calc_m,y_calc_m\nccw,2,0.1,0.2,0,0\n")
        .unwrap();
    // It stands, drives, stands, drives and stands, 5 mm in 0.1 s.
    let driven = |i: i32| (i - 20).clamp(0, 60) + (i - 110).clamp(0, 90);
    let table = |header: &str, row: &dyn Fn(i32) -> String| {
        (0..240)
            .map(|i| format!("{},{}\n", 0.1 * f64::from(i), row(i)))
            .fold(format!("{header}\n"), |all, row| all + &row)
    };
    let ticks = |i: i32| (f64::from(driven(i)) * 0.005 / (0.15 * std::f64::consts::PI) * 2000.0).round();
    let log = table("t_s,ticks_left,ticks_right", &|i| format!("{},{}", ticks(i), ticks(i)));
    std::fs::write(folder.join("runs").join("ccw_01.csv"), log).unwrap();
    let track = table("t_s,px,py", &|i| format!("{},0", 5 * driven(i)));
    std::fs::write(folder.join("reference").join("ccw_01.csv"), track).unwrap();
    let data = crate::load(&folder).unwrap();
    let far = logs(&data)[0].reference.iter().map(|pose| pose.x.hypot(pose.y)).fold(0.0, f64::max);
    assert!((far - 0.75).abs() < 1e-3, "{far}");
    assert!((data.runs[1].returned.unwrap().x - 0.1).abs() < 1e-12);
}

#[test]
fn optiodom_holds_every_log_with_a_pose_in_every_row() {
    let data = dataset(1);
    let (read, lost) = round_trip(&data, "optiodom");
    assert_eq!(logs(&read), logs(&data));
    assert_eq!(read.robot.as_ref().unwrap().drive, data.robot.as_ref().unwrap().drive);
    assert_eq!(read.robot.unwrap().encoder.ticks_per_revolution(), 2796.8);
    assert_eq!(read.path.unwrap().values(), data.path.as_ref().unwrap().values());
    let said = lost.join("; ");
    assert_eq!(
        said,
        "the numbers of the runs: they are counted through both directions; encoder rate and counter width; return errors: \
         they follow from the last row of each log"
    );
}

#[test]
fn optiodom_says_how_many_rows_had_no_pose_and_keeps_their_ticks() {
    let data = dataset(4);
    let (read, lost) = round_trip(&data, "optiodom");
    assert!(lost.contains(&"360 rows without a pose: their ticks are in the next row with one".into()), "{lost:?}");
    for (ours, theirs) in logs(&data).iter().zip(logs(&read)) {
        assert_eq!(theirs.left.last(), Some(&ours.left[116]));
        assert_eq!(theirs.reference.len(), ours.reference.len());
    }
    assert!(lost.iter().any(|text| text.ends_with("ticks after the last poses")), "{lost:?}");
}

#[test]
fn tum_holds_the_measured_poses() {
    let data = dataset(2);
    let place = tempfile::tempdir().unwrap();
    layout("tum").write(&data, place.path().join("out"), Existing::Keep).unwrap();
    let text = std::fs::read_to_string(place.path().join("out/cw_02_reference.tum")).unwrap();
    let rows = tum::parse_tum(Source::of("file", text.as_bytes()).unwrap(), &mut Vec::new()).unwrap();
    let log = data.runs[1].log.as_ref().unwrap();
    assert_eq!(rows.time.len(), log.reference.len());
    for ((time, (x, y, heading)), pose) in rows.time.iter().zip(&rows.poses).zip(&log.reference) {
        assert_eq!((*time, *x, *y), (log.time[pose.sample], pose.x, pose.y));
        assert!(wrap(heading.unwrap() - pose.heading.unwrap()).abs() < 1e-14);
    }
}

#[test]
fn the_return_sheet_holds_the_return_errors() {
    let data = dataset(1);
    let place = tempfile::tempdir().unwrap();
    let lost = layout("returns").write(&data, place.path().join("out"), Existing::Keep).unwrap();
    let read = crate::load(place.path().join("out/returns.csv")).unwrap();
    let errors = |data: &Dataset| {
        let mut found: Vec<_> = data.runs.iter().map(|run| (run.direction, run.number, run.returned)).collect();
        found.sort_by_key(|(direction, number, _)| (*direction, *number));
        found
    };
    assert_eq!(errors(&read), errors(&data));
    assert_eq!(lost[0], "4 logs: a return sheet holds end poses only");
}

#[test]
fn counts_between_readings_of_a_counter_that_rolls_over_are_written_unrolled() {
    let mut data = dataset(1);
    let encoder = Encoder::new(2000.0, None, Some(12)).unwrap();
    data.robot.as_mut().unwrap().encoder = encoder;
    for run in &mut data.runs {
        run.log.as_mut().unwrap().left[7] += 0.5;
    }
    let (read, lost) = round_trip(&data, "csv");
    assert!(lost[0].starts_with("counter_bits"));
    assert_eq!(logs(&read).len(), 4);
    assert_eq!(read.robot.unwrap().encoder.counter_bits(), None);
}

#[test]
fn what_a_layout_cannot_hold_at_all_is_refused() {
    let mut data = dataset(1);
    for run in &mut data.runs {
        run.log.as_mut().unwrap().reference.clear();
        run.returned = None;
    }
    let place = tempfile::tempdir().unwrap();
    for name in ["optiodom", "returns"] {
        let error = layout(name).write(&data, place.path().join("out"), Existing::Keep).unwrap_err();
        assert!(matches!(error, DatasetError::Unwritable { .. }), "{error}");
        assert!(!place.path().join("out").exists());
    }
}

/// Logs as they differ after a way through MCAP: counts, positions and samples to the last bit, times and headings nearly.
fn assert_near(ours: &Dataset, theirs: &Dataset, origin: impl Fn(&TickLog) -> f64) {
    let mut runs = ours.runs.clone();
    runs.sort_by_key(|run| (run.test, run.direction, run.number));
    assert_eq!(runs.len(), theirs.runs.len());
    for (a, b) in runs.iter().zip(&theirs.runs) {
        assert_eq!((&a.name, a.number, a.direction, a.returned), (&b.name, b.number, b.direction, b.returned));
        let (a, b) = (a.log.as_ref().unwrap(), b.log.as_ref().unwrap());
        assert_eq!((&a.left, &a.right, a.reference.len()), (&b.left, &b.right, b.reference.len()));
        let zero = origin(a);
        assert!(a.time.iter().zip(&b.time).all(|(a, b)| (a - zero - b).abs() <= 1e-9));
        for (a, b) in a.reference.iter().zip(&b.reference) {
            assert_eq!((a.sample, a.x, a.y, a.heading.is_some()), (b.sample, b.x, b.y, b.heading.is_some()));
            let (a, b) = (a.heading.unwrap_or(0.0), b.heading.unwrap_or(0.0));
            assert!((a - b).abs() <= 4e-15 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}

#[test]
fn mcap_loses_nothing_but_last_digits_from_csv_to_mcap_to_csv() {
    let mut data = dataset(3);
    for pose in &mut data.runs[0].log.as_mut().unwrap().reference {
        pose.heading = pose.heading.map(|heading| 7.0 * heading).filter(|_| pose.sample % 9 == 0);
    }
    let place = tempfile::tempdir().unwrap();
    let [first, logs, second] = ["first", "logs", "second"].map(|name| place.path().join(name));
    assert!(layout("csv").write(&data, &first, Existing::Keep).unwrap().is_empty());
    let read = crate::load(&first).unwrap();
    let lost = layout("mcap").write(&read, &logs, Existing::Keep).unwrap();
    let known = ["times are rounded to the nanosecond", "headings are rounded in their last digits (4e-15 rad)"];
    assert!(lost.len() == 2 && lost.iter().zip(known).all(|(said, known)| said.ends_with(known)), "{lost:?}");
    let read = crate::load(&logs).unwrap();
    assert_eq!(read.topics.len(), 4);
    assert_eq!(
        (&*read.topics[0].wheels, read.topics[0].reference.as_deref()),
        ("/joint_states", Some("/ground_truth"))
    );
    assert_near(&data, &read, |_| 0.0);
    layout("csv").write(&read, &second, Existing::Keep).unwrap();
    let read = crate::load(&second).unwrap();
    assert_near(&data, &read, |_| 0.0);
    assert_eq!((&read.robot, read.path.unwrap().values()), (&data.robot, data.path.as_ref().unwrap().values()));
    for name in ["robot.toml", "returns.csv"] {
        let text = |folder: &Path| std::fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!((text(&first), text(&second)), (text(&logs), text(&logs)), "{name}");
    }
}

#[test]
fn mcap_counts_times_of_a_calendar_and_times_below_zero_from_the_first_row_and_says_so() {
    for origin in [1.7e9, -20.0] {
        let mut data = dataset(3);
        for run in &mut data.runs {
            run.log.as_mut().unwrap().time.iter_mut().for_each(|time| *time += origin);
        }
        let (read, lost) = round_trip(&data, "mcap");
        assert_eq!(lost[0], "4 logs keep no date: their times are counted from the first row");
        assert_near(&data, &read, |log| log.time[0]);
    }
}

#[test]
fn mcap_keeps_counts_between_readings_but_for_their_last_digits_and_says_how_many() {
    let mut data = dataset(1);
    for run in &mut data.runs {
        run.log.as_mut().unwrap().left.iter_mut().skip(7).step_by(2).for_each(|count| *count += 1.0 / 3.0);
    }
    let (read, lost) = round_trip(&data, "mcap");
    assert!(
        lost.iter().any(|said| said.ends_with("counts between readings are rounded in their last digits")),
        "{lost:?}"
    );
    let mut ours: Vec<&TickLog> = logs(&data);
    ours.rotate_left(if data.runs[0].direction == read.runs[0].direction { 0 } else { 2 });
    for (a, b) in ours.iter().zip(logs(&read)) {
        assert!(a.left.iter().zip(&b.left).all(|(a, b)| (a - b).abs() <= 4e-15 * a.abs()));
    }
}

#[test]
fn a_place_that_ends_in_mcap_holds_one_run() {
    let mut data = dataset(1);
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("one.MCAP");
    assert_eq!((Layout::of_place(&file).name, Layout::of_place(place.path()).name), ("mcap", "csv"));
    let error = Layout::of_place(&file).write(&data, &file, Existing::Keep).unwrap_err().to_string();
    assert!(error.contains("there are 4 runs, and an MCAP file holds one"), "{error}");
    data.runs.truncate(1);
    let lost = Layout::of_place(&file).write(&data, &file, Existing::Keep).unwrap();
    assert_eq!(lost.last().unwrap(), "the return error: it follows from the log");
    assert_eq!(logs(&crate::load(&file).unwrap())[0].left, data.runs[0].log.as_ref().unwrap().left);
}
