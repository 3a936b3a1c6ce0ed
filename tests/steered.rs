//! Steered drives on the floor of a simulator that knows nothing of the crates: points that roll, stepped by the millisecond.
//!
//! A wheel touches the floor at a point of the body, rolls along its own direction and does not move across it. The twist of the
//! body is the one that all wheels of a robot allow, found by elimination. What is logged goes through files, as other people's does.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::path::Path;
use umbmark_core::diagnose::{Options, Verdict};
use umbmark_core::learn::{calibrate_gears, learn};

/// A wheel: its place on the body \[m\], where it points from the body's heading \[rad\], and how fast it rolls, where that is known.
struct Rolling {
    at: [f64; 2],
    points: f64,
    speed: Option<f64>,
}

/// The twist (ahead, left, turn) that these wheels allow: two conditions a wheel, across (no slip) and along (its speed).
fn twist(wheels: &[Rolling]) -> [f64; 3] {
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for wheel in wheels {
        let (s, c) = wheel.points.sin_cos();
        let [x, y] = wheel.at;
        // The contact point moves by (u - ω y, v + ω x).
        rows.push([-s, c, s * y + c * x, 0.0]);
        rows.extend(wheel.speed.map(|speed| [c, s, s * x - c * y, speed]));
    }
    for column in 0..3 {
        let pivot =
            (column..rows.len()).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs())).unwrap();
        rows.swap(column, pivot);
        let lead = rows[column];
        for (_, row) in rows.iter_mut().enumerate().filter(|(index, _)| *index != column) {
            let times = row[column] / lead[column];
            row.iter_mut().zip(lead).for_each(|(value, own)| *value -= times * own);
        }
    }
    // Wheels that one motion cannot serve would leave a condition that fails.
    assert!(rows[3..].iter().all(|row| row[3].abs() < 1e-9), "{rows:?}");
    [0, 1, 2].map(|k| rows[k][3] / rows[k][k])
}

/// What a driver does at a time: rate of the counted wheel \[m/s, as believed\] and angle of the steering \[rad, as believed\].
type Command = fn(run: u32, time: f64) -> (f64, f64);

/// One robot as it truly is: its twist for a true rate and steering, how fast its course turns beside its body, and true over
/// believed rate and steering.
struct Truth {
    twist: fn(rate: f64, steering: f64) -> [f64; 3],
    rate: f64,
    steering: fn(believed: f64) -> f64,
    /// Whether the steering turns the course, whose heading is measured, and not the body (synchro).
    course: fn(steering: f64, driven: f64) -> Option<f64>,
}

/// Noise of the reference: the sum of twelve numbers of a linear congruential generator.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn normal(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

const DT: f64 = 1e-3;
const PER_REVOLUTION: f64 = 20_000.0;
const STEERING: f64 = 60_000.0;
const DIAMETER: f64 = 0.15;

/// Rows of a log at 50 Hz, each with the pose: whole counts of the drive and of the steering.
fn log(truth: &Truth, command: Command, run: u32, seconds: f64) -> String {
    let mut text = String::from("t_s,ticks_drive,ticks_steering,x_ref_m,y_ref_m,theta_ref_rad\n");
    let mut chance = Chance(u64::from(run) + 1);
    let ([mut x, mut y, mut heading], mut believed, mut driven) = ([0.0_f64; 3], 0.0, 0.0);
    for step in 0..=(seconds / DT) as u32 {
        let time = f64::from(step) * DT;
        let (_, steering) = command(run, time);
        if step % 20 == 0 {
            let counts = (believed / (PI * DIAMETER) * PER_REVOLUTION).floor();
            let angle = (steering / TAU * STEERING).round();
            let seen = heading + (truth.course)((truth.steering)(steering), driven).unwrap_or(0.0);
            // A reference of 1 mm and 1 mrad.
            let [e, f, g] = [0, 1, 2].map(|_| 1e-3 * chance.normal());
            writeln!(text, "{time:.3},{counts},{angle},{:.7},{:.7},{:.7}", x + e, y + f, seen + g).unwrap();
        }
        // The middle of the step: second order.
        let (rate, steered) = command(run, time + 0.5 * DT);
        let [ahead, left, turn] = (truth.twist)(rate * truth.rate, (truth.steering)(steered));
        let course = heading + 0.5 * turn * DT + (truth.course)((truth.steering)(steered), driven).unwrap_or(0.0);
        x += DT * (ahead * course.cos() - left * course.sin());
        y += DT * (ahead * course.sin() + left * course.cos());
        heading += turn * DT;
        believed += rate * DT;
        driven += rate * truth.rate * DT;
    }
    text
}

