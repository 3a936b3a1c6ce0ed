//! Corrections as text for robots.

use super::RobotFile;
use umbmark_core::VERSION;
use umbmark_core::calibrate::Correction;
use umbmark_core::drive::{DifferentialDrive, DriveError, Robot};

/// A float that every reader takes for a float: always with a decimal point.
fn decimal(value: f64) -> String {
    let text = format!("{value:.9}");
    let text = text.trim_end_matches('0');
    if text.ends_with('.') { format!("{text}0") } else { text.to_owned() }
}

/// Parameters of `diff_drive_controller` of ros2_control, to be loaded with the controller: they are read-only later.
///
/// The controller multiplies: left_wheel_radius_multiplier 2 E_s/(1 + E_d), right 2 E_s E_d/(1 + E_d),
/// wheel_separation_multiplier E_b, where the nominal wheels are the same; else each wheel's ratio to the mean.
///
/// ```
/// use umbmark_core::{calibrate::Correction, drive::Robot};
/// use umbmark_io::export;
/// let correction = Correction { e_d: 1.0, e_b: 0.99, e_s: 1.0 };
/// let yaml = export::ros2_control(&Robot::labmate(), &correction, "diff_drive_controller");
/// assert!(yaml.contains("    wheel_separation_multiplier: 0.99\n    left_wheel_radius_multiplier: 1.0\n"));
/// ```
pub fn ros2_control(robot: &Robot, correction: &Correction, controller: &str) -> String {
    let drive = &robot.drive;
    let radius = 0.25 * (drive.wheel_diameter_left() + drive.wheel_diameter_right());
    let (left, right) = correction.wheel_factors();
    let lines = [
        ("wheel_separation", drive.wheelbase()),
        ("wheel_radius", radius),
        ("wheel_separation_multiplier", correction.e_b),
        ("left_wheel_radius_multiplier", left * 0.5 * drive.wheel_diameter_left() / radius),
        ("right_wheel_radius_multiplier", right * 0.5 * drive.wheel_diameter_right() / radius),
    ];
    let mut text = format!("# {}\n{controller}:\n  ros__parameters:\n", heading(correction));
    for (key, value) in lines {
        text += &format!("    {key}: {}\n", decimal(value));
    }
    text
}

/// A `robot.toml` whose lengths are corrected, to the nanometre.
pub fn robot_toml(file: &RobotFile, correction: &Correction) -> Result<String, DriveError> {
    let corrected = correction.apply(&file.robot)?;
    let lengths =
        [corrected.drive.wheelbase(), corrected.drive.wheel_diameter_left(), corrected.drive.wheel_diameter_right()];
    let [wheelbase, left, right] = lengths.map(|length| (length * 1e9).round() / 1e9);
    let robot = Robot { drive: DifferentialDrive::new(wheelbase, left, right)?.into(), ..corrected };
    Ok(format!("# {}\n{}", heading(correction), RobotFile { robot, ..file.clone() }.text()))
}

/// A C header with the corrected lengths and the ratios.
pub fn c_header(robot: &Robot, correction: &Correction) -> Result<String, DriveError> {
    let corrected = correction.apply(robot)?;
    let per_tick = corrected.metres_per_tick();
    let mut text = format!(
        "/* {} */\n#ifndef UMBMARK_ODOMETRY_H\n#define UMBMARK_ODOMETRY_H\n\n",
        heading(correction).replace("*/", "* /")
    );
    for (name, value, meaning) in [
        ("WHEELBASE_M", corrected.drive.wheelbase(), "distance between the wheels' contact points"),
        ("WHEEL_DIAMETER_LEFT_M", corrected.drive.wheel_diameter_left(), "left wheel"),
        ("WHEEL_DIAMETER_RIGHT_M", corrected.drive.wheel_diameter_right(), "right wheel"),
    ] {
        text += &format!("#define UMBMARK_{name} {} /* {meaning} */\n", decimal(value));
    }
    for (side, value) in [("LEFT", per_tick.left), ("RIGHT", per_tick.right)] {
        text += &format!("#define UMBMARK_METRES_PER_TICK_{side} {value:.12e}\n");
    }
    Ok(text + "\n#endif\n")
}

