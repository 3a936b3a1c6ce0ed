//! Figures in characters.

use super::braille::{self, DOTS};
use crate::figure::{Layer, Mark, Panel};
use crate::scale;
use crate::tone::Tone;

/// What a terminal can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Whether it shows more than ASCII.
    pub unicode: bool,
    /// Whether it shows colours.
    pub colour: bool,
}

/// A panel of `width` by `height` characters, a unit as long across as up (a character is twice as high as wide), with
/// its axes and a line that says what the marks are.
pub fn plan(panel: &Panel, look: Look, width: usize, height: usize) -> String {
    let (x, y) = scale::ends(panel);
    let unit = ((x[1] - x[0]) / width as f64).max((y[1] - y[0]) / (2 * height) as f64);
    let middle = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
    let origin = [middle[0] - 0.5 * unit * width as f64, middle[1] + unit * height as f64];
    let mut canvas = Canvas { cells: vec![vec![Cell::default(); width]; height], origin, unit, look };
    panel.layers.iter().for_each(|layer| canvas.draw(layer));
    let bottom = origin[1] - 2.0 * unit * height as f64;
    let label = |value: f64| scale::written(value, scale::marks(y, 6).1).replace('\u{2212}', "-");
    let rows: Vec<(usize, String)> = [(0, origin[1]), (height / 2, middle[1]), (height - 1, bottom)]
        .map(|(row, value)| (row, label(value)))
        .to_vec();
    let margin = rows.iter().map(|(_, text)| text.len()).max().unwrap_or(0);
    let edge = if look.unicode { '│' } else { '|' };
    let mut text = format!("{:margin$} {}\n", "", panel.y.title);
    for (index, row) in canvas.cells.iter().enumerate() {
        let label = rows.iter().find(|(row, _)| *row == index).map_or("", |(_, text)| text);
        text += &format!("{label:>margin$} {edge}{}\n", canvas.row(row));
    }
    let (left, right) = (label(origin[0]), label(origin[0] + unit * width as f64));
    let gap = width.saturating_sub(left.len() + right.len());
    text += &format!("{:margin$}  {left}{:^gap$}{right}\n", "", panel.x.title);
    text + &legend(panel, look, margin + 2)
}

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    mark: Option<char>,
    /// Of a line through it.
    dots: u32,
    tone: Option<Tone>,
}

struct Canvas {
    cells: Vec<Vec<Cell>>,
    /// The upper left corner.
    origin: [f64; 2],
    /// Width of a character.
    unit: f64,
    look: Look,
}

impl Canvas {
    fn draw(&mut self, layer: &Layer) {
        let places: Vec<[f64; 2]> = layer.x.iter().zip(&layer.y).map(|(x, y)| self.at(*x, *y)).collect();
        match layer.mark {
            Mark::Line | Mark::Dashes => {
                for pair in places.windows(2) {
                    self.line(pair[0], pair[1], layer.tone);
                }
            }
            _ => {
                let mark = glyph(&layer.mark, layer.tone, self.look.unicode);
                for [x, y] in places {
                    if let Some(cell) = self.cell(x, y) {
                        (cell.mark, cell.tone) = (Some(mark), Some(layer.tone));
                    }
                }
            }
        }
    }

    /// A place in characters from the upper left corner.
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [(x - self.origin[0]) / self.unit, (self.origin[1] - y) / (2.0 * self.unit)]
    }

    fn cell(&mut self, x: f64, y: f64) -> Option<&mut Cell> {
        if !(x >= 0.0 && y >= 0.0) {
            return None;
        }
        self.cells.get_mut(y as usize)?.get_mut(x as usize)
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], tone: Tone) {
        let steps = (8.0 * (to[0] - from[0]).hypot(to[1] - from[1])).ceil();
        if !steps.is_finite() {
            return;
        }
        for i in 0..=steps as usize {
            let share = if steps > 0.0 { i as f64 / steps } else { 0.0 };
            let (x, y) = (from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]));
            let Some(cell) = self.cell(x, y) else { continue };
            cell.dots |= DOTS[((y.fract() * 4.0) as usize).min(3)][((x.fract() * 2.0) as usize).min(1)];
            if cell.mark.is_none() {
                cell.tone = Some(tone);
            }
        }
    }

    fn row(&self, row: &[Cell]) -> String {
        let mut text = String::new();
        let last = row.iter().rposition(|cell| cell.mark.is_some() || cell.dots > 0).map_or(0, |i| i + 1);
        for cell in &row[..last] {
            let line = || match (cell.dots, self.look.unicode) {
                (0, _) => ' ',
                (dots, true) => braille::character(dots, ' '),
                (_, false) => '.',
            };
            let character = cell.mark.unwrap_or_else(line);
            text += &painted(character, cell.tone.filter(|_| self.look.colour && character != ' '));
        }
        text
    }
}

