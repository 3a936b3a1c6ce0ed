//! Robots of every drive, from simulation to what is learnt of them.

#![allow(clippy::unwrap_used)]

use umbmark_core::dataset::{Dataset, Existing, Run, parse_robot, robot_text};
use umbmark_core::diagnose::{Options, Verdict};
use umbmark_core::drive::{AckermannDrive, Drive, Encoder, Kind, Robot};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::learn::{calibrate_gears, learn};
use umbmark_core::path::{CIRCLE, Direction, Path, ROUNDED_RECTANGLE, SpeedProfile};
use umbmark_core::preset::Preset;
use umbmark_core::replay::Track;
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

fn k2a() -> (Robot, Path) {
    (Preset::find("k2a").unwrap().robot(), Path::umbmark())
}

fn tricycle() -> (Robot, Path) {
    let drive = Drive::Ackermann(AckermannDrive::new(0.5, 0.4, 0.15, 20_000.0, 0.0).unwrap());
    let robot = Robot { name: "tricycle".into(), drive, encoder: Encoder::new(2000.0, None, None).unwrap() };
    (robot, Path::new(&ROUNDED_RECTANGLE, &[4.0, 4.0, 1.0], SpeedProfile::default()).unwrap())
}

fn model(robot: &Robot, values: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(robot);
    for (effect, parameter, value) in values {
        model.set(effect, parameter, *value).unwrap();
    }
    model.check_drive().unwrap();
    model
}

/// Five runs each way, ticks at 50 Hz and poses at 2 Hz.
fn recorded((robot, path): &(Robot, Path), values: &[(&str, &str, f64)], seed: u64) -> Dataset {
    let model = model(robot, values);
    let encoder = Encoder::new(robot.encoder.ticks_per_revolution(), Some(50.0), None).unwrap();
    let robot = Robot { encoder, ..robot.clone() };
    let mut simulator = Simulator::new(&robot, path, Odometry::of(&robot), Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, seed, 0);
    let mut runs = Vec::new();
    for direction in Direction::BOTH {
        for number in 1..=5 {
            let run = simulator.record(&mut truth, direction, TestKind::Systematic, [50.0, 2.0]).unwrap();
            let name = format!("{}_{number:02}", direction.name());
            let (log, returned) = (Some(run.log), Some(run.returned));
            runs.push(Run { name, number, direction: Some(direction), test: TestKind::Systematic, log, returned });
        }
    }
    let (clocks, topics, warnings) = Default::default();
    Dataset { robot: Some(robot), path: Some(path.clone()), runs, clocks, topics, warnings }
}

/// The same robot known by its return poses alone.
fn returns_of(mut data: Dataset) -> Dataset {
    data.runs.iter_mut().for_each(|run| run.log = None);
    data
}

/// Bits, and not tolerances: counts are whole in the file, and travel follows from them as it did before.
#[test]
fn logs_of_a_drives_own_counters_read_back_to_the_last_bit() {
    for robot in [k2a(), tricycle()] {
        let data = recorded(&robot, &[("wheel_noise", "k_sqrt_m", 1e-3)], 3);
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("data");
        data.save(&place, Existing::Keep).unwrap();
        let read = Dataset::load(&place).unwrap();
        assert_eq!((&read.robot, &read.runs), (&data.robot, &data.runs));
        let header = std::fs::read_to_string(place.join("runs/cw_01.csv")).unwrap();
        assert!(header.starts_with("t_s,ticks_drive,ticks_steering,x_ref_m"), "{header}");
        assert!(data.save_mcap(folder.path().join("mcap"), Existing::Keep).is_err());
        let text = robot_text(&robot.0, Some(&robot.1));
        assert_eq!(parse_robot("robot.toml", &text).unwrap().0, robot.0);
    }
}

