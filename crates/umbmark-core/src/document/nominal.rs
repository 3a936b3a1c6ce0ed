//! Nominal robots and paths.

use crate::drive::Robot;
use crate::path::Path;
use serde_json::{Map, Value, json};

/// A nominal robot.
pub fn robot(robot: &Robot) -> Value {
    json!({
        "name": robot.name,
        "wheelbase_m": robot.drive.wheelbase(),
        "wheel_diameter_left_m": robot.drive.wheel_diameter_left(),
        "wheel_diameter_right_m": robot.drive.wheel_diameter_right(),
        "ticks_per_revolution": robot.encoder.ticks_per_revolution(),
        "encoder_rate_hz": robot.encoder.rate(),
        "counter_bits": robot.encoder.counter_bits(),
    })
}

/// A path.
pub fn path(path: &Path) -> Value {
    let shape = path.shape();
    let mut sizes: Map<String, Value> =
        shape.parameters.iter().zip(path.values()).map(|(p, value)| (p.name.to_owned(), json!(value))).collect();
    if shape.parameters.is_empty() {
        sizes.insert("points_m".into(), json!(path.values().chunks(2).collect::<Vec<_>>()));
    }
    json!({ "shape": shape.name, "sizes": sizes, "length_m": path.length() })
}
