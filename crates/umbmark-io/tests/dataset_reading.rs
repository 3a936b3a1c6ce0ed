//! What good files mean, and what is tolerated in them.

use std::f64::consts::{FRAC_PI_2, PI};
use umbmark_core::dataset::{Dataset, ReturnError, Run};
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;
use umbmark_io::{At, DatasetError, Existing, LineProblem, RobotFile};

pub(crate) const ROBOT: &str = "[robot]\nwheelbase_m = 0.5\nwheel_diameter_m = 0.2\nticks_per_revolution = 1000\n";

pub(crate) fn load(files: &[(&str, &str)], path: &str) -> Result<Dataset, DatasetError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }
    umbmark_io::load(if path.is_empty() { folder.path().to_owned() } else { folder.path().join(path) })
}

fn returns(text: &str) -> Dataset {
    load(&[("robot.toml", ROBOT), ("returns.csv", text)], "").unwrap()
}

pub(crate) fn log(name: &str, text: &str) -> Dataset {
    load(&[("robot.toml", ROBOT), (&format!("runs/{name}"), text)], "").unwrap()
}

fn errors(data: &Dataset) -> Vec<ReturnError> {
    data.runs.iter().map(|run| run.returned.unwrap()).collect()
}

/// Counts of a robot that turns on the spot by an angle \[rad\] and stands still before and after.
fn turning(angle: f64, references: [&str; 3]) -> String {
    let ticks = (angle * 0.25 / (PI * 0.2 / 1000.0)).round();
    let mut text = String::from("t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n");
    for (i, reference) in references.iter().enumerate() {
        let turned = if i == 0 { 0.0 } else { ticks };
        text += &format!("{},{},{},{reference}\n", 10 * i, -turned, turned);
    }
    text
}

#[test]
fn the_error_is_absolute_minus_computed_with_the_heading_wrapped() {
    let data = returns(
        "direction,run,x_abs_m,y_abs_m,theta_abs_rad,x_calc_m,y_calc_m,theta_calc_rad\n\
         cw,1,0.5,0.25,-6.25,0.125,0.5,0.0\nccw,2,0,0,3.0,0,0,-3.0\n",
    );
    let [cw, ccw] = errors(&data)[..] else { panic!() };
    assert_eq!((cw.x, cw.y), (0.375, -0.25));
    assert!((cw.heading.unwrap() - (2.0 * PI - 6.25)).abs() < 1e-15);
    assert!((ccw.heading.unwrap() - (6.0 - 2.0 * PI)).abs() < 1e-15);
    assert_eq!(data.runs[1].number, 2);
    let errors = errors(&returns("direction,run,ex_m,ey_m,etheta_rad\ncw,1,0,0,6.25\n"));
    assert!((errors[0].heading.unwrap() - (6.25 - 2.0 * PI)).abs() < 1e-15);
}

#[test]
fn millimetres_centimetres_and_degrees_are_metres_and_radians() {
    let mm = returns("direction,run,ex_mm,ey_mm,etheta_deg\ncw,1,250,-125,90\n");
    let cm = returns("direction,run,ex_cm,ey_cm,etheta_rad\ncw,1,25,-12.5,1.5707963267948966\n");
    let expected = ReturnError { x: 0.25, y: -0.125, heading: Some(FRAC_PI_2) };
    assert_eq!((errors(&mm), errors(&cm)), (vec![expected], vec![expected]));
}

#[test]
fn a_heading_may_be_missing_in_all_rows_or_in_some() {
    let none = returns("direction,run,ex_m,ey_m\ncw,1,0.1,0.2\n");
    assert_eq!(errors(&none)[0].heading, None);
    let some = returns(
        "direction,run,x_abs_m,y_abs_m,theta_abs_rad,x_calc_m,y_calc_m,theta_calc_rad\ncw,1,1,2,,0,0,0.5\ncw,2,1,2,0.5,0,0,0.25\n",
    );
    assert_eq!(errors(&some).iter().map(|e| e.heading).collect::<Vec<_>>(), [None, Some(0.25)]);
}

#[test]
fn a_measured_start_turns_the_absolute_pose_into_its_frame() {
    let data = returns(
        "direction,run,x_abs_m,y_abs_m,theta_abs_deg,x_calc_m,y_calc_m,theta_calc_deg,x_start_m,y_start_m,theta_start_deg\n\
         cw,1,3,5.5,100,0.25,0,0,3,5,90\n",
    );
    let error = errors(&data)[0];
    assert!((error.x - 0.25).abs() < 1e-15 && error.y.abs() < 1e-15, "{error:?}");
    assert!((error.heading.unwrap() - 10f64.to_radians()).abs() < 1e-15);
}

