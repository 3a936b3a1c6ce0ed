//! The first screen: how far off, why, what to write, and how the error fell.

use serde::Serialize;
use umbmark_core::action::Wording;
use umbmark_core::effect::find;
use umbmark_core::learn::{Learnt, Step};
use umbmark_core::result::meaning;
use umbmark_core::score::Change as Difference;
use umbmark_core::solve::{Change, Measure, Off, Part, Solution};

use super::said;
use super::verdict::Outcome;
use crate::scale::written;
use crate::study::{Absent, Study};

const MM: f64 = 1e3;
/// An error is told in tenths of a millimetre below this \[m\].
const FINE: f64 = 0.01;

/// What the first screen says of one study.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    /// What the dataset is called.
    name: String,
    notices: Vec<String>,
    /// In a word, which decides the colour.
    outcome: &'static str,
    /// The same for people.
    words: &'static str,
    verdict: String,
    far: Tile,
    why: Tile,
    write: Tile,
    fall: Vec<Fallen>,
    /// What each value means for the robot.
    meaning: Vec<(String, String)>,
    next: Vec<String>,
}

/// A question and its answer.
#[derive(Debug, Default, Serialize)]
struct Tile {
    /// The answer in a word or a number.
    answer: String,
    /// What it is, in a sentence.
    says: String,
    rows: Vec<Row>,
}

/// A line of an answer.
#[derive(Debug, Serialize)]
struct Row {
    words: String,
    /// A name of files, shown small.
    id: String,
    value: String,
    /// What stands below the value.
    beside: String,
}

/// A step of the fall of the error.
#[derive(Debug, Serialize)]
struct Fallen {
    words: String,
    id: String,
    value: String,
    /// Of the largest error, in percent.
    share: f64,
}

impl Summary {
    pub(super) fn of(study: &Study, actions: Wording) -> Summary {
        let solution = study.solution();
        let said = said(study);
        let told = |tile: fn(&Solution) -> Tile, absent: fn(&Study, &Absent) -> Tile| match solution.as_ref() {
            Ok(solution) => tile(solution),
            Err(why) => absent(study, why),
        };
        let far = Tile { says: beside_far(study, solution.as_ref().ok().copied()), ..told(how_far, far_of_score) };
        let means = study.diagnosis().map(|diagnosis| meaning(&diagnosis.fitted, &diagnosis.model));
        let is_chance = solution.as_ref().is_ok_and(|solution| is_chance(solution));
        let means = means.iter().filter(|_| !is_chance).flat_map(|means| means.iter());
        let means = means.map(|(effect, sentence)| (effect.to_owned(), sentence.clone()));
        let steps = study.learnt().map(|learnt| learnt.steps.iter()).into_iter().flatten();
        let of_law = |step: &Step| {
            let words = step.law.as_ref()?.law.words();
            Some((step.added?.to_owned(), format!("A law that is in no catalogue: {words}.")))
        };
        Summary {
            name: said.name,
            notices: said.notices,
            outcome: said.outcome,
            words: Outcome::of(study).words(),
            verdict: said.verdict,
            far,
            why: told(why, why_of_model),
            write: told(to_write, |_, why| Tile { answer: "–".into(), says: why.to_string(), rows: Vec::new() }),
            fall: study.learnt().map(fall).unwrap_or_default(),
            meaning: means.chain(steps.filter_map(of_law)).collect(),
            next: solution.map(|solution| solution.next(actions)).unwrap_or_default(),
        }
    }
}

/// Millimetres; tenths of small ones.
pub(super) fn millimetres(metres: f64) -> String {
    format!("{} mm", written(MM * metres, usize::from(metres.abs() < FINE)))
}

fn how_far(solution: &Solution) -> Tile {
    let answer = solution.off.as_ref().map_or("–".to_owned(), |off| millimetres(off.driven));
    Tile { answer, ..Tile::default() }
}

fn far_of_score(study: &Study, _: &Absent) -> Tile {
    let e_max = study.score().ok().and_then(|score| score.summary.e_max_sys());
    Tile { answer: e_max.map_or("–".to_owned(), millimetres), ..Tile::default() }
}

