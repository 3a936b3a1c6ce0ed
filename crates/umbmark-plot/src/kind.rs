//! The kinds of figures, one file each.

mod circle;
mod confusability;
mod correlations;
mod laws;
mod learning;
mod monte_carlo;
mod parameters;
mod residuals;
mod return_errors;
mod runs;
mod tracks;

use crate::figure::Figure;
use crate::study::{Absent, Study};

pub use monte_carlo::histogram;
pub use return_errors::of_score;

/// A kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    /// Builds it from a study.
    pub build: fn(&Study) -> Result<Figure, Absent>,
}

/// All kinds, in the order of a report.
pub const KINDS: [Kind; 16] = [
    Kind {
        name: "return_errors",
        about: "return errors, centres of gravity, E_max,sys: the paper's Fig. 5",
        build: return_errors::figure,
    },
    Kind { name: "circle", about: "end points beside the circle through START", build: circle::figure },
    Kind { name: "tracks", about: "measured, computed and modelled path, the error magnified", build: tracks::figure },
    Kind { name: "residuals_along", about: "errors of the model along each run", build: residuals::along },
    Kind { name: "residuals_by_move", about: "errors that each leg and turn adds", build: residuals::by_move },
    Kind { name: "residuals_by_speed", about: "errors against the speed", build: residuals::by_speed },
    Kind { name: "residuals_by_turn_rate", about: "errors against the turn rate", build: residuals::by_turn_rate },
    Kind {
        name: "residuals_by_wheel_angle",
        about: "errors against the wheels' angles",
        build: residuals::by_wheel_angle,
    },
    Kind {
        name: "residuals_by_heading",
        about: "errors against the heading in the room",
        build: residuals::by_heading,
    },
    Kind { name: "learning", about: "the error falling as effects are added", build: learning::figure },
    Kind { name: "laws", about: "laws that no catalogue lists: error left out against length", build: laws::figure },
    Kind { name: "confusability", about: "which effects look alike in these runs", build: confusability::figure },
    Kind { name: "parameters", about: "the model's numbers with their intervals", build: parameters::figure },
    Kind { name: "correlations", about: "how far the model's numbers are tied", build: correlations::figure },
    Kind {
        name: "monte_carlo",
        about: "E_max,sys of simulated tests, the measured one among them",
        build: monte_carlo::figure,
    },
    Kind { name: "runs", about: "each run's distance from the others: outliers, drift", build: runs::figure },
];

/// A p-value in a sentence or a table: "0.013", and "< 0.001" below that.
fn p_value(p: f64) -> String {
    if p < 0.001 { "< 0.001".into() } else { format!("{p:.3}") }
}

/// A p-value behind its letter: "p = 0.013", "p < 0.001".
fn p_is(p: f64) -> String {
    if p < 0.001 { "p < 0.001".into() } else { format!("p = {p:.3}") }
}

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}
