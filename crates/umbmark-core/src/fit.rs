//! Weighted non-linear least squares: minimise Σ r_i(p)², with residuals r = (observed - predicted)/standard deviation.
//!
//! Levenberg (1944) and Marquardt (1963): Gauss-Newton steps damped in units of the Jacobian's column lengths, each solved
//! by an orthogonal factorisation of \[J; √λ D\], never by normal equations. A parameter, or a combination of parameters, that
//! the data does not show stays where it started and is named by [`null_directions`]. A fit that stops early is a [`Fit`] that
//! says so, not an error.

mod covariance;

use nalgebra::{DMatrix, DVector};

pub use covariance::{jackknife_covariance, null_directions};

/// Singular values of the Jacobian with columns of unit length below this share of the largest count as zero.
pub const RANK_TOLERANCE: f64 = 1e-3;

const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;
/// A step learns from so many changes before it at most.
const REMEMBERED: usize = 4;

/// Residuals to be made small.
pub trait Problem {
    /// r(p): observed minus predicted, each in units of its standard deviation.
    fn residuals(&self, parameters: &[f64]) -> DVector<f64>;

    /// ∂r_i/∂p_j, one row a residual.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64>;

    /// Both, where one calculation gives them for less than two would.
    fn both(&self, parameters: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        (self.residuals(parameters), self.jacobian(parameters))
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The largest number of steps tried.
    pub iterations: usize,
    /// Stops where a step changes each parameter by less than this share of its size.
    pub step_tolerance: f64,
    /// Stops where a step lowers the sum of squares by less than this share of it.
    pub decrease_tolerance: f64,
    /// Whether the first steps are damped: needed where the start may be far from the end.
    pub cautious: bool,
    /// Whether points are dear: steps learn from those before them, and one that would lower the sum of squares too little to matter is
    /// not taken.
    pub frugal: bool,
}

impl Default for Options {
    /// 100 steps, 1e-14, 1e-15: to the last digits, and from afar.
    fn default() -> Self {
        Options { iterations: 100, step_tolerance: 1e-14, decrease_tolerance: 1e-15, cautious: true, frugal: false }
    }
}

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The last step was too small to matter.
    SmallStep,
    /// The last step lowered the sum of squares too little to matter, or no shorter step lowers it at all.
    SmallDecrease,
    /// The limit of steps was reached: the values are the best so far.
    IterationLimit,
    /// The residuals are not finite at the start.
    NotFinite,
}

impl Termination {
    /// Whether the values are a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Termination::SmallStep | Termination::SmallDecrease)
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Termination::SmallStep => "converged: the step is negligible",
            Termination::SmallDecrease => "converged: the decrease is negligible",
            Termination::IterationLimit => "stopped at the limit of iterations",
            Termination::NotFinite => "the residuals are not finite at the start values",
        }
    }
}

/// Where a fit stopped, and everything there.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The parameters.
    pub values: Vec<f64>,
    /// r at the parameters.
    pub residuals: DVector<f64>,
    /// ∂r/∂p at the parameters.
    pub jacobian: DMatrix<f64>,
    /// Steps tried.
    pub iterations: usize,
    /// Why it stopped.
    pub termination: Termination,
}

impl Fit {
    /// Σ r².
    pub fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Combinations of parameters that the data does not show; see [`null_directions`].
    pub fn null_directions(&self) -> Vec<DVector<f64>> {
        null_directions(&self.jacobian, RANK_TOLERANCE)
    }