fn painted(character: char, tone: Option<Tone>) -> String {
    tone.map_or(character.to_string(), |tone| format!("\u{1b}[{}m{character}\u{1b}[0m", tone.ansi()))
}

fn glyph(mark: &Mark, tone: Tone, unicode: bool) -> char {
    let (fine, plain) = match (mark, tone) {
        (Mark::Line | Mark::Dashes, _) => ('⠒', '.'),
        (Mark::Crosses, Tone::Measured) => ('S', 'S'),
        (Mark::Crosses, _) => ('+', '+'),
        (Mark::Rings, Tone::Cw) => ('◆', '#'),
        (Mark::Rings, Tone::Ccw) => ('◇', '%'),
        (Mark::Rings, _) => ('◊', 'm'),
        (_, Tone::Cw) => ('●', 'x'),
        (_, Tone::Ccw) => ('○', 'o'),
        _ => ('•', '*'),
    };
    if unicode { fine } else { plain }
}

/// What the marks are, in lines of 80 characters.
fn legend(panel: &Panel, look: Look, indent: usize) -> String {
    let mut entries: Vec<(char, Tone, &str)> = Vec::new();
    for layer in panel.layers.iter().filter(|layer| !layer.name.is_empty()) {
        let mark = glyph(&layer.mark, layer.tone, look.unicode);
        if entries.iter().all(|(_, tone, name)| (*tone, *name) != (layer.tone, &layer.name)) {
            entries.push((mark, layer.tone, &layer.name));
        }
    }
    let mut text = String::new();
    let mut wide = 0;
    for (mark, tone, name) in entries {
        let own = 4 + name.chars().count();
        if wide == 0 || wide + own > 80 {
            text += if wide == 0 { "" } else { "\n" };
            text += &" ".repeat(indent);
            wide = indent;
        }
        text += &format!("{} {name}  ", painted(mark, look.colour.then_some(tone)));
        wide += own;
    }
    text.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Axis;

    fn panel() -> Panel {
        let start = Layer::new("START", Tone::Measured, Mark::Crosses, [[0.0, 0.0]]);
        let runs = Layer::new("cw runs", Tone::Cw, Mark::Dots, [[10.0, 5.0]]);
        let (x, y) = (Axis::of("x [mm]").from_to(-10.0, 10.0), Axis::of("y [mm]").from_to(-10.0, 10.0));
        Panel { title: String::new(), x, y, equal: true, layers: vec![start, runs] }
    }

    #[test]
    fn a_plan_has_marks_axes_and_a_legend() {
        let text = plan(&panel(), Look::default(), 21, 10);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "    y [mm]");
        assert!(lines[6].starts_with("  0 |") && lines[6].ends_with('S'), "{text}");
        assert!(lines[3].ends_with('x'), "{text}");
        assert_eq!(lines[lines.len() - 1].trim(), "S START  x cw runs");
        assert!(text.is_ascii());
    }

    #[test]
    fn colours_come_only_where_they_are_shown() {
        let coloured = plan(&panel(), Look { unicode: true, colour: true }, 21, 10);
        assert!(coloured.contains("\u{1b}[34m●\u{1b}[0m"), "{coloured}");
        assert!(!plan(&panel(), Look { unicode: true, colour: false }, 21, 10).contains('\u{1b}'));
    }
}