#[test]
fn harmless_untidiness_is_tolerated() {
    let tidy = returns("direction,run,test,ex_m,ey_m\ncw,1,systematic,0.1,0.2\ncw,1,bumps,0.3,0.4\nccw,1,,0.5,0.6\n");
    for untidy in [
        "direction,run,test,ex_m,ey_m\r\ncw,1,systematic,0.1,0.2\r\ncw,1,bumps,0.3,0.4\r\nccw,1,,0.5,0.6\r\n",
        "direction,run,test,ex_m,ey_m\rcw,1,systematic,0.1,0.2\rcw,1,bumps,0.3,0.4\rccw,1,,0.5,0.6",
        "\u{feff}direction,run,test,ex_m,ey_m\ncw,1,systematic,0.1,0.2\ncw,1,bumps,0.3,0.4\nccw,1,,0.5,0.6",
        " Direction , RUN,Test ,ex_m, ey_m\n CW , 1, systematic, +0.1, 2e-1\n\n  \ncw,1,Bumps,.3,0.4\nccw,01,,0.5,0.6\n,,,,\n",
        "# a comment\n\"direction\",\"run\",test,ex_m,ey_m\n# another\nccw,1,,0.5,0.6,,\ncw,1,bumps,0.3,\"0.4\"\ncw,1,systematic,0.1,0.2\n",
    ] {
        assert_eq!(returns(untidy).runs, tidy.runs, "{untidy:?}");
    }
    assert_eq!(tidy.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>(), ["cw_01", "ccw_01", "bumps_cw_01"]);
}

#[test]
fn a_column_that_is_not_known_is_named_in_a_warning() {
    let data = returns("direction,run,ex_m,ey_m,operator\ncw,1,0.1,0.2,Ann\n");
    assert_eq!(data.warnings.len(), 1);
    assert!(data.warnings[0].ends_with("column \"operator\" is not used"), "{:?}", data.warnings);
}

#[test]
fn columns_and_headings_that_are_not_what_they_are_called_are_mended_where_robot_toml_says_how() {
    let track = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n0,0,0,0,0,0\n1,100,200,0.1,0.05,0.2\n2,100,200,0.1,0.05,0.2\n";
    let robot = |keys: &str| ROBOT.to_owned() + keys;
    let read = |keys: &str| load(&[("robot.toml", &robot(keys)), ("runs/ccw_01.csv", track)], "").unwrap();
    let seen = |data: Dataset| {
        let log = data.runs[0].log.as_ref().unwrap();
        let (pose, rounded) = (log.reference[1], |value: f64| (1e9 * value).round() / 1e9);
        ([log.left[1], log.right[1]], (rounded(pose.y), rounded(pose.heading.unwrap())))
    };
    for (keys, ticks, pose) in [
        ("", [100.0, 200.0], (0.05, 0.2)),
        ("wheels_exchanged = true\n", [200.0, 100.0], (0.05, 0.2)),
        ("left_counts_backward = true\n", [-100.0, 200.0], (0.05, 0.2)),
        ("right_counts_backward = true\nwheels_exchanged = true\n", [-200.0, 100.0], (0.05, 0.2)),
        ("left_counts_backward = true\ncounter_bits = 16\n", [-100.0, 200.0], (0.05, 0.2)),
        ("left_counts_backward = false\n[reference]\ny_mirrored = true\n", [100.0, 200.0], (-0.05, 0.2)),
        ("[reference]\nheading_clockwise = true\n", [100.0, 200.0], (0.05, -0.2)),
        // Poses are seen from START, where the robot then faces the other way.
        ("[reference]\nheading_backward = true\n", [100.0, 200.0], (-0.05, 0.2)),
        ("[reference]\nheading_backward = true\nheading_clockwise = true\n", [100.0, 200.0], (-0.05, -0.2)),
    ] {
        assert_eq!(seen(read(keys)), (ticks, pose), "{keys}");
        // What is saved reads back as it is meant, whatever its columns were.
        let (data, folder) = (read(keys), tempfile::tempdir().unwrap());
        for (place, mcap) in [("csv", false), ("mcap", true)] {
            let place = folder.path().join(place);
            if mcap {
                umbmark_io::save_mcap(&data, &place, Existing::Keep).unwrap();
            } else {
                umbmark_io::save(&data, &place, Existing::Keep).unwrap();
            }
            assert_eq!(seen(umbmark_io::load(&place).unwrap()), (ticks, pose), "{keys}");
        }
        let file = RobotFile::beside(&data, data.robot.clone().unwrap());
        let again = RobotFile::parse("robot.toml", &file.text()).unwrap();
        assert_eq!((again.robot, again.reference), (file.robot, file.reference), "{keys}");
    }
    let refused =
        |keys: &str| load(&[("robot.toml", &robot(keys)), ("runs/ccw_01.csv", track)], "").unwrap_err().to_string();
    assert!(refused("wheels_exchanged = 1\n").ends_with("robot.toml:5: wheels_exchanged must be true or false, got 1"));
    assert!(refused("[reference]\nclockwise = true\n").contains("unknown key \"clockwise\" in [reference]"));
}

