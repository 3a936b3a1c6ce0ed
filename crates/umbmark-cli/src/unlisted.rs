//! What is missing and not in the catalogue: as a curve, and as a formula to try.

use umbmark_core::diagnose::{Curve, CurvePoint, Dependence, Diagnosis, Reason, Repeated, UnlistedLaw};
use umbmark_core::effect::effects_text;

use crate::model_report::p_text;
use crate::prose::hanging;
use crate::table::with_precision_of;

/// Characters from the lower to the upper edge of a figure.
const WIDTH: usize = 41;

/// What is missing and not in the catalogue: the law that repeats, or the curve where that has a formula or no law counts.
pub fn missing_text(diagnosis: &Diagnosis, terminal: bool) -> String {
    let law = law_text(&diagnosis.reasons);
    match &diagnosis.dependence {
        Some(told) if law.is_empty() || told.suggestion.is_some() => unlisted_text(told, terminal),
        _ => law,
    }
}

/// For people: the curve with its band, and the formula.
fn unlisted_text(told: &Dependence, terminal: bool) -> String {
    let mut text = format!("\nwhat is added to the {} motion, by {}\n\n", told.acts_on, told.title);
    text += &figure(&told.curve, told.depends_on, terminal);
    text += &match &told.suggestion {
        Some(suggestion) => {
            let share = 100.0 * suggestion.share.min(1.0);
            let what = format!(
                "a formula that explains {share:.0} % of it; save it as FILE and try `umbmark learn DATA --model FILE`"
            );
            format!("\n{}\n{}", hanging("", 0, &what), effects_text(&suggestion.model))
        }
        None => format!("\n{}", hanging("", 0, "No formula of one variable that was tried explains half of it.")),
    };
    text
}

/// The law that was added, and the others that were tried, the one that was taken marked where it is not the first: a longer formula has to
/// predict runs left out better.
pub fn laws_text(repeated: &Repeated) -> String {
    let [before, after] = repeated.law.left_out.map(|error| 1e3 * error);
    let said = format!(
        "{} (p = {} among {} laws; cross-validated error {before:.1} mm without it, {after:.1} mm with it)",
        repeated.law.words(),
        p_text(repeated.p),
        repeated.laws
    );
    let mut text = format!("\n{}", hanging("law", 10, &said));
    text += &hanging("", 10, &formula_of(&repeated.law));
    let alike: Vec<String> = repeated.others.iter().filter(|law| law.is_alike()).map(UnlistedLaw::words).collect();
    if !alike.is_empty() {
        text += &hanging("alike", 10, &format!("these runs cannot distinguish it from: {}", alike.join("; ")));
    }
    if let Some((effect, share)) = repeated.law.nearest.filter(|(_, share)| *share >= NEAR) {
        let said = format!("{effect} of the catalogue is most similar, and explains {:.0} % of it", 100.0 * share);
        text += &hanging("nearest", 10, &said);
    }
    text += "\n --law  left out [mm]  length  formula\n";
    let mut laws: Vec<&UnlistedLaw> = std::iter::once(&repeated.law).chain(&repeated.others).collect();
    laws.sort_by_key(|law| law.number);
    let taken = repeated.law.number;
    for law in laws.iter().take(MOST_SHOWN).chain(laws.iter().skip(MOST_SHOWN).filter(|law| law.number == taken)) {
        let length = if law.model.is_some() { law.length.to_string() } else { "-".to_owned() };
        let number = if law.number == taken && taken > 1 { format!("*{taken}") } else { law.number.to_string() };
        let head = format!("{number:>6}  {:>13.1}  {length:>6}", 1e3 * law.left_out[1]);
        text += &hanging(&head, 31, &formula_of(law));
    }
    let more = laws.iter().skip(MOST_SHOWN).filter(|law| law.number != taken).count();
    if more > 0 {
        text += &format!("        and {more} more: `umbmark plot laws`\n");
    }
    text
}

/// An effect of the catalogue that makes less than this share of a law is not near.
const NEAR: f64 = 0.5;
/// So many laws are shown.
const MOST_SHOWN: usize = 8;

