//! Bases on wheels with rollers, on the floor of a simulator that knows nothing of the crates: rollers that do not slip along their axes.
//!
//! The driver gives the twist of the body. The rim of each wheel moves so that the lowest roller rolls across its own axis only; its counter
//! counts that by the wheel's true size. What is logged goes through files, as other people's does.

use crate::steered::Chance;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::fmt::Write;
use umbmark_core::diagnose::{Options, Verdict};
use umbmark_core::learn::learn;

/// A wheel as it truly is: its place \[m\], the direction in which it rolls and that of the axis of its lowest roller \[rad\], its diameter \[m\].
struct Wheel {
    at: [f64; 2],
    rolls: f64,
    axis: f64,
    diameter: f64,
}

impl Wheel {
    /// Speed of the rim for a twist of the body: what is left along the axis of the roller is nothing.
    fn rim(&self, [ahead, left, turn]: [f64; 3]) -> f64 {
        let place = [ahead - turn * self.at[1], left + turn * self.at[0]];
        let (sine, cosine) = self.axis.sin_cos();
        (place[0] * cosine + place[1] * sine) / (self.rolls - self.axis).cos()
    }
}

const DT: f64 = 1e-3;
/// Half the nominal sum of both distances of the mecanum wheels \[m\].
const ARM: f64 = 0.325;
const PER_REVOLUTION: f64 = 20_000.0;

/// Twists of a run: swings ahead, sideways and round with periods that have nothing to do with each other, between two rests.
fn twist(run: u32, time: f64) -> [f64; 3] {
    let until = 43.0 + f64::from(run);
    let pace = ((time - 1.0).min(until - time) / 2.0).clamp(0.0, 1.0);
    let swing = |most: f64, period: f64, begun: f64| most * pace * (TAU * (time / period + begun)).sin();
    let [ahead, left, round] = [13.0, 9.1, 7.3].map(|period| period + 0.7 * f64::from(run % 5));
    [swing(0.2, ahead, 0.1 * f64::from(run)), swing(0.2, left, 0.3), swing(0.6, round, 0.05 * f64::from(run))]
}

/// Rows of a log at 50 Hz, each with the pose. Of a turn, this share is lost on the way to the side.
fn log(wheels: &[Wheel], run: u32, lost: f64) -> String {
    let mut text = String::from("t_s");
    (1..=wheels.len()).for_each(|wheel| write!(text, ",ticks_{wheel}").unwrap());
    text += ",x_ref_m,y_ref_m,theta_ref_rad\n";
    let mut chance = Chance(u64::from(run) + 1);
    let ([mut x, mut y, mut heading], mut rolled) = ([0.0_f64; 3], vec![0.0; wheels.len()]);
    for step in 0..=((45.0 + f64::from(run)) / DT) as u32 {
        let time = f64::from(step) * DT;
        if step % 20 == 0 {
            write!(text, "{time:.3}").unwrap();
            for (wheel, way) in wheels.iter().zip(&rolled) {
                write!(text, ",{}", (way / (PI * wheel.diameter) * PER_REVOLUTION).floor()).unwrap();
            }
            let [e, f, g] = [0, 1, 2].map(|_| 1e-3 * chance.normal());
            writeln!(text, ",{:.7},{:.7},{:.7}", x + e, y + f, heading + g).unwrap();
        }
        // The middle of the step: second order.
        let commanded = twist(run, time + 0.5 * DT);
        let [ahead, left, turn] = commanded;
        let sideways = left.abs() / (left.abs() + ARM * turn.abs()).max(1e-12);
        let moved = [ahead, left, turn * (1.0 - lost * sideways)];
        let course = heading + 0.5 * moved[2] * DT;
        x += DT * (moved[0] * course.cos() - moved[1] * course.sin());
        y += DT * (moved[0] * course.sin() + moved[1] * course.cos());
        heading += moved[2] * DT;
        rolled.iter_mut().zip(wheels).for_each(|(way, wheel)| *way += wheel.rim(commanded) * DT);
    }
    text
}

/// What is learnt of a robot must be what it was made of, and nothing besides.
fn finds(robot: &str, wheels: &[Wheel], hidden: &[(&str, &str, f64, f64)]) {
    finds_with(robot, wheels, hidden, 0.0);
}

