//! Figures as drawings.

pub mod bitmap;
pub mod plotly;
pub mod svg;
pub mod terminal;

mod font;
pub(crate) mod legend;
