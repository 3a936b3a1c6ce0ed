//! What was found of an experiment before anything was fitted, for people.

use umbmark_core::diagnose::{Reason, Remains};
use umbmark_core::likelihood::Taken;
use umbmark_core::prose::counted;
use umbmark_core::setup::{OutlyingReturn, RunSetup, Setup};
use umbmark_core::stats::Measured;

use crate::prose::hanging;
use crate::table::with_precision_of;

/// So many jumps are told one by one; --json has all.
const JUMPS: usize = 5;

/// Faults first, with the line that corrects each.
pub fn faults_text(setup: &Setup) -> String {
    let fault =
        |(sentence, remedy): (String, String)| hanging("FAULT", 10, &format!("{sentence}. To correct it, {remedy}."));
    setup.all_faults().map(|fault| (fault.sentence(), fault.remedy())).map(fault).collect()
}

/// What makes ticks or tracks suspicious.
pub fn doubts_text(setup: &Setup) -> String {
    setup.doubts.iter().map(|doubt| hanging("DOUBT", 10, &format!("{}.", doubt.sentence()))).collect()
}

/// Clock and mounting of the reference, each with its 95 % interval.
pub fn mounting_text(setup: &Setup) -> String {
    let Some(m) = &setup.mounting else { return String::new() };
    let degrees = 1f64.to_degrees();
    let all = [
        ("late", Some(m.delay), 1e3, "ms"),
        ("fast", m.rate, 1e6, "ppm"),
        ("ahead", m.ahead, 1e3, "mm"),
        ("left", m.left, 1e3, "mm"),
        ("turned", m.yaw, degrees, "deg"),
    ];
    let shown =
        all.into_iter().filter_map(|(what, m, scale, unit)| Some(format!("{what} {}", number(&m?, scale, unit))));
    hanging("reference", 10, &shown.collect::<Vec<_>>().join(", "))
}

/// A value with its interval.
fn number(m: &Measured, scale: f64, unit: &str) -> String {
    let half = scale * (m.interval.high - m.value);
    if !half.is_finite() {
        return "not known".into();
    }
    format!("{} ± {} {unit}", with_precision_of(scale * m.value, half), with_precision_of(half, half))
}

/// What of the reference was taken into a model.
pub fn taken_text(taken: &[Taken]) -> String {
    let one = |own: &Taken| {
        let values = own.values.iter().flatten();
        let values: Vec<String> = values.map(|(name, value)| format!("{name} {}", number(value, 1.0, ""))).collect();
        let said = format!("{} was estimated from the motion before the fit: {}", own.effect, values.join(", "));
        hanging("taken", 10, said.trim_end())
    };
    taken.iter().map(one).collect()
}

/// Clocks of runs that differ.
pub fn clocks_text(setup: &Setup) -> String {
    setup.clocks().map(|said| hanging("clocks", 10, &format!("{said}."))).unwrap_or_default()
}

/// Clocks that differ, jumps and wrong poses, a paragraph each.
pub fn disturbances_text(setup: &Setup) -> String {
    let mut text = clocks_text(setup);
    let jumps = setup.jumps();
    for (run, jump) in jumps.clone().take(JUMPS) {
        let turned = jump.turned.map(|t| format!(" and {:.1} deg", t.to_degrees())).unwrap_or_default();
        let size = format!("{:.3} m{turned} ({:.0} standard deviations)", jump.moved, jump.deviations);
        let what = match jump.unrecorded {
            Some(seconds) => format!("no rows for {seconds:.2} s; the wheels' way across is off by {size}"),
            None => format!("the track jumps by {size}"),
        };
        let said = format!("{} {}: {what}; the run starts anew there.", run.run, jump.when(2));
        text += &hanging("jump", 10, &said);
    }
    if let rest @ 1.. = jumps.count().saturating_sub(JUMPS) {
        text += &hanging("", 10, &format!("and {rest} more (--json)"));
    }
    text += &setup.wrong_steps().map(|said| hanging("steps", 10, &format!("{said}."))).unwrap_or_default();
    let wrong: Vec<&RunSetup> = setup.runs.iter().filter(|run| !run.relative && !run.wrong.is_empty()).collect();
    for run in wrong.iter().take(JUMPS) {
        text += &hanging("wrong", 10, &format!("{}, and left out.", run.notice()));
    }
    if let rest @ 1.. = wrong.len().saturating_sub(JUMPS) {
        text += &hanging("", 10, &format!("and wrong poses in {} (--json)", counted(rest, "more run")));
    }
    text
}

/// Runs whose return error is far from the others, a paragraph each.
pub fn returns_text(setup: &Setup) -> String {
    let outlying = &setup.returned.outlying;
    let one =
        |run: &OutlyingReturn| hanging("RETURN", 10, &format!("{}. To correct it, {}.", run.sentence(), run.remedy()));
    let mut text: String = outlying.iter().take(JUMPS).map(one).collect();
    if let rest @ 1.. = outlying.len().saturating_sub(JUMPS) {
        text += &hanging("", 10, &format!("and {rest} more (--json)"));
    }
    text
}

/// What a model leaves, a paragraph for what repeats, for chance and for disturbances.
pub fn remains_text(remains: Option<&Remains>) -> String {
    let sentences = remains.map(Remains::sentences).unwrap_or_default();
    let heads = std::iter::once("left").chain(std::iter::repeat(""));
    heads.zip(sentences).map(|(head, sentence)| hanging(head, 10, &sentence)).collect()
}

/// Why a model is not called explained.
pub fn reasons_text(reasons: &[Reason]) -> String {
    let told = reasons.iter().filter(|reason| !matches!(reason, Reason::Fault(_)));
    told.map(|reason| hanging("reason", 10, &format!("{}.", reason.sentence()))).collect()
}