#[test]
fn a_return_sheet_alone_needs_no_robot_until_one_is_asked_for() {
    let files = [("sheet.csv", "direction,run,ex_m,ey_m\ncw,1,0.1,0.2\n")];
    let data = load(&files, "sheet.csv").unwrap();
    assert_eq!(data.returns(TestKind::Systematic, Direction::Cw).count(), 1);
    assert_eq!(data.returns(TestKind::Systematic, Direction::Ccw).count(), 0);
    let said = data.nominal_robot().unwrap_err().to_string();
    assert_eq!(said, "the nominal robot is not known: no robot.toml beside the data");
    let beside = load(&[("robot.toml", ROBOT), files[0]], "sheet.csv").unwrap();
    assert_eq!(beside.nominal_robot().unwrap().drive.wheelbase(), 0.5);
}

#[test]
fn wheels_and_wheelbase_go_by_several_names() {
    let read = |wheels: &str| {
        let text = format!("[robot]\n{wheels}\nticks_per_revolution = 1000\nencoder_rate_hz = \"every tick\"\n");
        RobotFile::parse("robot.toml", &text).unwrap().robot
    };
    let plain = read("wheelbase_m = 0.5\nwheel_diameter_m = 0.25");
    assert_eq!(plain.encoder.rate(), None);
    let hex = "[robot]\nwheelbase_m = 0.5\nwheel_diameter_m = 0.25\nticks_per_revolution = 0x3E8\n";
    assert_eq!(RobotFile::parse("robot.toml", hex).unwrap().robot.encoder.ticks_per_revolution(), 1000.0);
    assert_eq!(read("track_width_m = 0.5\nwheel_radius_m = 0.125"), plain);
    assert_eq!(read("wheel_separation_m = 0.5\nwheel_diameter_left_m = 0.25\nwheel_diameter_right_m = 0.25"), plain);
    assert_eq!(
        read("wheelbase_m = 5e-1\nwheel_diameter_left_m = 0.2\nwheel_diameter_right_m = 0.3")
            .drive
            .wheel_diameter_left(),
        0.2
    );
}

#[test]
fn paths_of_every_shape_are_read() {
    for (lines, length) in [
        ("shape = \"square\"\nside_m = 2", 8.0),
        ("shape = \"rectangle\"\nlength_m = 7.0\nwidth_m = 4.0", 22.0),
        ("shape = \"figure_eight\"\nradius_m = 1.0", 4.0 * PI),
        ("shape = \"circle\"\nradius_m = 1.0\nturns = 2", 4.0 * PI),
        ("shape = \"straight\"\nlength_m = 10.0", 10.0),
        ("shape = \"spin\"\nturns = 3.0", 0.0),
        ("shape = \"waypoints\"\npoints_m = [[1.0, 0.0], [1, 1], [0, 0]]", 2.0 + 2f64.sqrt()),
    ] {
        let text = format!("{ROBOT}[path]\n{lines}\nspeed_m_s = 0.5\npause_s = 0\n");
        let path = RobotFile::parse("robot.toml", &text).unwrap().path.unwrap();
        assert!((path.length() - length).abs() < 1e-12, "{lines}");
        assert_eq!(path.speed.values(), [0.5, 0.2, 0.0]);
    }
}