#[test]
fn a_simulated_run_ends_where_replay_of_its_commands_and_of_its_log_does() {
    let circle = Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap();
    for ((robot, path), values) in [
        (
            k2a(),
            &[
                ("steer_scale", "ratio", 1.01),
                ("steer_coupling", "rad_per_m", 2e-3),
                ("contact_trail", "trail_m", 0.02),
                ("base_yaw", "sine_rad_per_m", 2e-3),
            ][..],
        ),
        (
            tricycle(),
            &[
                ("steering_zero", "angle_rad", 4e-3),
                ("steering_gain", "share", 0.01),
                ("understeer", "rad_per_m_s2", 0.1),
                ("contact_trail", "trail_m", 0.05),
            ],
        ),
    ] {
        let model = model(&robot, values);
        for path in [&path, &circle] {
            let mut simulator = Simulator::new(&robot, path, Odometry::Continuous, Phase::Edge).unwrap();
            let mut truth = Truth::new(&model);
            simulator.open(&mut truth, 1, 0);
            for direction in Direction::BOTH {
                let simulated = simulator.run(&mut truth, direction, TestKind::Systematic);
                let (end, told) = (Track::in_pieces(path, direction, &robot).end(&model.chain()), path.end(direction));
                let gap = (simulated.x - (end.x - told.x)).hypot(simulated.y - (end.y - told.y));
                assert!(gap < 1e-9 && simulated.x.hypot(simulated.y) > 1e-3, "{}: {gap}", robot.name);
                let run = simulator.record(&mut truth, direction, TestKind::Systematic, [100.0, 1.0]).unwrap();
                let replayed = Track::from_log(&run.log, &robot).unwrap().end(&model.chain());
                let true_end = run.truth.last().unwrap();
                let gap = (replayed.x - true_end.x).hypot(replayed.y - true_end.y);
                assert!(gap < 2e-3, "{} {direction:?}: {gap}", robot.name);
            }
        }
    }
}

/// Without noise, the first effects come out to the quantisation of the counters, and the corrected robot returns to START.
#[test]
fn calibration_finds_the_gears_of_each_drive_and_says_what_returns_do_not_show() {
    for (robot, truth) in [
        (
            k2a(),
            [("steer_coupling", "rad_per_m", 1.5e-3), ("steer_scale", "ratio", 1.004), ("drive_scale", "e_s", 1.003)],
        ),
        (tricycle(), [("steering_zero", "angle_rad", 3e-3), ("steering_gain", "share", 6e-3), ("scale", "e_s", 1.003)]),
    ] {
        let data = recorded(&robot, &truth, 5);
        let found = calibrate_gears(&data).unwrap();
        for (effect, parameter, value) in truth {
            let estimate = found.model.get(effect, parameter).unwrap();
            assert!((estimate - value).abs() < 2e-4, "{effect}: {estimate}");
        }
        assert!(found.e_max_sys_before.unwrap() > 0.1 && found.e_max_sys_after.unwrap() < 5e-3);
        // A robot that believes what was found, and truly is what it was, returns to START.
        let again = found.corrected.drive.corrected([
            0.0,
            1.0 - f64::from(u8::from(robot.0.drive.kind() == Kind::Ackermann)),
            1.0,
        ]);
        assert_eq!(again.unwrap(), found.corrected.drive);
        let returns = calibrate_gears(&returns_of(data)).unwrap();
        assert_eq!(returns.identifiability.unwrap().rank, 2);
        assert!(returns.model.get(truth[2].0, truth[2].1).is_none());
        assert!(returns.e_max_sys_after.unwrap() < 5e-3);
    }
}

fn learns(robot: &(Robot, Path), values: &[(&str, &str, f64)], class: &str, seed: u64) {
    let noise = [("wheel_noise", "k_sqrt_m", 5e-4), ("reference_noise", "position_sd_m", 1e-3)];
    let data = recorded(robot, &[values, &noise].concat(), seed);
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let named = learnt.steps.iter().skip(4).any(|step| step.class.contains(&class));
    let story: Vec<_> = learnt.steps.iter().map(|step| (step.added, step.class.clone())).collect();
    assert!(named, "{class} of {}: {story:?} {:?}", robot.0.name, learnt.verdict);
}

