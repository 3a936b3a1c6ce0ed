//! How far runs go in everything that a law may depend on.

use super::steps::TrackStep;
use std::f64::consts::TAU;

/// The extent of what runs do.
pub struct Extent {
    /// Way in all runs, and how much of it back.
    pub way: f64,
    pub back: f64,
    pub time: f64,
    pub distance: f64,
    pub speed: f64,
    pub turn_rate: f64,
    pub acceleration: f64,
    pub turn_acceleration: f64,
    pub low: [f64; 2],
    pub high: [f64; 2],
    /// Nominal distance of the wheels \[m\].
    pub wheelbase: f64,
    /// How far the runs reach against each of eight [directions](direction) \[m\].
    pub edges: [f64; 8],
}

/// How far along a direction in the room a step is \[m\].
pub fn along(step: &TrackStep, direction: f64) -> f64 {
    let (sine, cosine) = libm::sincos(direction);
    step.middle.x * cosine + step.middle.y * sine
}

/// One of eight directions in the room \[rad\].
pub fn direction(k: usize) -> f64 {
    TAU * k as f64 / 8.0
}

impl Extent {
    pub fn of(steps: &[Vec<TrackStep>], wheelbase: f64) -> Extent {
        let most = |of: fn(&TrackStep) -> f64| steps.iter().flatten().map(of).fold(1e-9, f64::max);
        let least = |of: fn(&TrackStep) -> f64| steps.iter().flatten().map(of).fold(0.0, f64::min);
        let sum = |of: fn(&TrackStep) -> f64| steps.iter().flatten().map(of).sum::<f64>();
        Extent {
            way: sum(|s| s.way),
            back: sum(|s| if s.speed < 0.0 { s.way } else { 0.0 }),
            time: most(|s| s.time),
            distance: most(|s| s.distance),
            speed: most(|s| s.speed.abs()),
            turn_rate: most(|s| s.turn_rate.abs()),
            acceleration: most(|s| s.acceleration.abs()),
            turn_acceleration: most(|s| s.turn_acceleration.abs()),
            wheelbase,
            edges: std::array::from_fn(|k| {
                steps.iter().flatten().map(|s| along(s, direction(k))).fold(f64::INFINITY, f64::min)
            }),
            low: [least(|s| s.middle.x), least(|s| s.middle.y)],
            high: [most(|s| s.middle.x), most(|s| s.middle.y)],
        }
    }
}
