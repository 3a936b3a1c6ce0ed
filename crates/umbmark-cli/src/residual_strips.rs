//! Residuals of tracks as small pictures: blocks and braille on a terminal, plain characters elsewhere.

use umbmark_core::compare::tracks::TrackResiduals;
use umbmark_core::path::Direction;

use crate::signature::three_digits;
use umbmark_plot::render::strip::strip;

/// Characters across and, on a terminal, down.
const WIDTH: usize = 29;
const HEIGHT: usize = 3;
/// Columns of the labels.
const INDENT: usize = 20;

/// One mark a value: within ±1 the middle one, beyond ±1, ±2 and ±4 farther up or down; a space for what is not there.
pub fn marks(values: &[Option<f64>], terminal: bool) -> String {
    const BLOCKS: [char; 7] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇'];
    const PLAIN: [char; 7] = ['v', '-', '-', '.', '+', '+', '^'];
    let marks = if terminal { BLOCKS } else { PLAIN };
    let mark = |value: &Option<f64>| {
        let Some(value) = value else { return ' ' };
        let level = [1.0, 2.0, 4.0].iter().filter(|least| value.abs() > **least).count();
        marks[if *value < 0.0 { 3 - level } else { 3 + level }]
    };
    values.iter().map(mark).collect::<String>().trim_end().to_owned()
}

/// The mean error along the way of runs in each direction, forward, to the left and in heading.
pub fn strips(residuals: &[TrackResiduals], terminal: bool) -> String {
    let of = |direction: Option<Direction>| residuals.iter().filter(|r| r.direction == direction).collect::<Vec<_>>();
    let groups: Vec<(&str, Vec<&TrackResiduals>)> =
        [("ccw", Some(Direction::Ccw)), ("cw", Some(Direction::Cw)), ("runs", None)]
            .into_iter()
            .map(|(name, direction)| (name, of(direction)))
            .filter(|(_, runs)| !runs.is_empty())
            .take(2)
            .collect();
    if groups.is_empty() {
        return String::new();
    }
    let heads: Vec<String> = groups.iter().map(|(name, _)| format!("{name:<WIDTH$}")).collect();
    let mut text = format!("\nmean error along the way\n{:INDENT$}{}\n", "", heads.join("  ").trim_end());
    for (k, (name, scale, unit)) in
        [("forward", 1e3, "mm"), ("left", 1e3, "mm"), ("heading", 1f64.to_degrees(), "deg")].into_iter().enumerate()
    {
        let lines: Vec<Vec<f64>> = groups.iter().map(|(_, runs)| mean_line(runs, k)).collect();
        let limit = lines.iter().flatten().fold(0.0, |most: f64, v| most.max(v.abs()));
        if limit == 0.0 {
            continue;
        }
        let label = format!("±{} {unit}", three_digits(scale * limit));
        let pictures: Vec<Vec<String>> = lines.iter().map(|line| picture(line, limit, terminal)).collect();
        for row in 0..pictures[0].len() {
            let head = match (row, pictures[0].len()) {
                (0, 1) => format!("{name} {label}"),
                (0, _) => format!("  {name}"),
                (1, _) => format!("  {label}"),
                _ => String::new(),
            };
            let cells: Vec<&str> = pictures.iter().map(|picture| picture[row].as_str()).collect();
            text += format!("{head:<INDENT$}{}", cells.join("  ")).trim_end();
            text += "\n";
        }
    }
    text
}

/// A component of the error at evenly spaced shares of the way, averaged over runs.
fn mean_line(runs: &[&TrackResiduals], component: usize) -> Vec<f64> {
    let samples = 2 * WIDTH;
    let at = |run: &TrackResiduals, i: usize| {
        let whole = run.rolled.last().copied().unwrap_or(0.0);
        let way = whole * i as f64 / (samples - 1) as f64;
        let index = run.rolled.partition_point(|rolled| *rolled < way).min(run.errors.len() - 1);
        run.errors[index][component]
    };
    (0..samples).map(|i| runs.iter().map(|run| at(run, i)).sum::<f64>() / runs.len() as f64).collect()
}

fn picture(line: &[f64], limit: f64, terminal: bool) -> Vec<String> {
    if terminal {
        let points: Vec<(f64, f64)> = line.iter().enumerate().map(|(i, v)| (i as f64, *v)).collect();
        return strip(&points, (line.len() - 1) as f64, limit, WIDTH, HEIGHT);
    }
    let fifths = |pair: &[f64]| {
        let share = 0.5 * (pair[0] + pair[1]) / limit;
        ['v', '-', '.', '+', '^'][((share * 2.5 + 2.5).floor() as usize).min(4)]
    };
    let marks: String = line.chunks(2).map(fifths).collect();
    vec![marks]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_tell_size_and_sign_and_what_is_not_there() {
        let values = [Some(-5.0), Some(-3.0), Some(-1.5), Some(0.3), Some(1.5), None, Some(9.0)];
        assert_eq!(marks(&values, true), "▁▂▃▄▅ ▇");
        assert_eq!(marks(&values, false), "v--.+ ^");
    }

    #[test]
    fn a_line_that_rises_from_the_least_to_the_greatest_uses_every_mark() {
        let line: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0 * 2.0 - 1.0).collect();
        assert_eq!(picture(&line, 1.0, false), ["vvvvvv------......++++++^^^^^^"]);
        assert_eq!(picture(&line, 1.0, true).len(), HEIGHT);
    }
}
