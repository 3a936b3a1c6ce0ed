//! Workloads with fixed seeds for the benchmarks: segments as a robot on the UMBmark square drives them, whole tests, and
//! the studies made of them.

pub mod logs;
pub mod mcap_logs;
pub mod plain_trials;
pub mod studies;

use std::f64::consts::{FRAC_PI_2, PI};
use umbmark_core::engine::{TickGeometry, UNITS_PER_TICK, WheelLine};

/// Wheels of 0.15 m with 2000 ticks a turn, wheelbase 0.34 m: 0.236 mm per tick.
pub fn robot() -> TickGeometry {
    let metres_per_tick = PI * 0.15 / 2000.0;
    TickGeometry::new(metres_per_tick, metres_per_tick, 0.34).expect("positive lengths")
}

/// Readings of a controller at 100 Hz along a 4 m leg at 0.2 m/s.
pub const LEG_READINGS: u32 = 2000;

/// Readings of a controller at 100 Hz during a turn of 90° with 0.2 m/s at the wheels.
pub const TURN_READINGS: u32 = 134;

/// Uniform and normal numbers of a fixed seed (SplitMix64, Box & Muller).
pub struct Draws(u64);

impl Draws {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Draws {
        Draws(seed)
    }

    /// In \[0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (2.0 * PI * self.unit()).cos()
    }

    fn line(&mut self, left: f64, right: f64) -> WheelLine {
        WheelLine::from_ticks([self.unit(), self.unit()], [left, right]).expect("a travel within range")
    }

    /// A 4 m leg whose wheels err by 1e-3 each.
    pub fn leg(&mut self) -> WheelLine {
        let ticks = 4.0 / robot().left();
        let [left, right] = [0, 1].map(|_| ticks * (1.0 + 1e-3 * self.normal()));
        self.line(left, right)
    }

    /// A turn of 90° on the spot, either way, whose wheels err by 1e-3 each.
    pub fn turn(&mut self) -> WheelLine {
        let ticks = FRAC_PI_2 * 0.17 / robot().left();
        let [left, right] = [0, 1].map(|_| ticks * (1.0 + 1e-3 * self.normal()));
        if self.unit() < 0.5 { self.line(-left, right) } else { self.line(left, -right) }
    }

    /// Any ratio of the speeds, up to 17 000 ticks per wheel either way.
    pub fn generic(&mut self) -> WheelLine {
        let [left, right] = [0, 1].map(|_| 34_000.0 * self.unit() - 17_000.0);
        self.line(left, right)
    }
}

/// The end (x, y) \[m\] of a segment by the loop one writes by hand: whichever wheel ticks next turns the robot by one
/// precomputed step, the direction a rotating unit vector. Simultaneous ticks are right, then left.
pub fn tick_loop(geometry: &TickGeometry, line: &WheelLine) -> (f64, f64) {
    let sign = line.backward().map(|backward| if backward { -1.0 } else { 1.0 });
    let step = |length: f64, rotation: f64| {
        let ((side, ahead), (sine, cosine)) = ((0.5 * rotation).sin_cos(), rotation.sin_cos());
        [length * ahead, length * side, cosine, sine]
    };
    let left_tick = sign[0] * geometry.left();
    let right_tick = sign[1] * geometry.right();
    let steps = [
        step(0.5 * left_tick, -left_tick / geometry.wheelbase()),
        step(0.5 * right_tick, right_tick / geometry.wheelbase()),
    ];
    let travel = line.travel().map(|units| units.abs() as f64);
    let first = [0, 1].map(|i| {
        let start = line.start()[i];
        (if sign[i] < 0.0 { start + 1 } else { UNITS_PER_TICK - start }) as f64 / travel[i]
    });
    let period = travel.map(|travel| UNITS_PER_TICK as f64 / travel);
    let [mut left_time, mut right_time] = first;
    let (mut x, mut y, mut cosine, mut sine) = (0.0, 0.0, 1.0, 0.0);
    for _ in 0..line.counts().iter().map(|count| count.abs()).sum::<i64>() {
        let [dx, dy, c, s] = if left_time < right_time {
            left_time += period[0];
            steps[0]
        } else {
            right_time += period[1];
            steps[1]
        };
        x += cosine * dx - sine * dy;
        y += sine * dx + cosine * dy;
        (cosine, sine) = (cosine * c - sine * s, sine * c + cosine * s);
    }
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::engine::TickOdometry;

    #[test]
    fn the_tick_loop_is_the_odometry_it_is_compared_with() {
        let (odometry, mut draws) = (TickOdometry::new(robot()), Draws::new(1));
        for line in [draws.leg(), draws.turn(), draws.generic(), draws.generic()] {
            let ((x, y), motion) = (tick_loop(&robot(), &line), odometry.motion(&line));
            assert!((x - motion.pose.x).abs() < 1e-6 && (y - motion.pose.y).abs() < 1e-6, "{line:?}");
        }
    }
}
