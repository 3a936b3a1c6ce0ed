//! Clocks that were aligned from the motion.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Measured, ends};
use crate::{dataset, stats};

/// Offset of a track's clock and tracked body from those of the ticks, in one run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Clock {
    /// Delay of the track's clock, in s.
    pub offset_s: Measured,
    /// Rate by which it is fast, in s/s.
    pub rate: Measured,
    /// Distance of the tracked point ahead of the axle's centre, in m; null if the motion does not determine it.
    pub lever_ahead_m: Option<Measured>,
    /// Distance of the tracked point to the left of the axle's centre, in m; null if the motion does not determine it.
    pub lever_left_m: Option<Measured>,
    /// Heading of the tracked body minus heading of the robot, in rad; null if the motion does not determine it.
    pub yaw_rad: Option<Measured>,
    /// Root mean square of the residuals, in m.
    pub misfit_m: f64,
    /// Number of windows that were compared.
    pub windows: usize,
    /// Number of windows that were excluded.
    pub left_out: usize,
    /// Name of the run.
    pub run: String,
    /// Name of the track.
    pub track: String,
}

impl From<&dataset::RunClock> for Clock {
    fn from(clock: &dataset::RunClock) -> Self {
        let of =
            |m: &stats::Measured| Measured { value: m.value, std_error: Some(m.std_error), interval: ends(m.interval) };
        let alignment = &clock.alignment;
        Clock {
            offset_s: of(&alignment.offset),
            rate: of(&alignment.rate),
            lever_ahead_m: alignment.lever_ahead.as_ref().map(of),
            lever_left_m: alignment.lever_left.as_ref().map(of),
            yaw_rad: alignment.yaw.as_ref().map(of),
            misfit_m: alignment.misfit,
            windows: alignment.windows,
            left_out: alignment.left_out,
            run: clock.run.clone(),
            track: clock.track.clone(),
        }
    }
}