    /// Covariance of the parameters, (JᵀJ)⁻¹, for independent residuals of unit variance; `None` where the data leaves
    /// a combination of parameters open.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        covariance::inverse_information(&self.jacobian)
    }

    /// s² = Σ r²/(N - p), the variance of the residuals; `None` without spare residuals.
    pub fn residual_variance(&self) -> Option<f64> {
        let spare = self.residuals.len().checked_sub(self.values.len())?;
        (spare > 0).then(|| self.cost() / spare as f64)
    }
}

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
    let mut at = Point::new(problem, start.to_vec());
    if !at.cost.is_finite() {
        return at.stopped(0, Termination::NotFinite);
    }
    if start.is_empty() {
        return at.stopped(0, Termination::SmallStep);
    }
    let mut lengths = vec![0.0_f64; start.len()];
    let mut damping = if options.cautious { FIRST_DAMPING } else { LEAST_DAMPING };
    let (mut before, mut refused) = (Memory::default(), false);
    for iteration in 1..=options.iterations {
        for (length, now) in lengths.iter_mut().zip(covariance::column_lengths(&at.jacobian)) {
            *length = length.max(now);
        }
        let plain = damped_step(&at.jacobian, &at.residuals, &lengths, damping);
        let moved = &at.jacobian * &plain;
        let expected = -moved.dot(&(&moved + 2.0 * &at.residuals));
        if options.frugal && !refused && expected <= options.decrease_tolerance * at.cost {
            if damping <= LEAST_DAMPING {
                return at.stopped(iteration, Termination::SmallDecrease);
            }
            // A damped step may lower the sum too little to matter and yet be far from the end.
            damping = LEAST_DAMPING;
            continue;
        }
        let learnt = if options.frugal { before.learn(&at, &plain) } else { None };
        let step = learnt.as_ref().unwrap_or(&plain);
        let next = Point::new(problem, at.values.iter().zip(step.iter()).map(|(p, d)| p + d).collect());
        let small = step.iter().zip(&at.values).all(|(d, p)| d.abs() <= options.step_tolerance * p.abs().max(1e-300));
        let decrease = at.cost - next.cost;
        // Sums that agree to the last digits cannot tell which point is better; the step can, so it is taken.
        let negligible = decrease.abs() <= options.decrease_tolerance * at.cost;
        let better = decrease > 0.0 || negligible;
        refused = !better;
        if better {
            at = next;
        }
        if small {
            return at.stopped(iteration, Termination::SmallStep);
        }
        if (negligible && damping <= LEAST_DAMPING) || damping >= MOST_DAMPING {
            return at.stopped(iteration, Termination::SmallDecrease);
        }
        if !better && learnt.is_some() {
            before = Memory::default();
            continue;
        }
        damping = match (negligible, better) {
            (true, _) => LEAST_DAMPING,
            (false, true) => (0.1 * damping).max(LEAST_DAMPING),
            (false, false) if damping <= LEAST_DAMPING => FIRST_DAMPING,
            (false, false) => 10.0 * damping,
        };
    }
    at.stopped(options.iterations, Termination::IterationLimit)
}

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

    fn stopped(self, iterations: usize, termination: Termination) -> Fit {
        Fit { values: self.values, residuals: self.residuals, jacobian: self.jacobian, iterations, termination }
    }
}

/// Points of a fit, and the steps that Gauss and Newton take from there, the last one last.
#[derive(Default)]
struct Memory {
    values: Vec<DVector<f64>>,
    steps: Vec<DVector<f64>>,
}

impl Memory {
    /// The step to where, by how steps changed from point to point, there would be none (Anderson 1965): with the combination of
    /// changes that leaves the least of the last step, in units of what it does to the residuals. Where much is left of these, steps of
    /// Gauss and Newton alone shrink by the same share each time. `None` without a change to go by.
    fn learn(&mut self, at: &Point, step: &DVector<f64>) -> Option<DVector<f64>> {
        let values = DVector::from_column_slice(&at.values);
        if self.values.last() != Some(&values) {
            self.values.push(values);
            self.steps.push(step.clone());
        }
        let changes = (self.values.len() - 1).min(REMEMBERED).min(step.len());
        if changes == 0 {
            return None;
        }
        let change = |of: &[DVector<f64>]| {
            let last = &of[of.len() - changes - 1..];
            DMatrix::from_columns(&last.windows(2).map(|pair| &pair[1] - &pair[0]).collect::<Vec<_>>())
        };
        let (moved, turned) = (change(&self.values), change(&self.steps));
        let information = at.jacobian.tr_mul(&at.jacobian);
        let products = turned.tr_mul(&(&information * &turned));
        let least = RANK_TOLERANCE * RANK_TOLERANCE * products.trace();
        let share = products.svd(true, true).solve(&turned.tr_mul(&(&information * step)), least).ok()?;
        Some(step - (moved + turned) * share)
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

/// Another minimum is about as good where its cost is at most so many times the least.
const RIVAL: f64 = 2.0;
/// A minimum replaces that of the first start where it costs less than this share of it.
const BETTER: f64 = 0.99;
/// Minima whose parameters differ by less are one.
const SAME: f64 = 0.02;

/// The best of several minima.
#[derive(Clone, Debug)]
pub(crate) struct Searched {
    /// The fit of least cost.
    pub fit: Fit,
    /// The parameters of another minimum that is about as good.
    pub rival: Option<Vec<f64>>,
}

/// Looks for a better minimum than that of a `first` fit from further starts. `possible` says which parameters can be.
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

#[cfg(test)]
mod tests;
