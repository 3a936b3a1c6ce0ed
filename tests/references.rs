//! References that tell less than poses: they give what poses give, as far as they can.

use std::io::Write;
use std::path::Path;
use umbmark_core::dataset::Dataset;
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::evidence::{Estimate, Fit, fit};
use umbmark_core::geometry::{Pose2, wrap};
use umbmark_core::path::{self, SQUARE, SpeedProfile};
use umbmark_core::random::Stream;
use umbmark_core::run::TickLog;
use umbmark_core::simulate::record_test;
use umbmark_io::Existing;

/// Squares of OptiOdom (Sousa et al. 2022) of both sizes, or a notice that they are not there.
fn squares() -> Vec<Dataset> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/optiodom/raw/square");
    if !folder.is_dir() {
        // Past the harness, which keeps what a passing test prints to itself.
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", folder.display());
        return Vec::new();
    }
    ["230620202042", "230620202317", "231220200029"].map(|set| umbmark_io::load(folder.join(set)).unwrap()).into()
}

/// `runs` squares of 2 m each way of a robot of this model, watched at 20 Hz.
fn watched(model: &Model, runs: usize, seed: u64) -> Dataset {
    watched_at(model, runs, seed, 20.0)
}

/// The same, watched at another rate \[Hz\].
fn watched_at(model: &Model, runs: usize, seed: u64, rate: f64) -> Dataset {
    let path = path::Path::new(&SQUARE, &[2.0], SpeedProfile::default()).unwrap();
    record_test(model, &path, &[TestKind::Systematic], [runs, runs], rate, [seed, 0]).unwrap()
}

fn logs(data: &mut Dataset) -> impl Iterator<Item = &mut TickLog> {
    data.runs.iter_mut().filter_map(|run| run.log.as_mut())
}

/// The dataset as it is read from files, with the rows of each log written anew: `columns` names what stands behind the counts, and `cells` says
/// it of a sample; with a marks.csv, where one is given.
fn rewritten(
    data: &Dataset,
    marks: Option<&str>,
    columns: &str,
    mut cells: impl FnMut(&TickLog, usize) -> String,
) -> Dataset {
    let mut bare = data.clone();
    bare.runs.iter_mut().for_each(|run| run.returned = None);
    logs(&mut bare).for_each(|log| log.reference.clear());
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("data");
    umbmark_io::save(&bare, &place, Existing::Keep).unwrap();
    if let Some(marks) = marks {
        std::fs::write(place.join("marks.csv"), marks).unwrap();
    }
    for run in &data.runs {
        let log = run.log.as_ref().unwrap();
        let mut text = format!("t_s,ticks_left,ticks_right,{columns}\n");
        for (sample, time) in log.time.iter().enumerate() {
            let (left, right) = (log.left[sample], log.right[sample]);
            text += &format!("{time},{left},{right},{}\n", cells(log, sample));
        }
        let name = format!("{}_{:02}.csv", run.direction.unwrap().name(), run.number);
        std::fs::write(place.join("runs").join(name), text).unwrap();
    }
    umbmark_io::load(&place).unwrap()
}

/// The dataset with positions only, each run measured in the frame of another room.
fn positions_in_rooms(data: &Dataset) -> Dataset {
    let mut stream = Stream::new(3, 0, 0);
    positions(data, || Pose2::new(4.0 + stream.normal(), -3.0 + stream.normal(), 6.0 * stream.uniform()))
}

/// The same, each run in the frame of the next room.
fn positions(data: &Dataset, mut next_room: impl FnMut() -> Pose2) -> Dataset {
    let mut room = Pose2::IDENTITY;
    rewritten(data, None, "x_ref_m,y_ref_m", |log, sample| {
        if sample == 0 {
            room = next_room();
        }
        let seen = log.reference.binary_search_by_key(&sample, |pose| pose.sample).map(|found| log.reference[found]);
        seen.map_or(",".into(), |pose| {
            let at = room.compose(&Pose2::new(pose.x, pose.y, 0.0));
            format!("{},{}", at.x, at.y)
        })
    })
}

