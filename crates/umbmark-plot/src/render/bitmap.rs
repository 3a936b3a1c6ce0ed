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
    let pdf = svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page);
    pdf.map(|pdf| in_order(&pdf)).map_err(|error| DrawError::Pdf(error.to_string()))
}

/// The same file with neighbouring entries of dictionaries in the order of their names.
///
/// svg2pdf writes references to resources in the order of a hash table, another one each time. Their order means nothing, and
/// sorting keeps the length, so the table of objects stays right.
fn in_order(pdf: &[u8]) -> Vec<u8> {
    let mut lines: Vec<&[u8]> = pdf.split(|byte| *byte == b'\n').collect();
    lines.chunk_by_mut(|a, b| is_reference(a) && is_reference(b)).for_each(|entries| entries.sort_unstable());
    lines.join(&b'\n')
}

/// Whether a line is an entry such as `/F0 12 0 R`.
fn is_reference(line: &[u8]) -> bool {
    let Some(words) = std::str::from_utf8(line).ok().and_then(|line| line.trim_start().strip_prefix('/')) else {
        return false;
    };
    let words: Vec<&str> = words.split(' ').collect();
    matches!(words[..], [_, number, "0", "R"] if number.parse::<u32>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_sorted_where_they_stand_side_by_side_only() {
        let pdf = b"<<\n  /gs1 8 0 R\n  /gs0 7 0 R\n>>\n/b 2 0 R\n/Type /Page\n/a 1 0 R\n\xff\n";
        let sorted = b"<<\n  /gs0 7 0 R\n  /gs1 8 0 R\n>>\n/b 2 0 R\n/Type /Page\n/a 1 0 R\n\xff\n";
        assert_eq!(in_order(pdf), sorted);
    }
}
