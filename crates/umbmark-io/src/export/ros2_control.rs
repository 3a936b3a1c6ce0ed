//! Parameters of a controller of ros2_control.

use super::covariance::{diagonal, of_pose, of_twist, sentences};
use super::text::{list, number};
use super::{Comment, Export, ExportError, Target, Written};
use umbmark_core::drive::Drive;

/// Parameters to be loaded with the controller: some are read-only later.
///
/// `diff_drive_controller` multiplies: left_wheel_radius_multiplier 2 E_s/(1 + E_d), right 2 E_s E_d/(1 + E_d),
/// wheel_separation_multiplier E_b, where the nominal wheels are the same; else each wheel's ratio to the mean. The steering
/// controllers have no multipliers: they get the corrected lengths.
pub static TARGET: Target = Target {
    name: "ros2_control",
    about: "YAML for diff_drive_controller, ackermann_steering_controller, tricycle_steering_controller or tricycle_controller, with \
            covariances",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let kind = export.robot().drive.kind();
    let mut notes = export.uncorrected();
    let (usual, values) = if kind.has_axle_wheels() {
        ("diff_drive_controller", of_two_wheels(export)?)
    } else if kind.drives_front_wheel() {
        ("tricycle_controller", of_front_wheel(export, &mut notes)?)
    } else if kind.steers() {
        ("ackermann_steering_controller", of_steering(export, &mut notes)?)
    } else {
        return Err(export.no_drive(TARGET.name));
    };
    let controller = export.controller.as_deref().unwrap_or(usual);
    // It is a key of YAML.
    if controller.is_empty() || !controller.chars().all(|c| c.is_ascii_alphanumeric() || "_/.-".contains(c)) {
        let what = "the name of a controller has letters, digits, _, /, . and - only; give it as ROS 2 lists it";
        return Err(ExportError::Missing { target: TARGET.name, what });
    }
    let mut lines: Vec<String> = values.iter().map(|(key, value)| format!("{key}: {}", number(*value))).collect();
    if let Some(noise) = export.noise_or(&mut notes) {
        let [twist, pose] = sentences(&export.usual);
        let of = |variances| list(&diagonal(variances));
        lines.push(format!("# {pose}"));
        lines.push(format!("pose_covariance_diagonal: {}", of(of_pose(&noise))));
        lines.push(format!("# {twist}"));
        lines.push(format!("twist_covariance_diagonal: {}", of(of_twist(&noise, &export.usual))));
    }
    let body: String = lines.iter().map(|line| format!("    {line}\n")).collect();
    let head = Comment::Hash.line(&export.heading()) + &Comment::Hash.lines(&notes);
    Ok(Written { text: format!("{head}{controller}:\n  ros__parameters:\n{body}"), notes })
}

fn of_two_wheels(export: &Export) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let (nominal, corrected) = (export.robot().drive, export.corrected()?.drive);
    let radius = 0.25 * (nominal.wheel_diameter_left() + nominal.wheel_diameter_right());
    Ok(vec![
        ("wheel_separation", nominal.wheelbase()),
        ("wheel_radius", radius),
        ("wheel_separation_multiplier", corrected.wheelbase() / nominal.wheelbase()),
        ("left_wheel_radius_multiplier", 0.5 * corrected.wheel_diameter_left() / radius),
        ("right_wheel_radius_multiplier", 0.5 * corrected.wheel_diameter_right() / radius),
    ])
}

/// Of a tricycle whose front wheel is driven.
fn of_front_wheel(export: &Export, notes: &mut Vec<String>) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let corrected = export.corrected()?.drive;
    of_the_driver(&export.robot().drive, &corrected, notes);
    Ok(vec![("wheelbase", corrected.axle_distance()), ("wheel_radius", 0.5 * corrected.wheel_diameter_left())])
}

/// Notes on numbers of the steering, which no controller has.
fn of_the_driver(nominal: &Drive, corrected: &Drive, notes: &mut Vec<String>) {
    for key in ["steering_zero_rad", "steering_ticks_per_revolution"] {
        let [before, after] = [nominal, corrected].map(|drive| drive.number(key));
        if let Some(after) = after.filter(|_| before != after) {
            let value = number(after);
            notes.push(format!("not in this file: {key} = {value}, which the driver of the steering has to know"));
        }
    }
}

fn of_steering(export: &Export, notes: &mut Vec<String>) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let (nominal, corrected) = (export.robot().drive, export.corrected()?.drive);
    of_the_driver(&nominal, &corrected, notes);
    Ok(vec![
        ("wheelbase", corrected.axle_distance()),
        ("traction_track_width", corrected.wheelbase()),
        ("traction_wheels_radius", 0.5 * corrected.wheel_diameter_left()),
    ])
}
