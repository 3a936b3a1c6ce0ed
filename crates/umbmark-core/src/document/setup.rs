//! What was found of an experiment before anything was fitted.

use super::{ends, finite};
use crate::diagnose::Reason;
use crate::likelihood::Taken;
use crate::setup::{Deviant, Jump, OutlyingReturn, RunSetup, Setup, WrongPose};
use crate::stats::Measured;
use serde_json::{Map, Value, json};

/// The findings: faults with what to do, clock and mounting of the reference, jumps and wrong poses, runs whose return is far from the others.
pub fn setup(setup: &Setup) -> Value {
    let faults = setup.all_faults().map(|fault| json!({ "fault": fault.sentence(), "remedy": fault.remedy() }));
    let mounting = setup.mounting.as_ref().map(|m| {
        json!({
            "delay_s": measured(&m.delay),
            "clock_rate": m.rate.as_ref().map(measured),
            "ahead_m": m.ahead.as_ref().map(measured),
            "left_m": m.left.as_ref().map(measured),
            "yaw_rad": m.yaw.as_ref().map(measured),
            "scale": m.scale.as_ref().map(measured),
            "gain": m.gain.as_ref().map(measured),
            "drift_rad_per_m": m.drift.as_ref().map(measured),
        })
    });
    let jump = |run: &RunSetup, jump: &Jump| {
        json!({
            "run": run.run,
            "since_s": jump.since,
            "time_s": jump.time,
            "moved_m": jump.moved,
            "turned_rad": jump.turned,
            "standard_deviations": jump.deviations,
        })
    };
    let wrong = |run: &RunSetup, wrong: &WrongPose| json!({ "run": run.run, "time_s": wrong.time, "moved_m": wrong.moved, "turned_rad": wrong.turned });
    let runs = || setup.runs.iter();
    let delay = |run: &RunSetup| json!({ "run": run.run, "delay_s": run.delay.as_ref().map(measured) });
    json!({
        "faults": faults.collect::<Vec<_>>(),
        "reference": mounting,
        "delays": setup.runs.iter().map(delay).collect::<Vec<_>>(),
        "jumps": runs().flat_map(|run| run.jumps.iter().map(move |j| jump(run, j))).collect::<Vec<_>>(),
        "wrong_poses": runs().flat_map(|run| run.wrong.iter().map(move |w| wrong(run, w))).collect::<Vec<_>>(),
        "returns": setup.returned.outlying.iter().map(outlying).collect::<Vec<_>>(),
    })
}

/// A run far from the others; its values in m and rad.
fn outlying(run: &OutlyingReturn) -> Value {
    let one = |d: &Deviant| {
        json!({
            "coordinate": d.coordinate.name(),
            "value": d.value,
            "mean_of_others": d.usual,
            "standard_deviations": finite(d.deviations),
        })
    };
    json!({
        "run": run.run,
        "test": run.test.name(),
        "direction": run.direction.map(|direction| direction.name()),
        "others": run.others,
        "moved_m": run.moved,
        "turned_rad": run.turned,
        "standard_deviations": finite(run.deviations()),
        "deviants": run.deviants.iter().map(one).collect::<Vec<_>>(),
        "said": run.sentence(),
        "remedy": run.remedy(),
    })
}

/// A quantity with standard error and 95 % interval.
pub(super) fn measured(m: &Measured) -> Value {
    json!({ "value": m.value, "std_error": finite(m.std_error), "interval": ends(m.interval) })
}

/// What of the reference was taken from the motion: its effects with their numbers.
pub(super) fn taken(taken: &[Taken]) -> Value {
    let one = |own: &Taken| {
        let numbers = own.values.iter().flatten().map(|(name, value)| ((*name).to_owned(), measured(value)));
        json!({ "effect": own.effect, "parameters": Map::from_iter(numbers), "p": own.p })
    };
    json!(taken.iter().map(one).collect::<Vec<_>>())
}

/// Why a model is not called explained, a sentence each.
pub(super) fn reasons(reasons: &[Reason]) -> Value {
    json!(reasons.iter().map(Reason::sentence).collect::<Vec<_>>())
}
