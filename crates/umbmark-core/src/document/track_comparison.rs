//! `compare` along the way.

use super::finite;
use super::remains::{least_left, with_remains};
use super::setup::{reasons, setup, taken};
use crate::compare::tracks::{Against, Bin, By, Mean, Part, Rms, TrackComparison, TracksJudged};
use crate::diagnose::Options;
use crate::path::Direction;
use crate::stats::Interval;
use serde_json::{Map, Value, json};

/// Models beside tracks.
pub fn track_comparison(comparison: &TrackComparison, options: &Options) -> Value {
    let [cw, ccw, neither] = comparison.runs;
    let document = json!({
        "observed": "tracks",
        "n_cw": cw,
        "n_ccw": ccw,
        "n_other": neither,
        "poses": comparison.poses,
        "models": comparison.models.iter().map(|judged| model_json(judged, options)).collect::<Vec<_>>(),
        "remarks": comparison.remarks,
        "setup": setup(&comparison.setup),
        "size": options.size,
        "version": crate::VERSION,
    });
    with_remains(document, least_left(comparison.models.iter().filter_map(|model| model.remains.as_ref())))
}

fn model_json(judged: &TracksJudged, options: &Options) -> Value {
    let rms = |rms: &Rms| json!({ "rmse_m": finite(rms.position), "heading_rmse_rad": rms.heading });
    let parts = By::ALL.into_iter().map(|by| {
        let own = judged.parts.iter().filter(|part| part.by == by).map(part_json);
        (by.key().to_owned(), Value::Array(own.collect()))
    });
    let overall = judged.overall.iter().map(|o| {
        let mut told = mean_json(&o.mean);
        told["p"] = json!(o.p);
        (o.rate.key().to_owned(), told)
    });
    let document = json!({
        "name": judged.name,
        "explains": judged.explains(options.size),
        "p": judged.p,
        "tests": judged.tests,
        "along": rms(&judged.along),
        "end": rms(&judged.end),
        "parts": Map::from_iter(parts),
        "overall": Map::from_iter(overall),
        "against": judged.against.iter().map(against_json).collect::<Vec<_>>(),
        "sentences": judged.sentences,
        "taken": taken(&judged.taken),
        "reasons": reasons(&judged.reasons),
    });
    with_remains(document, judged.remains.as_ref())
}

fn mean_json(mean: &Mean) -> Value {
    json!({ "mean": finite(mean.value), "interval": mean.interval.map(half_open), "runs": mean.runs })
}

fn part_json(part: &Part) -> Value {
    let keys = ["forward_m", "sideways_m", "heading_rad"];
    let one = |k: usize| {
        let mut told = mean_json(&part.mean[k]);
        told["sd"] = part.spread.map_or(Value::Null, |spread| finite(spread[k]));
        (keys[k].to_owned(), told)
    };
    let mut told = Map::from_iter((0..3).map(one));
    told.insert("name".into(), json!(part.name));
    told.insert("direction".into(), json!(part.direction.map(Direction::name)));
    told.insert("count".into(), json!(part.count));
    let share = part.share;
    told.insert("share".into(), json!({ "position": share.position, "heading": share.heading, "end": share.end }));
    Value::Object(told)
}

fn against_json(against: &Against) -> Value {
    let bin = |bin: &Bin| {
        let mut told = bin.mean.as_ref().map_or(json!({ "mean": null, "interval": null, "runs": 0 }), mean_json);
        told["low"] = json!(bin.span.low);
        told["high"] = finite(bin.span.high);
        told["sense"] = json!(bin.span.sense);
        told["amount"] = json!(bin.amount);
        told
    };
    json!({
        "rate": against.rate.key(),
        "covariate": against.covariate.name,
        "unit": against.covariate.units[usize::from(against.rate.of_turns())],
        "p": against.p,
        "bins": against.bins.iter().map(bin).collect::<Vec<_>>(),
    })
}

/// The ends of an interval; null for one that is open.
fn half_open(interval: Interval) -> Value {
    json!([finite(interval.low), finite(interval.high)])
}
