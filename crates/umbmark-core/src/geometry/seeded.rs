//! Numbers that carry derivatives by themselves.

use super::{Dual, LANES};

/// Numbers of which those at `places` carry a derivative by themselves: place k in lane k.
pub fn seeded(values: impl IntoIterator<Item = f64>, places: &[usize]) -> Vec<Dual> {
    debug_assert!(places.len() <= LANES);
    let mut duals: Vec<Dual> = values.into_iter().map(Dual::from).collect();
    places.iter().enumerate().for_each(|(lane, place)| duals[*place].eps[lane] = 1.0);
    duals
}
