//! What is found of the data before a calibration: faults, jumps, wrong poses, the mounting of the reference, robots far from nominal.

use super::*;
use crate::likelihood::watched::{watched, watched_on};
use crate::path::{SQUARE, SpeedProfile};
use crate::run::{Run, TickLog};

/// A LabMate with these effects.
fn robot_with(effects: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    let usual = [("wheel_diameter_ratio", "e_d", 1.003), ("wheelbase", "e_b", 0.99), ("wheel_noise", "k_sqrt_m", 3e-4)];
    for (effect, parameter, value) in usual.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

fn exact(data: &Dataset) -> (Calibration, Correction) {
    let calibration = calibrate(data, &Options::default()).unwrap();
    let correction = calibration.estimate(Method::Exact).unwrap().correction;
    (calibration, correction)
}

fn log(run: &mut Run) -> &mut TickLog {
    run.log.as_mut().unwrap()
}

#[test]
fn exchanged_wheels_are_refused_with_the_line_that_mends_them() {
    let mut data = watched(&robot_with(&[]), 3, 1);
    for run in &mut data.runs {
        let log = log(run);
        std::mem::swap(&mut log.left, &mut log.right);
    }
    let error = calibrate(&data, &Options::default()).unwrap_err();
    assert!(
        matches!(&error, CalibrateError::Fit(FitError::Faulty { faults }) if faults[0] == Fault::Exchanged),
        "{error}"
    );
    assert!(error.to_string().contains("wheels_exchanged = true"), "{error}");
}

/// Moves every pose from one on by a jump of 0.5 m and 28 deg.
#[test]
fn a_run_is_used_up_to_its_jump_and_wrong_poses_are_left_out() {
    let mut data = watched(&robot_with(&[]), 3, 2);
    for run in &mut data.runs[..2] {
        let poses = &mut log(run).reference;
        let (middle, turn) = (poses.len() / 2, 28f64.to_radians());
        for pose in &mut poses[middle..] {
            (pose.x, pose.y) = (pose.x + 0.3, pose.y + 0.4);
            pose.heading = pose.heading.map(|heading| heading + turn);
        }
    }
    log(&mut data.runs[4]).reference[100].x += 1.0;
    let (calibration, correction) = exact(&data);
    assert!((correction.e_d - 1.003).abs() < 1e-3 && (correction.e_b - 0.99).abs() < 2e-3, "{correction:?}");
    let told = |words: &str| calibration.warnings.iter().filter(|warning| warning.contains(words)).count();
    assert_eq!([told("jumps by 0.5"), told("is used up to"), told("poses of run ccw_1 is wrong")], [2, 2, 1]);
    assert!(calibration.doubts.is_empty(), "{:?}", calibration.doubts);
    assert_eq!(calibration.setup.disturbances(), [2, 1]);
}

/// 90 ms late, turned by 3 deg, 60 mm ahead: what the motion alone says is taken, and E_d and E_b are those of the robot.
#[test]
fn delay_yaw_and_place_of_the_reference_are_taken_from_the_motion() {
    let off =
        [("reference_delay", "delay_s", 0.09), ("marker_yaw", "yaw_rad", 0.05), ("marker_offset", "forward_m", 0.06)];
    let data = watched(&robot_with(&off), 3, 3);
    let (calibration, correction) = exact(&data);
    let taken = |effect: &str| {
        let own = calibration.taken.iter().find(|own| own.effect == effect);
        own.and_then(|own| own.values[0]).map_or(0.0, |(_, measured)| measured.value)
    };
    assert!((taken("reference_delay") - 0.09).abs() < 0.01, "{:?}", calibration.taken);
    assert!((taken("marker_yaw") - 0.05).abs() < 0.01 && (taken("marker_offset") - 0.06).abs() < 0.01);
    assert!((correction.e_d - 1.003).abs() < 1e-3 && (correction.e_b - 0.99).abs() < 3e-3, "{correction:?}");
}

/// A robot whose wheels really are twice as far apart as robot.toml says, from tracks and from return poses.
#[test]
fn a_wheelbase_that_is_off_by_two_is_found() {
    let square = Path::new(&SQUARE, &[2.0], SpeedProfile::default()).unwrap();
    for e_b in [0.5, 2.007] {
        let tracked = watched_on(&square, &robot_with(&[("wheelbase", "e_b", e_b)]), 3, 4);
        let found = exact(&tracked).1;
        assert!((found.e_b / e_b - 1.0).abs() < 5e-3, "{e_b}: {found:?}");
        let first = crate::diagnose::first_model(&tracked).unwrap();
        let fitted = crate::evidence::fit(&tracked, &first).unwrap().model;
        assert!((fitted.get("wheelbase", "e_b").unwrap() / e_b - 1.0).abs() < 5e-3, "{e_b}");
    }
    // At 0.5 a square is a line there and back, and its ends are those of another robot too.
    for e_b in [0.62, 2.007] {
        let truth = Correction { e_d: 1.003, e_b, e_s: 1.0 };
        let (calibration, found) = exact(&noise_free(&truth));
        assert!((found.e_b / e_b - 1.0).abs() < 1e-6 && (found.e_d - 1.003).abs() < 1e-6, "{e_b}: {found:?}");
        assert!(calibration.doubts.is_empty(), "{:?}", calibration.doubts);
        let mut model = crate::diagnose::base_model(&Robot::labmate()).unwrap();
        model = crate::evidence::fit(&noise_free(&truth), &model).unwrap().model;
        assert!((model.get("wheelbase", "e_b").unwrap() / e_b - 1.0).abs() < 1e-6, "{e_b}");
    }
}

#[test]
fn a_typing_error_is_told_first_and_puts_the_lengths_in_doubt() {
    let mut errors = scattered();
    errors.extend(scattered().into_iter().map(|(direction, e)| (direction, moved(&e, (1e-3, -2e-3, 5e-4)))));
    assert!(calibrated(&errors).doubts.is_empty());
    errors[1].1.y += 2.2;
    let calibration = calibrated(&errors);
    assert!(
        calibration.warnings[0].starts_with("The return error of run run 1 lies 2.2"),
        "{:?}",
        calibration.warnings
    );
    assert_eq!(calibration.doubts.len(), 1, "{:?}", calibration.doubts);
}

#[test]
fn returns_in_millimetres_are_refused_with_the_names_of_the_columns() {
    let all = scattered().into_iter().map(|(d, e)| (d, ReturnError { x: 1e3 * e.x, y: 1e3 * e.y, ..e }));
    let data = dataset(&Robot::labmate(), &Path::umbmark(), &all.collect::<Vec<_>>());
    let error = calibrate(&data, &Options::default()).unwrap_err().to_string();
    assert!(error.starts_with("the robot cannot be judged yet") && error.contains("ex_mm"), "{error}");
}
