//! The answer in words.

use super::{Change, Measure, Off, Part, Solution};
use crate::action::{Action, Wording};
use crate::diagnose::{Experiment, Reason, Verdict};
use crate::effect::find;
use crate::evidence::Level;
use crate::prose::{counted, listed};

/// An error is told in tenths of a millimetre below this \[m\].
const FINE: f64 = 0.01;
/// A part is told where it is more than this share of the whole.
pub(super) const TOLD: f64 = 0.02;
/// Another effect in place of one that was added is named where its Akaike weight is more than this.
const LIKELY: f64 = 0.05;
/// New numbers make it worse where the error that they leave exceeds that as driven by this share.
pub(super) const WORSE: f64 = 0.1;

pub(super) fn sentence(solution: &Solution) -> String {
    if let Some(fault) = solution.faults().first() {
        return format!("Nothing can be said of the robot yet: {}. First {}.", fault.sentence(), fault.remedy());
    }
    let Some(off) = &solution.off else {
        return "These data do not show how far off the robot is: no run has a measured pose at its end.".into();
    };
    let mut said = vec![how_far(off)];
    let reference: f64 = off.reference.iter().map(|part| part.worth).sum();
    if reference > TOLD * off.driven {
        said.push(format!(
            "{} of it is the reference's, not the robot's: {}.",
            mm(reference),
            titles(solution, &off.reference)
        ));
    }
    said.extend(of_numbers(solution, off));
    said.join(" ")
}

/// How far off the robot is.
fn how_far(off: &Off) -> String {
    let far = mm(off.driven);
    match off.measure {
        Measure::Returns => format!("The robot comes back {far} off."),
        Measure::Ends => format!("The robot ends {far} from where its odometry says it is."),
        Measure::Steps => {
            format!(
                "From one measurement to the next, the robot is {far} from where its odometry says it is, on average."
            )
        }
        Measure::Along => format!("The robot is {far} from where its odometry says it is, on average along the way."),
    }
}