/// A law as a formula with the numbers that shape it, or in words.
fn formula_of(law: &UnlistedLaw) -> String {
    let part = law.model.as_ref().and_then(|model| model.parts().first());
    let Some(formula) = part.and_then(|part| part.effect.formula()) else { return law.words() };
    let shapes: String = law.shapes().iter().map(|(name, value)| format!(", {name} = {value}")).collect();
    format!("{} = {}{shapes}", formula.target().name(), formula.text())
}

/// The law that repeats as a formula, where it counts and can be written as one.
fn law_text(reasons: &[Reason]) -> String {
    let law = reasons.iter().find_map(|reason| match reason {
        Reason::Repeats(repeated) => repeated.law.model.as_ref(),
        _ => None,
    });
    let what = "a formula for the repeating error; save it as FILE and try `umbmark learn DATA --model FILE`";
    law.map_or_else(String::new, |law| format!("\n{}\n{}", hanging("", 0, what), effects_text(law)))
}

/// A line for each place: the value with half its 95 % interval, and where it lies between the edges.
fn figure(curve: &Curve, depends_on: &str, terminal: bool) -> String {
    let most = curve.points.iter().map(|p| p.value.abs() + p.half_width).fold(f64::MIN_POSITIVE, f64::max);
    let (scale, prefix) = scaled(most);
    let step = curve.points.windows(2).map(|pair| pair[1].at - pair[0].at).fold(f64::INFINITY, f64::min);
    let unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    let mut text = format!(
        "{:>22}  {}\n",
        format!("{}{}", depends_on.split(' ').next().unwrap_or(depends_on), unit(curve.at_unit)),
        unit(&format!("{prefix}{}", curve.unit)).trim_start()
    );
    for point in &curve.points {
        let (value, half) = (scale * point.value, scale * point.half_width);
        let at = with_precision_of(point.at, if step.is_finite() { step } else { 1.0 });
        let number = format!("{} ± {}", with_precision_of(value, half), with_precision_of(half, half));
        text += &format!("{at:>10} {number:>18}  {}\n", band(point, most, terminal).trim_end());
    }
    text
}

/// Powers of ten that make a number readable, with their prefix.
fn scaled(most: f64) -> (f64, &'static str) {
    match most {
        m if m < 1e-4 => (1e6, "1e-6 "),
        m if m < 0.1 => (1e3, "1e-3 "),
        _ => (1.0, ""),
    }
}

/// The interval of one place between ±`most`, with a line at zero.
fn band(point: &CurvePoint, most: f64, terminal: bool) -> String {
    let [zero, low, line, high, middle] =
        if terminal { ['│', '├', '─', '┤', '●'] } else { ['|', '(', '-', ')', 'o'] };
    let place = |value: f64| ((0.5 + 0.5 * value / most).clamp(0.0, 1.0) * (WIDTH - 1) as f64).round() as usize;
    let mut marks = vec![' '; WIDTH];
    marks[WIDTH / 2] = zero;
    let (from, to) = (place(point.value - point.half_width), place(point.value + point.half_width));
    marks[from..=to].fill(line);
    marks[from] = low;
    marks[to] = high;
    marks[place(point.value)] = middle;
    marks.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_drawn_with_its_interval_about_a_line_at_zero() {
        let point = |value: f64, half_width: f64| CurvePoint { at: 0.0, value, half_width };
        assert_eq!(band(&point(0.5, 0.25), 1.0, false), "                    |    (----o----)     ");
        assert_eq!(band(&point(-1.0, 0.0), 1.0, true), "●                   │                    ");
        let curve = Curve { at_unit: "m", unit: "rad/m".into(), points: vec![point(2e-3, 1e-3), point(-1e-3, 2e-4)] };
        let text = figure(&curve, "since_turn * last_turn", false);
        assert!(text.starts_with("        since_turn [m]  [1e-3 rad/m]\n"), "{text}");
        assert!(text.contains("2.0 ± 1.0") && text.contains("-1.00 ± 0.20"), "{text}");
    }
}
