//! The steps of Levenberg and Marquardt.

use super::covariance::column_lengths;
use super::known::AllKnown;
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
    let known = AllKnown(problem.known());
    let at = Point::new(problem, known.nearest(start.to_vec()), &known);
    if !at.cost.is_finite() {
        return at.stopped(0, Termination::NotFinite);
    }
    if start.is_empty() {
        return at.stopped(0, Termination::SmallStep);
    }
    let mut descent = Descent::new(at, known, options);
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
    known: AllKnown,
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
    fn new(at: Point, known: AllKnown, options: &Options) -> Descent<'_> {
        let lengths = vec![0.0_f64; at.values.len()];
        let damping = if options.cautious { FIRST_DAMPING } else { LEAST_DAMPING };
        let memory = options.frugal.then(Memory::default);
        Descent { options, known, at, lengths, damping, memory, refused: false }
    }

    /// Tries one step; says why no further one is needed.
    fn step(&mut self, problem: &impl Problem) -> Option<Termination> {
        for (length, now) in self.lengths.iter_mut().zip(column_lengths(&self.at.jacobian)) {
            *length = length.max(now);
        }
        let (plain, ends_at_bound) = self.plain_step();
        let is_undamped = self.damping <= LEAST_DAMPING;
        let is_inside = !ends_at_bound && !self.refused;
        if self.memory.is_some() && is_inside && self.at.expected_decrease(&plain) <= self.tolerance() {
            // A damped step can gain very little although the minimum is still far away.
            self.damping = LEAST_DAMPING;
            return is_undamped.then_some(Termination::SmallDecrease);
        }
        // Earlier steps that ended at a bound say nothing of the next.
        let memory = self.memory.as_mut().filter(|_| !self.known.is_bounded());
        let learnt = memory.and_then(|memory| memory.learn(&self.at.values, &self.at.jacobian, &plain));
        let step = learnt.as_ref().unwrap_or(&plain);
        let next = Point::new(problem, self.known.nearest(self.at.moved(step)), &self.known);
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

    /// The damped step within the bounds, and whether it ends at one that it would exceed. What is at a bound and would leave it stays; what
    /// reaches one on the way ends there, and the others step as is best beside that.
    fn plain_step(&self) -> (DVector<f64>, bool) {
        let Point { values, residuals, jacobian, held, .. } = &self.at;
        if !self.known.is_bounded() {
            return (damped_step(jacobian, residuals, &self.lengths, self.damping), false);
        }
        let mut fixed: Vec<Option<f64>> = held.iter().map(|held| held.then_some(0.0)).collect();
        let mut ends_at_bound = false;
        loop {
            let (mut left, mut free, mut lengths) = (residuals.clone(), jacobian.clone(), self.lengths.clone());
            for (k, by) in fixed.iter().enumerate().filter_map(|(k, by)| Some((k, (*by)?))) {
                left.axpy(by, &jacobian.column(k), 1.0);
                free.column_mut(k).fill(0.0);
                lengths[k] = 0.0;
            }
            let mut step = damped_step(&free, &left, &lengths, self.damping);
            fixed.iter().enumerate().for_each(|(k, by)| step[k] = by.unwrap_or(step[k]));
            let ends = self.at.moved(&step);
            let within = self.known.nearest(ends.clone());
            let exceeds = |k: &usize| fixed[*k].is_none() && within[*k] != ends[*k];
            let Some(k) = (0..values.len()).find(exceeds) else { return (step, ends_at_bound) };
            fixed[k] = Some(within[k] - values[k]);
            ends_at_bound = true;
        }
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
    /// Which parameters are at a bound beyond which the cost falls.
    held: Vec<bool>,
    cost: f64,
}

impl Point {
    fn new(problem: &impl Problem, values: Vec<f64>, known: &AllKnown) -> Point {
        let (residuals, jacobian) = known.with_priors(&values, problem.both(&values));
        let (held, cost) = (known.held(&values, &residuals, &jacobian), residuals.norm_squared());
        Point { values, residuals, jacobian, held, cost }
    }

    /// The values after a step.
    fn moved(&self, step: &DVector<f64>) -> Vec<f64> {
        self.values.iter().zip(step.iter()).map(|(p, d)| p + d).collect()
    }

    /// By how much a step would lower the sum of squares of a linear problem.
    fn expected_decrease(&self, step: &DVector<f64>) -> f64 {
        let moved = &self.jacobian * step;
        -moved.dot(&(&moved + 2.0 * &self.residuals))
    }

    fn stopped(self, iterations: usize, termination: Termination) -> Fit {
        let Point { values, residuals, jacobian, held, .. } = self;
        Fit { values, residuals, jacobian, held, iterations, termination }
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
