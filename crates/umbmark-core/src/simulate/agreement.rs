//! Simulation against replay, effect by effect: both pass the same pieces to a law, so both get the same motion.

use super::*;
use crate::drive::DriveKind;
use crate::effect::tests::{recorded_back, sideways_log};
use crate::effect::{CATALOGUE, Changes, Entry, Model, RunContext};
use crate::parameter::{Parameter, Role};
use crate::path::{CIRCLE, FIGURE_EIGHT, SQUARE, SpeedProfile};
use crate::preset::Preset;
use crate::replay::Track;

/// Numbers with a random effect.
fn by_chance(entry: &Entry, p: &Parameter) -> bool {
    !entry.changes.include(Changes::MEAN) || matches!(p.role, Role::Scatter | Role::Count)
}

/// Gives an effect its usual sizes, those of chance at zero unless asked for.
fn put(model: &mut Model, entry: &Entry, chance: bool) {
    for p in entry.about.parameters.iter().filter(|p| chance || !by_chance(entry, p)) {
        model.set(entry.about.name, p.name, p.usual(&Robot::labmate())).unwrap();
    }
}

/// Each effect alone, and all of them together.
fn models() -> Vec<(&'static str, Model)> {
    let nothing = Model::new(&Robot::labmate());
    let mut together = nothing.clone();
    let mut models = Vec::new();
    for entry in CATALOGUE {
        let mut alone = nothing.clone();
        put(&mut alone, entry, false);
        if entry.drives().contains(DriveKind::default()) {
            put(&mut together, entry, false);
        }
        models.push((entry.about.name, alone));
    }
    models.push(("all together", together));
    models
}

fn path(shape: &'static crate::path::Shape, values: &[f64]) -> Path {
    Path::new(shape, values, SpeedProfile::default()).unwrap()
}

fn opened(model: &Model, path: &Path, odometry: Odometry, phase: Phase) -> (Simulator, Truth) {
    let mut simulator = Simulator::new(model.robot(), path, odometry, phase).unwrap();
    let mut truth = Truth::new(model);
    simulator.open(&mut truth, 5, 3);
    (simulator, truth)
}

fn gap(a: &ReturnError, b: &ReturnError) -> f64 {
    let heading = wrap(a.heading.unwrap() - b.heading.unwrap());
    (a.x - b.x).abs().max((a.y - b.y).abs()).max(heading.abs())
}

#[test]
fn a_simulated_run_ends_where_replay_of_its_commands_does() {
    let mut moved = 0;
    for path in [Path::umbmark(), path(&CIRCLE, &[2.0, 1.0]), path(&FIGURE_EIGHT, &[1.0])] {
        for (name, model) in models() {
            for direction in Direction::BOTH {
                let (mut simulator, mut truth) = opened(&model, &path, Odometry::Continuous, Phase::Edge);
                let simulated = simulator.run(&mut truth, direction, TestKind::Systematic);
                let end = Track::in_pieces(&path, direction, model.robot()).end(&model.chain());
                let replayed = return_error(&end, &path.end(direction));
                let gap = gap(&simulated, &replayed);
                assert!(gap < 1e-9, "{name} {direction:?} {}: {gap:e}", path.shape().name);
                moved += usize::from(simulated.x.abs() + simulated.y.abs() > 1e-5);
            }
        }
    }
    // Five effects are drawn by chance alone, and some do not show at the end of a closed path.
    assert!(moved > 120, "{moved} of 210 runs end elsewhere");
}

/// Two runs each way, recorded one after the other as one session: how far replay of their ticks is from the poses that
/// were measured, in position \[m\] and heading \[rad\], at worst.
fn replay_gap(model: &Model, path: &Path) -> [f64; 2] {
    let (mut simulator, mut truth) =
        opened(model, path, Odometry::Sampled { rate: 100.0, update: Update::Arc }, Phase::Random);
    let chain = model.chain();
    let (mut place, mut worst) = (RunContext::default(), [0.0_f64; 2]);
    for direction in Direction::BOTH.into_iter().flat_map(|d| [d; 2]) {
        place.direction = Some(direction);
        let recording = simulator.record(&mut truth, direction, TestKind::Systematic, [100.0, 20.0]).unwrap();
        let track = Track::from_log_at(&recording.log, model.robot(), place).unwrap();
        for (seen, replayed) in recording.log.reference.iter().zip(track.poses(&chain)) {
            worst[0] = worst[0].max(libm::hypot(seen.x - replayed.x, seen.y - replayed.y));
            worst[1] = worst[1].max(wrap(seen.heading.unwrap() - replayed.heading).abs());
        }
        place.run += 1;
        place.session_distance += track.length();
    }
    worst
}