#[test]
fn rolled_counters_are_unrolled_both_ways_and_counted_from_start() {
    let robot = format!("{ROBOT}counter_bits = 16\n");
    let text = "t_s,ticks_left,ticks_right\n0,169,65533\n0.05,65410,394\n0.1,65000,800\n";
    let data = load(&[("robot.toml", &robot), ("runs/cw_01.csv", text)], "").unwrap();
    let log = data.runs[0].log.as_ref().unwrap();
    assert_eq!((&log.left[..], &log.right[..]), (&[0.0, -295.0, -705.0][..], &[0.0, 397.0, 803.0][..]));
    assert!(data.warnings[0].ends_with("2 roll-overs of the 16-bit counters undone"), "{:?}", data.warnings);
}

#[test]
fn the_direction_is_that_of_the_name_else_that_of_the_ticks() {
    for (name, turned, direction, number) in [
        ("ccw_03.csv", 6.0, Some(Direction::Ccw), 3),
        ("monday 7.csv", -6.0, Some(Direction::Cw), 7),
        ("monday.csv", 6.0, Some(Direction::Ccw), 1),
        ("straight_02.csv", 0.1, None, 2),
        ("none_01.csv", 6.0, None, 1),
    ] {
        let data = log(name, &turning(turned, ["", "", ""].map(|_| ",,")));
        assert_eq!((data.runs[0].direction, data.runs[0].number), (direction, number), "{name}");
        assert!(data.warnings.is_empty());
    }
    let data = log("cw_01.csv", &turning(6.0, [",,"; 3]));
    assert_eq!(data.runs[0].direction, Some(Direction::Cw));
    assert!(data.warnings[0].contains("its name says cw, its ticks turn ccw"), "{:?}", data.warnings);
}

#[test]
fn without_a_return_sheet_the_error_follows_from_the_log() {
    let data = log("ccw_01.csv", &turning(2.0, ["0.001,0,0", "0.05,0.25,2.25", "0.05,0.25,2.25"]));
    let error = errors(&data)[0];
    assert_eq!((error.x, error.y), (0.05, 0.25));
    assert!((error.heading.unwrap() - 0.25).abs() < 1e-3, "{error:?}");
}

#[test]
fn at_the_end_the_second_half_of_the_standing_measurements_is_averaged() {
    let mut text = turning(2.0, ["0,0,0", "9,9,9", "1,1,1"]);
    let last = text.lines().last().unwrap().split(',').take(3).skip(1).collect::<Vec<_>>().join(",");
    for (time, reference) in [(30, "0.25,0,2"), (40, "0.75,0,2.5")] {
        text += &format!("{time},{last},{reference}\n");
    }
    let error = errors(&log("ccw_01.csv", &text))[0];
    assert_eq!(error.x, 0.5);
    assert!((error.heading.unwrap() - 0.25).abs() < 1e-3);
}

#[test]
fn a_track_in_the_room_is_turned_into_the_frame_of_start_and_a_misplaced_robot_is_not() {
    let room = log(
        "ccw_01.csv",
        &turning(
            2.0,
            ["3,5,1.5707963267948966", "", "2.75,5.5,3.5707963267948966"].map(|r| if r.is_empty() { ",," } else { r }),
        ),
    );
    let error = errors(&room)[0];
    assert!((error.x - 0.5).abs() < 1e-12 && (error.y - 0.25).abs() < 1e-12, "{error:?}");
    assert!(error.heading.unwrap().abs() < 1e-3);
    assert!(room.warnings[0].contains("starts 5.831 m and 90.0 deg from the origin; taken as poses in the room"));
    let hand = log("ccw_01.csv", &turning(2.0, ["0.02,0,0.01", ",,", "0.25,0.5,2"]));
    assert_eq!(errors(&hand)[0].x, 0.25);
    assert!(hand.warnings[0].contains("taken as misplacement of the robot"), "{:?}", hand.warnings);
    let noise = log("ccw_01.csv", &turning(2.0, ["0.001,0,0.001", ",,", "0.25,0.5,2"]));
    assert!(noise.warnings.is_empty());
}

