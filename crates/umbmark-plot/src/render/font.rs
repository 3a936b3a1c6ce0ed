//! The font of all drawings: a part of Roboto that goes with the program, so that drawings are the same everywhere.

use std::sync::{Arc, LazyLock};

use resvg::usvg::fontdb;
use ttf_parser::Face;

/// The name that drawings ask for, and what else will do.
pub const FAMILY: &str = "Roboto, Arial, sans-serif";

static REGULAR: &[u8] = include_bytes!("../../fonts/Roboto-Regular.ttf");

static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(REGULAR, 0).ok());

/// Width of a line of text, as tall as `size`.
pub fn width(text: &str, size: f64) -> f64 {
    let Some(face) = FACE.as_ref() else { return 0.55 * size * text.chars().count() as f64 };
    let advance = |c: char| {
        let glyph = face.glyph_index(c).unwrap_or_default();
        f64::from(face.glyph_hor_advance(glyph).unwrap_or_default())
    };
    text.chars().map(advance).sum::<f64>() * size / f64::from(face.units_per_em())
}

/// This font and no other; of two, PDFs would not be the same each time (svg2pdf).
pub fn database() -> Arc<fontdb::Database> {
    let mut database = fontdb::Database::new();
    database.load_font_data(REGULAR.to_vec());
    database.set_sans_serif_family("Roboto");
    Arc::new(database)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_figures_say() {
        let face = FACE.as_ref().unwrap();
        for c in "AZaz09 .,:;()[]%+−±×°σεθ₁₀–²".chars() {
            assert!(face.glyph_index(c).is_some(), "{c}");
        }
        // Digits of Roboto are 1151 units of 2048 wide.
        assert!((width("00", 10.0) - 20.0 * 1151.0 / 2048.0).abs() < 1e-9);
    }
}
