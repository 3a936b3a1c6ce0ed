use super::*;
use umbmark_core::drive::{DifferentialDrive, DriveKind, Encoder, SkidSteerDrive};
use umbmark_core::path::{CIRCLE, Path, SQUARE, SpeedProfile, WAYPOINTS};

const RATIOS: [(&str, &str, f64); 2] = [("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 337.2 / 340.0)];

fn model_of(robot: &Robot, values: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(robot);
    for (effect, parameter, value) in values {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

fn written(name: &str, export: &Export) -> Written {
    Target::named(name).unwrap().write(export).unwrap()
}

/// The number of a key, wherever its line stands.
pub fn value(text: &str, key: &str, between: &str) -> f64 {
    let line = text.lines().find(|line| line.trim().starts_with(&format!("{key}{between}"))).unwrap();
    line.trim()[key.len() + between.len()..].split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn the_robot_file_reads_back_as_the_corrected_robot_with_its_path() {
    let robot = Robot {
        name: "a \"quoted\" \\ robot".into(),
        drive: DifferentialDrive::new(0.34, 0.151, 0.149).unwrap().into(),
        encoder: Encoder::new(2796.8, Some(50.0), Some(16)).unwrap(),
    };
    let model = model_of(&robot, &RATIOS);
    let speed = SpeedProfile::new(0.3, 0.4, 0.0).unwrap();
    for path in [
        Path::new(&SQUARE, &[4.0], speed).unwrap(),
        Path::new(&CIRCLE, &[1.0, 2.0], speed).unwrap(),
        Path::new(&WAYPOINTS, &[1.0, 0.0, 1.0, 2.5], speed).unwrap(),
    ] {
        let beside = Some(RobotFile::new(robot.clone(), Some(path.clone())));
        let text = written("toml", &Export { beside, ..Export::of(&model) }).text;
        let RobotFile { robot: read, path: read_path, .. } = RobotFile::parse("exported", &text).unwrap();
        assert_eq!((&read.name, read.encoder), (&robot.name, robot.encoder));
        assert!((read.drive.wheelbase() - 0.3372).abs() < 1e-9);
        assert!((read.drive.wheel_diameter_left() - 0.151 * 2.0 / 2.00121).abs() < 1e-9);
        assert!((read.drive.wheel_diameter_right() - 0.149 * 2.0 * 1.00121 / 2.00121).abs() < 1e-9);
        let read_path = read_path.unwrap();
        assert_eq!((read_path.shape().name, read_path.values()), (path.shape().name, path.values()));
        assert_eq!(read_path.speed.values(), [0.3, 0.4, 0.0]);
    }
}

/// Oracle: the multipliers of the documentation, 2/(E_d + 1), 2/(1/E_d + 1), E_b.
#[test]
fn the_ros2_file_multiplies_and_every_number_in_it_has_a_decimal_point() {
    let model = model_of(&Robot::labmate(), &RATIOS);
    let yaml = written("ros2_control", &Export { controller: Some("base".into()), ..Export::of(&model) }).text;
    assert!(yaml.contains("\nbase:\n  ros__parameters:\n    wheel_separation: 0.34\n    wheel_radius: 0.075\n"));
    assert!((value(&yaml, "left_wheel_radius_multiplier", ": ") - 2.0 / 2.00121).abs() < 1e-9);
    assert!((value(&yaml, "right_wheel_radius_multiplier", ": ") - 2.0 / (1.0 / 1.00121 + 1.0)).abs() < 1e-9);
    assert!((value(&yaml, "wheel_separation_multiplier", ": ") - 337.2 / 340.0).abs() < 1e-9);
    let unequal = Robot { drive: DifferentialDrive::new(1.0, 0.2, 0.1).unwrap().into(), ..Robot::labmate() };
    let yaml = written("ros2_control", &Export::of(&Model::new(&unequal))).text;
    assert!(yaml.contains("diff_drive_controller:\n"));
    assert!(yaml.contains("left_wheel_radius_multiplier: 1.333333333\n") && yaml.contains("wheel_separation: 1.0\n"));
}

/// The driver of a skid-steer base multiplies what a tape measures.
#[test]
fn the_multiplier_of_a_skid_steer_base_is_corrected_and_its_sides_stay_where_they_are() {
    let drive = SkidSteerDrive::new(0.4, 1.8, 0.2, 0.2).unwrap().into();
    let yaml = written("ros2_control", &Export::of(&model_of(&Robot { drive, ..Robot::labmate() }, &RATIOS))).text;
    assert!(yaml.contains("diff_drive_controller:\n") && yaml.contains("    wheel_separation: 0.4\n"), "{yaml}");
    assert!((value(&yaml, "wheel_separation_multiplier", ": ") - 1.8 * 337.2 / 340.0).abs() < 1e-9);
}

#[test]
fn a_car_gets_its_lengths_and_its_steering_is_named_as_left_over() {
    let car = Robot { drive: DriveKind::Ackermann.usual(), ..Robot::labmate() };
    let first = car.drive.first_effects();
    let model =
        model_of(&car, &[(first[0], "angle_rad", 0.004), (first[2], "e_s", 1.01), ("axle_distance", "ratio", 0.98)]);
    let Written { text, notes } = written("ros2_control", &Export::of(&model));
    assert!(text.contains("ackermann_steering_controller:\n"));
    assert!((value(&text, "wheelbase", ": ") - 0.49).abs() < 1e-9);
    assert!((value(&text, "traction_wheels_radius", ": ") - 0.075 * 1.01).abs() < 1e-9);
    assert!(notes.iter().any(|note| note.contains("steering_zero_rad = 0.004")), "{notes:?}");
    assert!(notes.iter().all(|note| !note.contains("axle_distance") && text.contains(note)), "{notes:?}");
}

#[test]
fn a_tricycle_that_drives_its_front_wheel_has_a_controller_of_its_own_and_each_length_is_corrected_once() {
    let robot = Robot { drive: DriveKind::Tricycle.usual(), ..Robot::labmate() };
    let model = model_of(
        &robot,
        &[("front_wheel_zero", "angle_rad", 0.004), ("axle_distance", "ratio", 0.98), ("scale", "e_s", 1.01)],
    );
    let Written { text, notes } = written("ros2_control", &Export::of(&model));
    assert!(text.contains("tricycle_controller:\n"), "{text}");
    assert!((value(&text, "wheelbase", ": ") - 0.49).abs() < 1e-9, "{text}");
    assert!((value(&text, "wheel_radius", ": ") - 0.075 * 1.01).abs() < 1e-9);
    assert!(notes.iter().any(|note| note.contains("steering_zero_rad = 0.004")), "{notes:?}");
    for target in ["gazebo", "urdf", "mujoco"] {
        let refused = Target::named(target).unwrap().write(&Export::of(&model));
        assert!(matches!(refused, Err(ExportError::Drive { .. })), "{target}");
    }
}

/// Oracle: the equations of the controllers' odometry (ros2_controllers), beside those of the drive.
#[test]
fn bases_on_rollers_get_the_numbers_by_which_their_controllers_reckon_the_same_motion() {
    let ways = [0.1, -0.2, 0.3, 0.05];
    let noise = Noise { heading_per_metre: 0.004, ..Noise::default() };
    let mecanum = Robot { drive: DriveKind::Mecanum.usual(), ..Robot::labmate() };
    let model = model_of(&mecanum, &[("wheelbase", "e_b", 1.02), ("roller_scale", "e_s", 0.99)]);
    let Written { text, notes } = written("ros2_control", &Export { noise: Some(noise), ..Export::of(&model) });
    assert!(
        text.contains("mecanum_drive_controller:\n  ros__parameters:\n    kinematics:\n      wheels_radius: "),
        "{text}"
    );
    let (radius, arm) =
        (value(&text, "wheels_radius", ": "), value(&text, "sum_of_robot_center_projection_on_X_Y_axis", ": "));
    let motion = mecanum.drive.with("wheel_distance_length_m", 0.3 * 1.02).unwrap();
    let motion = motion.with("wheel_distance_width_m", 0.3 * 1.02).unwrap().rollers().unwrap().motion(&ways);
    let turned = (-ways[0] + ways[1] - ways[2] + ways[3]) / (4.0 * arm);
    assert!((turned - motion.rotation).abs() < 1e-9 && (radius - 0.075 * 0.99).abs() < 1e-9, "{text}");
    assert!(text.contains("    twist_covariance_diagonal: [") && notes.is_empty(), "{notes:?}");

    let omni = Robot { drive: DriveKind::Omni3.usual(), ..Robot::labmate() };
    let model = model_of(&omni, &[("front_diameter_ratio", "ratio", 1.01), ("wheelbase", "e_b", 1.02)]);
    let Written { text, notes } = written("ros2_control", &Export { noise: Some(noise), ..Export::of(&model) });
    assert!(
        text.contains("omni_wheel_drive_controller:\n") && text.contains("    diagonal_covariance:\n      pose: ["),
        "{text}"
    );
    let (offset, arm) = (value(&text, "wheel_offset", ": "), value(&text, "robot_radius", ": "));
    let motion = umbmark_core::geometry::Displacement2 { forward: 0.3, sideways: -0.2, rotation: 0.7 };
    let rollers = omni.drive.with("wheel_distance_m", 0.2 * 1.02).unwrap().rollers().unwrap();
    for (k, way) in rollers.ways_of(&motion).iter().enumerate() {
        let angle = offset + k as f64 * std::f64::consts::TAU / 3.0;
        let expected = motion.forward * angle.sin() - motion.sideways * angle.cos() - arm * motion.rotation;
        assert!((way - expected).abs() < 1e-9, "{way} {expected}");
    }
    assert!(notes.iter().any(|note| note.contains("one radius for all wheels")), "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("anti-clockwise round the base")), "{notes:?}");

    let four = Robot { drive: DriveKind::Omni4.usual().with("wheel_offset_rad", 0.3).unwrap(), ..Robot::labmate() };
    let model = model_of(&four, &[("omni_side_ratio", "ratio", 1.01), ("wheelbase", "e_b", 1.02)]);
    let Written { text, .. } = written("ros2_control", &Export { noise: Some(noise), ..Export::of(&model) });
    let (offset, arm) = (value(&text, "wheel_offset", ": "), value(&text, "robot_radius", ": "));
    let rollers = four.drive.with("wheel_distance_m", 0.2 * 1.02).unwrap().rollers().unwrap();
    for (k, way) in rollers.ways_of(&motion).iter().enumerate() {
        let angle = offset + k as f64 * std::f64::consts::FRAC_PI_2;
        let expected = motion.forward * angle.sin() - motion.sideways * angle.cos() - arm * motion.rotation;
        assert!((way - expected).abs() < 1e-9, "{way} {expected}");
    }
}

/// Oracle: sums over one second of a filter that integrates speeds with that variance, by hand.
#[test]
fn covariances_of_speeds_add_up_to_the_noise_of_the_motion() {
    let noise =
        Noise { heading_per_metre: 0.003, heading_per_radian: 0.02, forward_per_metre: 0.004, ..Noise::silent() };
    let usual = Usual { speed: 0.5, turn_rate: 0.8, rate: 20.0 };
    let [ahead, aside, turn] = covariance::of_twist(&noise, &usual);
    let after_a_second = |variance: f64| (0..20).map(|_| variance * 0.05 * 0.05).sum::<f64>();
    assert!((after_a_second(ahead) - 0.004f64.powi(2) * 0.5).abs() < 1e-15);
    assert_eq!(aside, 0.0);
    assert!((after_a_second(turn) - (9e-6 * 0.5 + 4e-4 * 0.8)).abs() < 1e-15);
    let [x, y, heading] = covariance::of_pose(&noise);
    assert!(
        (x - 1.6e-5 * 10.0).abs() < 1e-15 && (heading - 9e-5).abs() < 1e-15 && (y - 9e-6 * 1000.0 / 3.0).abs() < 1e-15
    );
    let model = Model::new(&Robot::labmate());
    let yaml = written("ros2_control", &Export { noise: Some(noise), usual, ..Export::of(&model) }).text;
    assert!(yaml.contains(&format!("twist_covariance_diagonal: [{}, 0.0,", text::number(ahead))), "{yaml}");
}

#[test]
fn the_c_header_is_guarded_and_holds_the_corrected_lengths() {
    let model = model_of(&Robot::labmate(), &RATIOS);
    let text = written("c", &Export::of(&model)).text;
    assert!(text.contains("#ifndef UMBMARK_ODOMETRY_H\n#define UMBMARK_ODOMETRY_H\n"));
    assert!(text.contains("#define UMBMARK_WHEELBASE_M 0.3372 /*"), "{text}");
    assert_eq!(text.matches("/*").count(), text.matches("*/").count());
    assert!(text.ends_with("#endif\n"));
}

#[test]
fn every_drive_has_a_robot_file_and_a_header() {
    for kind in DriveKind::ALL {
        let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
        let model = Model::new(&robot);
        let export = Export::of(&model);
        let read = RobotFile::parse("exported", &written("toml", &export).text).unwrap().robot;
        assert_eq!(read.drive, robot.drive);
        assert!(written("c", &export).text.matches("#define UMBMARK_").count() > kind.parameters().len());
    }
}

#[test]
fn every_file_says_first_what_wrote_it_and_which_ratios_are_in_it() {
    let model = model_of(&Robot::labmate(), &RATIOS);
    let line = format!("umbmark {}: E_d 1.00121, E_b 0.991764706, E_s 1.0", umbmark_core::VERSION);
    for (name, first) in
        [("ros2_control", format!("# {line}\n")), ("toml", format!("# {line}\n")), ("c", format!("/* {line} */\n"))]
    {
        assert!(written(name, &Export::of(&model)).text.starts_with(&first), "{name}");
    }
}

#[test]
fn what_lengths_cannot_correct_is_said_in_the_file_and_beside_it() {
    let mut model = model_of(&Robot::labmate(), &RATIOS);
    model.set("floor_slope", "slide_x_m_per_rad", 0.5).unwrap();
    model.add("crab").unwrap();
    model.set("reference_noise", "position_sd_m", 0.001).unwrap();
    // A table holds all of them.
    for target in TARGETS.iter().filter(|target| !["urdf", "embedded", "embedded_rust"].contains(&target.name)) {
        let Written { text, notes } =
            target.write(&Export { noise: Some(Noise::default()), ..Export::of(&model) }).unwrap();
        let said: Vec<&String> = notes.iter().filter(|note| note.contains("floor_slope (")).collect();
        assert!(said.len() == 1 && text.contains(said[0].as_str()), "{}: {notes:?}", target.name);
        assert!(!notes.iter().any(|note| note.contains("crab") || note.contains("reference_noise")), "{notes:?}");
    }
}

#[test]
fn a_drive_that_a_target_cannot_have_is_refused_with_those_that_can() {
    let robot = Robot { drive: DriveKind::Synchro.usual(), ..Robot::labmate() };
    let model = Model::new(&robot);
    let said = Target::named("ros2_control").unwrap().write(&Export::of(&model)).unwrap_err().to_string();
    assert_eq!(said, "ros2_control has no synchro drive; toml and c hold the numbers of every drive");
}
