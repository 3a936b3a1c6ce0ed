//! `fit`.

use super::setup::{setup, taken};
use super::{ends, finite, model::model};
use crate::effect::Model;
use crate::evidence::Estimate;
use crate::evidence::Fit;
use crate::likelihood::Outlier;
use serde_json::{Map, Value, json};

/// A fit: its numbers, the free effects that the data does not show, and the model.
pub fn fitted(fit: &Fit, level: f64) -> Value {
    json!({
        "fitted": estimates(&fit.estimates, level),
        "not_shown": not_shown(&fit.model, &fit.estimates),
        "meaning": meaning(&fit.estimates, &fit.model),
        "outliers": outliers(&fit.outliers),
        "usual_noise": fit.usual_noise,
        "setup": setup(&fit.setup),
        "taken": taken(&fit.taken),
        "model": model(&fit.model),
        "level": level,
        "version": crate::VERSION,
    })
}

/// Each fitted effect with what it means for the robot.
pub fn meanings(estimates: &[Estimate], model: &Model) -> Vec<(&'static str, String)> {
    let mut said: Vec<(&str, String)> = Vec::new();
    for e in estimates {
        if said.iter().all(|(name, _)| *name != e.effect) {
            said.extend(model.meaning(e.effect).map(|sentence| (e.effect, sentence)));
        }
    }
    said
}

pub(super) fn meaning(estimates: &[Estimate], model: &Model) -> Value {
    let pairs = meanings(estimates, model).into_iter().map(|(name, said)| (name.to_owned(), json!(said)));
    Value::Object(Map::from_iter(pairs))
}

pub(super) fn outliers(outliers: &[Outlier]) -> Value {
    let one = |o: &Outlier| {
        json!({
            "run": o.run,
            "time_s": o.time,
            "moved_m": o.moved,
            "turned_rad": o.turned,
            "standard_deviations": finite(o.deviations),
        })
    };
    json!(outliers.iter().map(one).collect::<Vec<_>>())
}

/// The free effects that were not fitted, because this data does not show them apart from the rest of the model.
pub fn not_shown(model: &Model, fitted: &[Estimate]) -> Vec<&'static str> {
    let free = model.parts().iter().filter(|part| part.free).map(|part| part.effect.name());
    free.filter(|name| fitted.iter().all(|e| e.effect != *name)).collect()
}

/// What was fitted, with standard errors and intervals.
pub fn estimates(estimates: &[Estimate], level: f64) -> Value {
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