#[test]
fn logs_and_returns_are_matched_by_test_direction_and_number() {
    let sheet = "direction,run,test,ex_m,ey_m\nccw,1,systematic,1,0\nccw,1,bumps,2,0\nccw,2,bumps,3,0\n";
    let still = turning(2.0, [",,"; 3]);
    let files = [
        ("robot.toml", ROBOT),
        ("returns.csv", sheet),
        ("runs/ccw_01.csv", &still),
        ("runs/bumps_ccw_01.csv", &still),
        ("runs/ccw_02.csv", &still),
        ("runs/ccw_03.csv", &still),
    ];
    let data = load(&files, "").unwrap();
    let described = |run: &Run| (run.name.clone(), run.test, run.number, run.returned.map(|e| e.x), run.log.is_some());
    assert_eq!(
        data.runs.iter().map(described).collect::<Vec<_>>(),
        [
            ("ccw_01".into(), TestKind::Systematic, 1, Some(1.0), true),
            ("ccw_03".into(), TestKind::Systematic, 3, None, true),
            ("bumps_ccw_01".into(), TestKind::Bumps, 1, Some(2.0), true),
            ("ccw_02".into(), TestKind::Bumps, 2, Some(3.0), true),
        ]
    );
    assert!(data.warnings[0].ends_with("has no row in the return sheet; its return error is not known"));
}

#[test]
fn a_gap_in_which_the_wheels_rolled_on_is_not_taken_for_a_roll_over() {
    let mut text = String::from("t_s,ticks_left,ticks_right\n");
    for row in (0..40).filter(|row| !(20..30).contains(row)) {
        text += &format!("{},{},{}\n", 0.1 * f64::from(row), 23 * row, 24 * row);
    }
    assert_eq!(log("cw_01.csv", &text).runs[0].log.as_ref().unwrap().right[29], 936.0);
    let rolled = "t_s,ticks_left,ticks_right\n0,3,250\n0.1,6,254\n0.2,9,2\n";
    let files = [("robot.toml", ROBOT), ("runs/cw_01.csv", rolled)];
    let error = load(&files, "").unwrap_err();
    assert!(matches!(
        error,
        DatasetError::Line { problem: LineProblem::RolledOver { bits: 8, .. }, at: At { line: 4, .. } }
    ));
}

#[test]
fn the_model_in_the_documents_is_one() {
    let blocks = include_str!("../../../docs/files.md").split("```toml\n").skip(1);
    let blocks: Vec<&str> = blocks.filter_map(|block| block.split("```").next()).collect();
    let effects = blocks[0];
    let noise = blocks.iter().find(|block| block.starts_with("[noise]")).unwrap();
    let robot = umbmark_core::drive::Robot::labmate();
    let umbmark_io::ModelFile { model, draws, noise, .. } =
        umbmark_io::ModelFile::parse("files.md", &format!("{effects}\n{noise}"), Some(&robot)).unwrap();
    assert_eq!((model.parts().len(), draws.len()), (4, 2));
    assert_eq!(model.parts()[3].fixed, ["drift_y"]);
    assert_eq!(noise, Some(umbmark_core::likelihood::Noise::default()));
}

fn warnings_of(text: &str) -> (Dataset, String) {
    let data = log("cw_01.csv", text);
    let warnings = data.warnings.join("; ");
    (data, warnings)
}

fn counts(data: &Dataset) -> (&[f64], &[f64], &[f64]) {
    let log = data.runs[0].log.as_ref().unwrap();
    (&log.time, &log.left, &log.right)
}

#[test]
fn late_and_repeated_rows_are_put_in_order_and_counted() {
    let (data, said) = warnings_of(
        "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m\n0,0,0,0,0\n0.02,2,4,,\n0.01,1,2,0.5,0\n0.03,3,6,,\n0.03,3,6,0.7,0\n0.04,4,8,,\n",
    );
    let expected: &[f64] = &[0.0, 1.0, 2.0, 3.0, 4.0];
    assert_eq!(counts(&data).1, expected);
    assert_eq!(counts(&data).0, [0.0, 0.01, 0.02, 0.03, 0.04]);
    let reference = &data.runs[0].log.as_ref().unwrap().reference;
    assert_eq!(reference.iter().map(|pose| (pose.sample, pose.x)).collect::<Vec<_>>(), [(0, 0.0), (1, 0.5), (3, 0.7)]);
    assert!(said.contains("1 rows out of order were put where their time stamps say"), "{said}");
    assert!(said.contains("1 rows that repeat a time stamp were left out"), "{said}");
}

#[test]
fn a_time_stamp_coarser_than_the_rate_keeps_the_last_of_its_rows() {
    let (data, said) = warnings_of("t_s,ticks_left,ticks_right\n0,0,0\n0.01,1,1\n0.01,2,2\n0.02,3,3\n");
    assert_eq!(counts(&data).1, [0.0, 2.0, 3.0]);
    assert!(said.contains("1 rows that repeat a time stamp were left out"), "{said}");
}