/// What the number is, its interval, and what chance alone would be.
fn beside_far(study: &Study, solution: Option<&Solution>) -> String {
    let measure = solution.and_then(|solution| solution.off.as_ref()).map(|off| off.measure);
    let what = match measure {
        Some(Measure::Ends) => {
            return "from where its odometry says it is, at the ends of the runs (root mean square).".into();
        }
        Some(Measure::Steps) => {
            return "from where its odometry says it is, from one measurement to the next (root mean square).".into();
        }
        Some(Measure::Along) => return "from where its odometry says it is, along the way (root mean square).".into(),
        Some(Measure::Returns) | None => "from START, the worse of both directions on average: E_max,sys",
    };
    let Ok(score) = study.score() else { return "No run has a measured end.".into() };
    let level = 100.0 * score.level;
    let interval = score.intervals.as_ref().and_then(|intervals| intervals.e_max_sys);
    let interval = interval.map(|i| format!(" ({level:.0} %: {:.0} to {:.0} mm)", MM * i.low, MM * i.high));
    let chance = score.noise_band.map(|band| format!(" Chance alone would reach {}.", millimetres(band)));
    format!("{what}{}.{}", interval.unwrap_or_default(), chance.unwrap_or_default())
}

fn why(solution: &Solution) -> Tile {
    let Some(off) = &solution.off else {
        return Tile { answer: "unknown".into(), says: "See the verdict.".into(), rows: Vec::new() };
    };
    if is_chance(solution) {
        let says = "Wheels and wheelbase differ from the robot's numbers by no more than chance, and no other error source is found.";
        return Tile { answer: "scatter".into(), says: says.into(), rows: Vec::new() };
    }
    let mut parts: Vec<&Part> = off.reference.iter().chain(&off.written).chain(&off.known).collect();
    parts.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    // What does not show at all is no error source here.
    parts.retain(|part| part.worth.abs() >= 5e-5);
    let mut rows: Vec<Row> = parts.iter().map(|part| of_part(part, solution)).collect();
    let above = |chance: f64| off.rest > chance;
    let rest = match off.chance {
        _ if solution.misses_something() => "not explained".to_owned(),
        Some(chance) if above(chance) => format!("the rest; chance stays below {}", millimetres(chance)),
        _ => "the rest: scatter".to_owned(),
    };
    rows.push(Row { words: rest, id: String::new(), value: millimetres(off.rest), beside: String::new() });
    let answer = match parts.len() {
        0 => "no error source".to_owned(),
        1 => "1 error source".to_owned(),
        count => format!("{count} error sources"),
    };
    let hid = if parts.iter().any(|part| part.worth < 0.0) { " One below zero hid a part of the others." } else { "" };
    Tile { answer, says: format!("What each takes off the {}.{hid}", of_measure(off)), rows }
}

/// Whether nothing is found but what chance makes.
fn is_chance(solution: &Solution) -> bool {
    let others = solution.off.as_ref().is_some_and(|off| !(off.known.is_empty() && off.reference.is_empty()));
    solution.is_trusted() && !solution.needed && !others && !solution.misses_something()
}

fn of_measure(off: &Off) -> String {
    let what = match off.measure {
        Measure::Returns => "of E_max,sys",
        Measure::Ends => "at the ends",
        Measure::Along => "along the way",
        Measure::Steps => "from step to step",
    };
    format!("{} {what}, averaged over the orders of adding them", millimetres(off.driven))
}

fn of_part(part: &Part, solution: &Solution) -> Row {
    let step = solution.learnt.steps.iter().find(|step| step.added == Some(part.name));
    let words = step.map_or_else(|| title(part.name), of_step);
    Row { words, id: part.name.into(), value: millimetres(part.worth), beside: String::new() }
}

/// An effect in words.
fn title(effect: &str) -> String {
    find(effect).map_or_else(|_| effect.replace('_', " "), |entry| entry.about.title.to_owned())
}

/// What a step added, in words.
fn of_step(step: &Step) -> String {
    let Some(effect) = step.added else { return "as the robot is".into() };
    let words = match &step.law {
        Some(_) => format!("a law that is not in the catalogue: {}", effect.replace('_', " ")),
        None => title(effect),
    };
    match step.class.len() {
        0 | 1 => words,
        _ => {
            let others: Vec<&str> = step.class.iter().copied().filter(|other| *other != effect).collect();
            format!("{words} (or {})", others.join(", "))
        }
    }
}

fn why_of_model(study: &Study, _: &Absent) -> Tile {
    let Ok(model) = study.model() else {
        return Tile { answer: "unknown".into(), says: "No model could be fitted.".into(), rows: Vec::new() };
    };
    let free: Vec<&str> = model.parts().iter().filter(|part| part.free).map(|part| part.effect.name()).collect();
    let row = |name: &&str| Row { words: title(name), id: (*name).into(), value: String::new(), beside: String::new() };
    let answer = if free.len() == 1 { "1 effect".to_owned() } else { format!("{} effects", free.len()) };
    Tile { answer, says: format!("fitted, of {}.", study.model_name()), rows: free.iter().map(row).collect() }
}

