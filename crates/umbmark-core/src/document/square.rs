//! What the closure of a square says.

use super::ends;
use crate::diagnose::{Contrast, OnCircle};
use serde_json::{Value, json};

/// The closure of a square: contrasts, and end points beside the circle through START.
pub(super) fn square(contrasts: &[Contrast], circle: &[OnCircle]) -> [(String, Value); 2] {
    let contrast = |c: &Contrast| json!({ "name": c.name, "unit": c.unit, "value": c.value, "interval": ends(c.interval), "meaning": c.meaning });
    let on = |c: &OnCircle| {
        json!({
            "direction": c.direction.name(),
            "off_m": c.off,
            "mean_off_m": c.mean_off,
            "mean_off_interval_m": ends(c.off_interval),
            "distance_m": c.distance,
            "distance_by_heading_m": c.implied,
            "angle_less_heading_rad": c.turned_less_heading,
            "angle_less_heading_interval_rad": c.turned_interval.and_then(ends),
            "explained": c.explained(),
        })
    };
    [
        ("contrasts".into(), json!(contrasts.iter().map(contrast).collect::<Vec<_>>())),
        ("circle".into(), json!(circle.iter().map(on).collect::<Vec<_>>())),
    ]
}