/// The pose of a moment belongs to the counts of that moment, not to those of another row with its stamp.
#[test]
fn counts_and_pose_of_one_stamp_are_of_one_row() {
    let (data, _) = warnings_of(
        "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m\n0,0,0,0,0\n0.1,1,1,0.1,0\n0.1,2,2,0.2,0\n0.1,3,3,0.3,0\n\
         0.2,4,4,0.4,0\n0.2,5,5,,\n0.3,6,6,,\n0.3,7,7,,\n",
    );
    assert_eq!(counts(&data).1, [0.0, 3.0, 4.0, 7.0]);
    let reference = &data.runs[0].log.as_ref().unwrap().reference;
    assert_eq!(reference.iter().map(|pose| (pose.sample, pose.x)).collect::<Vec<_>>(), [(0, 0.0), (1, 0.3), (2, 0.4)]);
}

#[test]
fn a_counter_that_was_set_back_goes_on_and_one_that_rolled_over_is_another_thing() {
    let rows = |counts: &[(i64, i64)]| {
        let row = |(i, (left, right)): (usize, &(i64, i64))| format!("{},{left},{right}\n", 0.01 * i as f64);
        "t_s,ticks_left,ticks_right\n".to_owned() + &counts.iter().enumerate().map(row).collect::<String>()
    };
    let up: Vec<(i64, i64)> = (0..200).map(|i| (1000 + 3 * i, 2000 + 3 * i)).collect();
    let reset: Vec<(i64, i64)> = up.iter().copied().chain((0..200).map(|i| (3 * i, 1 + 3 * i))).collect();
    let (data, said) = warnings_of(&rows(&reset));
    assert!(
        said.contains("1 counter reset: counted on; what the wheels turned between the rows around each"),
        "{said}"
    );
    assert_eq!((counts(&data).1[399], counts(&data).2[399]), (3.0 * 399.0, 3.0 * 399.0));
    // After a pause of two tenths of a second, what the counters show is all that is known.
    let late = rows(&reset).replace("\n2,0,1\n", "\n2.19,0,1\n");
    let late: String = late.lines().take(202).map(|line| format!("{line}\n")).collect();
    assert_eq!((counts(&warnings_of(&late).0).1[200], counts(&warnings_of(&late).0).2[200]), (597.0, 598.0));
    // A 16-bit counter, full before and empty after.
    let robot = format!("{ROBOT}counter_bits = 16\n");
    let rolled: Vec<(i64, i64)> = (0..400).map(|i| ((65000 + 3 * i) % 65536, (65100 + 3 * i) % 65536)).collect();
    let data = load(&[("robot.toml", &robot), ("runs/cw_01.csv", &rows(&rolled))], "").unwrap();
    assert_eq!(counts(&data).1[399], 1197.0);
    assert!(data.warnings.iter().all(|warning| !warning.contains("reset")), "{:?}", data.warnings);
    // The same counter, set back at 1597 and then at half its range: no shorter way round explains it.
    let data = load(&[("robot.toml", &robot), ("runs/cw_01.csv", &rows(&reset))], "").unwrap();
    assert!(data.warnings[0].contains("1 counter reset"), "{:?}", data.warnings);
    assert_eq!(counts(&data).1[399], 1197.0);
}

/// Rows that were read from a buffer at once: 3 mm in a microsecond, where usual rows take 10 ms.
#[test]
fn stamps_that_nearly_agree_are_no_jump_of_the_counters() {
    let mut text = String::from("t_s,ticks_left,ticks_right\n");
    for row in 0..60 {
        let stamp = if row % 3 == 0 {
            0.01 * f64::from(row)
        } else {
            0.01 * f64::from(row / 3 * 3) + 1e-6 * f64::from(row % 3)
        };
        text += &format!("{stamp:.6},{},{}\n", 13 * row, 13 * row);
    }
    let slow = "t_s,ticks_left,ticks_right\n0,0,0\n0.01,13,13\n0.010001,26,26\n0.02,39,39\n0.03,52,52\n";
    for text in [slow, &text] {
        let data = load(&[("robot.toml", ROBOT), ("runs/cw_01.csv", text)], "").unwrap();
        assert_eq!(counts(&data).1.last(), counts(&data).2.last());
    }
}

