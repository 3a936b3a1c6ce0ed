//! Parameters of a controller of ros2_control.

use super::covariance::{diagonal, of_pose, of_twist, sentences};
use super::text::{list, number};
use super::{Comment, Export, ExportError, Target, Written};
use umbmark_core::drive::{Drive, Rollers};

/// Parameters to be loaded with the controller: some are read-only later.
///
/// `diff_drive_controller` multiplies: left_wheel_radius_multiplier 2 E_s/(1 + E_d), right 2 E_s E_d/(1 + E_d),
/// wheel_separation_multiplier E_b, where the nominal wheels are the same; else each wheel's ratio to the mean. The steering
/// controllers have no multipliers: they get the corrected lengths, and so do those of bases on rollers, which have one radius for all
/// wheels.
pub static TARGET: Target = Target {
    name: "ros2_control",
    about: "YAML for diff_drive_controller, ackermann_steering_controller, tricycle_steering_controller, tricycle_controller, \
            mecanum_drive_controller or omni_wheel_drive_controller, with covariances",
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
    } else if let Some(rollers) = export.corrected()?.drive.rollers().filter(|_| kind.is_driven()) {
        one_radius(&rollers, &mut notes);
        if rollers.wheels().iter().all(|wheel| wheel.roller == 0.0) {
            ("omni_wheel_drive_controller", of_omni_wheels(export, &rollers, &mut notes)?)
        } else {
            ("mecanum_drive_controller", of_mecanum(export)?)
        }
    } else {
        return Err(export.no_drive(TARGET.name));
    };
    let controller = export.controller.as_deref().unwrap_or(usual);
    // It is a key of YAML.
    if controller.is_empty() || !controller.chars().all(|c| c.is_ascii_alphanumeric() || "_/.-".contains(c)) {
        let what = "the name of a controller has letters, digits, _, /, . and - only; give it as ROS 2 lists it";
        return Err(ExportError::Missing { target: TARGET.name, what });
    }
    let mut lines = nested(&values, number);
    if let Some(noise) = export.noise_or(&mut notes) {
        let sentences = sentences(&export.usual);
        let of = |variances| list(&diagonal(variances));
        let keys = if usual == "omni_wheel_drive_controller" {
            ["diagonal_covariance.pose", "diagonal_covariance.twist"]
        } else {
            ["pose_covariance_diagonal", "twist_covariance_diagonal"]
        };
        let [pose, twist] = [of(of_pose(&noise)), of(of_twist(&noise, &export.usual))];
        lines.extend(sentences.iter().rev().map(|said| format!("# {said}")));
        lines.extend(nested(&[(keys[0], pose), (keys[1], twist)], |value: String| value));
    }
    let body: String = lines.iter().map(|line| format!("    {line}\n")).collect();
    let head = Comment::Hash.line(&export.heading()) + &Comment::Hash.lines(&notes);
    Ok(Written { text: format!("{head}{controller}:\n  ros__parameters:\n{body}"), notes })
}

/// Keys with dots as those of a map in a map; neighbours with the same beginning share it.
fn nested<T: Clone>(values: &[(&str, T)], written: impl Fn(T) -> String) -> Vec<String> {
    let mut lines = Vec::new();
    let mut inside = None;
    for (key, value) in values {
        let value = written(value.clone());
        match key.split_once('.') {
            Some((map, key)) => {
                if inside != Some(map) {
                    lines.push(format!("{map}:"));
                }
                lines.push(format!("  {key}: {value}"));
                inside = Some(map);
            }
            None => {
                lines.push(format!("{key}: {value}"));
                inside = None;
            }
        }
    }
    lines
}

/// Half of the sum of both distances of the wheels, and one radius.
fn of_mecanum(export: &Export) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let corrected = export.corrected()?.drive;
    Ok(vec![
        ("kinematics.wheels_radius", 0.5 * corrected.wheel_diameter_left()),
        ("kinematics.sum_of_robot_center_projection_on_X_Y_axis", 0.5 * corrected.wheelbase()),
    ])
}

/// Wheels anti-clockwise round the base from the first one.
fn of_omni_wheels(
    export: &Export,
    rollers: &Rollers,
    notes: &mut Vec<String>,
) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let corrected = export.corrected()?.drive;
    notes.push(
        "wheel_names are the joints in the order of the counters, anti-clockwise round the base, each counting up clockwise round it"
            .into(),
    );
    let [x, y] = rollers.wheels()[0].at;
    Ok(vec![
        ("wheel_offset", y.atan2(x)),
        ("robot_radius", x.hypot(y)),
        ("wheel_radius", 0.5 * corrected.wheel_diameter_left()),
    ])
}

/// A note on wheels of different sizes, for a controller that has one radius.
fn one_radius(rollers: &Rollers, notes: &mut Vec<String>) {
    let diameters: Vec<f64> = rollers.wheels().iter().map(|wheel| wheel.diameter).collect();
    if diameters.iter().any(|diameter| (diameter / diameters[0] - 1.0).abs() > 1e-9) {
        let sizes: Vec<String> = diameters.iter().map(|diameter| number(*diameter)).collect();
        let sizes = sizes.join(", ");
        notes.push(format!(
            "this controller has one radius for all wheels, their mean; the wheels' diameters in m are {sizes}, so scale the positions and speeds \
             that the driver of each wheel reports by its own size over the mean"
        ));
    }
}

fn of_two_wheels(export: &Export) -> Result<Vec<(&'static str, f64)>, ExportError> {
    let (nominal, corrected) = (export.robot().drive, export.corrected()?.drive);
    let radius = 0.25 * (nominal.wheel_diameter_left() + nominal.wheel_diameter_right());
    Ok(vec![
        ("wheel_separation", nominal.track_width()),
        ("wheel_radius", radius),
        ("wheel_separation_multiplier", corrected.wheelbase() / nominal.track_width()),
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
