//! PNG and PDF, both from the SVG.

use resvg::{tiny_skia, usvg};

use super::font;

/// Why a drawing could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The SVG is not one.
    #[error("the figure cannot be drawn: {0}")]
    Svg(#[from] usvg::Error),
    /// More points than can be held.
    #[error("a picture of {width} x {height} points cannot be made; choose fewer dots per inch or a smaller width")]
    Size {
        /// Points across.
        width: u32,
        /// Points down.
        height: u32,
    },
    /// The PDF cannot be made.
    #[error("the figure cannot be written as PDF: {0}")]
    Pdf(String),
    /// The PNG cannot be packed.
    #[error("the figure cannot be written as PNG: {0}")]
    Png(String),
}

fn tree(svg: &str) -> Result<usvg::Tree, DrawError> {
    let options = usvg::Options { fontdb: font::database(), font_family: "Roboto".into(), ..usvg::Options::default() };
    Ok(usvg::Tree::from_str(svg, &options)?)
}

/// A PNG with so many dots per inch, on white.
pub fn png(svg: &str, dots_per_inch: f64) -> Result<Vec<u8>, DrawError> {
    let tree = tree(svg)?;
    let scale = (dots_per_inch / 96.0) as f32;
    let size = tree.size();
    let (width, height) = ((size.width() * scale).ceil() as u32, (size.height() * scale).ceil() as u32);
    let mut canvas = tiny_skia::Pixmap::new(width, height).ok_or(DrawError::Size { width, height })?;
    canvas.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut canvas.as_mut());
    canvas.encode_png().map_err(|error| DrawError::Png(error.to_string()))
}

/// A PDF page of the size of the figure, the text kept as text.
pub fn pdf(svg: &str) -> Result<Vec<u8>, DrawError> {
    let tree = tree(svg)?;
    // A point of a PDF is 1/72 inch, a pixel of the SVG 1/96.
    let page = svg2pdf::PageOptions { dpi: 96.0 };
    svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page)
        .map_err(|error| DrawError::Pdf(error.to_string()))
}
