//! Plain figures as SVG: lines, bands and points in a frame with ticks.

use std::fmt::Write;
use std::path::Path;

const SIZE: [f64; 2] = [620.0, 360.0];
/// Left, right, top and bottom of the frame.
const FRAME: [f64; 4] = [64.0, 600.0, 30.0, 312.0];
/// Colours that are distinct for any colour vision (Okabe & Ito).
pub const COLOURS: [&str; 5] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#555555"];

/// A figure under way.
#[derive(Debug)]
pub struct Figure {
    x: [f64; 2],
    y: [f64; 2],
    body: String,
    names: Vec<(String, &'static str)>,
}

impl Figure {
    /// An empty frame from x\[0\] to x\[1\] and y\[0\] to y\[1\].
    pub fn new(title: &str, x_label: &str, y_label: &str, x: [f64; 2], y: [f64; 2]) -> Figure {
        let mut figure = Figure { x, y, body: String::new(), names: Vec::new() };
        let [left, right, top, bottom] = FRAME;
        for tick in ticks(x) {
            let at = figure.at_x(tick);
            figure.line([at, bottom, at, top], "#e4e4e4", 1.0);
            figure.text([at, bottom + 16.0], "middle", &number(tick), "#222");
        }
        for tick in ticks(y) {
            let at = figure.at_y(tick);
            figure.line([left, at, right, at], "#e4e4e4", 1.0);
            figure.text([left - 6.0, at + 4.0], "end", &number(tick), "#222");
        }
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        figure.text([middle[0], bottom + 36.0], "middle", x_label, "#222");
        figure.text([left, top - 12.0], "start", title, "#000");
        let _ = writeln!(
            figure.body,
            "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\" fill=\"#222\">{y_label}</text>",
            middle[1]
        );
        figure
    }

    fn at_x(&self, x: f64) -> f64 {
        FRAME[0] + (x - self.x[0]) / (self.x[1] - self.x[0]) * (FRAME[1] - FRAME[0])
    }

    fn at_y(&self, y: f64) -> f64 {
        FRAME[3] - (y - self.y[0]) / (self.y[1] - self.y[0]) * (FRAME[3] - FRAME[2])
    }

    fn line(&mut self, [x1, y1, x2, y2]: [f64; 4], colour: &str, width: f64) {
        let _ = writeln!(
            self.body,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        );
    }

    fn text(&mut self, [x, y]: [f64; 2], anchor: &str, text: &str, colour: &str) {
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        );
    }

    fn points(&self, points: impl Iterator<Item = (f64, f64)>) -> String {
        points.map(|(x, y)| format!("{:.1},{:.1} ", self.at_x(x), self.at_y(y))).collect()
    }

    /// A line through points, named in the legend.
    pub fn curve(&mut self, points: &[(f64, f64)], colour: &'static str, name: &str) {
        let way = self.points(points.iter().copied());
        let _ =
            writeln!(self.body, "<polyline points=\"{way}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>");
        self.name(colour, name);
    }

    /// The area between two lines over the same x.
    pub fn band(&mut self, low: &[(f64, f64)], high: &[(f64, f64)], colour: &'static str) {
        let round = self.points(low.iter().chain(high.iter().rev()).copied());
        let _ = writeln!(self.body, "<polygon points=\"{round}\" fill=\"{colour}\" fill-opacity=\"0.15\"/>");
    }

    /// Dots, named in the legend.
    pub fn dots(&mut self, points: &[(f64, f64)], colour: &'static str, name: &str) {
        for (x, y) in points {
            let _ = writeln!(
                self.body,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.2\" fill=\"{colour}\" fill-opacity=\"0.55\"/>",
                self.at_x(*x),
                self.at_y(*y)
            );
        }
        self.name(colour, name);
    }

    /// A mark across the whole height at x.
    pub fn mark(&mut self, x: f64, colour: &'static str, name: &str) {
        let at = self.at_x(x);
        self.line([at, FRAME[3], at, FRAME[2]], colour, 2.0);
        self.name(colour, name);
    }

    fn name(&mut self, colour: &'static str, name: &str) {
        if !name.is_empty() {
            self.names.push((name.to_owned(), colour));
        }
    }

    /// Writes the file.
    pub fn save(mut self, folder: &Path, name: &str) {
        let names = std::mem::take(&mut self.names);
        for (i, (name, colour)) in names.iter().enumerate() {
            let y = FRAME[2] + 16.0 + 16.0 * i as f64;
            self.line([FRAME[1] - 22.0, y - 4.0, FRAME[1] - 6.0, y - 4.0], colour, 3.0);
            self.text([FRAME[1] - 28.0, y], "end", name, "#222");
        }
        let [width, height] = SIZE;
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body
        );
        std::fs::write(folder.join(name), svg).expect("the figure can be written");
    }
}

/// Four to ten round numbers in a range.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let raw = (high - low) / 6.0;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= raw).unwrap_or(power);
    let first = (low / step).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