/// The dataset with nothing but a gyro that has this noise of its heading \[deg/√s\], a rate of its own of 0.5 deg/s that is another one in
/// each run by so much \[deg/s\], and that grows by 0.05 deg/s in a minute.
fn gyro(data: &Dataset, (noise, apart): (f64, f64), seed: u64) -> Dataset {
    let mut stream = Stream::new(seed, 1, 0);
    let mut own = 0.0;
    rewritten(data, None, "gyro_deg_s", |log, sample| {
        let poses = &log.reference;
        let Ok(found) = poses.binary_search_by_key(&sample, |pose| pose.sample) else { return String::new() };
        if found == 0 {
            own = 0.5 + apart * stream.normal();
        }
        // The mean rate since the reading before, as of an instrument that adds up.
        let (before, after) = (poses[found.saturating_sub(1)], poses[found.max(1)]);
        let seconds = log.time[after.sample] - log.time[before.sample];
        let turned = wrap(after.heading.unwrap() - before.heading.unwrap()).to_degrees();
        let drift = 0.05 * log.time[sample] / 60.0;
        format!("{:.5}", turned / seconds + own + drift + noise * stream.normal() / seconds.sqrt())
    })
}

/// A model of E_d, E_b, E_s and these effects, all free.
fn asked(robot: &Robot, others: &[&str]) -> Model {
    let mut model = Model::new(robot);
    for effect in ["wheel_diameter_ratio", "wheelbase", "scale"].iter().chain(others) {
        model.add(effect).unwrap().free = true;
    }
    model
}

fn of<'a>(fit: &'a Fit, parameter: &str) -> &'a Estimate {
    fit.estimates.iter().find(|estimate| estimate.parameter == parameter).unwrap()
}

/// Effect, parameter and value.
type Number = (&'static str, &'static str, f64);

const RATIOS: [Number; 3] =
    [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("scale", "e_s", 1.003)];

