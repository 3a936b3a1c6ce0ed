//! Figures as files: one format for each ending.

use std::ops::RangeInclusive;
use std::path::Path;

use super::bitmap::{self, DrawError};
use super::{plotly, svg};
use crate::figure::Figure;

/// How a figure is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A drawing.
    Svg,
    /// A picture of dots.
    Png,
    /// A page.
    Pdf,
    /// The JSON that Plotly reads.
    Plotly,
}

/// An ending that no format has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a figure is written as NAME.svg, NAME.png, NAME.pdf or NAME.json (for Plotly)")]
pub struct UnknownEnding;

/// Widths that figures may have \[mm\].
pub const WIDTHS_MM: RangeInclusive<f64> = 40.0..=400.0;

/// Dots per inch that pictures may have.
pub const DOTS_PER_INCH: RangeInclusive<u32> = 30..=1200;

impl Format {
    /// The format of a file, by its ending.
    pub fn of(file: &Path) -> Result<Format, UnknownEnding> {
        let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "svg" => Ok(Format::Svg),
            "png" => Ok(Format::Png),
            "pdf" => Ok(Format::Pdf),
            "json" => Ok(Format::Plotly),
            _ => Err(UnknownEnding),
        }
    }

    /// A figure in this format, so wide and, as a picture, with so many dots per inch.
    pub fn bytes(self, figure: &Figure, width_mm: f64, dots_per_inch: u32) -> Result<Vec<u8>, DrawError> {
        let drawn = || svg::svg(figure, &svg::Style { width_mm, ..svg::Style::default() });
        Ok(match self {
            Format::Svg => drawn().into_bytes(),
            Format::Png => bitmap::png(&drawn(), f64::from(dots_per_inch))?,
            Format::Pdf => bitmap::pdf(&drawn())?,
            Format::Plotly => plotly::figure(figure).to_string().into_bytes(),
        })
    }
}
