//! The closure of a square: contrasts, and end points on a circle.

use schemars::JsonSchema;
use serde::Serialize;

use super::ends;
use crate::diagnose;

/// A closure contrast of a square driven both ways: zero where the model is complete.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Contrast {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Its 95 % interval; null if the runs do not determine it.
    pub interval: Option<[f64; 2]>,
    /// Its meaning if it is not zero.
    pub meaning: &'static str,
}

impl From<&diagnose::Contrast> for Contrast {
    fn from(c: &diagnose::Contrast) -> Self {
        Contrast { name: c.name, unit: c.unit, value: c.value, interval: ends(c.interval), meaning: c.meaning }
    }
}

/// End points of a direction relative to the circle through START.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OnCircle {
    /// "cw" or "ccw".
    pub direction: &'static str,
    /// Distance of each end point outside the circle, in m.
    pub off_m: Vec<f64>,
    /// Mean of these, in m.
    pub mean_off_m: f64,
    /// Its 95 % interval, in m; null if the runs do not determine it.
    pub mean_off_interval_m: Option<[f64; 2]>,
    /// Mean distance of the end points from START, in m.
    pub distance_m: f64,
    /// The distance that the headings imply, in m; null where none were measured.
    pub distance_by_heading_m: Option<f64>,
    /// Angle on the circle minus the return heading, in rad; null where no headings were measured.
    pub angle_less_heading_rad: Option<f64>,
    /// Its 95 % interval, in rad; null if the runs do not determine it.
    pub angle_less_heading_interval_rad: Option<[f64; 2]>,
    /// Whether the circle explains the end points.
    pub explained: bool,
}

impl From<&diagnose::OnCircle> for OnCircle {
    fn from(c: &diagnose::OnCircle) -> Self {
        OnCircle {
            direction: c.direction.name(),
            off_m: c.off.clone(),
            mean_off_m: c.mean_off,
            mean_off_interval_m: ends(c.off_interval),
            distance_m: c.distance,
            distance_by_heading_m: c.implied,
            angle_less_heading_rad: c.turned_less_heading,
            angle_less_heading_interval_rad: c.turned_interval.and_then(ends),
            explained: c.explained(),
        }
    }
}

/// The closure of a square, as keys of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Closure {
    /// Closure contrasts of a square driven both ways; empty for other paths.
    pub contrasts: Vec<Contrast>,
    /// End points relative to the circle through START; empty for other paths.
    pub circle: Vec<OnCircle>,
}

impl Closure {
    pub(super) fn new(contrasts: &[diagnose::Contrast], circle: &[diagnose::OnCircle]) -> Closure {
        Closure {
            contrasts: contrasts.iter().map(Contrast::from).collect(),
            circle: circle.iter().map(OnCircle::from).collect(),
        }
    }
}