/// A robot with these ratios, with noisy wheels, and with what else is given.
fn rough(others: &[Number]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in RATIOS.iter().chain(&[("wheel_noise", "k_sqrt_m", 6e-4)]).chain(others) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

/// Whether the interval of 95 % misses the true value.
fn misses(found: &Fit, (_, parameter, value): &Number) -> bool {
    !of(found, parameter).interval(0.95).unwrap().contains(*value)
}

#[test]
fn positions_alone_of_real_squares_give_the_ratios_of_whole_poses_in_intervals_at_most_half_as_long_again() {
    for poses in squares() {
        let positions = positions_in_rooms(&poses);
        assert!(
            positions.runs.iter().flat_map(|run| &run.log).all(|log| log.reference.iter().all(|p| p.heading.is_none()))
        );
        let [whole, part] =
            [&poses, &positions].map(|data| fit(data, &asked(data.robot.as_ref().unwrap(), &[])).unwrap());
        for parameter in ["e_d", "e_b", "e_s"] {
            let (whole, part) = (of(&whole, parameter), of(&part, parameter));
            let apart = (part.value - whole.value).abs();
            let both = libm::hypot(part.standard_error, whole.standard_error);
            assert!(apart < 2.0 * both, "{parameter}: {part:?} {whole:?}");
            assert!(part.standard_error < 1.5 * whole.standard_error, "{parameter}: {part:?} {whole:?}");
        }
    }
}

/// 40 sets of 3 + 3 squares, seeds 0 to 39: of 200 intervals of two standard errors, 20 or more miss the truth with a probability below 0.1 %
/// if these are right (binomial), and so do 2 or fewer. The intervals of 95 % are longer, by Student's t of five degrees of freedom.
#[test]
fn a_marker_off_the_axle_that_shows_positions_only_gives_ratios_and_lever_arm_in_intervals_that_hold() {
    let robot = Robot::labmate();
    let marker = [("marker_offset", "forward_m", 0.12), ("marker_offset", "left_m", -0.05)];
    let model = rough(&[&marker[..], &[("reference_noise", "position_sd_m", 2e-3)]].concat());
    let truth = [&RATIOS[..], &marker].concat();
    let (mut missed, mut beyond) = (Vec::new(), Vec::new());
    for seed in 0..40 {
        let data = positions_in_rooms(&watched(&model, 3, seed));
        let found = fit(&data, &asked(&robot, &["marker_offset"])).unwrap();
        let is_beyond = |(_, parameter, value): &&Number| {
            let own = of(&found, parameter);
            (own.value - value).abs() > 1.96 * own.standard_error
        };
        beyond.extend(truth.iter().filter(is_beyond).map(|(_, parameter, _)| (seed, *parameter)));
        missed.extend(truth.iter().filter(|number| misses(&found, number)).map(|(_, parameter, _)| (seed, *parameter)));
    }
    assert!((3..20).contains(&beyond.len()) && missed.len() < 20, "{beyond:?} {missed:?}");
}

#[test]
fn a_robot_that_is_driven_from_mark_to_mark_unwatched_gives_the_exact_fit_of_its_returns() {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    for (effect, parameter, value) in
        [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("wheel_noise", "k_sqrt_m", 4e-4)]
    {
        model.set(effect, parameter, value).unwrap();
    }
    let mut data = watched(&model, 5, 7);
    // A mark at each place where a run ends, and one where all begin.
    let mut marks = "mark,x_m,y_m,theta_rad\nSTART,0,0,0\n".to_owned();
    for (index, run) in data.runs.iter_mut().enumerate() {
        let (log, error) = (run.log.as_mut().unwrap(), run.returned.unwrap());
        let computed = umbmark_core::run::dead_reckoning::computed_poses(log, &robot).pop().unwrap();
        let (x, y, heading) = (computed.x + error.x, computed.y + error.y, computed.heading + error.heading.unwrap());
        marks += &format!("end {index},{x},{y},{heading}\n");
        log.reference.clear();
    }
    let mut run = 0;
    let marked = rewritten(&data, Some(&marks), "mark", |log, sample| match sample {
        0 => "START".into(),
        _ if sample + 1 == log.time.len() => {
            run += 1;
            format!("end {}", run - 1)
        }
        _ => String::new(),
    });
    let mut asked = Model::new(&robot);
    ["wheel_diameter_ratio", "wheelbase"].iter().for_each(|effect| asked.add(effect).unwrap().free = true);
    let [by_returns, by_marks] = [&data, &marked].map(|data| fit(data, &asked).unwrap());
    for (parameter, truth) in [("e_d", 1.002), ("e_b", 0.99)] {
        let (returns, marks) = (of(&by_returns, parameter), of(&by_marks, parameter));
        assert!((returns.value - marks.value).abs() < 1e-9, "{returns:?} {marks:?}");
        assert!((returns.standard_error / marks.standard_error - 1.0).abs() < 1e-6, "{returns:?} {marks:?}");
        assert!((marks.value - truth).abs() < 4.0 * marks.standard_error, "{marks:?}");
    }
}

#[test]
fn a_robot_that_is_put_back_on_its_mark_is_as_far_off_as_its_odometry_is_from_start() {
    let data = watched(&rough(&[]), 2, 3);
    let put_back = rewritten(&data, None, "closed", |log, sample| match sample {
        0 => "1".into(),
        _ if sample + 1 == log.time.len() => "1".into(),
        _ => if sample % 2 == 0 { "0" } else { "" }.into(),
    });
    assert_eq!(put_back.runs.len(), data.runs.len());
    for run in &put_back.runs {
        let (log, error) = (run.log.as_ref().unwrap(), run.returned.unwrap());
        let computed = umbmark_core::run::dead_reckoning::computed_poses(log, &Robot::labmate()).pop().unwrap();
        let heading = wrap(-computed.heading);
        assert!((error.x + computed.x).abs() < 1e-12 && (error.y + computed.y).abs() < 1e-12, "{error:?} {computed:?}");
        assert!((error.heading.unwrap() - heading).abs() < 1e-9 && computed.x.hypot(computed.y) < 0.2, "{error:?}");
    }
    assert!(put_back.inspect().checks.iter().all(|check| check.name != "reference"));
}

/// The dataset with nothing but what a scan matcher tells twice a second: the motion of a sensor since it last looked, to 0.5 mm and 0.5 mrad,
/// and every fiftieth time anything at all.
fn steps(data: &Dataset, mount: &Pose2, seed: u64) -> Dataset {
    let mut stream = Stream::new(seed, 0, 0);
    let mut before: Option<(f64, Pose2)> = None;
    rewritten(data, None, "dx_rel_m,dy_rel_m,dtheta_rel_rad", |log, sample| {
        if sample == 0 {
            before = None;
        }
        let Ok(found) = log.reference.binary_search_by_key(&sample, |pose| pose.sample) else { return ",,".into() };
        let (pose, time) = (log.reference[found], log.time[sample]);
        let Some(heading) = pose.heading.filter(|_| before.is_none_or(|(at, _)| time - at > 0.49)) else {
            return ",,".into();
        };
        let now = Pose2::new(pose.x, pose.y, heading).compose(mount);
        let step = before.map_or(Pose2::IDENTITY, |(_, before)| before.between(&now));
        before = Some((time, now));
        let wild = if stream.uniform() < 0.02 { 1.0 } else { 0.0 };
        let mut noisy = |value: f64, sd: f64, most: f64| {
            value + sd * stream.normal() + wild * most * (2.0 * stream.uniform() - 1.0)
        };
        let (x, y, turned) = (noisy(step.x, 5e-4, 0.2), noisy(step.y, 5e-4, 0.2), noisy(step.heading, 5e-4, 0.3));
        format!("{x},{y},{turned}")
    })
}

#[test]
fn steps_of_a_sensor_that_fails_every_fiftieth_time_give_the_ratios_of_whole_poses() {
    for (seed, poses) in squares().iter().enumerate() {
        let steps = steps(poses, &Pose2::new(0.06, -0.02, 0.1), seed as u64);
        assert!(
            steps.runs.iter().all(|run| run.returned.is_none() && run.log.as_ref().is_some_and(|log| log.relative))
        );
        let robot = poses.robot.as_ref().unwrap();
        let [whole, part] = [poses, &steps].map(|data| fit(data, &asked(robot, &[])).unwrap());
        let apart = |parameter: &str| (of(&whole, parameter).value - of(&part, parameter).value).abs();
        assert!(apart("e_d") < 5e-4 && apart("e_b") < 3e-3, "{:?} {:?}", whole.estimates, part.estimates);
    }
}

/// 40 sets of 3 + 3 squares, seeds 0 to 39: of 120 intervals of 95 %, 13 or more miss the truth with a probability of 0.8 % if they are
/// right (binomial), and 1 or none with one of 1.6 %.
#[test]
fn intervals_from_steps_hold_the_truth_and_the_mounting_of_the_sensor_is_found() {
    let (robot, model, truth) = (Robot::labmate(), rough(&[]), &RATIOS);
    let mount = Pose2::new(0.2, 0.05, -0.3);
    let mut missed = Vec::new();
    for seed in 0..40 {
        let data = steps(&watched(&model, 3, seed), &mount, seed);
        let found = fit(&data, &asked(&robot, &[])).unwrap();
        let mounting = found.setup.mounting.as_ref().unwrap();
        let near =
            |found: Option<umbmark_core::stats::Measured>, value: f64| (found.unwrap().value - value).abs() < 0.01;
        assert!(
            near(mounting.ahead, mount.x) && near(mounting.left, mount.y) && near(mounting.yaw, mount.heading),
            "{mounting:?}"
        );
        missed.extend(truth.iter().filter(|number| misses(&found, number)).map(|(_, parameter, _)| (seed, *parameter)));
    }
    assert!((2..13).contains(&missed.len()), "{missed:?}");
}

/// What `inspect` promises of steps is what a fit of them gives.
#[test]
fn what_steps_will_determine_is_told_before_the_fit() {
    let data = steps(&watched(&rough(&[]), 3, 1), &Pose2::IDENTITY, 1);
    let promised = data.inspect().determined;
    let found = fit(&data, &asked(&Robot::labmate(), &[])).unwrap();
    for (quantity, (_, parameter, _)) in promised.iter().zip(RATIOS) {
        let (promised, given) = (quantity.std_error.unwrap(), of(&found, parameter).standard_error);
        assert!(quantity.yes && (0.4..2.5).contains(&(promised / given)), "{quantity:?} {given}");
    }
}

/// A square with turns on the spot moves a marker on the axle nowhere in its turns: nothing but chance then says how the robot turned, and it
/// must accuse no wheel.
#[test]
fn positions_of_turns_on_the_spot_accuse_no_wheel_and_give_what_poses_give() {
    let poses = umbmark_io::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/hidden")).unwrap();
    // One room: a floor turns the robot by its heading in it.
    let positions = positions(&poses, || Pose2::IDENTITY);
    let asked = asked(poses.robot.as_ref().unwrap(), &["floor_slope_yaw"]);
    let [whole, part] = [&poses, &positions].map(|data| fit(data, &asked).unwrap());
    for parameter in ["e_d", "e_b", "e_s"] {
        let (whole, part) = (of(&whole, parameter), of(&part, parameter));
        let both = libm::hypot(part.standard_error, whole.standard_error);
        assert!((part.value - whole.value).abs() < 2.5 * both, "{parameter}: {part:?} {whole:?}");
        assert!(part.standard_error < 2.0 * whole.standard_error, "{parameter}: {part:?} {whole:?}");
    }
}

/// By headings, E_b is that for E_s = 1: what poses say of E_b over what they say of E_s.
#[test]
fn a_gyro_with_a_rate_of_its_own_and_drift_gives_the_ratios_of_whole_poses_on_real_squares() {
    for poses in squares() {
        let robot = poses.robot.as_ref().unwrap();
        let gyro = gyro(&poses, (0.02, 0.02), 5);
        let logs = || gyro.runs.iter().flat_map(|run| &run.log);
        assert!(logs().all(|log| log.headings_only && log.relative && log.reference.len() > 100));
        let mut turns = Model::new(robot);
        ["wheel_diameter_ratio", "wheelbase"].iter().for_each(|effect| turns.add(effect).unwrap().free = true);
        let (whole, part) = (fit(&poses, &asked(robot, &[])).unwrap(), fit(&gyro, &turns).unwrap());
        let expected = of(&whole, "e_b").value / of(&whole, "e_s").value;
        let (e_b, e_d) = (of(&part, "e_b"), of(&part, "e_d"));
        assert!((e_b.value / expected - 1.0).abs() < 3e-3, "{e_b:?} {expected}");
        let apart = |part: &Estimate, value: f64, whole: &Estimate| {
            (part.value - value).abs() / libm::hypot(part.standard_error, whole.standard_error)
        };
        assert!(apart(e_b, expected, of(&whole, "e_b")) < 3.0, "{e_b:?} {expected}");
        assert!(apart(e_d, of(&whole, "e_d").value, of(&whole, "e_d")) < 3.0, "{e_d:?} {:?}", of(&whole, "e_d"));
    }
}

/// 40 sets of 3 + 3 squares, seeds 0 to 39: of 80 intervals of two standard errors, 12 or more miss the truth with a probability below 0.1 %
/// if these are right (binomial).
#[test]
fn a_gyro_gives_ratios_in_intervals_that_hold() {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    let truth = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99)];
    for (effect, parameter, value) in truth.iter().chain(&[("wheel_noise", "k_sqrt_m", 6e-4)]) {
        model.set(effect, parameter, *value).unwrap();
    }
    let mut turns = Model::new(&robot);
    truth.iter().for_each(|(effect, ..)| turns.add(effect).unwrap().free = true);
    let mut beyond = Vec::new();
    for seed in 0..40 {
        let found = fit(
            &gyro(&watched_at(&model, 3, seed, 100.0), (0.1, if seed % 2 == 0 { 0.02 } else { 0.5 }), seed),
            &turns,
        )
        .unwrap();
        let is_beyond = |(_, parameter, value): &&Number| {
            let own = of(&found, parameter);
            (own.value - value).abs() > 1.96 * own.standard_error
        };
        beyond.extend(truth.iter().filter(is_beyond).map(|(_, parameter, _)| (seed, *parameter)));
    }
    assert!(beyond.len() < 12, "{beyond:?}");
}

