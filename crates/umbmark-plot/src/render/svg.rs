//! SVG for papers and for print: one column wide, the same bytes everywhere.

mod marks;
mod page;

use crate::figure::{Axis, Figure, Panel};
use crate::scale;
use crate::tone::Tone;

use super::font::{self, FAMILY};
use super::legend;
use marks::Frame;
use page::{Anchor, Drawing};

/// Height of the letters \[px\].
const LETTERS: f64 = 9.0;
/// Between things \[px\].
const GAP: f64 = 5.0;

/// How a figure is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Width of the whole \[mm\].
    pub width_mm: f64,
    /// What names inside begin with: drawings on one page must not share names.
    pub id: String,
}

impl Default for Style {
    /// A column of a journal, 88 mm.
    fn default() -> Style {
        Style { width_mm: 88.0, id: "figure".into() }
    }
}

/// A figure as SVG.
pub fn svg(figure: &Figure, style: &Style) -> String {
    let width = style.width_mm * 96.0 / 25.4;
    let mut drawing = Drawing::new(width, &style.id);
    let mut top = GAP;
    for (index, panel) in figure.panels.iter().enumerate() {
        top = draw_panel(&mut drawing, panel, index, width, top) + GAP;
    }
    top = draw_legend(&mut drawing, figure, width, top);
    let told = &figure.told;
    drawing.finish(top + GAP, &figure.title, &format!("{} {} {}", told.shows, told.good, told.says))
}

/// Draws a panel from `top` down and gives where it ends.
fn draw_panel(drawing: &mut Drawing, panel: &Panel, index: usize, width: f64, mut top: f64) -> f64 {
    let (mut x, mut y) = scale::ends(panel);
    let left = margin(&panel.y, y) + if panel.y.title.is_empty() { GAP } else { LETTERS + 2.0 * GAP };
    let inner = (width - left - 2.0 * GAP).max(0.25 * width);
    let height = inner_height(panel, x, y, inner);
    if panel.equal {
        (x, y) = equal(x, y, height / inner);
    }
    if !panel.title.is_empty() {
        drawing.bold(left, top + LETTERS, &panel.title);
        top += LETTERS + GAP;
    }
    let frame = Frame {
        left,
        top,
        width: inner,
        height,
        x: if panel.x.falling { [x[1], x[0]] } else { x },
        y: if panel.y.falling { [y[1], y[0]] } else { y },
    };
    grid(drawing, panel, &frame);
    drawing.clip(&frame, index);
    panel.layers.iter().for_each(|layer| marks::draw(drawing, layer, &frame));
    drawing.unclip();
    drawing.frame(&frame);
    let bottom = x_labels(drawing, &panel.x, &frame);
    y_labels(drawing, &panel.y, &frame);
    bottom
}

/// Ranges widened so that a unit is as long on both axes, for a panel so much higher than wide.
fn equal(x: [f64; 2], y: [f64; 2], aspect: f64) -> ([f64; 2], [f64; 2]) {
    let (across, up) = (x[1] - x[0], y[1] - y[0]);
    let unit = (across).max(up / aspect);
    let widened = |[low, high]: [f64; 2], span: f64| {
        let middle = 0.5 * (low + high);
        [middle - 0.5 * span, middle + 0.5 * span]
    };
    (widened(x, unit), widened(y, unit * aspect))
}

fn inner_height(panel: &Panel, x: [f64; 2], y: [f64; 2], inner: f64) -> f64 {
    if panel.equal {
        return inner * ((y[1] - y[0]) / (x[1] - x[0])).clamp(0.45, 1.0);
    }
    match panel.y.names.len() {
        0 => 0.58 * inner,
        names => (names as f64 * 2.2 * LETTERS).max(5.0 * LETTERS),
    }
}

/// Room for what stands left of the frame.
fn margin(axis: &Axis, ends: [f64; 2]) -> f64 {
    let widest = |words: &mut dyn Iterator<Item = String>| words.map(|w| font::width(&w, LETTERS)).fold(0.0, f64::max);
    if axis.names.is_empty() {
        let (marks, decimals) = scale::marks(ends, 6);
        return widest(&mut marks.iter().map(|mark| scale::written(*mark, decimals))) + GAP;
    }
    widest(&mut axis.names.iter().cloned()) + GAP
}