/// What new numbers do, and what they leave.
fn of_numbers(solution: &Solution, off: &Off) -> Vec<String> {
    let verdict = solution.learnt.verdict;
    if solution.changes.is_empty() {
        return vec![match verdict {
            Verdict::NotEnoughData => "These runs are too few to say why.".into(),
            _ => "These runs do not show the numbers of the robot.".into(),
        }];
    }
    if solution.learnt.is_in_doubt() {
        let mut forbidding =
            solution.learnt.diagnosis.reasons.iter().filter(|reason| reason.forbids_writing()).peekable();
        let cause = match forbidding.peek().is_some() && forbidding.all(Reason::is_of_data) {
            _ if solution.learnt.partial => "The search was stopped",
            true => "What was measured is in doubt",
            false => "No model explains these runs",
        };
        return vec![format!("{cause}, so do not write the new numbers below into the robot yet.")];
    }
    if let Some(vague) = vague(solution) {
        return vec![vague];
    }
    if solution.misleads_alone() {
        return vec![alone(solution, off)];
    }
    if solution.makes_worse() {
        return vec![worse(off)];
    }
    if let Some(outweighed) = outweighed(solution) {
        return vec![outweighed];
    }
    let known: f64 = off.known.iter().map(|part| part.worth).sum();
    let explained = verdict == Verdict::Explained;
    // Runs begin anew behind the jumps that the setup found, and not behind those that only the fit shows.
    let jumps = if off.measure == Measure::Along { only_fitted(solution) } else { 0 };
    let remains = solution.learnt.diagnosis.remains.as_ref();
    let drifts = remains.is_some_and(|remains| remains.excess().is_some());
    let is_chance = |error: f64| off.chance.map_or(explained && jumps == 0 && !drifts, |chance| error <= chance);
    let by_chance = |error: f64| match off.chance {
        _ if is_chance(error) => ", no more than chance makes".to_owned(),
        Some(chance) => format!(", and chance stays below {} in 95 % of tests", mm(chance)),
        None if jumps == 1 => ", of which one jump that only the fit shows makes a part".to_owned(),
        None if jumps > 1 => format!(", of which {jumps} jumps that only the fit shows make a part"),
        None => String::new(),
    };
    let mut said = Vec::new();
    if !solution.needed {
        said.push(match off.known.is_empty() && is_chance(off.driven) {
            true => "That is no more than chance makes: its numbers are right, and nothing is to be written.".into(),
            false if off.driven - off.with_numbers > TOLD * off.driven || !solution.tells_numbers() => {
                "These runs do not tell whether its numbers are right: nothing is to be written.".into()
            }
            false => "Its numbers are right: nothing is to be written.".into(),
        });
    } else {
        let (count, these) = match solution.changes.len() {
            1 => ("the new number".to_owned(), "it"),
            count => (format!("the {count} new numbers"), "them"),
        };
        let (left, names) = (mm(off.with_numbers), listed(&names(&solution.changes)));
        let rest = if off.known.is_empty() { by_chance(off.with_numbers) } else { String::new() };
        let fall = off.driven - off.with_numbers;
        said.push(match fall > TOLD * off.driven {
            true => format!("Write {count} ({names}): with {these}, {left} are left{rest}."),
            false if off.measure == Measure::Steps && -fall <= TOLD * off.driven => format!(
                "Write {count} ({names}): they differ from the old ones by more than chance, though a single step hardly shows it."
            ),
            false if -fall <= TOLD * off.driven => format!(
                "Write {count} ({names}): they differ from the old ones by more than chance, though on this path the error of the \
                 position hardly shows it."
            ),
            false if off.known.is_empty() => format!("Write {count} ({names}): with {these}, {left} are left{rest}."),
            false => {
                let elsewhere = match off.known.iter().any(|part| solution.travels(part)) {
                    true => "",
                    false => " On another floor they are better.",
                };
                format!(
                    "Write {count} ({names}). With {these} alone, {left} are left on this path: what no number holds had hidden a \
                     part of their error.{elsewhere}"
                )
            }
        });
    }
    if !off.known.is_empty() {
        let titles = titles(solution, &off.known);
        said.push(match known > TOLD * off.driven {
            true => format!("{} of it is known but no number of the robot can hold it: {titles}.", mm(known)),
            false => format!("Known besides, and no number of the robot can hold it: {titles}."),
        });
    }
    if solution.misses_something() {
        said.push(format!("The robot has a further error source, which the model lacks{}.", hidden(solution)));
    } else if !off.known.is_empty() {
        said.push(format!("The rest is {}{}.", mm(off.rest), by_chance(off.rest)));
        if verdict == Verdict::UnlistedEffect {
            said.push(format!("The cause of a law outside the catalogue is not known{}.", hidden(solution)));
        }
    }
    said
}

/// That what is not known may hide in the new numbers, where there are some to write.
fn hidden(solution: &Solution) -> &'static str {
    match solution.needed {
        true => ": a part of it may be in the new numbers, and their intervals leave that out",
        false => "",
    }
}

/// Number of jumps of the tracks that only the fit shows.
fn only_fitted(solution: &Solution) -> usize {
    let diagnosis = &solution.learnt.diagnosis;
    diagnosis.outliers.len().saturating_sub(diagnosis.setup.jumps().count())
}

/// That what no catalogue lists makes more of the error than the new numbers do, where it does.
fn outweighed(solution: &Solution) -> Option<String> {
    let [laws, numbers] = solution.outweighed()?;
    let off = solution.off.as_ref()?;
    let gain = match numbers > TOLD * off.driven {
        true => format!(", and the new numbers {} of it", mm(numbers)),
        false => ", and the new numbers hardly any of it".to_owned(),
    };
    Some(format!(
        "{} of it follows {}{gain}. The cause of the law is not known, and a part of it may be in the numbers: do not write them \
         before it is found.",
        mm(laws),
        titles(solution, &off.known)
    ))
}

/// That some of the new numbers are known worse than by tape, where they are.
fn vague(solution: &Solution) -> Option<String> {
    let share = |change: &Change| {
        let interval = change.interval?;
        Some(0.5 * (interval.high - interval.low) / change.new.abs())
    };
    let widest = solution.vague().filter_map(share).fold(0.0, f64::max);
    let named = listed(&names(solution.vague()));
    (widest > 0.0).then(|| {
        format!(
            "These runs leave the {named} open, by up to {:.0} % either way, which any tape tells better: do not write the new \
             numbers below.",
            100.0 * widest
        )
    })
}