/// A heading that turns against the counts may be the gyro's fault or the wheels'.
#[test]
fn a_gyro_that_turns_against_the_counts_accuses_nobody_and_says_what_may_be() {
    let mut data = gyro(&watched(&rough(&[]), 3, 2), (0.1, 0.1), 2);
    logs(&mut data).for_each(|log| std::mem::swap(&mut log.left, &mut log.right));
    let error = fit(&data, &asked(&Robot::labmate(), &[])).unwrap_err().to_string();
    assert!(error.contains("turns opposite to the counts") && error.contains("heading_clockwise"), "{error}");
    assert!(error.contains("wheels_exchanged"), "{error}");
}

/// A decoder that counts every second edge of one wheel: a robot with such wheels fits the log, and none is built.
#[test]
fn one_wheel_with_half_its_counts_is_named() {
    let mut data = watched(&rough(&[]), 3, 2);
    assert!(umbmark_core::setup::Setup::of(&data.runs, &Robot::labmate(), None).faults.is_empty());
    logs(&mut data).for_each(|log| log.right.iter_mut().for_each(|count| *count = (0.5 * *count).floor()));
    let setup = umbmark_core::setup::Setup::of(&data.runs, &Robot::labmate(), None);
    assert_eq!(setup.faults, [umbmark_core::setup::Fault::OneCounter { name: "right", factor: 2.0 }]);
    let refused = fit(&data, &asked(&Robot::labmate(), &[])).unwrap_err().to_string();
    assert!(refused.contains("multiply ticks_right by 2") && refused.contains("wheel_diameter_left_m"), "{refused}");
    let learnt = umbmark_core::learn::learn(&data, &Default::default()).unwrap();
    assert_eq!(learnt.diagnosis.verdict, umbmark_core::diagnose::Verdict::NotExplained);
}

