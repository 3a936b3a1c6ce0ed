//! `diagnose`.

use super::fitted::{estimates, meaning, outliers};
use super::law::repeats;
use super::remains::with_remains;
use super::setup::{reasons, setup, taken};
use super::square::square;
use super::{finite, model::model};
use crate::diagnose::{
    CurvePoint, Dependence, Detectable, Diagnosis, Experiment, Identifiability, Options, Suspect, Unseen, Why,
};
use crate::drive::Robot;
use crate::effect::effects_text;
use crate::evidence::Estimate;
use serde_json::{Map, Value, json};

/// A diagnosis.
pub fn diagnosis(diagnosis: &Diagnosis, options: &Options) -> Value {
    let gof = diagnosis.goodness_of_fit.iter().map(
        |g| json!({ "name": g.name, "statistic": g.statistic, "degrees_of_freedom": g.degrees_of_freedom, "p": g.p }),
    );
    let mut document = json!({
        "verdict": diagnosis.verdict.name(),
        "observed": diagnosis.level.name(),
        "fitted": estimates(&diagnosis.fitted, 1.0 - options.size),
        "goodness_of_fit": gof.collect::<Vec<_>>(),
        "ranking": diagnosis.ranking.iter().map(|s| suspect_json(s, diagnosis.model.robot())).collect::<Vec<_>>(),
        "certified": diagnosis.certified,
        "invisible": diagnosis.invisible.iter().map(|u| u.effect).collect::<Vec<_>>(),
        "absorbed": absorbed_json(&diagnosis.invisible),
        "minimum_detectable": detectable_json(&diagnosis.minimum_detectable),
        "minimum_detectable_sizes": diagnosis.minimum_detectable.iter().map(|d| {
            json!({ "effect": d.effect, "parameter": d.parameter, "size": finite(d.size) })
        }).collect::<Vec<_>>(),
        "next_experiments": experiments(&diagnosis.next_experiments),
        "identifiability": identifiability_json(&diagnosis.identifiability),
        "unlisted": unlisted(diagnosis.dependence.as_ref()),
        "model": model(&diagnosis.model),
        "meaning": meaning(&diagnosis.fitted, &diagnosis.model),
        "outliers": outliers(&diagnosis.outliers),
        "setup": setup(&diagnosis.setup),
        "taken": taken(&diagnosis.taken),
        "reasons": reasons(&diagnosis.reasons),
        "repeats": diagnosis.repeats.as_ref().map(repeats),
        "remarks": diagnosis.remarks,
        "size": options.size,
        "draws": options.draws,
        "seed": options.seed,
        "version": crate::VERSION,
    });
    if let Some(map) = document.as_object_mut() {
        map.extend(square(&diagnosis.contrasts, &diagnosis.circle));
    }
    with_remains(document, diagnosis.remains.as_ref())
}

/// What is missing and not in the catalogue; null where nothing is.
pub(super) fn unlisted(unlisted: Option<&Dependence>) -> Value {
    let point = |p: &CurvePoint| json!({ "at": p.at, "value": p.value, "low": p.value - p.half_width, "high": p.value + p.half_width });
    json!(unlisted.map(|told| {
        json!({
            "acts_on": told.acts_on,
            "depends_on": told.depends_on,
            "p_adjusted": told.p_adjusted,
            "curve": {
                "at_unit": told.curve.at_unit,
                "unit": told.curve.unit,
                "points": told.curve.points.iter().map(point).collect::<Vec<_>>(),
            },
            "nearest": told.nearest.map(|(effect, share)| json!({ "effect": effect, "share": share })),
            "suggestion": told.suggestion.as_ref().map(|suggestion| {
                let mut model = model(&suggestion.model);
                model["share"] = json!(suggestion.share);
                model["toml"] = json!(effects_text(&suggestion.model));
                model
            }),
        })
    }))
}

pub(super) fn experiments(experiments: &[Experiment]) -> Value {
    let one = |e: &Experiment| json!({ "separates": e.separates, "experiment": e.experiment, "minutes": e.minutes, "sd": e.sd });
    json!(experiments.iter().map(one).collect::<Vec<_>>())
}

fn suspect_json(suspect: &Suspect, robot: &Robot) -> Value {
    let of = |value: &dyn Fn(&Estimate) -> f64| {
        let pairs = suspect.estimate.iter().map(|e| (e.parameter.to_owned(), finite(value(e))));
        Value::Object(Map::from_iter(pairs))
    };
    json!({
        "class": suspect.class,
        "best": suspect.best,
        "f": suspect.f,
        "degrees_of_freedom": suspect.degrees_of_freedom,
        "p": suspect.p,
        "p_adjusted": suspect.p_adjusted,
        "p_flips": suspect.p_flips,
        "estimate": of(&|e| e.value),
        "standard_error": of(&|e| e.standard_error),
        "expected_drop": suspect.expected_drop,
        "meaning": suspect.meaning(robot),
    })
}

fn absorbed_json(unseen: &[Unseen]) -> Value {
    let pairs = unseen.iter().filter_map(|u| match &u.why {
        Why::Absorbed(by) => Some((u.effect.to_owned(), json!(by))),
        Why::BelowNoise => None,
    });
    Value::Object(Map::from_iter(pairs))
}

/// For each effect, the largest of its sizes' least.
fn detectable_json(detectable: &[Detectable]) -> Value {
    let mut sizes: Map<String, Value> = Map::new();
    for d in detectable {
        let before = sizes.get(d.effect).and_then(Value::as_f64).unwrap_or(0.0);
        sizes.insert(d.effect.to_owned(), finite(d.size.max(before)));
    }
    Value::Object(sizes)
}

fn identifiability_json(identifiability: &Identifiability) -> Value {
    let parameters = identifiability.shares.iter().map(|s| {
        json!({
            "effect": s.effect,
            "parameter": s.parameter,
            "position_m_per_unit": s.position,
            "heading_rad_per_unit": s.heading,
        })
    });
    let hidden = identifiability.hidden.iter().map(|h| {
        let weights = h.weights.iter().map(|(name, w)| ((*name).to_owned(), json!(w)));
        json!({ "weights": Map::from_iter(weights), "ratio": h.ratio })
    });
    json!({
        "parameters": parameters.collect::<Vec<_>>(),
        "rank": identifiability.rank,
        "hidden": hidden.collect::<Vec<_>>(),
    })
}
