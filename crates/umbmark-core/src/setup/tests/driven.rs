//! Drives of a robot, by the millisecond.

use super::WHEELBASE;
use crate::geometry::Pose2;
use crate::random::Stream;
use std::f64::consts::FRAC_PI_2;

/// Where the robot is at each millisecond, with the travel of both wheels.
pub(super) type Driven = Vec<(Pose2, [f64; 2])>;
/// Speed \[m/s\] and turn rate \[rad/s\] that a controller asks for.
type Speeds = [f64; 2];

/// At these speeds and turn rates, by the millisecond. Integrated by midpoints.
fn at_speeds(seconds: f64, mut speeds: impl FnMut(usize) -> Speeds) -> Driven {
    let (mut pose, mut rolled) = ([0.0; 3], [0.0; 2]);
    let step = |step: usize| {
        let driven = (Pose2::new(pose[0], pose[1], pose[2]), rolled);
        let [way, turn] = speeds(step).map(|speed| 1e-3 * speed);
        let middle = pose[2] + 0.5 * turn;
        pose = [pose[0] + way * middle.cos(), pose[1] + way * middle.sin(), pose[2] + turn];
        rolled = [rolled[0] + way - 0.5 * WHEELBASE * turn, rolled[1] + way + 0.5 * WHEELBASE * turn];
        driven
    };
    (0..(1000.0 * seconds) as usize).map(step).collect()
}

/// Speeds and turn rates follow what is asked for by 1.5 a second.
fn integrated(seconds: f64, mut asked: impl FnMut(usize) -> Speeds) -> Driven {
    let mut now = [0.0; 2];
    at_speeds(seconds, |step| {
        for (now, goal) in now.iter_mut().zip(asked(step)) {
            *now += (goal - *now).clamp(-1.5e-3, 1.5e-3);
        }
        now
    })
}

/// Every two seconds another heading is pursued on the way: a turn begins at once and fades, by a factor of e in 0.3 s.
pub(super) fn pursuing(seconds: f64, stream: &mut Stream) -> Driven {
    let mut angle = 0.0;
    at_speeds(seconds, |step| {
        let phase = step % 2000;
        if phase == 0 {
            angle = 2.4 * stream.uniform() - 1.2;
        }
        let speed = if step < 2000 { 0.0 } else { 0.4 };
        [speed, speed / 0.4 * angle / 0.3 * (-1e-3 * phase as f64 / 0.3).exp()]
    })
}

/// Straight ahead, a stop, a turn on the spot at 3 rad/s that begins and ends at once, and a stop.
pub(super) fn stop_and_turn(seconds: f64, stream: &mut Stream) -> Driven {
    let (mut leg, mut left, mut phase) = ([0.0; 2], 0, 0);
    at_speeds(seconds, |_| {
        if left == 0 {
            phase = (phase + 1) % 4;
            let side = if stream.uniform() < 0.5 { -3.0 } else { 3.0 };
            let lasts;
            (leg, lasts) = match phase {
                1 => ([0.4, 0.0], 2.0 + 2.0 * stream.uniform()),
                3 => ([0.0, side], 0.5 + 0.5 * stream.uniform()),
                _ => ([0.0, 0.0], 1.0),
            };
            left = (1000.0 * lasts) as usize;
        }
        left -= 1;
        leg
    })
}

/// The same with poses behind a first-order low-pass filter of this time constant \[s\].
pub(super) fn smoothed(mut driven: Driven, time_constant: f64) -> Driven {
    let share = if time_constant > 0.0 { 1e-3 / time_constant } else { 1.0 };
    let mut shown = driven[0].0;
    for (pose, _) in &mut driven {
        let of = |shown: f64, now: f64| shown + share * (now - shown);
        shown = Pose2::new(of(shown.x, pose.x), of(shown.y, pose.y), of(shown.heading, pose.heading));
        *pose = shown;
    }
    driven
}