/// Wheels as no robot has them, which are no factor of a decoder.
#[test]
fn one_wheel_with_a_third_of_its_counts_is_doubted() {
    let mut data = watched(&rough(&[]), 3, 2);
    logs(&mut data).for_each(|log| log.right.iter_mut().for_each(|count| *count = (*count / 3.0).floor()));
    let setup = umbmark_core::setup::Setup::of(&data.runs, &Robot::labmate(), None);
    assert!(
        matches!(setup.doubts[..], [umbmark_core::setup::Suspicion::UnequalWheels { ratio }] if (ratio - 3.0).abs() < 0.1),
        "{:?} {:?}",
        setup.doubts,
        setup.faults
    );
    assert!(setup.doubts[0].forbids_writing() && setup.doubts[0].sentence().contains("wheel_diameter_left_m"));
}

/// Counts of a decoder that counts every fourth edge: wheelbase or wheels are wrong, and headings do not say which.
#[test]
fn headings_that_turn_a_quarter_as_far_as_the_wheels_are_doubted() {
    let mut data = gyro(&watched(&rough(&[]), 3, 2), (0.1, 0.1), 2);
    let mut robot = data.robot.clone().unwrap();
    robot.encoder = umbmark_core::drive::Encoder::new(robot.encoder.ticks_per_revolution() / 4.0, None, None).unwrap();
    let setup = umbmark_core::setup::Setup::of(&data.runs, &robot, None);
    assert!(
        matches!(setup.doubts[..], [umbmark_core::setup::Suspicion::OtherTurns { ratio }] if (ratio - 0.25).abs() < 0.02)
    );
    assert!(setup.doubts[0].forbids_writing() && setup.doubts[0].sentence().contains("ticks_per_revolution"));
    data.robot = Some(robot);
    let learnt = umbmark_core::learn::learn(&data, &Default::default()).unwrap();
    assert_eq!(learnt.diagnosis.verdict, umbmark_core::diagnose::Verdict::NotExplained);
}