/// A data set on disk of eight runs.
fn write(folder: &Path, robot: &str, truth: &Truth, command: Command) {
    std::fs::create_dir_all(folder.join("runs")).unwrap();
    let robot = format!(
        "[robot]\nname = \"own\"\n{robot}\nticks_per_revolution = {PER_REVOLUTION}\nsteering_ticks_per_revolution = {STEERING}\n"
    );
    std::fs::write(folder.join("robot.toml"), robot).unwrap();
    for run in 0..8 {
        let text = log(truth, command, run, 45.0 + f64::from(run));
        std::fs::write(folder.join(format!("runs/none_{:02}.csv", run + 1)), text).unwrap();
    }
}

/// Ramps up, drives, and rests at the end, so that nothing is asked of the clocks.
fn paced(run: u32, time: f64, speed: f64) -> f64 {
    let until = 43.0 + f64::from(run);
    speed * ((time - 1.0).min(until - time) / 2.0).clamp(0.0, 1.0)
}

/// Swings of the steering while it drives, wide and narrow, left first in even runs.
fn swings(run: u32, time: f64, most: f64) -> f64 {
    let side = if run.is_multiple_of(2) { 1.0 } else { -1.0 };
    let period = 9.0 + 1.7 * f64::from(run % 5);
    side * most * (TAU * time / period).sin() * (0.4 + 0.6 * (time / 31.0).sin().powi(2))
}

/// What is found of a robot must be what it was made of, and nothing besides.
fn finds(robot: &str, truth: &Truth, command: Command, hidden: [(&str, &str, f64, f64); 3]) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), robot, truth, command);
    let data = umbmark_io::load(folder.path()).unwrap();
    let found = calibrate_gears(&data).unwrap();
    for (effect, parameter, value, tolerance) in hidden {
        let estimate = found.model.get(effect, parameter).unwrap_or(f64::NAN);
        assert!((estimate - value).abs() < tolerance, "{robot}: {effect} {estimate}, not {value}");
    }
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let story: Vec<_> = learnt.steps.iter().map(|step| (step.added, step.held_out)).collect();
    let off = learnt.steps.last().unwrap().held_out.position;
    assert!(off < 3e-3, "{robot}: {story:?} {:?}", learnt.verdict);
    assert_eq!(learnt.verdict, Verdict::Explained, "{robot}: {story:?} {:?}", learnt.remarks);
}