fn to_write(solution: &Solution) -> Tile {
    let rows: Vec<Row> = solution.changes.iter().map(of_change).collect();
    let (answer, says) = match (rows.len(), solution.is_trusted(), solution.needed) {
        (0, ..) => ("nothing", "These runs do not show the numbers of the robot.".to_owned()),
        (_, false, _) if solution.misleads_alone() => {
            ("nothing alone", "Alone, these numbers would make it worse: see the sentence above.".to_owned())
        }
        (_, false, _) if solution.makes_worse() => {
            ("nothing yet", "With these numbers, the error would be larger than as driven.".to_owned())
        }
        (_, false, _) if !solution.learnt.is_in_doubt() => {
            ("nothing yet", "These runs leave too much open for that: see the sentence above.".to_owned())
        }
        (_, false, _) => ("nothing yet", "The runs are not explained, so these numbers are not to be trusted.".into()),
        (_, true, false) => ("nothing", "The numbers of the robot are right as far as these runs can show.".into()),
        (count, true, true) => {
            let numbers = if count == 1 { "one number".to_owned() } else { format!("{count} numbers") };
            let left = solution.off.as_ref().map(|off| format!(": {} are left then", millimetres(off.with_numbers)));
            return Tile {
                answer: numbers,
                says: format!("in its robot.toml or controller{}.", left.unwrap_or_default()),
                rows,
            };
        }
    };
    Tile { answer: answer.into(), says, rows: if solution.needed { rows } else { Vec::new() } }
}

/// A number of the robot: its new value with its interval, and the old one.
fn of_change(change: &Change) -> Row {
    let is_length = change.key.ends_with("_m") && !change.key.ends_with("_per_m");
    let (scale, unit) = if is_length { (MM, " mm") } else { (1.0, "") };
    let half = change.interval.map(|i| 0.5 * scale * (i.high - i.low)).filter(|half| *half > 0.0);
    let decimals = half.map_or(3.0, |half| (1.0 - half.log10().floor()).clamp(0.0, 9.0)) as usize;
    let number = |value: f64| written(value, decimals);
    let about = half.map(|half| format!(" ± {}", number(half))).unwrap_or_default();
    let words = change.key.trim_end_matches("_m").trim_end_matches("_rad").replace('_', " ");
    Row {
        words,
        id: change.key.into(),
        value: format!("{}{about}{unit}", number(scale * change.new)),
        beside: format!("now {}{unit}", number(scale * change.old)),
    }
}

fn fall(learnt: &Learnt) -> Vec<Fallen> {
    let most = learnt.steps.iter().map(|step| step.held_out.position).fold(f64::MIN_POSITIVE, f64::max);
    let row = |step: &Step| Fallen {
        words: match step.added {
            None => of_step(step),
            Some(_) => format!("+ {}", of_step(step)),
        },
        id: step.added.unwrap_or_default().into(),
        value: millimetres(step.held_out.position),
        share: (1000.0 * step.held_out.position / most).round() / 10.0,
    };
    learnt.steps.iter().map(row).collect()
}

/// What became of a robot from the first study to the second.
#[derive(Debug, Serialize)]
pub(super) struct Changed {
    outcome: &'static str,
    /// In a word or two; nothing where it is not known.
    word: &'static str,
    says: String,
}

/// The change between two studies of different data; `None` for one study, or two models of the same data.
pub(super) fn changed(studies: &[Study]) -> Option<Changed> {
    let [before, after] = studies else { return None };
    if before.data.runs == after.data.runs {
        return None;
    }
    let options = &before.options.diagnose;
    let draws = options.draws.max(FEWEST_DRAWS);
    let named = |says: String| format!("From {} to {}: {says}", before.name, after.name);
    Some(match Difference::of(&before.data, &after.data, options.size, draws, options.seed) {
        Err(why) => Changed { outcome: "unknown", word: "", says: named(format!("{why}.")) },
        Ok(change) => {
            let [was, is] = change.rms.map(millimetres);
            let [n, m] = change.runs;
            let says = format!(
                "the root mean square return error went from {was} ({n} runs) to {is} ({m} runs), {} (permutation test of \
                 squared return errors).",
                crate::kind::p_is(change.p)
            );
            let outcome = change.outcome.name();
            Changed { outcome, word: judged(outcome), says: named(says) }
        }
    })
}

/// Permutations of a test that is told on a page, at least.
const FEWEST_DRAWS: usize = 999;

fn judged(outcome: &str) -> &'static str {
    match outcome {
        "better" => "Better.",
        "worse" => "Worse.",
        _ => "The same, as far as these runs can show.",
    }
}

/// Whether the robot returns better, in a word; `None` where that is not known.
pub fn change(studies: &[Study]) -> Option<&'static str> {
    changed(studies).map(|changed| changed.outcome).filter(|outcome| *outcome != "unknown")
}
