//! `mc` and `simulate`.

use crate::calibrate::{Angles, Correction};
use crate::dataset::Run;
use crate::monte_carlo::{Distribution, Draw, Ensemble, Metric, Statistics, Study, StudyError};
use crate::path::{Direction, SQUARE};
use crate::preset::Published;
use crate::score::summarise;
use serde_json::{Map, Value, json};

/// The quantiles that a document tells.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// E_max,sys \[m\] of a study's test without noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theory {
    /// By exact kinematics.
    pub exact: Option<f64>,
    /// By the formulas of the paper's companion, for a square.
    pub first_order: Option<f64>,
}

impl Theory {
    /// That of a study, all drawn parameters in their middle.
    pub fn of(study: &Study) -> Result<Theory, StudyError> {
        let [cw, ccw] = study.noise_free()?;
        let middle = |effect: &str, parameter: &str| {
            let drawn = study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter);
            drawn.map(Draw::centre).or(study.model.get(effect, parameter)).unwrap_or(1.0)
        };
        let e_d = middle("wheel_diameter_ratio", "e_d");
        // A square sees the ratio of the two only.
        let e_b = middle("wheelbase", "e_b") / middle("scale", "e_s");
        let of_paper = std::ptr::eq(study.path.shape(), &SQUARE) && study.robot().drive.kind().has_axle_wheels();
        let side = study.path.values().first().filter(|_| of_paper);
        let first_order = side.and_then(|side| {
            let angles = Angles::of(&Correction { e_d, e_b, e_s: 1.0 }, *side, &study.robot().drive);
            let [cw, ccw] = Direction::BOTH.map(|direction| angles.first_order_return(direction, *side));
            summarise(&[cw], &[ccw]).e_max_sys()
        });
        Ok(Theory { exact: summarise(&[cw], &[ccw]).e_max_sys(), first_order })
    }
}

/// What is to be said of a study beside its numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told<'a> {
    /// Where values are from, a phrase each.
    pub sources: &'a [String],
    /// What nobody said and was assumed, a phrase each.
    pub assumed: &'a [String],
    /// What was published of this test.
    pub published: Option<Published>,
}

/// What a study is: what its [`ensemble`] tells beside the metrics.
pub fn study(study: &Study, theory: &Theory, told: &Told) -> Map<String, Value> {
    let path = &study.path;
    let sizes = path.shape().parameters.iter().zip(path.values());
    let sizes: Map<String, Value> = sizes.map(|(p, v)| (p.name.to_owned(), json!(v))).collect();
    let members = [
        ("noise_free", json!({ "e_max_sys_m": theory.exact, "first_order_e_max_sys_m": theory.first_order })),
        ("runs", json!({ "cw": study.runs[0], "ccw": study.runs[1] })),
        ("robot", json!(study.robot().name)),
        ("path", json!({ "shape": path.shape().name, "sizes": sizes })),
        ("effects", effects(study)),
        ("sources", json!(told.sources)),
        ("assumed", json!(told.assumed)),
        ("published", json!(told.published.map(published))),
        ("version", json!(crate::VERSION)),
    ];
    members.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn effects(study: &Study) -> Value {
    let drawn = |effect: &str, parameter: &str| {
        study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter)
    };
    let effects = study.model.parts().iter().map(|part| {
        let name = part.effect.name();
        let mut entry = Map::from_iter([("name".to_owned(), json!(name))]);
        for (parameter, value) in part.effect.parameters().iter().zip(&part.values) {
            let value = match (drawn(name, parameter.name), parameter.word(*value)) {
                (Some(draw), _) => distribution(&draw.distribution()),
                (None, Some(word)) => json!(word),
                (None, None) => json!(value),
            };
            entry.insert(parameter.name.to_owned(), value);
        }
        Value::Object(entry)
    });
    Value::Array(effects.collect())
}

fn published(p: Published) -> Value {
    json!({ "row": p.row, "e_max_sys_m": p.e_max_sys, "sigma_m": p.sigma })
}

/// A distribution, as in `model.toml`.
pub fn distribution(distribution: &Distribution) -> Value {
    match distribution {
        Distribution::Normal { mean, sd } => json!({ "mean": mean, "sd": sd }),
        Distribution::Uniform { min, max } => json!({ "min": min, "max": max }),
        Distribution::Triangular { min, mode, max } => json!({ "min": min, "mode": mode, "max": max }),
        Distribution::LogUniform { min, max } => json!({ "min": min, "max": max, "scale": "log" }),
    }
}

/// An ensemble of a [`study`] with its seed; `partial` where trials that were asked for are not done.
pub fn ensemble(
    ensemble: &Ensemble,
    seed: u64,
    partial: bool,
    trials_per_s: Option<f64>,
    study: &Map<String, Value>,
) -> Value {
    let metric = |(metric, s): (Metric, &Statistics)| {
        let quantiles: Map<String, Value> = QUANTILES.iter().map(|q| (q.to_string(), json!(s.quantile(*q)))).collect();
        let value = json!({
            "mean": s.mean(), "std_dev": s.std_dev(), "std_error": s.std_error(),
            "min": s.min(), "max": s.max(), "quantiles": quantiles,
        });
        (metric.name().to_owned(), value)
    };
    let metrics: Map<String, Value> = ensemble.statistics().map(metric).collect();
    let mut document = Map::from_iter([
        ("n".to_owned(), json!(ensemble.trials())),
        ("seed".to_owned(), json!(seed)),
        ("partial".to_owned(), json!(partial)),
        ("metrics".to_owned(), Value::Object(metrics)),
        ("trials_per_s".to_owned(), json!(trials_per_s)),
    ]);
    document.extend(study.clone());
    Value::Object(document)
}

/// A run that was simulated.
pub fn run(run: &Run) -> Value {
    let error = run.returned.unwrap_or_default();
    json!({
        "run": run.name, "direction": run.direction.map(Direction::name), "test": run.test.name(),
        "ex_m": error.x, "ey_m": error.y, "etheta_rad": error.heading,
    })
}
