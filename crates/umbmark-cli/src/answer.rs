//! The one answer about a robot, for people: the last lines of every verb that finds its numbers.

use umbmark_core::solve::{Change, Measure, Part, Solution};

use crate::prose::hanging;
use crate::table::{table, with_precision_of};
use crate::words::ACTIONS;

/// The sentence, the new numbers, and what to do next.
pub fn answer_text(solution: &Solution, level: f64) -> String {
    let mut text = hanging("", 0, &solution.sentence());
    if !solution.changes.is_empty() {
        text += &format!("\n{}\n", numbers_table(solution, level));
        if solution.changes.iter().any(|change| change.worth.is_some_and(|worth| worth < -5e-5)) {
            text += &hanging(
                "",
                0,
                "A worth below zero: this error had hidden a part of the others, and all together help.",
            );
        }
    }
    let confounding = solution.learnt.diagnosis.confounding().filter(|_| !solution.changes.is_empty());
    text += &confounding.map_or_else(String::new, |told| hanging("", 0, &told));
    if solution.assumes_scale() {
        text += &hanging("", 0, "These hold if the mean wheel diameter is right: the runs do not show it.");
    }
    let next = solution.next(ACTIONS);
    if !next.is_empty() {
        text += "\nnext\n";
        for (number, step) in next.iter().enumerate() {
            text += &hanging(&format!("  {}.", number + 1), 5, step);
        }
    }
    text
}

/// Old and new numbers of the robot.
fn numbers_table(solution: &Solution, level: f64) -> String {
    let from = format!("{:.0} % from", 100.0 * level);
    let title = match (solution.is_trusted(), solution.needed) {
        (false, _) if solution.misleads_alone() => "not to be written alone",
        (false, _) => "not to be written yet",
        (true, false) => "nothing to write",
        (true, true) => "write",
    };
    table(&[title, "old", "new", &from, "to", "worth [mm]"], solution.changes.iter().map(row))
}

fn row(change: &Change) -> Vec<String> {
    let (name, scale) = match change.key.strip_suffix("_m").filter(|name| !name.ends_with("rad_per")) {
        Some(name) => (format!("{name} [mm]"), 1e3),
        None => match change.key.strip_suffix("_rad") {
            Some(name) => (format!("{name} [rad]"), 1.0),
            None => (change.key.to_owned(), 1.0),
        },
    };
    let half = change.interval.map_or(1e-4 * change.new.abs(), |i| 0.5 * (i.high - i.low));
    let number = |value: f64| with_precision_of(scale * value, scale * half);
    let end = |of: Option<f64>| of.map_or("-".to_owned(), number);
    vec![
        name.replace('_', " "),
        number(change.old),
        number(change.new),
        end(change.interval.map(|i| i.low)),
        end(change.interval.map(|i| i.high)),
        change.worth.map_or("-".to_owned(), millimetres),
    ]
}

/// How far off the robot is, step by step.
pub fn parts_text(solution: &Solution) -> String {
    let Some(off) = &solution.off else { return String::new() };
    let what = match off.measure {
        Measure::Returns => "error: E_max,sys of the recorded runs [mm]",
        Measure::Ends => "error: of the ends of the recorded runs, root mean square [mm]",
        Measure::Steps => "error: of all measured steps, root mean square [mm]",
        Measure::Along => "error: of all measured positions, root mean square [mm]",
    };
    let part = |part: &Part| vec![format!("  {}", part.name), millimetres(part.worth), String::new()];
    let total = |what: &str, error: f64| vec![what.to_owned(), String::new(), millimetres(error)];
    let mut rows = vec![total("as driven", off.driven)];
    rows.extend(off.reference.iter().map(part));
    rows.extend(off.written.iter().map(part));
    rows.push(total("with the new numbers", off.with_numbers));
    if !off.known.is_empty() {
        rows.extend(off.known.iter().map(part));
        rows.push(total("with all that is known", off.rest));
    }
    if let Some(chance) = off.chance {
        rows.push(total("chance alone, in 95 % of tests below", chance));
    }
    format!("\n{}\n", table(&[what, "worth", "error"], rows))
}

fn millimetres(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres)
}
