//! What a model explains of tracks and what it does not, in plain sentences.

use super::{Against, By, Mean, Part, Test, TrackErrors, TracksJudged};

/// A part is named if it has this share of the error.
const MUCH: f64 = 0.2;
/// Maximum number of parts, and of dependences of one rate, that are named.
const NAMED: usize = 3;

pub(super) fn of(judged: &TracksJudged, size: f64) -> Vec<String> {
    let (mut sentences, errors) = (Vec::new(), &judged.errors);
    if errors.tests == 0 {
        sentences.push("Too few runs, or poses too far apart, to test what the errors depend on.".to_owned());
    }
    let least = size / errors.tests.max(1) as f64;
    sentences.extend(judged.reasons.iter().map(|reason| format!("Not explained: {}.", reason.sentence())));
    sentences.extend(levels(errors, least));
    sentences.extend(dependences(errors, least));
    if errors.tests > 0 && sentences.is_empty() {
        sentences.push(format!("Explained: none of {} tests shows a repeating error that matters.", errors.tests));
    }
    sentences.extend(too_small(errors, least));
    sentences.extend(not_asked(errors));
    sentences.extend(seen_to(errors));
    sentences.extend(where_made(&errors.parts));
    sentences
}

/// What is off and on what it depends, without more words.
pub(super) fn accused(errors: &TrackErrors, size: f64) -> Vec<String> {
    let least = size / errors.tests.max(1) as f64;
    let told = levels(errors, least).into_iter().chain(dependences(errors, least));
    told.map(|said| said.trim_start_matches("Not explained: ").trim_end_matches('.').to_owned()).collect()
}

fn levels(errors: &TrackErrors, least: f64) -> Vec<String> {
    let accused = errors.overall.iter().filter(|o| o.test.is_some_and(|test| test.shows(least) && test.matters()));
    let told = accused.map(|o| {
        let (scale, unit) = o.rate.display();
        let value = with_interval(&o.mean, scale);
        format!("Not explained: {} is off by {value} {unit} overall.", o.rate.name())
    });
    told.collect()
}

fn dependences(errors: &TrackErrors, least: f64) -> Vec<String> {
    let mut sentences = Vec::new();
    for rate in super::Rate::DEPENDING {
        let of_rate = errors.against.iter().filter(|a| a.rate == rate).filter_map(|a| Some((a.test?, a)));
        let accused = of_rate.filter(|(test, _)| test.shows(least) && test.matters());
        let mut accused: Vec<(f64, &Against)> = accused.map(|(test, a)| (test.p, a)).collect();
        accused.sort_by(|a, b| a.0.total_cmp(&b.0));
        if accused.is_empty() {
            continue;
        }
        let names: Vec<&str> = accused.iter().take(NAMED).map(|(_, a)| a.covariate.title).collect();
        let further = match accused.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" (and {more} more)"),
        };
        sentences.push(format!("Not explained: {} depends on {}{further}.", rate.name(), names.join("; on ")));
    }
    sentences
}

/// Errors that are shown to repeat and would lower the error of other runs by too little.
fn too_small(errors: &TrackErrors, least: f64) -> Option<String> {
    let small = |test: &Option<Test>| test.filter(|test| test.shows(least) && !test.matters()).map(|test| test.gain);
    let levels = errors.overall.iter().filter_map(|o| Some((format!("{} overall", o.rate.name()), small(&o.test)?)));
    let dependences = errors
        .against
        .iter()
        .filter_map(|a| Some((format!("{} by {}", a.rate.name(), a.covariate.title), small(&a.test)?)));
    let told: Vec<(String, f64)> = levels.chain(dependences).collect();
    let most = told.iter().map(|(_, gain)| *gain).reduce(f64::max)?;
    let names: Vec<&str> = told.iter().map(|(name, _)| name.as_str()).collect();
    let worth = if most > 0.0 { format!("by at most {:.1} %", 100.0 * most) } else { "by nothing".to_owned() };
    Some(format!("Repeats, but lowers the error of runs left out {worth}: {}.", names.join("; ")))
}

/// What the counters are too coarse for.
fn not_asked(errors: &TrackErrors) -> Option<String> {
    let blurred = errors.against.iter().filter(|against| against.blurred);
    let told: Vec<String> = blurred.map(|a| format!("{} by {}", a.rate.name(), a.covariate.title)).collect();
    (!told.is_empty())
        .then(|| format!("Not tested within runs, because one tick is too coarse for it: {}.", told.join("; ")))
}

/// The smallest overall error that would have been detected.
fn seen_to(errors: &TrackErrors) -> Option<String> {
    let half = |o: &super::Overall| {
        let (scale, unit) = o.rate.display();
        let interval = o.mean.interval?;
        Some(format!("{} to ± {:.2} {unit}", o.rate.name(), scale * 0.5 * (interval.high - interval.low)))
    };
    let seen: Vec<String> = errors.overall.iter().filter_map(half).collect();
    (!seen.is_empty()).then(|| format!("Overall intervals: {}.", seen.join(", ")))
}

fn where_made(parts: &[Part]) -> Option<String> {
    let mut moves: Vec<&Part> =
        parts.iter().filter(|part| part.by == By::Move && part.share.position >= MUCH).collect();
    moves.sort_by(|a, b| b.share.position.total_cmp(&a.share.position));
    let told = |part: &&Part| {
        let direction = part.direction.map_or(String::new(), |d| format!(" of {} runs", d.name()));
        format!("{}{direction} ({:.0} %)", part.name, 100.0 * part.share.position)
    };
    let told: Vec<String> = moves.iter().take(NAMED).map(told).collect();
    let undone = if moves.iter().take(NAMED).any(|part| part.share.position > 1.0) {
        " Other moves undo a part of that."
    } else {
        ""
    };
    (!told.is_empty()).then(|| format!("Most of the position error is made in {}.{undone}", told.join(", ")))
}

fn with_interval(mean: &Mean, scale: f64) -> String {
    match mean.interval {
        Some(interval) => format!("{:.2} ± {:.2}", scale * mean.value, scale * 0.5 * (interval.high - interval.low)),
        None => format!("{:.2}", scale * mean.value),
    }
}
