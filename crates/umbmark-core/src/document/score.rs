//! `score`.

use super::setup::setup;
use super::{ends, pair};
use crate::score::{CentroidInterval, Convention, Score};
use serde_json::{Value, json};

/// A score, the extended test joined by `convention`.
pub fn score(score: &Score, convention: Convention) -> Value {
    let summary = &score.summary;
    let intervals = score.intervals.as_ref();
    let mut document = json!({
        "e_max_sys_m": summary.e_max_sys(),
        "e_max_sys_interval_m": intervals.and_then(|i| i.e_max_sys).and_then(ends),
        "noise_band_m": score.noise_band,
        "sigma_m": summary.sigma_axis(),
        "sigma_interval_m": intervals.and_then(|i| ends(i.sigma_axis)),
        "sigma_radial_m": summary.sigma_radial(),
    });
    let mut put = |key: String, value: Value| document.as_object_mut().map(|map| map.insert(key, value));
    for (name, cluster, interval) in
        [("cw", summary.cw, intervals.and_then(|i| i.cw)), ("ccw", summary.ccw, intervals.and_then(|i| i.ccw))]
    {
        put(format!("n_{name}"), json!(cluster.map_or(0, |c| c.n)));
        put(format!("centroid_{name}_m"), json!(cluster.and_then(|c| pair(c.x, c.y))));
        put(format!("centroid_{name}_interval_m"), json!(interval.map(|i| [ends(i.x), ends(i.y)])));
        put(format!("centroid_{name}_ellipse"), json!(interval.and_then(|i| ellipse_json(&i))));
        put(format!("return_heading_{name}_rad"), json!(cluster.and_then(|c| c.heading)));
        put(format!("return_heading_{name}_interval_rad"), json!(interval.and_then(|i| i.heading).and_then(ends)));
    }
    let extended = score.extended.as_ref();
    put("nonsys_orientation_rad".into(), json!(extended.map(|e| e.orientation(convention))));
    put("nonsys_orientation_interval_rad".into(), json!(extended.and_then(|e| e.interval(convention)).and_then(ends)));
    put("nonsys_convention".into(), json!(extended.map(|_| convention.name())));
    put("n_bumps_cw".into(), json!(extended.map_or(0, |e| e.n_cw)));
    put("n_bumps_ccw".into(), json!(extended.map_or(0, |e| e.n_ccw)));
    put("level".into(), json!(score.level));
    put("setup".into(), setup(&score.setup));
    put("warnings".into(), json!(score.warnings));
    put("version".into(), json!(crate::VERSION));
    document
}

fn ellipse_json(interval: &CentroidInterval) -> Option<Value> {
    let e = interval.ellipse;
    pair(e.semi_major, e.semi_minor)?;
    Some(json!({ "semi_major_m": e.semi_major, "semi_minor_m": e.semi_minor, "angle_rad": e.angle }))
}
