//! `fit`.

use super::{ends, finite, model::model};
use crate::diagnose::Estimate;
use crate::effect::Model;
use serde_json::{Value, json};

/// A fit: its numbers, the free effects that the data does not show, and the model.
pub fn fitted(fitted: &Model, numbers: &[Estimate], level: f64) -> Value {
    json!({
        "fitted": estimates(numbers, level),
        "not_shown": not_shown(fitted, numbers),
        "model": model(fitted),
        "level": level,
        "version": crate::VERSION,
    })
}

/// The free effects that were not fitted, because this data does not show them apart from the rest of the model.
pub fn not_shown(model: &Model, fitted: &[Estimate]) -> Vec<&'static str> {
    let free = model.parts().iter().filter(|part| part.free).map(|part| part.effect.name());
    free.filter(|name| fitted.iter().all(|e| e.effect != *name)).collect()
}

/// What was fitted, with standard errors and intervals.
pub(super) fn estimates(estimates: &[Estimate], level: f64) -> Value {
    let one = |e: &Estimate| {
        json!({
            "effect": e.effect,
            "parameter": e.parameter,
            "value": e.value,
            "standard_error": finite(e.standard_error),
            "interval": e.interval(level).and_then(ends),
        })
    };
    json!(estimates.iter().map(one).collect::<Vec<_>>())
}