#[test]
fn a_gyro_is_written_as_headings_that_drift_and_read_back_as_it_was() {
    let data = gyro(&watched(&rough(&[]), 2, 3), (0.1, 0.1), 3);
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("data");
    umbmark_io::save(&data, &place, Existing::Keep).unwrap();
    let read = umbmark_io::load(&place).unwrap();
    for (a, b) in data.runs.iter().zip(&read.runs) {
        let (a, b) = (a.log.as_ref().unwrap(), b.log.as_ref().unwrap());
        assert!(a.reference == b.reference && b.headings_only && b.relative);
    }
}

/// Wheels that follow late, and a reference that is early by as much, smooth the counts: they fit the steps of a quiet sensor better, and are not
/// there.
#[test]
fn steps_of_a_quiet_sensor_do_not_make_the_wheels_late() {
    let mut robot = Robot::labmate();
    robot.encoder = umbmark_core::drive::Encoder::new(300.0, None, None).unwrap();
    let mut model = Model::new(&robot);
    for (effect, parameter, value) in RATIOS.iter().chain(&[("wheel_noise", "k_sqrt_m", 4e-4)]) {
        model.set(effect, parameter, *value).unwrap();
    }
    let mut data = watched(&model, 3, 4);
    logs(&mut data).for_each(|log| log.relative = true);
    let learnt = umbmark_core::learn::learn(&data, &Default::default()).unwrap();
    assert_eq!(learnt.model.get("wheel_lag", "share"), None, "{:?}", learnt.steps);
}

/// The positions of a compass follow from the counts, so no fit of positions is offered.
#[test]
fn a_compass_gives_no_fit_of_positions_that_follow_from_counts() {
    let data = rewritten(&watched(&rough(&[]), 3, 2), None, "theta_ref_rad", |log, sample| {
        let found = log.reference.binary_search_by_key(&sample, |pose| pose.sample);
        found.map_or(String::new(), |pose| log.reference[pose].heading.unwrap().to_string())
    });
    assert!(data.runs.iter().all(|run| run.log.as_ref().is_some_and(|log| log.headings_only && !log.relative)));
    let calibration = umbmark_core::calibrate::calibrate(&data, &Default::default());
    assert!(calibration.is_err(), "{:?}", calibration.map(|found| found.estimates));
}