#[test]
fn poses_that_repeat_while_the_wheels_turn_are_stale_and_those_at_rest_are_not() {
    let mut text = String::from("t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n");
    for i in 0..40 {
        // Rest for ten rows, then 6.3 mm a row; the track freezes for five rows.
        let ticks = if i < 10 { 0 } else { 10 * (i - 9) };
        let seen = if (20..25).contains(&i) { 20 } else { i };
        let x = if seen < 10 { 0.0 } else { 0.0063 * f64::from(seen - 9) };
        text += &format!("{},{ticks},{ticks},{x},0,0\n", 0.05 * f64::from(i));
    }
    let (data, said) = warnings_of(&text);
    assert!(said.contains("4 poses repeat the one before while the wheels turn (stale) and were left out"), "{said}");
    assert_eq!(data.runs[0].log.as_ref().unwrap().reference.len(), 36);
}

/// A drive round a bend and on, with a pose each row that its reference saw every `every` rows, beginning with `first`, and filled in on straight
/// lines; as many rows as that.
fn seen_now_and_then(every: f64, first: f64) -> String {
    let noise = |seen: f64| 1e-3 * (7.3 * seen * seen).sin();
    let pose = |row: f64| {
        let heading = (0.004 * row).min(1.2);
        let turned = row.min(300.0);
        let on = 0.01 * (row - turned);
        let round = [2.5 * (0.004 * turned).sin(), 2.5 - 2.5 * (0.004 * turned).cos()];
        [round[0] + on * heading.cos(), round[1] + on * heading.sin(), heading]
    };
    let mut text = String::from("t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n");
    for row in 0..600 {
        let since = (f64::from(row) - first) / every;
        let (seen, share) = (since.floor(), since - since.floor());
        let measured = |seen: f64, axis: usize| pose(first + every * seen)[axis] + noise(seen + 0.3 * axis as f64);
        let [x, y, heading] =
            [0, 1, 2].map(|axis| (1.0 - share) * measured(seen, axis) + share * measured(seen + 1.0, axis));
        let ticks = [-1.0, 1.0].map(|side| 20.0 * f64::from(row) + side * 1.4 * f64::from(row.min(300)));
        text += &format!("{},{:.0},{:.0},{x:.5},{y:.5},{heading:.5}\n", 0.02 * f64::from(row), ticks[0], ticks[1]);
    }
    text
}

#[test]
fn poses_that_were_filled_in_on_straight_lines_are_left_out_and_those_that_were_measured_are_kept() {
    let (data, said) = warnings_of(&seen_now_and_then(10.0, 0.0));
    let kept: Vec<usize> = data.runs[0].log.as_ref().unwrap().reference.iter().map(|pose| pose.sample).collect();
    assert!(said.contains("poses were filled in on straight lines between measured ones, 10 poses apart"), "{said}");
    assert!(kept.len() >= 55 && kept[..kept.len() - 1].iter().all(|sample| sample % 10 == 0), "{kept:?}");
    // Measured between the rows: the row beside it stays.
    let (data, said) = warnings_of(&seen_now_and_then(8.0, 2.6));
    let kept: Vec<usize> = data.runs[0].log.as_ref().unwrap().reference.iter().map(|pose| pose.sample).collect();
    assert!(said.contains("between measured ones, 8 poses apart"), "{said}");
    let inner = &kept[1..kept.len() - 1];
    assert!(kept.len() >= 60 && inner.iter().all(|sample| [2, 3].contains(&(sample % 8))), "{kept:?}");
    // Every pose measured: nothing is filled in.
    let (data, said) = warnings_of(&seen_now_and_then(1.0, 0.0));
    assert!(!said.contains("filled in"), "{said}");
    assert_eq!(data.runs[0].log.as_ref().unwrap().reference.len(), 600);
}

