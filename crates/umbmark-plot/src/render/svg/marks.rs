//! The marks of layers.

use super::LETTERS;
use super::page::{Anchor, Drawing, number, stroke};
use crate::figure::{Layer, Mark};
use crate::tone::{Tone, shade};

/// A step shorter than this says nothing \[px\].
const SHORT: f64 = 0.25;
const RADIUS: f64 = 2.1;

/// Where a panel stands \[px\] and what lies in it.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    /// At its left and right end.
    pub x: [f64; 2],
    /// At its lower and upper end.
    pub y: [f64; 2],
}

impl Frame {
    pub fn across(&self, x: f64) -> f64 {
        self.left + self.width * (x - self.x[0]) / (self.x[1] - self.x[0])
    }

    pub fn up(&self, y: f64) -> f64 {
        self.top + self.height * (self.y[1] - y) / (self.y[1] - self.y[0])
    }

    pub fn x_ends(&self) -> [f64; 2] {
        [self.x[0].min(self.x[1]), self.x[0].max(self.x[1])]
    }

    pub fn y_ends(&self) -> [f64; 2] {
        [self.y[0].min(self.y[1]), self.y[0].max(self.y[1])]
    }

    /// So many marks stand below without touching.
    pub fn across_marks(&self) -> usize {
        (self.width / 45.0).clamp(2.0, 8.0) as usize
    }

    /// So many marks stand beside without touching.
    pub fn up_marks(&self) -> usize {
        (self.height / 26.0).clamp(2.0, 8.0) as usize
    }

    /// Height of letters of which so many stand below side by side.
    pub fn letters(&self, names: usize) -> f64 {
        LETTERS.min(0.95 * self.width / names as f64)
    }
}

/// Draws a layer.
pub fn draw(drawing: &mut Drawing, layer: &Layer, frame: &Frame) {
    let places: Vec<[f64; 2]> = layer.x.iter().zip(&layer.y).map(|(x, y)| [frame.across(*x), frame.up(*y)]).collect();
    let seen = || places.iter().enumerate().filter(|(_, [x, y])| x.is_finite() && y.is_finite());
    let tone = layer.tone;
    match &layer.mark {
        Mark::Line => drawing.element(&line(&places, tone, 1.1, false)),
        Mark::Dashes => drawing.element(&line(&places, tone, 1.0, true)),
        Mark::Dots => seen().for_each(|(_, p)| drawing.element(&dot(p, tone))),
        Mark::Rings => seen().for_each(|(_, p)| drawing.element(&ring(p, tone))),
        Mark::Crosses => seen().for_each(|(_, p)| drawing.element(&cross(p, tone))),
        Mark::Bars(width) => {
            let wide = frame.width * width / (frame.x[1] - frame.x[0]);
            let floor = frame.up(0.0);
            seen().for_each(|(_, p)| drawing.element(&bar(p, wide, floor, tone)));
        }
        Mark::Spans(low, high) => seen().for_each(|(i, p)| {
            let ends = [[frame.across(low[i]), p[1]], [frame.across(high[i]), p[1]]];
            drawing.element(&line(&ends, tone, 1.4, false));
            drawing.element(&dot(p, tone));
        }),
        Mark::Cells(values) => {
            let side = [frame.width / (frame.x[1] - frame.x[0]), frame.height / (frame.y[1] - frame.y[0])];
            seen().for_each(|(i, p)| drawing.element(&cell(p, side.map(f64::abs), values[i])));
        }
        Mark::Words(words) => seen().for_each(|(i, p)| drawing.text(p[0], p[1], Anchor::Start, &words[i])),
    }
}

/// A mark as the legend shows it, from `x` to the right.
pub fn sample(drawing: &mut Drawing, mark: &Mark, tone: Tone, x: f64, y: f64, width: f64) {
    let middle = [x + 0.5 * width, y];
    let element = match mark {
        Mark::Line => line(&[[x, y], [x + width, y]], tone, 1.1, false),
        Mark::Dashes => line(&[[x, y], [x + width, y]], tone, 1.0, true),
        Mark::Dots | Mark::Spans(..) => dot(&middle, tone),
        Mark::Rings => ring(&middle, tone),
        Mark::Crosses => cross(&middle, tone),
        Mark::Bars(_) | Mark::Cells(_) => bar(&[middle[0], y - 3.0], 0.6 * width, y + 4.0, tone),
        Mark::Words(_) => return,
    };
    drawing.element(&element);
}

fn line(places: &[[f64; 2]], tone: Tone, width: f64, dashed: bool) -> String {
    let mut path = String::new();
    let mut last: Option<[f64; 2]> = None;
    for (index, [x, y]) in places.iter().enumerate() {
        if !(x.is_finite() && y.is_finite()) {
            last = None;
            continue;
        }
        let ends_here = places.get(index + 1).is_none_or(|next| !next[0].is_finite());
        if last.is_some_and(|[a, b]| (x - a).hypot(y - b) < SHORT) && !ends_here {
            continue;
        }
        path.push(if last.is_some() { 'L' } else { 'M' });
        path.push_str(&format!("{} {}", number(*x), number(*y)));
        last = Some([*x, *y]);
    }
    format!(r#"<path d="{path}" {}/>"#, stroke(tone, width, dashed))
}

fn dot(at @ [x, y]: &[f64; 2], tone: Tone) -> String {
    if tone.is_modelled() {
        return diamond(at, RADIUS + 1.0, &format!(r#"fill="{}""#, tone.on_white()));
    }
    let (x, y, colour) = (number(*x), number(*y), tone.on_white());
    format!(r#"<circle cx="{x}" cy="{y}" r="{RADIUS}" fill="{colour}" fill-opacity="0.85"/>"#)
}

fn ring(at @ [x, y]: &[f64; 2], tone: Tone) -> String {
    if tone.is_modelled() {
        return diamond(at, 3.6, &stroke(tone, 1.1, false));
    }
    format!(r#"<circle cx="{}" cy="{}" r="2.6" {}/>"#, number(*x), number(*y), stroke(tone, 1.1, false))
}

fn diamond([x, y]: &[f64; 2], arm: f64, style: &str) -> String {
    let [left, right, above, below] = [x - arm, x + arm, y - arm, y + arm].map(number);
    let (x, y) = (number(*x), number(*y));
    format!(r#"<path d="M{left} {y}L{x} {above}L{right} {y}L{x} {below}Z" {style}/>"#)
}

fn cross([x, y]: &[f64; 2], tone: Tone) -> String {
    const ARM: f64 = 4.5;
    let [left, right, above, below] = [x - ARM, x + ARM, y - ARM, y + ARM].map(number);
    let (x, y) = (number(*x), number(*y));
    format!(r#"<path d="M{left} {y}L{right} {y}M{x} {above}L{x} {below}" {}/>"#, stroke(tone, 1.5, false))
}

fn bar([x, y]: &[f64; 2], width: f64, floor: f64, tone: Tone) -> String {
    let [left, top, wide, high] = [x - 0.46 * width, *y, 0.92 * width, (floor - y).max(0.0)].map(number);
    format!(r#"<rect x="{left}" y="{top}" width="{wide}" height="{high}" fill="{}"/>"#, tone.on_white())
}

fn cell([x, y]: &[f64; 2], [width, height]: [f64; 2], value: f64) -> String {
    let [left, top, wide, high] = [x - 0.48 * width, y - 0.48 * height, 0.96 * width, 0.96 * height].map(number);
    format!(r#"<rect x="{left}" y="{top}" width="{wide}" height="{high}" fill="{}"/>"#, shade(value, false))
}
