//! The text of an SVG, written element by element.

use std::fmt::Write;

use super::marks::Frame;
use super::{FAMILY, LETTERS, ink};
use crate::tone::Tone;

/// Which end of a text its place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn word(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// A drawing in the making.
pub struct Drawing {
    width: f64,
    id: String,
    body: String,
}

/// Hundredths of a pixel, without what says nothing.
pub fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

/// Text as XML holds it; characters that XML forbids are left out.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            c if (c as u32) < 0x20 || matches!(c, '\u{7f}' | '\u{fffe}' | '\u{ffff}') => {}
            c => safe.push(c),
        }
    }
    safe
}

impl Drawing {
    pub fn new(width: f64, id: &str) -> Drawing {
        Drawing { width, id: id.to_owned(), body: String::new() }
    }

    /// Adds an element as it is written.
    pub fn element(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    pub fn text(&mut self, x: f64, y: f64, anchor: Anchor, words: &str) {
        self.sized(x, y, anchor, LETTERS, words);
    }

    pub fn sized(&mut self, x: f64, y: f64, anchor: Anchor, size: f64, words: &str) {
        let (x, y, size) = (number(x), number(y), number(size));
        let (anchor, words) = (anchor.word(), escaped(words));
        let _ =
            writeln!(self.body, r#"<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}">{words}</text>"#);
    }

    pub fn bold(&mut self, x: f64, y: f64, words: &str) {
        let (x, y, words) = (number(x), number(y), escaped(words));
        let _ = writeln!(self.body, r#"<text x="{x}" y="{y}" font-weight="bold">{words}</text>"#);
    }

    /// Text that is read from below, its middle at the place.
    pub fn sideways(&mut self, x: f64, y: f64, words: &str) {
        let (x, y, words) = (number(x), number(y), escaped(words));
        let turn = format!("rotate(-90 {x} {y})");
        let _ = writeln!(self.body, r#"<text x="{x}" y="{y}" text-anchor="middle" transform="{turn}">{words}</text>"#);
    }

    /// Text that is read from below, its end at the place.
    pub fn upward(&mut self, x: f64, y: f64, size: f64, words: &str) {
        let (x, y, size, words) = (number(x), number(y), number(size), escaped(words));
        let turn = format!("rotate(-90 {x} {y})");
        let _ = writeln!(
            self.body,
            r#"<text x="{x}" y="{y}" font-size="{size}" text-anchor="end" transform="{turn}">{words}</text>"#
        );
    }

    /// A line of the grid.
    pub fn rule(&mut self, x1: f64, y1: f64, x2: f64, y2: f64) {
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(number);
        let _ = writeln!(self.body, r##"<path d="M{x1} {y1}L{x2} {y2}" stroke="#e3e6e9" stroke-width="0.6"/>"##);
    }

    pub fn frame(&mut self, frame: &Frame) {
        let rect = rect(frame);
        let _ = writeln!(self.body, r##"<rect {rect} fill="none" stroke="#6b737b" stroke-width="0.7"/>"##);
    }

    /// What follows is seen inside the frame only.
    pub fn clip(&mut self, frame: &Frame, index: usize) {
        let (rect, id) = (rect(frame), &self.id);
        let _ = writeln!(self.body, r#"<clipPath id="{id}-{index}"><rect {rect}/></clipPath>"#);
        let _ = writeln!(self.body, r#"<g clip-path="url(#{id}-{index})">"#);
    }

    pub fn unclip(&mut self) {
        self.element("</g>");
    }

    /// The whole.
    pub fn finish(self, height: f64, title: &str, description: &str) -> String {
        let (width, height, ink) = (number(self.width), number(height), ink());
        let (title, description, body) = (escaped(title), escaped(description), self.body);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"{FAMILY}\" font-size=\"{LETTERS}\" fill=\"{ink}\" role=\"img\">\n\
             <title>{title}</title>\n<desc>{description}</desc>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
        )
    }
}

fn rect(frame: &Frame) -> String {
    let [x, y, width, height] = [frame.left, frame.top, frame.width, frame.height].map(number);
    format!(r#"x="{x}" y="{y}" width="{width}" height="{height}""#)
}

/// Paint of a line.
pub fn stroke(tone: Tone, width: f64, dashed: bool) -> String {
    let dashes = if dashed { r#" stroke-dasharray="4 2.5""# } else { "" };
    let (colour, width) = (tone.on_white(), number(width));
    format!(r#"fill="none" stroke="{colour}" stroke-width="{width}"{dashes}"#)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_leave_their_place() {
        assert_eq!(escaped("</text><script>\u{1}&\""), "&lt;/text&gt;&lt;script&gt;&amp;&quot;");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([number(1.0), number(-0.001), number(2.345), number(10.5)], ["1", "0", "2.35", "10.5"]);
    }
}