/// Two rear wheels and a front wheel: the rear ones roll freely, and the front one is driven, at any angle and on the spot.
#[test]
fn a_tricycle_that_turns_about_its_axle_is_read_as_it_was_made() {
    fn allowed(rate: f64, steering: f64) -> [f64; 3] {
        twist(&[
            Rolling { at: [0.0, 0.2], points: 0.0, speed: None },
            Rolling { at: [0.0, -0.2], points: 0.0, speed: None },
            Rolling { at: [0.5 * 1.01, 0.0], points: steering, speed: Some(rate) },
        ])
    }
    fn command(run: u32, time: f64) -> (f64, f64) {
        let side = if run.is_multiple_of(2) { 1.0 } else { -1.0 };
        let speed = paced(run, time, 0.2);
        // From 15 to 19 s and from 27 to 31 s it stands, steered by a right angle, and turns on the spot; 1 s to steer before and after.
        for begin in [15.0, 27.0] {
            let within = time - begin;
            if (-2.0..6.0).contains(&within) {
                let steered = side * FRAC_PI_2 * (within + 1.0).min(5.0 - within).clamp(0.0, 1.0);
                let moving =
                    if (0.0..4.0).contains(&within) { 0.15 * (within.min(4.0 - within) / 0.5).min(1.0) } else { 0.0 };
                let driving = if within < -1.0 { -1.0 - within } else { (within - 5.0).max(0.0) };
                return (moving + speed * driving, steered);
            }
        }
        let shut = if !(13.0..=33.0).contains(&time) { 0.5 * swings(run, time, 1.2) } else { 0.0 };
        // The steering passes through zero at the joints.
        let joint = ((time - 13.0).abs().min((time - 33.0).abs())).min(1.0);
        (speed, shut * joint)
    }
    let truth = Truth { twist: allowed, rate: 1.004, steering: |believed| believed + 6e-3, course: |_, _| None };
    let robot = "drive = \"tricycle\"\naxle_distance_m = 0.5\ntrack_width_m = 0.4\nwheel_diameter_m = 0.15";
    let hidden = [
        ("front_wheel_zero", "angle_rad", 6e-3, 2e-4),
        ("axle_distance", "ratio", 1.01, 1e-3),
        ("scale", "e_s", 1.004, 5e-4),
    ];
    finds(robot, &truth, command, hidden);
}

/// Two driven rear wheels, which a differential lets roll as they like about their mean, and a steered one before them.
#[test]
fn a_car_that_steers_while_it_drives_is_read_as_it_was_made() {
    fn allowed(rate: f64, steering: f64) -> [f64; 3] {
        twist(&[
            Rolling { at: [0.0, 0.0], points: 0.0, speed: Some(rate) },
            Rolling { at: [0.5, 0.0], points: steering, speed: None },
        ])
    }
    let truth =
        Truth { twist: allowed, rate: 0.996, steering: |believed| 1.008 * (believed - 4e-3), course: |_, _| None };
    let robot = "drive = \"ackermann\"\naxle_distance_m = 0.5\ntrack_width_m = 0.4\nwheel_diameter_m = 0.15";
    let hidden = [
        ("steering_zero", "angle_rad", -4e-3, 2e-4),
        ("steering_gain", "share", 8e-3, 1e-3),
        ("scale", "e_s", 0.996, 5e-4),
    ];
    finds(robot, &truth, |run, time| (paced(run, time, 0.25), swings(run, time, 1.1)), hidden);
}

/// Three wheels that point alike and roll alike; the body keeps its heading, and the turret shows the course.
#[test]
fn a_synchro_drive_that_steers_while_it_drives_is_read_as_it_was_made() {
    fn allowed(rate: f64, _: f64) -> [f64; 3] {
        let wheel =
            |angle: f64| Rolling { at: [0.25 * angle.cos(), 0.25 * angle.sin()], points: 0.0, speed: Some(rate) };
        twist(&[wheel(0.0), wheel(2.1), wheel(4.2)])
    }
    let truth = Truth {
        twist: allowed,
        rate: 1.003,
        steering: |believed| 1.005 * believed,
        course: |steering, driven| Some(steering + 2e-3 * driven),
    };
    let robot = "drive = \"synchro\"\nwheel_circle_m = 0.5\nwheel_diameter_m = 0.15";
    let hidden = [
        ("steer_coupling", "rad_per_m", 2e-3, 2e-4),
        ("steer_scale", "ratio", 1.005, 5e-4),
        ("drive_scale", "e_s", 1.003, 5e-4),
    ];
    finds(robot, &truth, |run, time| (paced(run, time, 0.25), swings(run, time, 3.0)), hidden);
}
