//! What changed, in words.

use super::quantities::Of;
use super::{Changed, Moved, StartMoved, is_of_test};
use crate::effect::{Model, Part, differences};
use crate::prose::listed;

/// Lengths are told in millimetres, and changes of ratios in per cent.
pub(super) fn sentence(changed: &Changed) -> String {
    let mut said = Vec::new();
    let doubts = changed.doubts();
    if !doubts.is_empty() {
        said.extend(doubts);
        said.push("What follows is of models that are not right.".into());
    }
    said.extend(entered(changed));
    let moved: Vec<&Moved> = changed.moved().collect();
    said.extend(moved.iter().map(|moved| of(moved)));
    said.extend(by_itself(changed));
    said.extend(changed.start.as_ref().map(by_start));
    let still: Vec<&Moved> = changed.robot.iter().filter(|moved| !moved.is_shown(changed.size)).collect();
    let rest = if moved.is_empty() { "These tests show no change" } else { "No change is shown" };
    if !still.is_empty() {
        let names: Vec<String> = still.iter().map(|moved| format!("the {} ({})", name(moved), seen(moved))).collect();
        said.push(format!("{rest} of {}; in brackets what 80 % of such tests would have shown.", names.join(", ")));
    }
    if let Some([old, new]) = changed.costs.filter(|_| !moved.is_empty()) {
        let mm = |error: f64| format!("{:.1} mm", 1e3 * error);
        said.push(format!(
            "With the numbers of before, the runs after miss by {}; with their own, by {}.",
            mm(old),
            mm(new)
        ));
    }
    let references: Vec<String> = changed
        .reference
        .iter()
        .filter(|moved| moved.is_shown(changed.size))
        .map(|moved| name(moved).to_owned())
        .collect();
    if !references.is_empty() {
        said.push(format!("Of the reference, which is not the robot's, changed: {}.", references.join(", ")));
    }
    said.extend(of_one_test(changed));
    if !changed.assumed.is_empty() {
        said.push(format!(
            "Taken to be the same in both, because one of them does not show them: {}.",
            changed.assumed.join(", ")
        ));
    }
    said.join(" ")
}

/// That the tests are of robots with other nominal numbers: an entry that was corrected between them, or another robot.
fn entered(changed: &Changed) -> Option<String> {
    let [before, after] = [&changed.before, &changed.after].map(|test| test.fit.model.robot());
    let differs = differences(before, after)?;
    let numbers: Vec<String> =
        differs.iter().map(|(key, before, after)| format!("{key} = {before} before and {after} after")).collect();
    (!numbers.is_empty()).then(|| {
        format!(
            "The tests are of robots with other nominal numbers: {}. If it is one robot that was entered anew, what follows compares its true \
             numbers; two robots must not be compared.",
            listed(&numbers)
        )
    })
}

/// What only one of the tests has of the reference and of START.
fn of_one_test(changed: &Changed) -> Option<String> {
    let tests = [
        ("before", &changed.before.fit.model, &changed.after.fit.model),
        ("after", &changed.after.fit.model, &changed.before.fit.model),
    ];
    let told: Vec<String> = tests
        .into_iter()
        .filter_map(|(name, own, other): (_, &Model, &Model)| {
            let lacks = |part: &&Part| other.parts().iter().all(|of| of.effect.name() != part.effect.name());
            let names: Vec<&str> = own
                .parts()
                .iter()
                .filter(|part| part.free && is_of_test(part))
                .filter(lacks)
                .filter_map(title)
                .collect();
            (!names.is_empty()).then(|| format!("{} in the test {name}", listed(&names)))
        })
        .collect();
    (!told.is_empty()).then(|| format!("Only in one test, and not the robot's: {}.", told.join("; ")))
}

fn title(part: &Part) -> Option<&'static str> {
    part.effect.entry().map(|entry| entry.about.title)
}

/// The lengths that account for the change by themselves.
fn by_itself(changed: &Changed) -> Option<String> {
    let told: Vec<String> = changed
        .alone
        .iter()
        .map(|alone| {
            let word = if alone.share > 0.0 { "larger" } else { "smaller" };
            format!("the {} alone, {:.3} % {word}", alone.meaning, 100.0 * alone.share.abs())
        })
        .collect();
    match told.as_slice() {
        [] => None,
        [one] => Some(format!("One length accounts for it: {one}.")),
        several => Some(format!("Each of these accounts for it: {}.", several.join("; or "))),
    }
}

/// That START may be what moved.
fn by_start(start: &StartMoved) -> String {
    let turned = start.heading.map_or(String::new(), |turned| format!(", turned by {:+.2} deg", turned.to_degrees()));
    format!(
        "A START that lies elsewhere accounts for it, too: by {:+.1} mm along the first leg and {:+.1} mm to its left{turned}. Measure where it \
         is before any number is changed.",
        1e3 * start.x,
        1e3 * start.y
    )
}

/// What a number is called; of the robot's own, without an article.
fn name(moved: &Moved) -> &str {
    match moved.quantity.of {
        Of::Scatter => "scatter of the runs",
        _ => &moved.quantity.meaning,
    }
}

fn of(moved: &Moved) -> String {
    let p = if moved.p_adjusted < 1e-3 { "p < 0.001".to_owned() } else { format!("p = {:.3}", moved.p_adjusted) };
    if moved.quantity.of == Of::Scatter {
        let verb = if moved.change > 1.0 { "rose" } else { "fell" };
        let (low, high) = (moved.interval.low, moved.interval.high);
        return format!(
            "The scatter of the runs {verb} to {:.2} times what it was ({low:.2} to {high:.2}, {p}).",
            moved.change
        );
    }
    let verb = if moved.change > 0.0 { "rose" } else { "fell" };
    let half = 0.5 * (moved.interval.high - moved.interval.low);
    format!(
        "The {} {verb} by {} ± {}{} ({p}).",
        name(moved),
        sized(moved, moved.change.abs()),
        sized(moved, half),
        share(moved)
    )
}

/// A change as a share of the number, of one that is never near zero.
fn share(moved: &Moved) -> String {
    match moved.quantity.of {
        Of::Robot if moved.quantity.key.ends_with("_m") => {
            format!(", {:.3} %", 100.0 * (moved.change / moved.before.value).abs())
        }
        _ => String::new(),
    }
}

fn seen(moved: &Moved) -> String {
    match moved.quantity.of {
        Of::Scatter => format!("{:.1} times as much", moved.seen),
        _ => sized(moved, moved.seen),
    }
}

/// A difference in the unit in which people think of it.
fn sized(moved: &Moved, size: f64) -> String {
    let key = &moved.quantity.key;
    if key.ends_with("_m") && !key.ends_with("_per_m") {
        return format!("{:.3} mm", 1e3 * size);
    }
    if moved.quantity.of == Of::Robot && moved.before.value != 0.0 && !key.contains("_rad") {
        return format!("{:.3} %", 100.0 * (size / moved.before.value).abs());
    }
    format!("{size:.2e}")
}
