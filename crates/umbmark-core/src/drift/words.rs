//! What is known of a robot that is watched, in words.

use super::found::{Change, MovedNumber};
use super::statistic::Kind;
use super::{Arrived, Use, Watched};
use crate::path::Direction;
use crate::prose::counted;

/// Names that are told at most.
const NAMES: usize = 5;

pub(super) fn sentence(watched: &Watched, arrived: &Arrived) -> String {
    let mut said = Vec::new();
    let since = watched.runs.len() - watched.begins;
    let kept = watched.runs[watched.begins..].iter().filter(|run| !matches!(run.used, Use::LeftOut(_))).count();
    let new = arrived.new.min(since);
    let runs = match kept == since {
        true => format!("{} watched, {new} of them new", counted(since, "run")),
        false => format!("{}, {new} of them new, and {kept} of them watched", counted(since, "run")),
    };
    match &watched.change {
        None => said.push(format!("{runs}: {}.", unchanged(watched))),
        Some(change) => {
            said.push(changed(watched, change));
            said.push(format!("{runs}. {}", chance(watched)));
        }
    }
    if !watched.outlying.is_empty() {
        let all = names(watched.outlying.iter().map(|place| watched.runs[*place].name.as_str()));
        said.push(format!("Outlying runs, which are no lasting change by themselves: {all}."));
    }
    let seen = watched.delays.iter().filter_map(|delay| {
        let share = 100.0 * delay.share.abs();
        let (what, word) = match delay.key {
            "wheelbase_m" => ("the wheelbase", "grows"),
            _ => ("the right wheel", "shrinks"),
        };
        Some(format!("{what} {word} by {share} % ({})", delay.most?))
    });
    let seen: Vec<String> = seen.collect();
    if !seen.is_empty() {
        said.push(format!(
            "Changes that would be found, in brackets within how many runs in 90 % of cases: {}.",
            seen.join(", ")
        ));
    } else if !watched.delays.is_empty() {
        said.push("These runs scatter so much that a wheel that shrinks by 0.5 % or a wheelbase that grows by 1 % would not be found within 60 runs in 90 % of cases.".to_owned());
    }
    if !arrived.vanished.is_empty() {
        let all = names(arrived.vanished.iter().map(String::as_str));
        said.push(format!("Watched before, and missing in the data: {all}; their values are kept."));
    }
    if !arrived.changed.is_empty() {
        let all = names(arrived.changed.iter().map(String::as_str));
        said.push(format!("Watched before, and different in the data: {all}; the values that they had are kept."));
    }
    let left = watched.runs.iter().filter_map(|run| match run.used {
        Use::LeftOut(reason) => Some((run.name.as_str(), reason)),
        _ => None,
    });
    let left: Vec<(&str, &str)> =
        arrived.left_out.iter().map(|(name, reason)| (name.as_str(), *reason)).chain(left).collect();
    let mut reasons: Vec<&str> = left.iter().map(|(_, reason)| *reason).collect();
    reasons.dedup();
    for reason in reasons {
        let all = names(left.iter().filter(|(_, other)| *other == reason).map(|(name, _)| *name));
        said.push(format!("Not watched, because {reason}: {all}."));
    }
    said.join(" ")
}

fn unchanged(watched: &Watched) -> String {
    if watched.missing == [0; 2] && watched.runs.len() > watched.begins {
        return "nothing changed".to_owned();
    }
    let missing = Direction::BOTH.into_iter().zip(watched.missing).filter(|(_, missing)| *missing > 0);
    let needs: Vec<String> =
        missing.map(|(direction, missing)| format!("{missing} more {}", word(direction))).collect();
    format!("nothing changed that can be seen yet, because the baseline needs {}", needs.join(" and "))
}

fn word(direction: Direction) -> &'static str {
    match direction {
        Direction::Cw => "clockwise",
        Direction::Ccw => "counter-clockwise",
    }
}

fn chance(watched: &Watched) -> String {
    let months = 1.0 / watched.rate.false_alarms_per_month;
    format!(
        "The false-alarm rate is one in {} months of {}, if runs do not depend on each other.",
        if months >= 10.0 { format!("{months:.0}") } else { format!("{months:.1}") },
        counted(watched.rate.runs_per_month as usize, "run")
    )
}

fn changed(watched: &Watched, change: &Change) -> String {
    let name = |place: usize| watched.runs[place].name.as_str();
    let between = if change.earliest == change.latest {
        String::new()
    } else {
        format!(" (between {} and {})", name(change.earliest), name(change.latest))
    };
    let (since, later) =
        (format!("since run {}{between}", name(change.since)), counted(change.runs_until_seen(&watched.runs), "run"));
    match change.kind {
        Kind::Numbers => {
            let mut moved: Vec<&MovedNumber> = change.moved().collect();
            if moved.is_empty() {
                moved = change.numbers.iter().collect();
            }
            let all: Vec<String> = moved.iter().map(|number| of_number(number)).collect();
            let lengths: Vec<String> = change
                .alone
                .iter()
                .map(|alone| {
                    let word = if alone.share > 0.0 { "larger" } else { "smaller" };
                    let share = 100.0 * alone.share.abs();
                    format!("the {} alone, {share:.3} ± {:.3} % {word}", alone.meaning, 100.0 * alone.half)
                })
                .collect();
            let alone = match lengths.as_slice() {
                [] => String::new(),
                [one] => format!(" One length accounts for it: {one}."),
                several => format!(" Each of these accounts for it: {}.", several.join("; or ")),
            };
            format!("The robot changed: {since}, {}, seen with {later}.{alone}", all.join(" and "))
        }
        Kind::Place => {
            let all: Vec<String> = change
                .places
                .iter()
                .map(|place| {
                    let mm = |value: f64| format!("{:.1}", 1e3 * value);
                    let turned = place
                        .heading
                        .map_or(String::new(), |heading| format!(", turned by {:.2} deg", heading.value.to_degrees()));
                    format!(
                        "{} runs return ({}, {}) mm away from where they did{turned}",
                        word(place.direction),
                        mm(place.x.value),
                        mm(place.y.value)
                    )
                })
                .collect();
            let remedy =
                "no change of E_d and E_b explains it; look at START, the reference, the floor, the load and the speed";
            format!("The return errors changed: {since}, {}, seen with {later}; {remedy}.", all.join("; "))
        }
        Kind::Scatter => {
            let ratio = change.scatter.map_or(String::new(), |scatter| {
                format!(
                    " to {:.1} times what it was ({:.1} to {:.1})",
                    scatter.ratio, scatter.interval.low, scatter.interval.high
                )
            });
            let remedy = "look for slip, loose parts and a reference that errs";
            format!("The scatter of the runs rose{ratio}: {since}, seen with {later}; {remedy}.")
        }
    }
}

fn of_number(number: &MovedNumber) -> String {
    let key = match number.key {
        "e_d" => "E_d",
        "e_b" => "E_b",
        _ => "E_s",
    };
    let half = 0.5 * (number.interval.high - number.interval.low);
    let digits = (1.0 - libm::floor(libm::log10(half.max(1e-9)))).clamp(4.0, 7.0) as usize;
    format!("{key} moved from {:.digits$} to {:.digits$} ± {half:.digits$}", number.before.value, number.after.value)
}

/// The first of some names, and how many there are besides.
fn names<'a>(all: impl Iterator<Item = &'a str>) -> String {
    let all: Vec<&str> = all.collect();
    match all.len().checked_sub(NAMES) {
        Some(more @ 1..) => format!("{} and {more} more", all[..NAMES].join(", ")),
        _ => all.join(", "),
    }
}