fn heading(correction: &Correction) -> String {
    let [e_d, e_b, e_s] = correction.values().map(decimal);
    format!("umbmark {VERSION} calibrate: E_d {e_d}, E_b {e_b}, E_s {e_s}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::drive::Encoder;
    use umbmark_core::path::{CIRCLE, Path, SQUARE, SpeedProfile, WAYPOINTS};

    const CORRECTION: Correction = Correction { e_d: 1.00121, e_b: 337.2 / 340.0, e_s: 1.0 };

    #[test]
    fn the_robot_file_reads_back_as_the_corrected_robot_with_its_path() {
        let robot = Robot {
            name: "a \"quoted\" \\ robot".into(),
            drive: DifferentialDrive::new(0.34, 0.151, 0.149).unwrap().into(),
            encoder: Encoder::new(2796.8, Some(50.0), Some(16)).unwrap(),
        };
        let speed = SpeedProfile::new(0.3, 0.4, 0.0).unwrap();
        for path in [
            Path::new(&SQUARE, &[4.0], speed).unwrap(),
            Path::new(&CIRCLE, &[1.0, 2.0], speed).unwrap(),
            Path::new(&WAYPOINTS, &[1.0, 0.0, 1.0, 2.5], speed).unwrap(),
        ] {
            let text = robot_toml(&RobotFile::new(robot.clone(), Some(path.clone())), &CORRECTION).unwrap();
            let RobotFile { robot: read, path: read_path, .. } = RobotFile::parse("exported", &text).unwrap();
            let expected = CORRECTION.apply(&robot).unwrap();
            assert_eq!((&read.name, read.encoder), (&expected.name, expected.encoder));
            assert!((read.drive.wheelbase() - expected.drive.wheelbase()).abs() < 1e-9);
            assert!((read.drive.wheel_diameter_left() - expected.drive.wheel_diameter_left()).abs() < 1e-9);
            assert!((read.drive.wheel_diameter_right() - expected.drive.wheel_diameter_right()).abs() < 1e-9);
            let read_path = read_path.unwrap();
            assert_eq!((read_path.shape().name, read_path.values()), (path.shape().name, path.values()));
            assert_eq!(read_path.speed.values(), [0.3, 0.4, 0.0]);
        }
    }

    /// Oracle: the multipliers of dependencies.md 2.8, 2/(E_d + 1), 2/(1/E_d + 1), E_b.
    #[test]
    fn the_ros2_file_multiplies_and_every_number_in_it_has_a_decimal_point() {
        let yaml = ros2_control(&Robot::labmate(), &CORRECTION, "base");
        let value = |key: &str| -> f64 {
            let line = yaml.lines().find(|l| l.trim().starts_with(&format!("{key}:"))).unwrap();
            let number = line.split(": ").nth(1).unwrap();
            assert!(number.contains('.') && !number.contains('e'), "{line}");
            number.parse().unwrap()
        };
        assert!(yaml.contains("\nbase:\n  ros__parameters:\n    wheel_separation: 0.34\n    wheel_radius: 0.075\n"));
        assert!((value("left_wheel_radius_multiplier") - 2.0 / 2.00121).abs() < 1e-9);
        assert!((value("right_wheel_radius_multiplier") - 2.0 / (1.0 / 1.00121 + 1.0)).abs() < 1e-9);
        assert!((value("wheel_separation_multiplier") - 337.2 / 340.0).abs() < 1e-9);
        let unequal = Robot { drive: DifferentialDrive::new(1.0, 0.2, 0.1).unwrap().into(), ..Robot::labmate() };
        let yaml = ros2_control(&unequal, &Correction::NONE, "base");
        assert!(
            yaml.contains("left_wheel_radius_multiplier: 1.333333333\n") && yaml.contains("wheel_separation: 1.0\n")
        );
    }

    #[test]
    fn the_c_header_is_guarded_and_holds_the_corrected_lengths() {
        let text = c_header(&Robot::labmate(), &CORRECTION).unwrap();
        assert!(text.contains("#ifndef UMBMARK_ODOMETRY_H\n#define UMBMARK_ODOMETRY_H\n"));
        assert!(text.contains("#define UMBMARK_WHEELBASE_M 0.3372 /*"), "{text}");
        assert_eq!(text.matches("/*").count(), text.matches("*/").count());
        assert!(text.ends_with("#endif\n"));
    }

    #[test]
    fn every_file_says_first_what_wrote_it_and_which_ratios_are_in_it() {
        let robot = Robot::labmate();
        let line = format!("umbmark {VERSION} calibrate: E_d 1.00121, E_b 0.991764706, E_s 1.0");
        assert!(ros2_control(&robot, &CORRECTION, "base").starts_with(&format!("# {line}\n")));
        assert!(
            robot_toml(&RobotFile::new(robot.clone(), None), &CORRECTION).unwrap().starts_with(&format!("# {line}\n"))
        );
        assert!(c_header(&robot, &CORRECTION).unwrap().starts_with(&format!("/* {line} */\n")));
    }

    #[test]
    fn whole_numbers_keep_a_decimal_point_and_fractions_their_digits() {
        assert_eq!([1.0, 0.25, 1e-9, 2796.8, -3.0].map(decimal), ["1.0", "0.25", "0.000000001", "2796.8", "-3.0"]);
    }
}
