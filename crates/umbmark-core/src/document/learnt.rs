//! `learn`.

use super::diagnosis::{experiments, unlisted};
use super::fitted::{estimates, meaning, outliers};
use super::law::repeats;
use super::remains::with_remains;
use super::setup::{reasons, setup, taken};
use super::{finite, model::model};
use crate::diagnose::Options;
use crate::learn::{Learnt, Step};
use serde_json::{Value, json};

/// What was learnt.
pub fn learnt(learnt: &Learnt, options: &Options) -> Value {
    let step = |s: &Step| {
        json!({
            "added": s.added,
            "class": s.class,
            "p_adjusted": s.p_adjusted,
            "law": s.law.as_deref().map(repeats),
            "rmse_m": finite(s.error.position),
            "heading_rmse_rad": s.error.heading,
            "heldout_rmse_m": finite(s.held_out.position),
            "heldout_heading_rmse_rad": s.held_out.heading,
            "aicc": s.aicc,
            "bic": s.bic,
        })
    };
    let document = json!({
        "steps": learnt.steps.iter().map(step).collect::<Vec<_>>(),
        "verdict": learnt.verdict.name(),
        "unlisted": unlisted(learnt.diagnosis.dependence.as_ref()),
        "next_experiments": experiments(&learnt.diagnosis.next_experiments),
        "model": model(&learnt.model),
        "fitted": estimates(&learnt.diagnosis.fitted, 1.0 - options.size),
        "meaning": meaning(&learnt.diagnosis.fitted, &learnt.model),
        "outliers": outliers(&learnt.diagnosis.outliers),
        "setup": setup(&learnt.diagnosis.setup),
        "taken": taken(&learnt.diagnosis.taken),
        "reasons": reasons(&learnt.diagnosis.reasons),
        "repeats": learnt.diagnosis.repeats.as_ref().map(repeats),
        "remarks": learnt.remarks,
        "partial": learnt.partial,
        "size": options.size,
        "draws": options.draws,
        "seed": options.seed,
        "version": crate::VERSION,
    });
    with_remains(document, learnt.diagnosis.remains.as_ref())
}
