//! Figures as drawings.

pub mod bitmap;
pub mod file;
pub mod plotly;
pub mod strip;
pub mod svg;
pub mod terminal;

mod braille;
mod font;
pub mod legend;
