//! Wheel speeds from counts.

use crate::travel::WheelTravel;

/// Half the width of the window that a speed is taken over \[s\].
pub const HALF_WINDOW: f64 = 0.05;

/// The ticks of the axle's two wheels at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// \[s\]
    pub time: f64,
    /// Ticks of the left and the right wheel since START.
    pub ticks: [f64; 2],
}

/// The window of a speed at a time, as far as a log reaches \[s\].
#[inline]
pub fn window(time: f64, first: f64, last: f64) -> [f64; 2] {
    [(time - HALF_WINDOW).max(first), (time + HALF_WINDOW).min(last)]
}

/// Ticks at a time, linear between the readings before and after it.
#[inline]
pub fn between(before: &Reading, after: &Reading, time: f64) -> [f64; 2] {
    let span = after.time - before.time;
    let share = if span > 0.0 { ((time - before.time) / span).clamp(0.0, 1.0) } else { 0.0 };
    [0, 1].map(|wheel| before.ticks[wheel] + share * (after.ticks[wheel] - before.ticks[wheel]))
}

/// Speeds of the left and the right wheel \[m/s\] from the ticks at both ends of a window: (s(t + h) - s(t - h))/2h.
#[inline]
pub fn speeds(window: [f64; 2], from: [f64; 2], to: [f64; 2], metres_per_tick: &WheelTravel) -> [f64; 2] {
    let scale = if window[1] > window[0] { 1.0 / (window[1] - window[0]) } else { 0.0 };
    [(to[0] - from[0]) * metres_per_tick.left * scale, (to[1] - from[1]) * metres_per_tick.right * scale]
}