/// Every two seconds another speed and turn rate, and rest for two seconds at both ends.
pub(super) fn free(seconds: f64, stream: &mut Stream) -> Driven {
    let pick = |values: &[f64], stream: &mut Stream| values[(stream.uniform() * values.len() as f64) as usize];
    let mut goal = [0.0; 2];
    integrated(seconds, |step| {
        if step % 2000 == 0 {
            let ends = step < 2000 || step as f64 >= 1000.0 * seconds - 4000.0;
            goal = [pick(&[0.0, 0.15, 0.3, 0.45], stream), pick(&[-0.5, -0.2, 0.0, 0.0, 0.2, 0.5], stream)];
            goal = if ends { [0.0; 2] } else { goal };
        }
        goal
    })
}

/// Speeds one after the other, each for so long \[s\]; `next` gives more of them.
fn in_turn(seconds: f64, mut next: impl FnMut() -> Vec<(Speeds, f64)>) -> Driven {
    let (mut legs, mut until) = (Vec::new(), 0.0);
    let mut goal = [0.0; 2];
    integrated(seconds, |step| {
        if 1e-3 * step as f64 >= until {
            if legs.is_empty() {
                legs = next();
                legs.reverse();
            }
            let (speeds, lasts) = legs.pop().unwrap();
            (goal, until) = (speeds, until + lasts);
        }
        goal
    })
}

/// Straight to a dock, a pause, straight back, and a turn on the spot.
pub(super) fn docking(seconds: f64, stream: &mut Stream) -> Driven {
    in_turn(seconds, || {
        let [way, back, turn] = [0.0; 3].map(|_| stream.uniform());
        let angle = if stream.uniform() < 0.5 { -0.6 } else { 0.6 };
        vec![
            ([0.3, 0.0], 4.0 + 3.0 * way),
            ([0.0, 0.0], 0.7),
            ([-0.2, 0.0], 4.0 + 3.0 * back),
            ([0.0, angle], 0.5 + 1.5 * turn),
        ]
    })
}

/// A little way or a turn now and then, and rest for most of the time.
pub(super) fn stopping(seconds: f64, stream: &mut Stream) -> Driven {
    in_turn(seconds, || {
        let turn = if stream.uniform() < 0.5 { -0.5 } else { 0.5 };
        vec![([0.3, 0.0], 1.5 + stream.uniform()), ([0.0, 0.0], 5.0), ([0.0, turn], 1.5), ([0.0, 0.0], 5.0)]
    })
}

/// Long legs to and fro along x, half a metre apart.
pub(super) fn lawn(seconds: f64, _: &mut Stream) -> Driven {
    let mut side = -0.6;
    in_turn(seconds, || {
        side = -side;
        let turn = ([0.0, side], FRAC_PI_2 / 0.6);
        vec![([0.4, 0.0], 12.0), ([0.0, 0.0], 0.3), turn, ([0.0, 0.0], 0.4), ([0.3, 0.0], 1.6), ([0.0, 0.0], 0.3), turn]
    })
}

/// Straight ahead and back, five seconds each.
pub(super) fn to_and_fro(seconds: f64, _: &mut Stream) -> Driven {
    integrated(seconds, |step| [if step % 10_000 < 5_000 { 0.3 } else { -0.3 }, 0.0])
}

/// The same, where the right wheel spins for two seconds after 20 s: by its count, the robot turns by two radians.
pub(super) fn spinning_once(seconds: f64, stream: &mut Stream) -> Driven {
    let spun = |step: usize| WHEELBASE * ((step as f64 - 20_000.0) / 1000.0).clamp(0.0, 2.0);
    let driven = to_and_fro(seconds, stream).into_iter().enumerate();
    driven.map(|(step, (pose, [left, right]))| (pose, [left, right + spun(step)])).collect()
}

/// Straight ahead and back, five seconds each, on wheels of unequal diameter: by their counts the robot turns, and by the reference it does not.
pub(super) fn forth_and_back(seconds: f64, stream: &mut Stream) -> Driven {
    to_and_fro(seconds, stream).into_iter().map(|(pose, [left, right])| (pose, [0.99 * left, 1.01 * right])).collect()
}
