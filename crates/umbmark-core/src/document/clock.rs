//! Clocks that were set by the motion.

use super::ends;
use crate::dataset::RunClock;
use crate::stats::Measured;
use crate::synchronise::Alignment;
use serde_json::{Value, json};

/// A clock that was set, with its run and its track.
pub fn clock(clock: &RunClock) -> Value {
    let mut document = alignment(&clock.alignment);
    document["run"] = json!(clock.run);
    document["track"] = json!(clock.track);
    document
}

/// An alignment: each quantity with standard error and 95 % interval.
fn alignment(alignment: &Alignment) -> Value {
    let measured = |m: &Measured| json!({ "value": m.value, "std_error": m.std_error, "interval": ends(m.interval) });
    json!({
        "offset_s": measured(&alignment.offset),
        "rate": measured(&alignment.rate),
        "lever_ahead_m": alignment.lever_ahead.as_ref().map(measured),
        "lever_left_m": alignment.lever_left.as_ref().map(measured),
        "yaw_rad": alignment.yaw.as_ref().map(measured),
        "misfit_m": alignment.misfit,
        "windows": alignment.windows,
        "left_out": alignment.left_out,
    })
}
