//! Which numbers depend on which conditions, in words.

use super::{Against, Asked, AskedCondition, Conditions, Kind, Number, SESSION, Shared};
use crate::effect::Model;
use crate::prose::counted;

/// What a number of a model is, in words.
pub(super) fn meaning(model: &Model, number: &Number) -> String {
    let part = model.parts().iter().find(|part| part.effect.name() == number.effect);
    let Some(part) = part else { return number.key() };
    let title = part.effect.entry().map_or(number.effect, |entry| entry.about.title);
    if part.effect.parameters().len() > 1 { format!("{title}, {}", number.parameter) } else { title.to_owned() }
}

/// What depends on something comes first.
pub(super) fn sentence(found: &Conditions) -> String {
    let mut said: Vec<String> = found.differing().map(|asked| differs(found, asked)).collect();
    let none = said.is_empty();
    let still: Vec<&Asked> = found.asked.iter().filter(|asked| !asked.is_shown(found.size)).collect();
    for condition in 0..found.conditions.len() {
        let names: Vec<String> = still
            .iter()
            .filter(|asked| asked.condition == condition)
            .map(|asked| format!("{} ({})", asked.number.parameter, sized(asked, asked.seen)))
            .collect();
        if names.is_empty() {
            continue;
        }
        let of = &found.conditions[condition];
        let what = match (&of.condition.kind, none) {
            (Kind::Levels(_), true) => format!("These runs show no difference between {}", plural(of)),
            (Kind::Levels(_), false) => format!("No difference between {} is shown", plural(of)),
            (Kind::Amount(_), true) => format!("These runs show no dependence on {}", called(of)),
            (Kind::Amount(_), false) => format!("No dependence on {} is shown", called(of)),
        };
        said.push(format!("{what} for {}; in brackets what 80 % of such tests would have shown.", names.join(", ")));
    }
    let shared: Vec<String> = found.numbers.iter().filter(|number| number.depends_on.is_empty()).map(value).collect();
    if !shared.is_empty() {
        let what = if shared.len() == 1 { "One value holds" } else { "These values hold" };
        said.push(format!("{what} for all runs: {}.", shared.join(", ")));
    }
    said.join(" ")
}

fn value(shared: &Shared) -> String {
    let half = shared.value.interval.high - shared.value.value;
    format!("{} {}", shared.number.parameter, with_error(shared.value.value, half))
}

/// A value and half of its interval, with as many digits as that has.
fn with_error(value: f64, half: f64) -> String {
    let digits = digits(half);
    format!("{value:.digits$} ± {half:.digits$}")
}

/// Digits behind the point that show two places of a number.
fn digits(size: f64) -> usize {
    if !(size > 0.0 && size.is_finite()) {
        return 5;
    }
    (1.0 - libm::floor(libm::log10(size))).clamp(0.0, 12.0) as usize
}

fn differs(found: &Conditions, asked: &Asked) -> String {
    let of = &found.conditions[asked.condition];
    let p = if asked.p_adjusted < 1e-3 { "p < 0.001".to_owned() } else { format!("p = {:.3}", asked.p_adjusted) };
    // What stands behind a comma is named beside the number.
    let meaning = if asked.meaning.contains(',') { format!("{},", asked.meaning) } else { asked.meaning.clone() };
    if let Some(slope) = &asked.slope {
        let verb = if slope.value > 0.0 { "grows" } else { "falls" };
        let half = slope.interval.high - slope.value;
        let Kind::Amount([low, high]) = of.condition.kind else { return String::new() };
        let by = with_error(slope.value.abs(), half);
        return format!(
            "The {meaning} depends on {} ({p}): it {verb} by {by} for each unit, from {low} to {high}.",
            called(of)
        );
    }
    let levels: Vec<String> = asked
        .levels
        .iter()
        .map(|at| format!("{} {}", at.level, with_error(at.own.value, at.own.interval.high - at.own.value)))
        .collect();
    let largest = asked.largest.as_ref().map(|largest| {
        let half = largest.by.interval.high - largest.by.value;
        let by = with_error(largest.by.value, half);
        format!(" The largest difference, {} less {}, is {by}.", largest.high, largest.low)
    });
    format!(
        "The {meaning} differs between {} ({p}): {}.{}",
        plural(of),
        levels.join(", "),
        largest.filter(|_| asked.levels.len() > 1).unwrap_or_default()
    )
}

/// The names of a condition.
fn called(of: &AskedCondition) -> String {
    of.condition.names.join(" or ")
}

/// The names of a condition of levels, as of several: "floors".
fn plural(of: &AskedCondition) -> String {
    let of_name = |name: &String| crate::prose::of(2, name);
    of.condition.names.iter().map(of_name).collect::<Vec<_>>().join(" or ")
}

/// A difference in per cent of numbers near one, else as it is; of an amount, for each of its units.
fn sized(asked: &Asked, size: f64) -> String {
    let near_one = asked.levels.first().is_some_and(|at| (at.own.value - 1.0).abs() < 0.5);
    if near_one { format!("{:.3} %", 100.0 * size) } else { format!("{size:.2e}") }
}

/// What has to be known of the answer.
pub(super) fn remarks(found: &Conditions) -> Vec<String> {
    let mut said = Vec::new();
    for of in &found.conditions {
        let name = &of.condition.names[0];
        if let [_, others @ ..] = of.condition.names.as_slice()
            && !others.is_empty()
        {
            said.push(format!(
                "{} divide the runs alike: these runs do not tell which of them makes a difference.",
                of.condition.names.join(" and ")
            ));
        }
        if !of.like.is_empty() {
            let others = of.like.join(", ");
            said.push(format!(
                "What {name} changes looks the same as what {others} changes in these runs: drive each {name} with several values of {others}."
            ));
        }
        if of.against == Against::Sessions {
            said.push(format!(
                "{name} is the same in whole sessions, so its differences are compared with those between sessions."
            ));
        }
        let few: Vec<&str> = match &of.condition.kind {
            Kind::Levels(levels) => {
                levels.iter().zip(&of.runs).filter(|(_, runs)| **runs < 2).map(|(level, _)| level.as_str()).collect()
            }
            Kind::Amount(_) => Vec::new(),
        };
        if !few.is_empty() {
            said.push(format!("{name} {} has one run only: how it scatters is not known.", few.join(", ")));
        }
        if found.other_paths && of.condition.names.iter().any(|name| name == SESSION) {
            said.push(
                "The sessions drive different paths: an effect that the model lacks can look like a difference between them. Look for it in each session by itself."
                    .into(),
            );
        }
    }
    if !found.same.is_empty() {
        let are = if found.same.len() == 1 { "is" } else { "are" };
        said.push(format!(
            "{} {are} the same in all {}: nothing is known of other values.",
            found.same.join(", "),
            counted(found.runs, "run")
        ));
    }
    said
}
