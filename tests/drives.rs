//! Robots of every drive, from simulation to what is learnt of them.

use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::diagnose::{Options, Verdict, diagnose};
use umbmark_core::drive::{AckermannDrive, ClapperDrive, Encoder, Robot, TricycleDrive};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::learn::{calibrate_gears, learn};
use umbmark_core::path::{CIRCLE, Direction, Path, ROUNDED_RECTANGLE, SpeedProfile};
use umbmark_core::preset::Preset;
use umbmark_core::replay::Track;
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth, record_test};
use umbmark_io::{Existing, RobotFile};

fn k2a() -> (Robot, Path) {
    (Preset::find("k2a").unwrap().robot(), Path::umbmark())
}

fn tricycle() -> (Robot, Path) {
    let drive = AckermannDrive::new(0.5, 0.4, 0.15, 20_000.0, 0.0).unwrap().into();
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
fn recorded(robot: &(Robot, Path), values: &[(&str, &str, f64)], seed: u64) -> Dataset {
    recorded_at(robot, values, seed, [50.0, 2.0])
}

/// Five runs each way, with these rates of ticks and of poses \[Hz\].
fn recorded_at((robot, path): &(Robot, Path), values: &[(&str, &str, f64)], seed: u64, rates: [f64; 2]) -> Dataset {
    let model = model(robot, values);
    let encoder = Encoder::new(robot.encoder.ticks_per_revolution(), Some(50.0), None).unwrap();
    let robot = Robot { encoder, ..robot.clone() };
    let mut simulator = Simulator::new(&robot, path, Odometry::of(&robot), Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, seed, 0);
    let mut runs = Vec::new();
    for direction in Direction::BOTH {
        for number in 1..=5 {
            let run = simulator.record(&mut truth, direction, TestKind::Systematic, rates).unwrap();
            let name = format!("{}_{number:02}", direction.name());
            let (log, returned) = (Some(run.log), Some(run.returned));
            runs.push(Run { name, number, direction: Some(direction), test: TestKind::Systematic, log, returned });
        }
    }
    Dataset { robot: Some(robot), path: Some(path.clone()), runs, ..Dataset::default() }
}

/// The same robot known by its return poses alone.
fn returns_of(mut data: Dataset) -> Dataset {
    data.runs.iter_mut().for_each(|run| run.log = None);
    data
}

/// Bits, and not tolerances: counts are whole in the file, and travel follows from them as it did before.
#[test]
fn logs_of_a_drives_own_counters_read_back_to_the_last_bit() {
    for robot in [k2a(), tricycle(), front_driven()] {
        let data = recorded(&robot, &[("wheel_noise", "k_sqrt_m", 1e-3)], 3);
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("data");
        umbmark_io::save(&data, &place, Existing::Keep).unwrap();
        let read = umbmark_io::load(&place).unwrap();
        assert_eq!((&read.robot, &read.runs), (&data.robot, &data.runs));
        let header = std::fs::read_to_string(place.join("runs/cw_01.csv")).unwrap();
        assert!(header.starts_with("t_s,ticks_drive,ticks_steering,x_ref_m"), "{header}");
        assert!(umbmark_io::save_mcap(&data, folder.path().join("mcap"), Existing::Keep).is_err());
        let text = RobotFile::new(robot.0.clone(), Some(robot.1.clone())).text();
        assert_eq!(RobotFile::parse("robot.toml", &text).unwrap().robot, robot.0);
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
        (
            front_driven(),
            &[
                ("front_wheel_zero", "angle_rad", 4e-3),
                ("front_wheel_gain", "share", 0.01),
                ("axle_distance", "ratio", 1.01),
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
        (
            front_driven(),
            [("front_wheel_zero", "angle_rad", 3e-3), ("axle_distance", "ratio", 1.006), ("scale", "e_s", 1.003)],
        ),
    ] {
        // Exact motion along exact legs, as the counts of a driven front wheel make it, leaves no residual to judge by.
        let seen = [("reference_noise", "position_sd_m", 1e-4), ("reference_noise", "heading_sd_rad", 1e-4)];
        let data = recorded(&robot, &[&truth[..], &seen].concat(), 5);
        let found = calibrate_gears(&data).unwrap();
        for (effect, parameter, value) in truth {
            let estimate = found.model.get(effect, parameter).unwrap();
            assert!((estimate - value).abs() < 2e-4, "{effect}: {estimate}");
        }
        assert!(found.e_max_sys_before.unwrap() > 0.1 && found.e_max_sys_after.unwrap() < 5e-3);
        // A robot that believes what was found, and truly is what it was, returns to START.
        let nothing = if truth[1].0 == "steering_gain" { 0.0 } else { 1.0 };
        let again = found.corrected.drive.corrected([0.0, nothing, 1.0]);
        assert_eq!(again.unwrap(), found.corrected.drive);
        let returns = calibrate_gears(&returns_of(data)).unwrap();
        assert_eq!(returns.identifiability.unwrap().rank, 2);
        assert!(returns.model.get(truth[2].0, truth[2].1).is_none());
        assert!(returns.e_max_sys_after.unwrap() < 5e-3);
    }
}

/// A tricycle whose front wheel is driven, on the paper's square: it turns on the spot.
fn front_driven() -> (Robot, Path) {
    let drive = TricycleDrive::new(0.5, 0.4, 0.15, 20_000.0, 0.0).unwrap().into();
    let robot = Robot { name: "front".into(), drive, encoder: Encoder::new(2000.0, None, None).unwrap() };
    (robot, Path::umbmark())
}

/// Runs of a tricycle in the layout of OptiOdom: whole ticks of its driven front wheel, and that wheel's angle, row by row.
fn write_optiodom_tricycle(data: &Dataset, folder: &std::path::Path) {
    let robot = data.robot.as_ref().unwrap();
    let [distance, _, diameter, steering, _] = robot.drive.values()[..] else { panic!("a tricycle has five numbers") };
    let ticks = robot.encoder.ticks_per_revolution();
    let metadata =
        format!("type,tricyc,\nngear,1,\nencRes,{ticks},\nLi,{distance},\nDi,{diameter},\nThi,0,\nN,10,\nL,,\n");
    std::fs::write(folder.join("made_metadata.csv"), metadata).unwrap();
    for (number, run) in data.runs.iter().enumerate() {
        let log = run.log.as_ref().unwrap();
        let [drive, steered] = robot.counters([&log.left, &log.right]);
        let (mut text, mut before, mut turned) = (String::new(), drive[0], steered[0]);
        let mut poses = log.reference.iter().peekable();
        for (sample, (drive, steered)) in drive.iter().zip(&steered).enumerate() {
            let Some(pose) = poses.next_if(|pose| pose.sample == sample) else { continue };
            // The angle of what was driven since the row before.
            let angle = 0.5 * (turned + steered) * std::f64::consts::TAU / steering;
            let (time, heading, count) = (log.time[sample], pose.heading.unwrap(), drive - before);
            (before, turned) = (*drive, *steered);
            text += &format!("{time},{},{},{heading},{count},{angle}\n", pose.x, pose.y);
        }
        std::fs::write(folder.join(format!("made_run-{:02}.csv", number + 1)), text).unwrap();
    }
}

/// Ticks of a front wheel count with the cosine and the sine of its angle, also on the spot, so what was hidden comes out.
#[test]
fn a_tricycle_in_the_layout_of_optiodom_is_read_and_calibrated() {
    let truth = [("front_wheel_zero", "angle_rad", 3e-3), ("axle_distance", "ratio", 1.006), ("scale", "e_s", 1.003)];
    let seen = [("reference_noise", "position_sd_m", 1e-4), ("reference_noise", "heading_sd_rad", 1e-4)];
    let data = recorded_at(&front_driven(), &[&truth[..], &seen].concat(), 7, [50.0, 50.0]);
    let folder = tempfile::tempdir().unwrap();
    write_optiodom_tricycle(&data, folder.path());
    let read = umbmark_io::load(folder.path()).unwrap();
    let nominal = read.robot.as_ref().unwrap();
    assert_eq!((nominal.drive.kind().name(), nominal.drive.values()[0], read.runs.len()), ("tricycle", 0.5, 10));
    for (made, found) in data.runs.iter().zip(&read.runs) {
        let (made, found) = (made.returned.unwrap(), found.returned.unwrap());
        assert!((made.x - found.x).hypot(made.y - found.y) < 1e-3, "{made:?} {found:?}");
    }
    let calibrated = calibrate_gears(&read).unwrap();
    for (effect, parameter, value) in truth {
        let estimate = calibrated.model.get(effect, parameter).unwrap();
        assert!((estimate - value).abs() < 3e-4, "{effect}: {estimate}");
    }
}

fn learns(robot: &(Robot, Path), values: &[(&str, &str, f64)], class: &str, seed: u64) {
    let noise = [("wheel_noise", "k_sqrt_m", 5e-4), ("reference_noise", "position_sd_m", 1e-3)];
    let data = recorded(robot, &[values, &noise].concat(), seed);
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let named = learnt.steps.iter().skip(1).any(|step| step.class.contains(&class));
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

fn clapper(correction: bool, rotary_ticks: f64) -> (Robot, Path) {
    let preset = Preset::find("clapper").unwrap();
    let drive = ClapperDrive::new(*preset.robot().drive, 1.0, rotary_ticks, correction).unwrap();
    (Robot { drive: drive.into(), ..preset.robot() }, preset.path())
}

/// Return poses of five runs each way.
fn returned((robot, path): &(Robot, Path), values: &[(&str, &str, f64)], seed: u64) -> Dataset {
    let model = model(robot, values);
    record_test(&model, path, &[TestKind::Systematic], [5, 5], 0.0, [seed, 0]).unwrap()
}

#[test]
fn a_simulated_clapper_returns_where_its_prediction_does() {
    for (correction, values) in [
        (
            true,
            &[
                ("rotary_zero_difference", "angle_rad", 3e-4),
                ("rotary_zero_mean", "angle_rad", 2e-3),
                ("rotary_gain", "share", 2e-3),
                ("link_length", "ratio", 1.002),
                ("rear_truck", "e_d", 1.004),
                ("scale", "e_s", 1.001),
                ("floor_slope", "drift_y", 2e-3),
                ("start_pose", "x_m", 4e-3),
            ][..],
        ),
        (
            false,
            &[
                ("wheel_diameter_ratio", "e_d", 1.002),
                ("wheelbase", "e_b", 0.99),
                ("crab", "angle_rad", 0.01),
                ("rear_truck", "e_d", 1.004),
            ],
        ),
    ] {
        let (robot, path) = clapper(correction, 1e9);
        let model = model(&robot, values);
        let mut simulator = Simulator::new(&robot, &path, Odometry::of(&robot), Phase::Edge).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, 1, 0);
        for direction in Direction::BOTH {
            let simulated = simulator.run(&mut truth, direction, TestKind::Systematic);
            for track in [Track::from_path, Track::in_pieces, Track::with_stops] {
                let track = track(&path, direction, &robot);
                let (end, told) = (track.end(&model.chain()), path.end(direction));
                let gap = (simulated.x - (end.x - told.x)).hypot(simulated.y - (end.y - told.y));
                let turn = simulated.heading.unwrap() - (end.heading - told.heading);
                assert!(gap < 1e-6 && turn.abs() < 1e-6 && simulated.x.hypot(simulated.y) > 1e-3, "{gap} {turn}");
            }
        }
    }
}

/// Without noise, and angles counted finely, what shows comes out; the corrected robot believes it.
#[test]
fn calibration_of_a_clapper_finds_its_link_or_without_correction_its_front_truck() {
    for (correction, truth, hidden) in [
        (
            true,
            [("rotary_zero_difference", "angle_rad", 3e-4), ("link_length", "ratio", 1.003)],
            &[("wheel_diameter_ratio", "e_d", 1.00121)][..],
        ),
        (
            false,
            [("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 337.2 / 340.0)],
            &[("link_length", "ratio", 1.003)],
        ),
    ] {
        let robot = clapper(correction, 1e9);
        let data = returned(&robot, &[&truth[..], hidden].concat(), 5);
        let found = calibrate_gears(&data).unwrap();
        for (effect, parameter, value) in truth {
            let estimate = found.model.get(effect, parameter).unwrap();
            // With the correction, unequal wheels of the trucks leave a sixtieth of what they do alone.
            assert!((estimate - value).abs() < 1e-4, "{effect}: {estimate}");
        }
        assert!(found.e_max_sys_before.unwrap() > 0.05 && found.e_max_sys_after.unwrap() < 1e-3);
        assert_eq!(found.identifiability.unwrap().rank, 2);
        // Driven again by what it now believes, it returns to START.
        let values: Vec<f64> = found.corrected.drive.values();
        let expected = if correction { (2, 1.003) } else { (0, 0.3372) };
        assert!((values[expected.0] - expected.1).abs() < 1e-4, "{values:?}");
        let text = RobotFile::new(found.corrected.clone(), Some(robot.1.clone())).text();
        let read = RobotFile::parse("robot.toml", &text).unwrap().robot.drive.values();
        assert!(read.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-12), "{text}");
    }
}

#[test]
fn with_its_correction_a_clapper_hides_what_the_link_takes_away() {
    let robot = clapper(true, 8192.0);
    let both = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("wheel_noise", "k_sqrt_m", 5e-4)];
    let data = returned(&robot, &both, 6);
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let names: Vec<_> = learnt.model.parts().iter().map(|part| part.effect.name()).collect();
    assert_eq!(names, ["link_length", "rotary_zero_difference"], "{:?}", learnt.verdict);
    let unseen: Vec<_> = learnt.diagnosis.invisible.iter().map(|unseen| unseen.effect).collect();
    for hidden in ["wheel_diameter_ratio", "wheelbase", "scale", "rotary_gain", "crab"] {
        assert!(unseen.contains(&hidden), "{hidden} of {unseen:?}");
    }
}

fn learns_from_returns(robot: &(Robot, Path), values: &[(&str, &str, f64)], class: &str, seed: u64) {
    let noise = [("wheel_noise", "k_sqrt_m", 5e-4)];
    let data = returned(robot, &[values, &noise].concat(), seed);
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let named = learnt.steps.iter().skip(3).any(|step| step.class.contains(&class));
    let story: Vec<_> = learnt.steps.iter().map(|step| (step.added, step.class.clone())).collect();
    assert!(named, "{class} of {}: {story:?} {:?} {:?}", robot.0.name, learnt.verdict, learnt.remarks);
}

#[test]
fn a_hidden_effect_of_a_clapper_is_learnt() {
    learns_from_returns(&clapper(true, 8192.0), &[("rotary_zero_mean", "angle_rad", 8e-3)], "rotary_zero_mean", 21);
    learns_from_returns(&clapper(true, 8192.0), &[("floor_slope", "drift_y", 4e-3)], "floor_slope", 22);
    learns_from_returns(&clapper(false, 8192.0), &[("carpet_nap", "drift_x", 5e-3)], "floor_slope", 23);
}

/// The first effects of a CLAPPER, where the model has none yet: the link's zeros are certified as missing.
#[test]
fn zeros_of_the_rotary_encoders_are_missed_by_a_model_without_them() {
    let robot = clapper(true, 8192.0);
    let values = [("rotary_zero_difference", "angle_rad", 5e-4), ("wheel_noise", "k_sqrt_m", 5e-4)];
    let data = returned(&robot, &values, 24);
    let found = diagnose(&data, &Model::new(&robot.0), &Options { draws: 199, ..Options::default() }).unwrap();
    assert_eq!(found.verdict, Verdict::MissingEffect, "{:?}", found.ranking);
    assert!(found.certified()[0].class.contains(&"rotary_zero_difference"), "{:?}", found.ranking);
    let experiments: Vec<_> = found.next_experiments.iter().map(|e| e.experiment.as_str()).collect();
    println!("{experiments:?}");
}

/// What has counters that no log holds, and what cannot be driven, is refused with a reason.
#[test]
fn tick_logs_and_arcs_of_a_clapper_are_refused() {
    let (robot, path) = clapper(true, 8192.0);
    let mut simulator = Simulator::new(&robot, &path, Odometry::of(&robot), Phase::Random).unwrap();
    let mut truth = Truth::new(&Model::new(&robot));
    simulator.open(&mut truth, 1, 0);
    let refused = simulator.record(&mut truth, Direction::Cw, TestKind::Systematic, [50.0, 2.0]).unwrap_err();
    assert!(refused.to_string().contains("each of its trucks has counters of its own"), "{refused}");
    let circle = Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap();
    let refused = Simulator::new(&robot, &circle, Odometry::of(&robot), Phase::Random).unwrap_err();
    assert_eq!(refused.to_string(), "drive = \"clapper\" does not support paths with arcs");
    let mut data = returned(&(robot.clone(), path), &[("wheel_noise", "k_sqrt_m", 5e-4)], 25);
    let folder = tempfile::tempdir().unwrap();
    umbmark_io::save(&data, folder.path().join("data"), Existing::Keep).unwrap();
    assert_eq!(umbmark_io::load(folder.path().join("data")).unwrap().robot, data.robot);
    data.path = Some(circle);
    let refused = calibrate_gears(&data).unwrap_err().to_string();
    assert!(refused.contains("cannot drive the path, shape = \"circle\""), "{refused}");
}

#[test]
fn return_poses_of_a_complete_synchro_model_are_explained() {
    let data = returns_of(recorded(&k2a(), &[("wheel_noise", "k_sqrt_m", 1e-3), ("steer_scale", "ratio", 1.005)], 17));
    let learnt = learn(&data, &Options::default()).unwrap();
    assert_eq!(learnt.verdict, Verdict::Explained);
    let names: Vec<_> = learnt.model.parts().iter().map(|part| part.effect.name()).collect();
    assert_eq!(names, ["steer_scale", "steer_coupling"]);
}
