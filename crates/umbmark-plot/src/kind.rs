//! The kinds of figures, one file each.

mod on_demand;
mod residuals;

use crate::figure::Figure;
use crate::study::{Absent, Study};
use umbmark_core::register;

pub use monte_carlo::histogram;
pub use return_errors::of_score;

/// A kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct FigureKind {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    /// Builds it from a study.
    pub build: fn(&Study) -> Result<Figure, Absent>,
}

register! {
    /// The kinds of a report, in its order.
    pub KINDS: FigureKind = FIGURE in
    return_errors,
    circle,
    tracks,
    residuals_along,
    residuals_by_move,
    residuals_by_speed,
    residuals_by_turn_rate,
    residuals_by_wheel_angle,
    residuals_by_heading,
    learning,
    laws,
    confusability,
    parameters,
    conditions,
    correlations,
    monte_carlo,
    runs,
}

/// A p-value in a sentence or a table: "0.013", and "< 0.001" below that.
fn p_value(p: f64) -> String {
    if p < 0.001 { "< 0.001".into() } else { format!("{p:.3}") }
}

/// A p-value behind its letter: "p = 0.013", "p < 0.001".
pub(crate) fn p_is(p: f64) -> String {
    if p < 0.001 { "p < 0.001".into() } else { format!("p = {p:.3}") }
}

/// All kinds: first those of a report, then those that are drawn only where they are asked for.
pub fn all() -> impl Iterator<Item = &'static FigureKind> {
    KINDS.iter().copied().chain(&on_demand::FIGURES)
}

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static FigureKind> {
    all().find(|kind| kind.name == name)
}
