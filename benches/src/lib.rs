//! Workloads with fixed seeds for the benchmarks: segments as a robot on the UMBmark square drives them.

use std::f64::consts::{FRAC_PI_2, PI};
use umbmark_core::engine::{TickGeometry, WheelLine};

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
