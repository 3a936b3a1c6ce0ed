//! Returns that were measured from another point than START, as in the frame of a room.
//!
//! Of first order in α (by E_b) and β (by E_d), on a square of side L
//!
//! ```text
//! (m_cw + m_ccw)/2 = 2L (-α, β),   (m_cw - m_ccw)/2 = 2L (-β, α)
//! ```
//!
//! have the same length: wheels and wheelbase take the returns of both directions as far from each other as from START. A point of reference that is
//! not START moves both alike, and leaves them near each other.

use super::{Fault, Run};
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use crate::stats::median;

/// So many returns of each direction are needed.
const FEWEST: usize = 2;
/// A START that is nearer, as a share of the path's length, is an effect that is fitted.
const NEAREST: f64 = 0.1;
/// So many times as far from the point of reference as from their common middle.
const TIMES: f64 = 5.0;
/// No room is larger \[m\]; farther away, the unit is wrong.
const LARGEST: f64 = 100.0;

/// The fault of such returns.
pub(super) fn of(runs: &[Run], path: Option<&Path>) -> Option<Fault> {
    let way = path?.length();
    let [cw, ccw] = Direction::BOTH.map(|direction| middle(runs, direction));
    let ([x, y], [to_x, to_y]) = (cw?, ccw?);
    let distance = 0.5 * libm::hypot(x + to_x, y + to_y);
    let apart = libm::hypot(x - to_x, y - to_y);
    let is_elsewhere = distance > NEAREST * way && distance < LARGEST && distance > 0.5 * TIMES * apart;
    is_elsewhere.then_some(Fault::ReturnsFromElsewhere { distance, apart })
}

/// Medians of x and y in a direction.
fn middle(runs: &[Run], direction: Direction) -> Option<[f64; 2]> {
    let own = runs.iter().filter(|run| run.test == TestKind::Systematic && run.direction == Some(direction));
    let errors: Vec<_> = own.filter_map(|run| run.returned).collect();
    let of = |pick: fn(&crate::run::ReturnError) -> f64| median(errors.iter().map(pick).collect());
    (errors.len() >= FEWEST).then_some(())?;
    Some([of(|error| error.x)?, of(|error| error.y)?])
}