/// Why the new numbers are not to be written alone.
fn alone(solution: &Solution, off: &Off) -> String {
    let these = match solution.changes.len() {
        1 => "The new number holds".to_owned(),
        count => format!("The {count} new numbers hold"),
    };
    format!(
        "{these} only beside {}, which no number of the robot can hold. Alone, they would leave {} on this path, more than the {} \
         as driven: do not write them alone.",
        titles(solution, &off.known),
        mm(off.with_numbers),
        mm(off.driven)
    )
}

/// That the new numbers leave more than there is.
fn worse(off: &Off) -> String {
    format!(
        "The new numbers below would leave {}, more than the {} as driven: do not write them.",
        mm(off.with_numbers),
        mm(off.driven)
    )
}

/// Why the numbers of a model are not to be written, where they are not.
pub(super) fn doubt(solution: &Solution) -> Option<String> {
    if !solution.learnt.is_in_doubt()
        && let Some(vague) = vague(solution)
    {
        return Some(vague);
    }
    if !solution.learnt.is_in_doubt() && solution.misleads_alone() {
        return solution.off.as_ref().map(|off| alone(solution, off));
    }
    if !solution.learnt.is_in_doubt() && solution.makes_worse() {
        return solution.off.as_ref().map(worse);
    }
    if !solution.learnt.is_in_doubt()
        && let Some(outweighed) = outweighed(solution)
    {
        return Some(outweighed);
    }
    let reasons = solution.learnt.diagnosis.reasons.iter().map(|reason| reason.sentence());
    let told = reasons.collect::<Vec<_>>().join("; ");
    (!solution.is_trusted()).then(|| format!("No model explains these runs: {told}."))
}

/// What else the runs show where E_d, E_b and E_s do not explain them.
pub(super) fn beyond_wheels(solution: &Solution) -> Option<String> {
    let known = &solution.off.as_ref()?.known;
    let more = match (known.is_empty(), solution.misses_something()) {
        (true, false) => return None,
        (true, true) => "there is a further error source, which no model explains".to_owned(),
        (false, _) => format!("there is also {}", titles(solution, known)),
    };
    Some(format!(
        "E_d, E_b and E_s do not explain these runs: {more}. The other methods take that for wheels and wheelbase; the learnt \
         model does not."
    ))
}

pub(super) fn next(solution: &Solution, words: Wording) -> Vec<String> {
    let faults = solution.faults();
    if !faults.is_empty() {
        let told = faults.iter().map(|fault| capital(&format!("{}, then solve again.", fault.remedy())));
        return told.collect();
    }
    let mut next = Vec::new();
    let learn = words(Action::Learn);
    let diagnosis = &solution.learnt.diagnosis;
    let enough = solution.learnt.verdict != Verdict::NotEnoughData;
    if solution.learnt.is_in_doubt() {
        next.extend(diagnosis.reasons.iter().map(|reason| capital(&format!("{}.", reason.sentence()))));
        let check = words(Action::CheckData);
        next.push(format!("Correct what is named above, or measure again; {check} checks the data."));
    } else if solution.vague().next().is_some() {
        next.push("Drive more runs, with straights and turns both ways, and at several speeds.".into());
    } else if solution.misleads_alone() {
        next.push(format!("Let the robot compute its odometry by the whole model: {}.", words(Action::WriteTable)));
        next.push(format!(
            "Or write numbers that fit drives like these without the other effects: {}. They are not the robot's true lengths.",
            words(Action::WriteFitted)
        ));
    } else if solution.makes_worse() {
        next.push("Drive more runs, with straights and turns both ways: these do not show numbers that help.".into());
    } else if solution.outweighed().is_some() {
        next.push(format!(
            "Find the cause of the law: {learn} says how sure it is, which others do as well, and which drive tells them apart."
        ));
    } else if solution.needed && !solution.changes.is_empty() {
        next.push(format!("Write the new numbers: {}.", words(Action::WriteNumbers)));
        let diagnosis = &solution.learnt.diagnosis;
        let from_sheet = diagnosis.level == Level::Ends && diagnosis.setup.runs.is_empty();
        let undo = match from_sheet {
            true => " If it is twice as bad, the sheet has computed minus measured: change its signs, and solve again.",
            false => "",
        };
        next.push(format!(
            "Then drive the same test again: {} shows whether it is better.{undo}",
            words(Action::Score)
        ));
    }
    let found = || solution.learnt.diagnosis.setup.runs.iter().flat_map(|run| &run.jumps);
    let unrecorded = found().filter(|jump| jump.unrecorded.is_some()).count();
    let jumps = found().count() - unrecorded + only_fitted(solution);
    if !solution.learnt.is_in_doubt() && jumps > 0 {
        next.push(format!(
            "Find the cause of {}: counts that were lost, a wheel that slipped, a push, or a reference that lost the robot. {} says \
             where.",
            counted(jumps, "jump"),
            capital(learn)
        ));
    }
    if !solution.learnt.is_in_doubt() && unrecorded > 0 {
        next.push(format!(
            "Log without a gap: in {} no rows were written while the wheels rolled, and no odometry knows that way. {} says \
             where.",
            counted(unrecorded, "place"),
            capital(learn)
        ));
    }
    if !enough {
        next.push("Drive at least three runs in each direction, or log poses on the way, then solve again.".into());
    }
    let has = |words: &[&str]| solution.not_shown.iter().any(|effect| words.contains(effect));
    if solution.assumes_scale() {
        next.push(
            "Measure one straight leg by tape, or a pose on the way: these runs do not show whether the wheels are too large \
             or too small on the whole."
                .into(),
        );
    }
    if has(&["wheelbase"]) && enough {
        next.push("Drive turns: these runs do not show the wheelbase.".into());
    }
    if !solution.learnt.is_in_doubt() && solution.off.as_ref().is_some_and(|off| !off.known.is_empty()) {
        next.push(format!("Correct logs by all that is known: {}.", words(Action::CorrectLogs)));
    }
    next.extend(unsure(solution).map(|e| {
        let [own, other] = e.separates;
        format!("To tell {own} from {other}: {} ({:.0} min).", e.experiment, e.minutes)
    }));
    next
}