fn grid(drawing: &mut Drawing, panel: &Panel, frame: &Frame) {
    if panel.x.names.is_empty() {
        for mark in scale::marks(frame.x_ends(), frame.across_marks()).0 {
            let at = frame.across(mark);
            drawing.rule(at, frame.top, at, frame.top + frame.height);
        }
    }
    if panel.y.names.is_empty() {
        for mark in scale::marks(frame.y_ends(), frame.up_marks()).0 {
            let at = frame.up(mark);
            drawing.rule(frame.left, at, frame.left + frame.width, at);
        }
    }
}

/// Numbers or names below the frame, and the axis' title; gives where they end.
fn x_labels(drawing: &mut Drawing, axis: &Axis, frame: &Frame) -> f64 {
    let mut bottom = frame.top + frame.height + LETTERS + 3.0;
    if axis.names.is_empty() {
        let (marks, decimals) = scale::marks(frame.x_ends(), frame.across_marks());
        for mark in marks {
            drawing.text(frame.across(mark), bottom, Anchor::Middle, &scale::written(mark, decimals));
        }
    } else {
        let size = frame.letters(axis.names.len());
        for (i, name) in axis.names.iter().enumerate() {
            drawing.upward(frame.across(i as f64) + 0.35 * size, frame.top + frame.height + 3.0, size, name);
        }
        let longest = axis.names.iter().map(|name| font::width(name, size)).fold(0.0, f64::max);
        bottom = frame.top + frame.height + longest + 4.0;
    }
    if !axis.title.is_empty() {
        bottom += LETTERS + 3.0;
        drawing.text(frame.left + 0.5 * frame.width, bottom, Anchor::Middle, &axis.title);
    }
    bottom + 2.0
}

fn y_labels(drawing: &mut Drawing, axis: &Axis, frame: &Frame) {
    let left = frame.left - 4.0;
    if axis.names.is_empty() {
        let (marks, decimals) = scale::marks(frame.y_ends(), frame.up_marks());
        for mark in marks {
            drawing.text(left, frame.up(mark) + 0.35 * LETTERS, Anchor::End, &scale::written(mark, decimals));
        }
    } else {
        let size = LETTERS.min(0.95 * frame.height / axis.names.len() as f64);
        for (i, name) in axis.names.iter().enumerate() {
            drawing.sized(left, frame.up(i as f64) + 0.35 * size, Anchor::End, size, name);
        }
    }
    if !axis.title.is_empty() {
        drawing.sideways(LETTERS + 2.0, frame.top + 0.5 * frame.height, &axis.title);
    }
}

/// Entries in as many rows as they need; gives where they end.
fn draw_legend(drawing: &mut Drawing, figure: &Figure, width: f64, top: f64) -> f64 {
    const SAMPLE: f64 = 16.0;
    let entries = legend::entries(figure);
    if entries.is_empty() {
        return top;
    }
    let (mut x, mut y) = (2.0 * GAP, top + LETTERS);
    for (name, tone, mark) in entries {
        let wide = SAMPLE + GAP + font::width(name, LETTERS) + 3.0 * GAP;
        if x > 2.0 * GAP && x + wide > width {
            (x, y) = (2.0 * GAP, y + LETTERS + GAP);
        }
        marks::sample(drawing, mark, tone, x, y - 0.35 * LETTERS, SAMPLE);
        drawing.text(x + SAMPLE + GAP, y, Anchor::Start, name);
        x += wide;
    }
    y + 2.0
}

/// Ink of letters and frames.
fn ink() -> &'static str {
    Tone::Measured.on_white()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_scales_only_widen() {
        let (x, y) = equal([0.0, 10.0], [0.0, 2.0], 0.5);
        assert_eq!((x, y), ([0.0, 10.0], [-1.5, 3.5]));
        let (x, y) = equal([0.0, 1.0], [0.0, 2.0], 1.0);
        assert_eq!((x, y), ([-0.5, 1.5], [0.0, 2.0]));
    }
}
