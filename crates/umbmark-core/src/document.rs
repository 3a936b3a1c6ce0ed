//! Results as documents: what `--json` prints, and what Python's results hold.
//!
//! Keys carry their unit and stay what they are; a number that is none, or that the data does not give, is null. One file
//! for each kind of result.

mod about;
mod calibration;
mod clock;
mod comparison;
mod diagnosis;
mod fitted;
mod gears;
mod inspection;
mod law;
mod learnt;
mod model;
mod nominal;
mod plan;
mod remains;
mod score;
mod sensitivity;
mod setup;
mod square;
mod study;
mod sweep;
mod tolerance;
mod track_comparison;

pub use about::{about, formula_variables};
pub use calibration::calibration;
pub use clock::clock;
pub use comparison::comparison;
pub use diagnosis::diagnosis;
pub use fitted::{estimates, fitted, meanings, not_shown};
pub use gears::gears;
pub use inspection::inspection;
pub use learnt::learnt;
pub use model::model;
pub use nominal::{path, robot};
pub use plan::{plan, separation};
pub use score::score;
pub use sensitivity::{Asked, Found, sensitivity};
pub use setup::setup;
pub use study::{Theory, Told, distribution, ensemble, run, study};
pub use sweep::sweep;
pub use tolerance::{Wanted, tolerance};
pub use track_comparison::track_comparison;

use crate::stats::Interval;
use serde_json::{Value, json};

/// A number, or null for what is none.
fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// The ends of an interval, or nothing where they are none.
fn ends(interval: Interval) -> Option<[f64; 2]> {
    pair(interval.low, interval.high)
}

/// Two numbers, or nothing where one is none.
fn pair(first: f64, second: f64) -> Option<[f64; 2]> {
    (first.is_finite() && second.is_finite()).then_some([first, second])
}