#[test]
fn replay_of_recorded_ticks_meets_the_measured_poses_as_near_as_ticks_tell_place_and_speed() {
    for (name, model) in models() {
        let [position, heading] = match name {
            // A tick is 0.24 mm or 0.7 mrad; the end of a turn is known to some of them.
            "caster_kick" | "leg_kick" => [0.8e-3, 1.6e-3],
            // Speeds on ramps are those of 0.3 s.
            "reference_delay" => [0.8e-3, 1.6e-3],
            "all together" => [2.4e-3, 4e-3],
            _ => [0.8e-3, 1.3e-3],
        };
        for path in [path(&SQUARE, &[1.0]), path(&CIRCLE, &[1.0, 1.0])] {
            let gap = replay_gap(&model, &path);
            assert!(gap[0] < position && gap[1] < heading, "{name}, {}: {gap:?}", path.shape().name);
        }
    }
}

/// Everything that is measured of some runs on a square and a circle, on the way and at their ends, and of a drive back; of two trucks, at the
/// end of a square.
fn everything_measured(model: &Model) -> Vec<f64> {
    let mut all = Vec::new();
    if model.robot().drive.kind().moves_sideways() {
        // Paths have no moves to the side; logs have.
        let log = sideways_log(&model.robot().drive, model.robot());
        let track = Track::from_log(&log, model.robot()).unwrap();
        return track.poses(&model.chain()).iter().flat_map(|pose| [pose.x, pose.y, pose.heading]).collect();
    }
    if !model.robot().drive.kind().has_tick_logs() {
        let (mut simulator, mut truth) =
            opened(model, &path(&SQUARE, &[1.0]), Odometry::of(model.robot()), Phase::Edge);
        let error = simulator.run(&mut truth, Direction::Ccw, TestKind::Systematic);
        return vec![error.x, error.y, error.heading.unwrap()];
    }
    // Paths lead ahead; logs lead back, too.
    let back = Track::from_log(&recorded_back(), model.robot()).unwrap();
    all.extend(back.poses(&model.chain()).iter().flat_map(|pose| [pose.x, pose.y, pose.heading]));
    for path in [path(&SQUARE, &[1.0]), path(&CIRCLE, &[1.0, 1.0])] {
        let (mut simulator, mut truth) =
            opened(model, &path, Odometry::Sampled { rate: 20.0, update: Update::Arc }, Phase::Edge);
        for direction in Direction::BOTH.into_iter().flat_map(|d| [d; 2]) {
            let run = simulator.run(&mut truth, direction, TestKind::Bumps);
            let recording = simulator.record(&mut truth, direction, TestKind::Bumps, [20.0, 5.0]).unwrap();
            for error in [run, recording.returned] {
                all.extend([error.x, error.y, error.heading.unwrap()]);
            }
            all.extend(recording.log.reference.iter().flat_map(|seen| [seen.x, seen.y, seen.heading.unwrap()]));
        }
    }
    all
}

#[test]
fn every_number_of_every_effect_shows_in_what_is_measured() {
    for entry in CATALOGUE {
        let of_trucks = entry.drives().each().all(DriveKind::has_trucks);
        let of_rollers = entry.drives().each().find(|_| entry.drives().each().all(DriveKind::moves_sideways));
        let robot = if let Some(kind) = of_rollers {
            Robot { drive: kind.usual(), ..Robot::labmate() }
        } else if of_trucks {
            Preset::find("clapper").unwrap().robot()
        } else {
            Robot::labmate()
        };
        let mut usual = Model::new(&robot);
        put(&mut usual, entry, true);
        if entry.about.name == "bumps" {
            usual.set("bumps", "rate_per_m", 1.0).unwrap();
        }
        let before = everything_measured(&usual);
        for p in entry.about.parameters {
            let (value, neutral) = (p.usual(&robot), p.default.resolve(&robot));
            let other = match (p.choices().is_empty(), value == neutral) {
                (false, _) => 1.0 - value,
                (true, true) => value + 0.5 * if value == 0.0 { p.typical } else { value },
                (true, false) => neutral + 1.5 * (value - neutral),
            };
            let mut changed = usual.clone();
            changed.set(entry.about.name, p.name, other).unwrap();
            let after = everything_measured(&changed);
            let most = before.iter().zip(&after).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(most > 1e-6, "--{} of {} moves nothing by more than {most:e}", p.flag, entry.about.name);
        }
    }
}