#[test]
fn a_track_beside_the_log_is_set_by_the_motion_in_every_format() {
    // Legs of 1 m and quarter turns, with rests, at 50 Hz; b = 0.5 m, 0.2 pi mm a tick.
    let (mut time, mut x, mut y, mut heading) = (vec![], vec![], vec![], vec![]);
    let (mut left, mut right, mut counted) = (0.0, 0.0, String::from("t_s,ticks_left,ticks_right\n"));
    let (mut px, mut py, mut ph) = (1.0, 2.0, 0.0_f64);
    let per_tick = PI * 0.2 / 1000.0;
    for i in 0..2600 {
        let phase = i % 300;
        let (v, w): (f64, f64) = match phase {
            20..170 => (1.0 / 3.0, 0.0),
            200..280 => (0.0, FRAC_PI_2 / 1.6),
            _ => (0.0, 0.0),
        };
        let (v, w) = if (100..2500).contains(&i) { (v, w) } else { (0.0, 0.0) };
        counted += &format!("{},{},{}\n", 0.02 * f64::from(i), left / per_tick, right / per_tick);
        time.push(7.5 + 1.01 * 0.02 * f64::from(i));
        x.push(px);
        y.push(py);
        heading.push(ph);
        (left, right) = (left + 0.02 * (v - 0.25 * w), right + 0.02 * (v + 0.25 * w));
        (px, py, ph) = (px + 0.02 * v * ph.cos(), py + 0.02 * v * ph.sin(), ph + 0.02 * w);
    }
    let rows = |row: &dyn Fn(usize) -> String| (0..time.len()).map(row).collect::<String>();
    let columns = "t_s,x_ref_m,y_ref_m,theta_ref_rad\n".to_owned()
        + &rows(&|i| format!("{},{},{},{}\n", time[i], x[i], y[i], heading[i]));
    let tum = rows(&|i| {
        format!("{} {} {} 0 0 0 {} {}\n", time[i], x[i], y[i], (0.5 * heading[i]).sin(), (0.5 * heading[i]).cos())
    });
    // Motive: y up, z for x and x for y, in millimetres and degrees.
    let motive = "Format Version,1.23,Rotation Type,YXZ,Length Units,Millimeters\n\n\
                  ,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,Name,r,r,r,r,r,r\n\
                  ,,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),Y,X,Z,X,Y,Z\n"
        .to_owned()
        + &rows(&|i| {
            let turned = heading[i].sin().atan2(heading[i].cos()).to_degrees();
            format!("{i},{},{turned},0,0,{},95,{}\n", time[i], 1e3 * y[i], 1e3 * x[i])
        });
    let tabbed = tum.replace(' ', "\t");
    let tracks = [("ccw_01.csv", &columns), ("ccw_01.tum", &tum), ("ccw_01.tsv", &tabbed), ("ccw_01.csv", &motive)];
    for (name, track) in tracks {
        let files =
            [("robot.toml", ROBOT), ("runs/ccw_01.csv", &*counted), (&*format!("reference/{name}"), track.as_str())];
        for path in ["", "runs/ccw_01.csv"] {
            let data = load(&files, path).unwrap();
            let alignment = &data.clocks[0].alignment;
            assert!((alignment.offset.value - 7.5).abs() < 2e-3, "{name}: {alignment:?}");
            assert!((alignment.rate.value - 1.01).abs() < 1e-4, "{name}: {alignment:?}");
            let error = data.runs[0].returned.unwrap();
            assert!(error.x.hypot(error.y) < 2e-3 && error.heading.unwrap().abs() < 1e-3, "{name}: {error:?}");
        }
    }
}

#[test]
fn what_a_folder_holds_and_was_not_read_is_said() {
    let sheet = "direction,run,ex_m,ey_m\ncw,1,0,0\n";
    let ticks = "t_s,ticks_left,ticks_right\n0,0,0\n1,9,9\n";
    let files = [
        ("robot.toml", ROBOT),
        ("notes.txt", "Monday"),
        ("returns.csv.gz", sheet),
        ("returns.xlsx", ""),
        ("runs/cw_01.csv", ticks),
        ("runs/cw_02.mat", ""),
        ("runs/cw_03.mat", "MATLAB 5.0 MAT-file"),
        ("reference/cw_01.tak", ""),
        ("reference/cw_07.tum", ""),
    ];
    let data = load(&files, "").unwrap();
    assert!(data.runs[0].returned.is_some());
    let [matlab] = data.warnings.iter().filter(|said| said.contains("MATLAB")).collect::<Vec<_>>()[..] else {
        panic!()
    };
    assert!(
        matlab.contains("cw_03.mat: is no log")
            && matlab.contains("not read: it is a file of MATLAB; ")
            && matlab.contains("writetable")
    );
    let said = data.warnings.iter().map(|said| said.split_once(") and was not read").unwrap().0);
    let said: Vec<&str> = said.map(|said| said.rsplit('/').next().unwrap().split(" (").next().unwrap()).collect();
    assert_eq!(
        said,
        [
            "cw_01.tak: is no track",
            "cw_02.mat: is no log",
            "cw_03.mat: is no log",
            "cw_07.tum: belongs to no log of its name",
            "returns.xlsx: is no return sheet",
        ]
    );
}
