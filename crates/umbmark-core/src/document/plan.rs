//! `plan`.

use super::diagnosis::experiments;
use crate::diagnose::{Experiment, Options};
use crate::plan::{Alternative, Answer, Drift, Findings, OfRuns, Request, Setting, Shown, Sought};
use serde_json::{Map, Value, json};

/// What a planned test would show; `assumed` is what nobody said, a phrase each.
pub fn plan(setting: &Setting, request: &Request, findings: &Findings, assumed: &[String]) -> Value {
    json!({
        "robot": setting.robot().name,
        "runs": request.runs,
        "minutes_a_run": setting.minutes_a_run(),
        "sigma_m": setting.sigma(),
        "sigma_interval_m": request.sigma_interval.map(|i| [i.low, i.high]),
        "e_max_sys_m": setting.e_max_sys(),
        "with_heading": setting.with_heading,
        "power": request.power,
        "size": request.options.size,
        "draws": request.options.draws,
        "seed": request.options.seed,
        "see": findings.answers.iter().map(answer).collect::<Vec<_>>(),
        "by_runs": findings.by_runs.iter().map(|row| of_runs(setting, &findings.sizes, row)).collect::<Vec<_>>(),
        "invisible": findings.unseen.iter().map(|u| u.effect).collect::<Vec<_>>(),
        "alternatives": findings.alternatives.iter().map(|a| alternative(&findings.compared, a)).collect::<Vec<_>>(),
        "extended": findings.extended.map(|e| json!({
            "bumps": e.bumps, "runs": e.runs, "minutes": e.minutes, "nonsys_orientation_rad": e.orientation,
            "interval_half_width_rad": e.half_width,
        })),
        "order": findings.drifts.iter().map(drift).collect::<Vec<_>>(),
        "assumed": assumed,
        "partial": findings.partial,
        "version": crate::VERSION,
    })
}

/// Experiments that tell two effects apart, together with what they come on top of.
pub fn separation(pair: [&str; 2], beside: &str, ranked: &[Experiment], options: &Options) -> Value {
    json!({
        "separates": pair,
        "beside": beside,
        "next_experiments": experiments(ranked),
        "seed": options.seed,
        "version": crate::VERSION,
    })
}

fn least(sizes: &[Sought], values: &[Option<f64>]) -> Value {
    let one = |(s, value): (&Sought, &Option<f64>)| json!({ "effect": s.effect.about.name, "parameter": s.parameter.name, "size": value });
    json!(sizes.iter().zip(values).map(one).collect::<Vec<_>>())
}

fn answer(answer: &Answer) -> Value {
    let (by, absorbed) = match &answer.shown {
        Shown::Fitted(_) => ("calibrate", None),
        Shown::Asked => ("diagnose", None),
        Shown::Absorbed(by) => ("never", Some(by)),
        Shown::BelowNoise => ("not_asked", None),
    };
    json!({
        "effect": answer.sought.effect.about.name,
        "parameter": answer.sought.parameter.name,
        "value": answer.value,
        "seen_by": by,
        "absorbed_by": absorbed,
        "runs": answer.runs,
        "runs_at_sigma_interval": answer.runs_at_sigma,
        "power": answer.power,
        "experiments": experiments(&answer.separable),
    })
}

fn of_runs(setting: &Setting, sizes: &[Sought], row: &OfRuns) -> Value {
    let i = &row.interval;
    json!({
        "runs": i.runs,
        "minutes": 2.0 * i.runs as f64 * setting.minutes_a_run(),
        "e_max_sys_m": { "mean": i.mean, "std_dev": i.std_dev, "interval_half_width_m": i.half_width,
                         "coverage": i.coverage, "tests": i.tests, "noise_band_m": i.noise_band },
        "minimum_detectable": least(sizes, &row.least),
    })
}

fn alternative(compared: &[Sought], a: &Alternative) -> Value {
    json!({ "what": a.what, "runs": { "cw": a.runs[0], "ccw": a.runs[1] }, "minutes": a.minutes, "sigma_m": a.sigma,
            "e_max_sys_interval_half_width_m": a.half_width, "minimum_detectable": least(compared, &a.least) })
}

fn drift(d: &Drift) -> Value {
    let of = |which: fn(&(&'static str, f64, f64)) -> f64| -> Map<String, Value> {
        d.errors.iter().map(|e| (e.0.to_owned(), json!(which(e)))).collect()
    };
    json!({ "effect": d.effect, "parameter": d.parameter, "change": d.change, "order": d.order.name(),
            "error": of(|e| e.1), "error_sd": of(|e| e.2) })
}