/// The same of a robot that loses this share of its turns on the way to the side.
fn finds_with(robot: &str, wheels: &[Wheel], hidden: &[(&str, &str, f64, f64)], lost: f64) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("runs")).unwrap();
    let text = format!("[robot]\nname = \"own\"\n{robot}\nticks_per_revolution = {PER_REVOLUTION}\n");
    std::fs::write(folder.path().join("robot.toml"), text).unwrap();
    for run in 0..8 {
        std::fs::write(folder.path().join(format!("runs/none_{:02}.csv", run + 1)), log(wheels, run, lost)).unwrap();
    }
    let data = umbmark_io::load(folder.path()).unwrap();
    let learnt = learn(&data, &Options { draws: 199, ..Options::default() }).unwrap();
    let story: Vec<_> = learnt.steps.iter().map(|step| (step.added, step.held_out)).collect();
    for (effect, parameter, value, tolerance) in hidden {
        let estimate = learnt.model.get(effect, parameter).unwrap_or(f64::NAN);
        assert!((estimate - value).abs() < *tolerance, "{robot}: {effect} {estimate}, not {value}: {story:?}");
    }
    assert_eq!(learnt.model.parts().len(), hidden.len(), "{story:?}");
    assert!(learnt.steps.last().unwrap().held_out.position < 3e-3, "{robot}: {story:?}");
    assert_eq!(learnt.verdict, Verdict::Explained, "{robot}: {story:?} {:?}", learnt.remarks);
}

#[test]
fn a_mecanum_base_with_four_different_wheels_is_read_as_it_was_made() {
    // Front left, front right, rear left, rear right: sides by 1.01, diagonals by 1.006, all by 1.004; D by 1.02.
    let [sides, diagonals, scale, distance] = [1.01, 1.006, 1.004, 1.02];
    let ratio = |r: f64| (r - 1.0) / (r + 1.0);
    let (s, d) = (ratio(sides), ratio(diagonals));
    let diameters = [1.0 - s + d, 1.0 + s - d, 1.0 - s - d, 1.0 + s + d].map(|size| 0.15 * scale * size);
    let corner = |ahead: f64, left: f64, diameter: f64| Wheel {
        at: [0.15 * distance * ahead, 0.175 * distance * left],
        rolls: 0.0,
        axis: -ahead * left * FRAC_PI_4,
        diameter,
    };
    let [a, b, c, e] = diameters;
    let wheels = [corner(1.0, 1.0, a), corner(1.0, -1.0, b), corner(-1.0, 1.0, c), corner(-1.0, -1.0, e)];
    let robot =
        "drive = \"mecanum\"\nwheel_distance_length_m = 0.3\nwheel_distance_width_m = 0.35\nwheel_diameter_m = 0.15";
    let hidden = [
        ("side_diameter_ratio", "ratio", sides, 3e-4),
        ("diagonal_diameter_ratio", "ratio", diagonals, 3e-4),
        ("roller_scale", "e_s", scale, 3e-4),
        ("wheelbase", "e_b", distance, 1e-3),
    ];
    finds(robot, &wheels, &hidden);
}

#[test]
fn three_omni_wheels_of_different_sizes_are_read_as_they_were_made() {
    let [fronts, rear, scale, distance] = [1.01, 0.992, 1.004, 1.02];
    let right = 2.0 / (1.0 + fronts);
    let front = 3.0 / (2.0 + rear);
    let diameters = [front * right, front * right * fronts, front * rear].map(|size| 0.10 * scale * size);
    let wheel = |from_ahead: f64, diameter: f64| Wheel {
        at: [0.2 * distance * from_ahead.cos(), 0.2 * distance * from_ahead.sin()],
        rolls: from_ahead - FRAC_PI_2,
        axis: from_ahead - FRAC_PI_2,
        diameter,
    };
    let [a, b, c] = diameters;
    let wheels = [wheel(-PI / 3.0, a), wheel(PI / 3.0, b), wheel(PI, c)];
    let robot = "drive = \"omni3\"\nwheel_distance_m = 0.2\nwheel_diameter_m = 0.10";
    let hidden = [
        ("front_diameter_ratio", "ratio", fronts, 3e-4),
        ("rear_diameter_ratio", "ratio", rear, 3e-4),
        ("roller_scale", "e_s", scale, 3e-4),
        ("wheelbase", "e_b", distance, 1e-3),
    ];
    finds(robot, &wheels, &hidden);
}

