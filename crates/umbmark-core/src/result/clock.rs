//! Clocks that were aligned from the motion.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Measured, ends};
use crate::{dataset, stats};

/// How the clock and the body of a run's track lie against those of the ticks.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Clock {
    /// How much later the clock of the track is, in s.
    pub offset_s: Measured,
    /// How much faster it goes, in s/s.
    pub rate: Measured,
    /// How far ahead of the centre of the axle the tracked point lies, in m; null where the motion does not show it.
    pub lever_ahead_m: Option<Measured>,
    /// How far to the left of it the tracked point lies, in m; null where the motion does not show it.
    pub lever_left_m: Option<Measured>,
    /// Heading of the tracked body minus heading of the robot, in rad; null where the motion does not show it.
    pub yaw_rad: Option<Measured>,
    /// Root mean square of what is left, in m.
    pub misfit_m: f64,
    /// Number of windows that were compared.
    pub windows: usize,
    /// Number of these that were left out.
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