/// The experiment that tells effects of one class apart, of which one was added.
fn unsure(solution: &Solution) -> Option<&Experiment> {
    let classes = || solution.learnt.steps.iter().filter(|step| step.class.len() > 1);
    let tells = |e: &&Experiment| classes().any(|step| e.separates.iter().all(|name| step.class.contains(name)));
    solution.learnt.diagnosis.next_experiments.iter().find(tells)
}

/// What effects are called, the largest part first, each with those that the runs cannot tell from it.
fn titles(solution: &Solution, parts: &[Part]) -> String {
    let mut parts: Vec<&Part> = parts.iter().collect();
    parts.sort_by(|a, b| b.worth.abs().total_cmp(&a.worth.abs()));
    let title = |name: &str| find(name).map_or_else(|_| name.replace('_', " "), |entry| entry.about.title.to_owned());
    let told = |part: &&Part| {
        let step = solution.learnt.steps.iter().find(|step| step.added == Some(part.name));
        if let Some(law) = step.and_then(|step| step.law.as_ref()) {
            return format!("a law that is in no catalogue ({})", law.law.words());
        }
        let of_class = step.into_iter().flat_map(|step| &step.class).copied();
        let as_likely = solution.others.iter().filter(|other| other.added == Some(part.name) && other.weight > LIKELY);
        let as_likely = as_likely.map(|other| other.effect).filter(|name| find(name).is_ok());
        let mut others: Vec<String> = Vec::new();
        for other in of_class.chain(as_likely).filter(|name| *name != part.name).map(title) {
            if !others.contains(&other) {
                others.push(other);
            }
        }
        if others.is_empty() { title(part.name) } else { format!("{} (or {})", title(part.name), others.join(" or ")) }
    };
    listed(&parts.iter().map(told).collect::<Vec<_>>())
}

/// What the new numbers are called; two of which only the side differs are one.
fn names<'a>(changes: impl IntoIterator<Item = &'a Change>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for change in changes {
        let name = without_unit(change.key);
        let both = ["_left", "_right"].into_iter().find_map(|side| name.strip_suffix(side));
        let name = both.map_or(name.to_owned(), |both| format!("{both}s")).replace('_', " ");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// A key without its unit.
fn without_unit(key: &str) -> &str {
    ["_rad_per_m", "_m", "_rad"].into_iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key)
}

/// Millimetres; tenths of small ones.
fn mm(metres: f64) -> String {
    let decimals = usize::from(metres.abs() < FINE);
    format!("{:.decimals$} mm", 1e3 * metres)
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
