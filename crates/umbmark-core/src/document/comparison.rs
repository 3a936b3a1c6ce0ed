//! `compare`.

use super::remains::{least_left, with_remains};
use super::setup::setup;
use super::square::square;
use crate::compare::{Comparison, Judged, NoiseSource};
use crate::diagnose::Options;
use serde_json::{Map, Value, json};

/// Models beside measurements.
pub fn comparison(comparison: &Comparison, options: &Options) -> Value {
    let mut document = json!({
        "observed": "end_poses",
        "n_cw": comparison.runs[0],
        "n_ccw": comparison.runs[1],
        "models": comparison.models.iter().map(|m| model_json(m, options)).collect::<Vec<_>>(),
        "setup": setup(&comparison.setup),
        "remarks": comparison.remarks,
        "size": options.size,
        "draws": options.draws,
        "seed": options.seed,
        "version": crate::VERSION,
    });
    if let Some(map) = document.as_object_mut() {
        map.extend(square(&comparison.contrasts, &comparison.circle));
    }
    with_remains(document, least_left(comparison.models.iter().map(|model| &model.remains)))
}

fn model_json(judged: &Judged, options: &Options) -> Value {
    let mut statistics: Map<String, Value> = Map::new();
    for s in &judged.statistics {
        let of_direction = statistics.entry(s.direction.name()).or_insert_with(|| json!({}));
        if let Some(map) = of_direction.as_object_mut() {
            let told = json!({ "measured": s.measured, "predicted": s.predicted, "p": s.p });
            map.insert(s.quantity.key().to_owned(), told);
        }
    }
    let document = json!({
        "name": judged.name,
        "explains": judged.explains(options.size),
        "p": judged.p,
        "noise": match judged.noise { NoiseSource::Model => "model", NoiseSource::Pooled => "pooled" },
        "rmse_m": judged.rmse,
        "heading_rmse_rad": judged.heading_rmse,
        "statistics": statistics,
        "sentences": judged.sentences,
    });
    with_remains(document, Some(&judged.remains))
}