#[test]
fn wheel_noise_and_bumps_are_the_same_whether_a_stretch_is_cut_for_an_effect_or_not() {
    let mut plain = Model::new(&Robot::labmate());
    for (effect, parameter, value) in [
        ("wheel_noise", "k_sqrt_m", 1e-3),
        ("bumps", "rate_per_m", 0.3),
        ("wheelbase", "e_b", 1.02),
        ("crab", "angle_rad", 0.02),
        ("start_pose", "heading_sd_rad", 0.1),
    ] {
        plain.set(effect, parameter, value).unwrap();
    }
    let mut cut = plain.clone();
    cut.set("floor_slope_yaw", "sine_rad_per_m", 1e-14).unwrap();
    assert!(cut.varies() && !plain.varies());
    for path in [Path::umbmark(), path(&CIRCLE, &[2.0, 1.0])] {
        let ends = [&plain, &cut].map(|model| {
            let (mut simulator, mut truth) = opened(model, &path, Odometry::Continuous, Phase::Edge);
            Direction::BOTH.map(|direction| simulator.run(&mut truth, direction, TestKind::Systematic))
        });
        for (plain, cut) in ends[0].iter().zip(&ends[1]) {
            assert!(plain.x.abs() > 1e-3 && gap(plain, cut) < 1e-9, "{plain:?} {cut:?}");
        }
    }
}

#[test]
fn a_floor_pulls_one_way_in_the_room_however_the_robot_was_put_down() {
    let mut model = Model::new(&Robot::labmate());
    model.set("floor_slope", "drift_x", 3e-3).unwrap();
    model.set("start_pose", "heading_sd_rad", 1.0).unwrap();
    let (mut simulator, mut truth) = opened(&model, &Path::umbmark(), Odometry::Continuous, Phase::Edge);
    for direction in Direction::BOTH.into_iter().flat_map(|d| [d; 3]) {
        let end = simulator.run(&mut truth, direction, TestKind::Systematic);
        assert!((end.x - 16.0 * 3e-3).abs() < 1e-9 && end.y.abs() < 1e-9, "{end:?}");
        assert!(end.heading.unwrap().abs() > 1e-3);
    }
}

#[test]
fn the_session_goes_on_from_run_to_run_and_begins_anew_with_each_trial() {
    let mut model = Model::new(&Robot::labmate());
    model.set("diameter_drift", "per_session_m", 1e-5).unwrap();
    let (mut simulator, mut truth) = opened(&model, &Path::umbmark(), Odometry::Continuous, Phase::Edge);
    for trial in 0..2 {
        simulator.open(&mut truth, 5, trial);
        let mut returned = [[ReturnError::default(); 2]; 2];
        simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(|r| r.as_mut_slice()));
        for (run, error) in returned.as_flattened().iter().enumerate() {
            // Run n begins at 16 n: the mean of D_R/D_L - 1 over its way is 1e-5 (16 n + 8), and turns it by that · 16/b.
            let expected = 1e-5 * (16.0 * run as f64 + 8.0) * 16.0 / 0.34;
            assert!((error.heading.unwrap() - expected).abs() < 1e-9, "{run}: {error:?} {expected}");
        }
    }
}

#[test]
fn the_bits_of_pieces_with_every_effect_are_the_same_on_every_instruction_set() {
    let mut model = Model::new(&Robot::labmate());
    CATALOGUE.iter().for_each(|entry| put(&mut model, entry, true));
    let ends = [Instructions::Portable, Instructions::Avx2, Instructions::Avx512].map(|instructions| {
        let (simulator, truth) = opened(&model, &Path::umbmark(), Odometry::EveryTick, Phase::Random);
        let (mut simulator, mut truth) = (simulator.limited_to(instructions), truth.limited_to(instructions));
        Direction::BOTH.map(|direction| simulator.run(&mut truth, direction, TestKind::Bumps))
    });
    assert!(ends[0] == ends[1] && ends[0] == ends[2], "{ends:?}");
}
