//! The steps of Levenberg and Marquardt.

use super::covariance::column_lengths;
use super::memory::Memory;
use super::outcome::{Fit, Termination};
use super::problem::{Options, Problem};
use nalgebra::{DMatrix, DVector};

const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;

/// Minimises the sum of squares of a problem's residuals from start values.
///
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use umbmark_core::fit::{Options, Problem, least_squares};
/// /// y = a exp(b x) through (0, 2), (1, 1), (2, 0.5).
/// struct Decay;
/// impl Problem for Decay {
///     fn residuals(&self, p: &[f64]) -> DVector<f64> {
///         DVector::from_fn(3, |i, _| [2.0, 1.0, 0.5][i] - p[0] * (p[1] * i as f64).exp())
///     }
///     fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
///         DMatrix::from_fn(3, 2, |i, j| {
///             let (x, e) = (i as f64, (p[1] * i as f64).exp());
///             if j == 0 { -e } else { -p[0] * x * e }
///         })
///     }
/// }
/// let fit = least_squares(&Decay, &[1.0, 0.0], &Options::default());
/// assert!(fit.termination.converged());
/// assert!((fit.values[0] - 2.0).abs() < 1e-9 && (fit.values[1] + 2f64.ln()).abs() < 1e-9);
/// ```
pub fn least_squares(problem: &impl Problem, start: &[f64], options: &Options) -> Fit {
    let at = Point::new(problem, start.to_vec());
    if !at.cost.is_finite() {
        return at.stopped(0, Termination::NotFinite);
    }
    if start.is_empty() {
        return at.stopped(0, Termination::SmallStep);
    }
    let mut descent = Descent::new(at, options);
    for iteration in 1..=options.iterations {
        if let Some(termination) = descent.step(problem) {
            return descent.at.stopped(iteration, termination);
        }
    }
    descent.at.stopped(options.iterations, Termination::IterationLimit)
}

/// A fit on its way.
struct Descent<'a> {
    options: &'a Options,
    at: Point,
    /// The greatest length that each column of the Jacobian has had.
    lengths: Vec<f64>,
    damping: f64,
    /// Earlier points and steps; kept only if points are expensive to compute.
    memory: Option<Memory>,
    /// Whether the last step led to a worse point, and was not taken.
    refused: bool,
}

impl Descent<'_> {
    fn new(at: Point, options: &Options) -> Descent<'_> {
        let lengths = vec![0.0_f64; at.values.len()];
        let damping = if options.cautious { FIRST_DAMPING } else { LEAST_DAMPING };
        let memory = options.frugal.then(Memory::default);
        Descent { options, at, lengths, damping, memory, refused: false }
    }

    /// Tries one step; says why no further one is needed.
    fn step(&mut self, problem: &impl Problem) -> Option<Termination> {
        for (length, now) in self.lengths.iter_mut().zip(column_lengths(&self.at.jacobian)) {
            *length = length.max(now);
        }
        let plain = damped_step(&self.at.jacobian, &self.at.residuals, &self.lengths, self.damping);
        let is_undamped = self.damping <= LEAST_DAMPING;
        if self.memory.is_some() && !self.refused && self.at.expected_decrease(&plain) <= self.tolerance() {
            // A damped step can gain very little although the minimum is still far away.
            self.damping = LEAST_DAMPING;
            return is_undamped.then_some(Termination::SmallDecrease);
        }
        let learnt = self.memory.as_mut().and_then(|memory| memory.learn(&self.at.values, &self.at.jacobian, &plain));
        let step = learnt.as_ref().unwrap_or(&plain);
        let next = Point::new(problem, self.at.values.iter().zip(step.iter()).map(|(p, d)| p + d).collect());
        let is_small = self.is_small(step);
        let decrease = self.at.cost - next.cost;
        // Both sums agree to rounding, so they cannot decide which point is better. The step comes from the gradient and is more exact:
        // take it.
        let is_negligible = decrease.abs() <= self.tolerance();
        let is_better = decrease > 0.0 || is_negligible;
        self.refused = !is_better;
        if is_better {
            self.at = next;
        }
        if is_small {
            return Some(Termination::SmallStep);
        }
        if (is_negligible && is_undamped) || self.damping >= MOST_DAMPING {
            return Some(Termination::SmallDecrease);
        }
        if self.refused && learnt.is_some() {
            // The accelerated step was worse: forget the earlier points and try the plain step next.
            self.memory = Some(Memory::default());
        } else {
            self.damping = match (is_negligible, is_better) {
                (true, _) => LEAST_DAMPING,
                (false, true) => (0.1 * self.damping).max(LEAST_DAMPING),
                (false, false) if is_undamped => FIRST_DAMPING,
                (false, false) => 10.0 * self.damping,
            };
        }
        None
    }

    /// A decrease of the sum of squares below this is negligible.
    fn tolerance(&self) -> f64 {
        self.options.decrease_tolerance * self.at.cost
    }

    /// Whether a step changes every parameter negligibly.
    fn is_small(&self, step: &DVector<f64>) -> bool {
        let tolerance = self.options.step_tolerance;
        step.iter().zip(&self.at.values).all(|(d, p)| d.abs() <= tolerance * p.abs().max(1e-300))
    }
}

/// A point of a fit.
struct Point {
    values: Vec<f64>,
    residuals: DVector<f64>,
    jacobian: DMatrix<f64>,
    cost: f64,
}

impl Point {
    fn new(problem: &impl Problem, values: Vec<f64>) -> Point {
        let (residuals, jacobian) = problem.both(&values);
        let cost = residuals.norm_squared();
        Point { values, residuals, jacobian, cost }
    }

    /// By how much a step would lower the sum of squares of a linear problem.
    fn expected_decrease(&self, step: &DVector<f64>) -> f64 {
        let moved = &self.jacobian * step;
        -moved.dot(&(&moved + 2.0 * &self.residuals))
    }

    fn stopped(self, iterations: usize, termination: Termination) -> Fit {
        Fit { values: self.values, residuals: self.residuals, jacobian: self.jacobian, iterations, termination }
    }
}

/// argmin |r + J δ|² + λ |D δ|², D the column lengths. A parameter whose column is zero stays.
fn damped_step(jacobian: &DMatrix<f64>, residuals: &DVector<f64>, lengths: &[f64], damping: f64) -> DVector<f64> {
    let (rows, columns) = jacobian.shape();
    let mut stacked = jacobian.clone().resize_vertically(rows + columns, 0.0);
    for (j, length) in lengths.iter().enumerate() {
        if *length > 0.0 {
            stacked[(rows + j, j)] = damping.sqrt() * length;
        } else {
            stacked.column_mut(j).fill(0.0);
            stacked[(rows + j, j)] = 1.0;
        }
    }
    let qr = stacked.qr();
    let mut right = -residuals.clone().resize_vertically(rows + columns, 0.0);
    qr.q_tr_mul(&mut right);
    let head = right.rows(0, columns).into_owned();
    qr.r().solve_upper_triangular(&head).unwrap_or_else(|| DVector::zeros(columns))
}
