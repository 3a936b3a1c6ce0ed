//! Plugins of a simulated robot in Gazebo.

use super::covariance::of_twist;
use super::text::number;
use super::{Comment, Export, ExportError, Target, Written};

/// The plugin that drives the robot and reckons its odometry, with the corrected numbers, and the noise that is added to speeds.
pub static TARGET: Target = Target {
    name: "gazebo",
    about: "plugins DiffDrive or AckermannSteering of Gazebo for a <model> of SDF, and OdometryPublisher with the noise",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let corrected = export.corrected()?;
    let (drive, kind) = (&corrected.drive, corrected.drive.kind());
    let mut notes = export.uncorrected();
    let [left, right] = [drive.wheel_diameter_left(), drive.wheel_diameter_right()].map(|diameter| 0.5 * diameter);
    let mut elements = vec![("wheel_separation", drive.wheelbase()), ("wheel_radius", 0.5 * (left + right))];
    let (file, name, joints) = if kind.has_axle_wheels() {
        ("gz-sim-diff-drive-system", "DiffDrive", "left_joint and right_joint")
    } else if kind.steers() && !kind.drives_front_wheel() {
        elements.push(("wheel_base", drive.axle_distance()));
        let joints =
            "left_joint, right_joint, left_steering_joint, right_steering_joint, kingpin_width and steering_limit";
        ("gz-sim-ackermann-steering-system", "AckermannSteering", joints)
    } else {
        return Err(export.no_drive(TARGET.name));
    };
    if left != right {
        let [left, right] = [left, right].map(number);
        notes.push(format!(
            "{name} has one wheel_radius: give the wheels of the model their own, {left} left and {right} right"
        ));
    }
    notes.push(format!("add {joints} of your model"));
    let rate = export.usual.rate;
    let frequency = format!("      <odom_publish_frequency>{}</odom_publish_frequency>\n", number(rate));
    let mut publisher = String::new();
    if let Some(noise) = export.noise_or(&mut notes) {
        let [ahead, _, turn] = of_twist(&noise, &export.usual).map(f64::sqrt);
        notes.push(format!(
            "OdometryPublisher has one gaussian_noise for m/s and rad/s: that of the turn rate is written, that of the speed is {}",
            number(ahead)
        ));
        publisher = format!(
            "    <plugin filename=\"gz-sim-odometry-publisher-system\" name=\"gz::sim::systems::OdometryPublisher\">\n{frequency}      \
             <gaussian_noise>{}</gaussian_noise>\n    </plugin>\n",
            number(turn)
        );
    }
    let head = Comment::Xml.line(&export.heading()) + &Comment::Xml.lines(&notes);
    let elements: String =
        elements.iter().map(|(key, value)| format!("      <{key}>{}</{key}>\n", number(*value))).collect();
    let text = format!(
        "{head}<sdf version=\"1.9\">\n  <model name=\"robot\">\n    <plugin filename=\"{file}\" name=\"gz::sim::systems::{name}\">\n\
         {elements}{frequency}    </plugin>\n{publisher}  </model>\n</sdf>\n"
    );
    Ok(Written { text, notes })
}