/// Both arrangements: wheels in front, behind and on both sides, and wheels at the corners.
#[test]
fn four_omni_wheels_of_different_sizes_are_read_as_they_were_made() {
    let [sides, axles, pairs, scale, distance] = [1.01, 0.992, 1.006, 1.004, 1.02];
    let share = |ratio: f64| (ratio - 1.0) / (ratio + 1.0);
    for offset in [0.0, FRAC_PI_4] {
        let most = f64::max(offset.sin(), offset.cos());
        let wheel = |k: usize| {
            let from_ahead = offset + FRAC_PI_2 * k as f64;
            let (to_the_left, ahead) = from_ahead.sin_cos();
            let pair = if k.is_multiple_of(2) { share(pairs) } else { -share(pairs) };
            let size = 1.0 - share(sides) / most * to_the_left + share(axles) / most * ahead + pair;
            Wheel {
                at: [0.2 * distance * ahead, 0.2 * distance * to_the_left],
                rolls: from_ahead - FRAC_PI_2,
                axis: from_ahead - FRAC_PI_2,
                diameter: 0.10 * scale * size,
            }
        };
        let robot =
            format!("drive = \"omni4\"\nwheel_distance_m = 0.2\nwheel_offset_rad = {offset}\nwheel_diameter_m = 0.10");
        let hidden = [
            ("omni_side_ratio", "ratio", sides, 3e-4),
            ("omni_axle_ratio", "ratio", axles, 3e-4),
            ("omni_pair_ratio", "ratio", pairs, 3e-4),
            ("roller_scale", "e_s", scale, 3e-4),
            ("wheelbase", "e_b", distance, 1e-3),
        ];
        finds(&robot, &[0, 1, 2, 3].map(wheel), &hidden);
    }
}

#[test]
fn turning_that_a_mecanum_base_loses_on_the_way_to_the_side_is_found() {
    let [sides, scale, distance, lost] = [1.01, 1.004, 1.02, 0.03];
    let share = (sides - 1.0) / (sides + 1.0);
    let corner = |ahead: f64, left: f64| Wheel {
        at: [0.15 * distance * ahead, 0.175 * distance * left],
        rolls: 0.0,
        axis: -ahead * left * FRAC_PI_4,
        diameter: 0.15 * scale * (1.0 - left * share),
    };
    let wheels = [corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)];
    let robot =
        "drive = \"mecanum\"\nwheel_distance_length_m = 0.3\nwheel_distance_width_m = 0.35\nwheel_diameter_m = 0.15";
    let hidden = [
        ("side_diameter_ratio", "ratio", sides, 3e-4),
        ("sideways_turn_slip", "share", lost, 3e-3),
        ("roller_scale", "e_s", scale, 3e-4),
        ("wheelbase", "e_b", distance, 1.5e-3),
    ];
    finds_with(robot, &wheels, &hidden, lost);
}

#[test]
fn three_tracking_wheels_are_read_as_they_were_made() {
    let [sides, across, scale, distance, ahead] = [1.01, 0.992, 1.004, 1.02, 4e-3];
    let share = (sides - 1.0) / (sides + 1.0);
    let wheel = |at: [f64; 2], rolls: f64, size: f64| Wheel { at, rolls, axis: rolls, diameter: 0.05 * scale * size };
    let half = 0.15 * distance;
    let wheels = [
        wheel([0.0, half], 0.0, 1.0 - share),
        wheel([0.0, -half], 0.0, 1.0 + share),
        wheel([-0.1 * distance + ahead, 0.0], FRAC_PI_2, across),
    ];
    let robot =
        "drive = \"dead_wheels\"\nwheel_distance_width_m = 0.3\nacross_wheel_ahead_m = -0.1\nwheel_diameter_m = 0.05";
    let hidden = [
        ("along_diameter_ratio", "ratio", sides, 3e-4),
        ("across_diameter_ratio", "ratio", across, 5e-4),
        // A wheel that stands elsewhere moves what is tracked as a tracked point does that stands elsewhere the other way.
        ("marker_offset", "forward_m", -ahead, 1e-3),
        ("roller_scale", "e_s", scale, 3e-4),
        ("wheelbase", "e_b", distance, 1e-3),
    ];
    finds(robot, &wheels, &hidden);
}