#[test]
fn a_hidden_effect_of_a_synchro_drive_is_learnt() {
    learns(&k2a(), &[("contact_trail", "trail_m", 0.02)], "contact_trail", 11);
    learns(&k2a(), &[("base_yaw", "cosine_rad_per_m", 4e-3)], "base_yaw", 12);
    learns(&k2a(), &[("carpet_nap", "drift_x", 4e-3)], "floor_slope", 13);
}

#[test]
fn a_hidden_effect_of_an_ackermann_drive_is_learnt() {
    learns(&tricycle(), &[("contact_trail", "trail_m", 0.03)], "contact_trail", 14);
    learns(&tricycle(), &[("crab", "angle_rad", 0.01)], "crab", 15);
    learns(&tricycle(), &[("floor_slope", "drift_y", 4e-3)], "floor_slope", 16);
}

#[test]
fn a_path_with_turns_on_the_spot_suits_no_ackermann_drive() {
    let ((k2a, square), (tricycle, rounded)) = (k2a(), tricycle());
    assert!(square.suits(&k2a) && rounded.suits(&k2a) && rounded.suits(&tricycle) && !square.suits(&tricycle));
    let refused = Simulator::new(&tricycle, &square, Odometry::EveryTick, Phase::Edge).unwrap_err().to_string();
    assert!(refused.contains("cannot turn as tightly as in move 2"), "{refused}");
}

/// What no model predicts is refused with a reason, and never answered with a number of something else.
#[test]
fn a_clapper_is_simulated_and_scored_and_refused_by_what_predicts() {
    let preset = Preset::find("clapper").unwrap();
    let (robot, path, model) = (preset.robot(), preset.path(), preset.model().unwrap());
    let mut simulator = Simulator::new(&robot, &path, Odometry::of(&robot), Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, 1, 0);
    assert!(simulator.record(&mut truth, Direction::Cw, TestKind::Systematic, [50.0, 2.0]).is_err());
    let mut runs = Vec::new();
    for direction in Direction::BOTH {
        for number in 1..=5 {
            let returned = Some(simulator.run(&mut truth, direction, TestKind::Systematic));
            let name = format!("{}_{number:02}", direction.name());
            runs.push(Run {
                name,
                number,
                direction: Some(direction),
                test: TestKind::Systematic,
                log: None,
                returned,
            });
        }
    }
    let (clocks, topics, warnings) = Default::default();
    let data = Dataset { robot: Some(robot.clone()), path: Some(path), runs, clocks, topics, warnings };
    let folder = tempfile::tempdir().unwrap();
    data.save(folder.path().join("data"), Existing::Keep).unwrap();
    assert_eq!(Dataset::load(folder.path().join("data")).unwrap().robot, Some(robot));
    assert!(umbmark_core::score::score(&data.runs, 0.95).is_ok());
    for refused in [
        learn(&data, &Options::default()).map(|_| ()).unwrap_err().to_string(),
        calibrate_gears(&data).map(|_| ()).unwrap_err().to_string(),
    ] {
        assert!(refused.contains("drive = \"clapper\" is not supported here"), "{refused}");
    }
}

#[test]
fn return_poses_of_a_complete_synchro_model_are_explained() {
    let data = returns_of(recorded(&k2a(), &[("wheel_noise", "k_sqrt_m", 1e-3), ("steer_scale", "ratio", 1.005)], 17));
    let learnt = learn(&data, &Options::default()).unwrap();
    assert_eq!(learnt.verdict, Verdict::Explained);
    let names: Vec<_> = learnt.model.parts().iter().map(|part| part.effect.name()).collect();
    assert_eq!(names, ["steer_scale", "steer_coupling"]);
}
