//! What the marks of a figure stand for.

use crate::figure::{Figure, Mark};
use crate::tone::Tone;

/// An entry: its words, its colour, its mark.
pub type Entry<'f> = (&'f str, Tone, &'f Mark);

/// The layers that have a name, those alike once.
pub fn entries(figure: &Figure) -> Vec<Entry<'_>> {
    let mut entries: Vec<Entry<'_>> = Vec::new();
    for layer in figure.panels.iter().flat_map(|panel| &panel.layers).filter(|layer| !layer.name.is_empty()) {
        if entries.iter().all(|(name, tone, _)| (*name, *tone) != (layer.name.as_str(), layer.tone)) {
            entries.push((&layer.name, layer.tone, &layer.mark));
        }
    }
    entries
}

/// A mark in one word, for pages.
pub fn word(mark: &Mark, tone: Tone) -> &'static str {
    match mark {
        Mark::Dots | Mark::Spans(..) if tone.is_modelled() => "dots diamond",
        Mark::Rings if tone.is_modelled() => "rings diamond",
        Mark::Dots | Mark::Spans(..) => "dots",
        Mark::Rings => "rings",
        Mark::Crosses => "crosses",
        Mark::Line => "line",
        Mark::Dashes => "dashes",
        Mark::Bars(_) | Mark::Cells(_) => "bars",
        Mark::Words(_) => "words",
    }
}
