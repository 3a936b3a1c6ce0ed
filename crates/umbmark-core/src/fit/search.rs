//! The best of several minima.

use super::descent::least_squares;
use super::outcome::Fit;
use super::problem::{Options, Problem};

/// Another minimum counts as a rival if its cost is at most this multiple of the least.
const RIVAL: f64 = 2.0;
/// A minimum replaces that of the first start if its cost is less than this share of the latter's.
const BETTER: f64 = 0.99;
/// Minima whose parameters differ by less than this are the same minimum.
const SAME: f64 = 0.02;

/// The best of several minima.
#[derive(Clone, Debug)]
pub(crate) struct Searched {
    /// The fit of least cost.
    pub fit: Fit,
    /// The parameters of another minimum that is about as good.
    pub rival: Option<Vec<f64>>,
}

/// Looks for a better minimum than that of a `first` fit from further starts. `possible` says which parameters are allowed.
pub(crate) fn search(
    problem: &impl Problem,
    first: Fit,
    starts: &[Vec<f64>],
    options: &Options,
    possible: impl Fn(&[f64]) -> bool,
) -> Searched {
    let sound = |fit: &Fit| {
        fit.termination.converged()
            && fit.cost().is_finite()
            && fit.values.iter().all(|v| v.is_finite())
            && possible(&fit.values)
    };
    let others: Vec<Fit> = starts.iter().map(|start| least_squares(problem, start, options)).filter(sound).collect();
    let of_first = if sound(&first) { BETTER * first.cost() } else { f64::INFINITY };
    let better = others.iter().filter(|fit| fit.cost() < of_first).min_by(|a, b| a.cost().total_cmp(&b.cost()));
    let fit = better.cloned().unwrap_or_else(|| first.clone());
    let differs = |other: &Fit| other.values.iter().zip(&fit.values).any(|(a, b)| (a - b).abs() > SAME);
    let limit = RIVAL * fit.cost();
    let all = others.into_iter().chain([first]);
    let rivals = all.filter(|other| sound(other) && sound(&fit) && differs(other) && other.cost() <= limit);
    let rival = rivals.min_by(|a, b| a.cost().total_cmp(&b.cost())).map(|other| other.values);
    Searched { fit, rival }
}
