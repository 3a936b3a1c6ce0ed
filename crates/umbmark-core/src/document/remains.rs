//! What a model leaves.

use super::finite;
use crate::diagnose::{Chance, Left, Remains};
use crate::likelihood::Disturbance;
use crate::stats::Interval;
use serde_json::{Value, json};

/// What a model leaves: how much of it is the same in every run, and what chance there is.
fn remains(remains: &Remains) -> Value {
    let chance = |chance: &Chance| json!({ "source": chance.source, "position_m": chance.position, "heading_rad": chance.heading });
    let disturbance = |at: &Disturbance| {
        json!({
            "run": at.run,
            "t_s": at.time,
            "rolled_m": at.rolled,
            "lasts": at.lasts,
            "forward_m": at.by[0],
            "left_m": at.by[1],
            "heading_rad": at.by[2],
            "standard_deviations": at.deviations,
        })
    };
    let heading = remains.heading.as_ref();
    json!({
        "left_m": finite(remains.position.rms),
        "repeats_m": repeats(&remains.position),
        "left_rad": heading.map(|left| left.rms),
        "repeats_rad": heading.and_then(repeats),
        "pairs_of_one_path": remains.pairs,
        "chance": remains.chance.iter().map(chance).collect::<Vec<_>>(),
        "disturbances": remains.disturbances.iter().map(disturbance).collect::<Vec<_>>(),
    })
}

/// How much is the same in every run, with its interval.
fn repeats(left: &Left) -> Option<Value> {
    let repeats = left.repeats?;
    let [low, high] = [|i: Interval| i.low, |i: Interval| i.high].map(|end| repeats.interval.map(end));
    Some(json!({ "value": repeats.value, "low": low, "high": high }))
}

/// Of several models that which leaves least.
pub(super) fn least_left<'a>(of: impl Iterator<Item = &'a Remains>) -> Option<&'a Remains> {
    of.min_by(|a, b| a.position.rms.total_cmp(&b.position.rms))
}

/// A document with what a model leaves.
pub(super) fn with_remains(mut document: Value, of: Option<&Remains>) -> Value {
    document["left_m"] = json!(of.map(|of| finite(of.position.rms)));
    document["repeats_m"] = json!(of.and_then(|of| repeats(&of.position)));
    document["remains"] = json!(of.map(remains));
    document
}
