//! The non-linear fit of a model's free parameters to return poses.
//!
//! Generalised least squares with the shape of the scatter that evenly noisy wheels give the path's end, the weights of
//! [`calibrate`](crate::calibrate); so E_d and E_b are the same there and here. The covariance of the estimates follows from the
//! pooled scatter that the runs really show.

use super::{End, Ends, mirrored};
use crate::effect::Model;
use crate::evidence::{Estimate, Evidence, FAR_FIT, FitError, Leaves, STARTS, is_possible};
use crate::fit::{self, Known, Prior, Problem, RANK_TOLERANCE, null_directions};
use crate::geometry::{Dual, LANES, Pose2, seeded};
use crate::likelihood::{Ended, KnowledgeError};
use crate::path::Direction;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// A component of a null direction below this is rounding.
const INVOLVED: f64 = 0.01;

/// When a fit has settled: predictions over thousands of small pieces are good to some 1e-13.
const SETTLED: fit::Options =
    fit::Options { iterations: 100, step_tolerance: 1e-10, decrease_tolerance: 1e-12, cautious: true, frugal: false };

/// A model fitted to return poses.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    pub model: Model,
    /// Indices, among the model's values, of what was fitted.
    pub free: Vec<usize>,
    /// Indices of what should be fitted but is not determined by the data.
    pub open: Vec<usize>,
    /// Observed minus predicted, in the mirrored frame, run by run.
    pub residuals: Vec<Vector3<f64>>,
    /// Derivatives of the predicted poses by the fitted values, in the mirrored frame, run by run: 3 rows.
    pub jacobian: Vec<DMatrix<f64>>,
    /// What was fitted, with its uncertainty; standard errors are NaN for too few runs.
    pub estimates: Vec<Estimate>,
    /// Their covariance; `None` for too few runs.
    pub covariance: Option<DMatrix<f64>>,
    /// How the fit ended.
    pub ended: Ended,
    /// Indices, among the model's values, of what ended at a bound.
    pub held: Vec<usize>,
}

impl Fitted {
    pub fn new(ends: &Ends, model: &Model) -> Result<Fitted, FitError> {
        ends.check(model)?;
        let (free, open) = what_shows(ends, model);
        let start: Vec<f64> = model.values().collect();
        let noise = noise_of(ends, model)?;
        let problem = Returns { ends, model, start: &start, free: &free, noise };
        let first: Vec<f64> = free.iter().map(|i| start[*i]).collect();
        let fit = fit::least_squares(&problem, &first, &SETTLED);
        let fit = problem.searched(fit, &first);
        if !fit.termination.converged() {
            return Err(FitError::NotConverged { how: fit.termination.name() });
        }
        let fitted = with_values(model, &problem.all(&fit.values))?;
        // A formula whose size started at 0 did not depend on its shape; now it does.
        if fitted.has_formulas() && what_shows(ends, &fitted).0.len() > free.len() {
            return Fitted::new(ends, &fitted);
        }
        let residuals = mirrored_residuals(ends, &fitted);
        // What is held at a bound has no interval.
        let inside: Vec<usize> = (0..free.len()).filter(|k| !fit.held[*k]).collect();
        let information = fit.covariance().map(|all| all.select_rows(&inside).select_columns(&inside));
        let known = problem.known();
        let priors: Vec<Option<Prior>> = inside.iter().map(|k| known[*k].prior).collect();
        let held = (0..free.len()).filter(|k| fit.held[*k]).map(|k| free[k]).collect();
        let free: Vec<usize> = inside.into_iter().map(|k| free[k]).collect();
        let jacobian = slopes(ends, &fitted, &free);
        let ended = Ended { termination: fit.termination, steps: fit.iterations };
        let (estimates, covariance) = (Vec::new(), None);
        let mut result = Fitted { model: fitted, free, open, residuals, jacobian, estimates, covariance, ended, held };
        result.estimate(ends, information, &priors, noise);
        Ok(result)
    }

    /// What the model leaves of the return poses.
    pub fn leaves(&self, ends: &Ends) -> Leaves {
        let root = |sum: f64| (sum / self.residuals.len().max(1) as f64).sqrt();
        let criteria = self.criteria(ends);
        Leaves {
            position: root(self.residuals.iter().map(|r| r.xy().norm_squared()).sum()),
            heading: ends.with_heading.then(|| root(self.residuals.iter().map(|r| r.z * r.z).sum())),
            aicc: criteria.map(|c| c[0]),
            bic: criteria.map(|c| c[1]),
            ..Leaves::default()
        }
    }

    /// AICc and BIC, if there are enough runs. From the normal likelihood of N runs with one unknown covariance: N ln |Σ̂| and 2k or k ln N
    /// for k parameters.
    pub fn criteria(&self, ends: &Ends) -> Option<[f64; 2]> {
        let (d, n) = (ends.coordinates(), self.residuals.len() as f64);
        let covariance = self.residuals.iter().map(|r| r * r.transpose()).sum::<Matrix3<f64>>() / n;
        let determinant = covariance.view((0, 0), (d, d)).into_owned().cholesky()?.determinant();
        let (values, parameters) = (n * d as f64, (self.free.len() + d * (d + 1) / 2) as f64);
        let spare = values - parameters - 1.0;
        if !(determinant > 0.0) || spare <= 0.0 {
            return None;
        }
        let deviance = n * libm::log(determinant);
        Some([deviance + 2.0 * parameters * values / spare, deviance + parameters * libm::log(n)])
    }

    /// Pooled scatter of the residuals about the mean of their direction, and its degrees of freedom.
    pub fn scatter(&self, ends: &Ends) -> (Matrix3<f64>, usize) {
        scatter(ends, &self.residuals)
    }

    /// The derivatives by the same values where the model does nothing, all its values at their defaults, on the path that was
    /// meant to be driven (where it is known), run by run.
    pub fn nominal_jacobian(&self, ends: &Ends) -> Vec<DMatrix<f64>> {
        slopes(&ends.as_meant(), &self.model.at_rest(), &self.free)
    }

    /// `priors` are earlier measurements of the free values, in units of the weighted residuals, whose standard deviation is `noise`.
    fn estimate(&mut self, ends: &Ends, information: Option<DMatrix<f64>>, priors: &[Option<Prior>], noise: f64) {
        let (scatter, freedom) = self.scatter(ends);
        let d = ends.coordinates();
        if let Some(inverse) = information.filter(|_| freedom > 0) {
            let mut covariance = DMatrix::zeros(self.free.len(), self.free.len());
            for (run, slope) in ends.runs.iter().zip(&self.jacobian) {
                let weight = mirrored_weight(run).view((0, 0), (d, d)).into_owned();
                let influence = &inverse * slope.rows(0, d).transpose() * weight.transpose() * weight;
                covariance += &influence * scatter.view((0, 0), (d, d)) * influence.transpose();
            }
            for (k, prior) in priors.iter().enumerate() {
                if let Some(Prior { sd, .. }) = prior {
                    let influence = inverse.column(k) * (noise / sd);
                    covariance += &influence * influence.transpose();
                }
            }
            self.covariance = Some(covariance);
        }
        let names: Vec<_> = names(&self.model);
        let values: Vec<f64> = self.model.values().collect();
        let estimate = |(j, i): (usize, &usize)| Estimate {
            effect: names[*i].0,
            parameter: names[*i].1,
            value: values[*i],
            standard_error: self.covariance.as_ref().map_or(f64::NAN, |c| c[(j, j)].max(0.0).sqrt()),
            degrees_of_freedom: freedom as f64,
        };
        self.estimates = self.free.iter().enumerate().map(estimate).collect();
    }
}

/// Observed minus predicted, in the mirrored frame, run by run.
fn mirrored_residuals(ends: &Ends, model: &Model) -> Vec<Vector3<f64>> {
    let residuals = ends.residuals(model);
    ends.runs.iter().zip(&residuals).map(|(run, r)| mirrored(run.direction, r)).collect()
}

/// The weight of a run in the mirrored frame. It is lower triangular in the run's own; mirroring twice is no change.
fn mirrored_weight(run: &End) -> Matrix3<f64> {
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, run.direction.sign(), run.direction.sign()));
    mirror * run.weight * mirror
}

/// Pooled scatter of residuals about the mean of their direction, and its degrees of freedom.
fn scatter(ends: &Ends, residuals: &[Vector3<f64>]) -> (Matrix3<f64>, usize) {
    let mut squares = Matrix3::zeros();
    let mut freedom = 0;
    for direction in Direction::BOTH {
        let of_direction: Vec<&Vector3<f64>> =
            ends.runs.iter().zip(residuals).filter(|(run, _)| run.direction == direction).map(|p| p.1).collect();
        if of_direction.is_empty() {
            continue;
        }
        let mean = of_direction.iter().fold(Vector3::zeros(), |sum, r| sum + **r) / of_direction.len() as f64;
        squares += of_direction.iter().map(|r| (*r - mean) * (*r - mean).transpose()).sum::<Matrix3<f64>>();
        freedom += of_direction.len() - 1;
    }
    (squares / freedom.max(1) as f64, freedom)
}

/// Standard deviation of weighted residuals where it counts: earlier measurements are weighed against it.
fn noise_of(ends: &Ends, model: &Model) -> Result<f64, FitError> {
    if !ends.knowledge.has_priors() {
        return Ok(1.0);
    }
    let (scatter, freedom) = scatter(ends, &mirrored_residuals(ends, model));
    let d = ends.coordinates();
    let of_run = |run: &End| {
        let weight = mirrored_weight(run).view((0, 0), (d, d)).into_owned();
        (&weight * scatter.view((0, 0), (d, d)) * weight.transpose()).trace()
    };
    let variance = ends.runs.iter().map(of_run).sum::<f64>() / (ends.runs.len() * d) as f64;
    if freedom > 0 && variance > 0.0 { Ok(variance.sqrt()) } else { Err(KnowledgeError::NoScatter.into()) }
}

/// Effect and parameter of each value of a model.
pub(crate) fn names(model: &Model) -> Vec<(&'static str, &'static str)> {
    let of_part = |part: &crate::effect::Part| {
        part.effect.parameters().iter().map(|p| (part.effect.name(), p.name)).collect::<Vec<_>>()
    };
    model.parts().iter().flat_map(of_part).collect()
}

/// The model with other values, each within its bounds.
fn with_values(model: &Model, values: &[f64]) -> Result<Model, FitError> {
    let mut changed = model.clone();
    for ((effect, parameter), value) in names(model).into_iter().zip(values) {
        changed.set(effect, parameter, *value).map_err(|source| FitError::OutOfBounds { source })?;
    }
    Ok(changed)
}

/// Derivatives of the predicted poses in the mirrored frame, run by run.
fn slopes(ends: &Ends, model: &Model, free: &[usize]) -> Vec<DMatrix<f64>> {
    let mut jacobian = vec![DMatrix::zeros(3, free.len()); ends.runs.len()];
    let values: Vec<f64> = model.values().collect();
    for (j, poses) in ends.slopes(model, &values, free).iter().enumerate() {
        for ((run, pose), slope) in ends.runs.iter().zip(poses).zip(&mut jacobian) {
            slope.set_column(j, &mirrored(run.direction, pose));
        }
    }
    jacobian
}

impl Ends {
    /// Derivatives of the predicted poses by the `places` of some values of a model: place by place, run by run.
    fn slopes(&self, model: &Model, values: &[f64], places: &[usize]) -> Vec<Vec<Vector3<f64>>> {
        let together = |places: &[usize]| {
            let poses = self.predict::<Dual>(model, &seeded(values.iter().copied(), places));
            let of_lane = |lane: usize| poses.iter().map(|pose| vector(&pose.slope(lane))).collect();
            (0..places.len()).map(of_lane).collect::<Vec<_>>()
        };
        places.chunks(LANES).flat_map(together).collect()
    }
}

fn vector(pose: &Pose2) -> Vector3<f64> {
    Vector3::new(pose.x, pose.y, pose.heading)
}

/// Values that the data determines, and those that it does not. E_d and E_b are tested first, then the others one at a time. All tests use
/// derivatives at the nominal robot: elsewhere, second-order terms seem to separate effects that no measurement could.
fn what_shows(ends: &Ends, model: &Model) -> (Vec<usize>, Vec<usize>) {
    let names = names(model);
    let nominal = model.at_rest();
    let start: Vec<f64> = nominal.values().collect();
    let free = model.free_places();
    // The value of a length, threshold, scatter or choice moves no pose as long as the size of its effect is zero.
    let moves = |poses: &Vec<Vector3<f64>>| poses.iter().any(|pose| *pose != Vector3::zeros());
    let slopes = ends.slopes(&nominal, &start, &free);
    let mut asked: Vec<usize> = free.iter().zip(&slopes).filter(|(_, s)| moves(s)).map(|(i, _)| *i).collect();
    // What other effects share with these is attributed to these.
    let first = &model.robot().drive.first_effects()[..2];
    asked.sort_by_key(|i| !first.contains(&names[*i].0));
    let problem = Returns { ends, model: &nominal, start: &start, free: &asked, noise: 1.0 };
    let mut jacobian = problem.jacobian(&asked.iter().map(|i| start[*i]).collect::<Vec<_>>());
    // An earlier measurement shows its number.
    for (k, known) in ends.knowledge.of(model, &asked).into_iter().enumerate() {
        if known.prior.is_some() {
            let (rows, length) = (jacobian.nrows(), jacobian.column(k).norm());
            jacobian = jacobian.resize_vertically(rows + 1, 0.0);
            jacobian[(rows, k)] = length;
        }
    }
    let columns: Vec<DVector<f64>> = jacobian.column_iter().map(|column| column.into_owned()).collect();
    let shows = |kept: &[usize]| {
        let matrix = DMatrix::from_columns(&kept.iter().map(|k| columns[*k].clone()).collect::<Vec<_>>());
        null_directions(&matrix, RANK_TOLERANCE)
    };
    let mut kept: Vec<usize> = Vec::new();
    for k in 0..asked.len() {
        if columns[k].norm() == 0.0 {
            continue;
        }
        kept.push(k);
        let null = shows(&kept);
        if null.is_empty() {
            continue;
        }
        kept.pop();
        if first.contains(&names[asked[k]].0) {
            // Of two values that act alike, neither is determined.
            let involved = |at: usize| null.iter().any(|direction| direction[at].abs() > INVOLVED);
            kept = kept.iter().enumerate().filter(|(at, _)| !involved(*at)).map(|(_, k)| *k).collect();
        }
    }
    let mut free: Vec<usize> = kept.iter().map(|k| asked[*k]).collect();
    free.sort_unstable();
    let open = asked.into_iter().filter(|i| !free.contains(i)).collect();
    (free, open)
}

struct Returns<'a> {
    ends: &'a Ends,
    model: &'a Model,
    start: &'a [f64],
    free: &'a [usize],
    /// Standard deviation of weighted residuals, if there is an earlier measurement.
    noise: f64,
}

impl Returns<'_> {
    fn all(&self, parameters: &[f64]) -> Vec<f64> {
        let mut all = self.start.to_vec();
        for (index, value) in self.free.iter().zip(parameters) {
            all[*index] = *value;
        }
        all
    }

    /// The fit, or a better one: further starts are tried if E_d or E_b ended far from the nominal robot or the fit did not converge.
    fn searched(&self, fit: fit::Fit, first: &[f64]) -> fit::Fit {
        let names = names(self.model);
        let ratio = |effect: &str| self.free.iter().position(|i| names[*i].0 == effect && self.start[*i] == 1.0);
        let (Some(e_d), Some(e_b)) = (ratio("wheel_diameter_ratio"), ratio("wheelbase")) else { return fit };
        let is_near = |place: usize| (fit.values[place] - 1.0).abs() <= FAR_FIT;
        if fit.termination.converged() && is_near(e_d) && is_near(e_b) {
            return fit;
        }
        let start = |value: f64| {
            let mut start = first.to_vec();
            start[e_b] = value;
            start
        };
        let is_possible = |values: &[f64]| is_possible(values[e_d]) && is_possible(values[e_b]);
        fit::search(self, fit, &STARTS.map(start), &SETTLED, is_possible).fit
    }

    fn rows(&self) -> usize {
        self.ends.runs.len() * self.ends.coordinates()
    }
}

impl Problem for Returns<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        let mut rows = Vec::with_capacity(self.rows());
        let poses = self.ends.predict::<f64>(self.model, &self.all(parameters));
        for (run, pose) in self.ends.runs.iter().zip(poses) {
            let weighted = run.weight * self.ends.residual(run, &pose);
            rows.extend_from_slice(&weighted.as_slice()[..self.ends.coordinates()]);
        }
        DVector::from_vec(rows)
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let values = self.all(parameters);
        let mut rows = Vec::with_capacity(self.rows() * self.free.len());
        for poses in self.ends.slopes(self.model, &values, self.free) {
            for (run, pose) in self.ends.runs.iter().zip(poses) {
                let slope = run.weight * -pose;
                rows.extend_from_slice(&slope.as_slice()[..self.ends.coordinates()]);
            }
        }
        DMatrix::from_vec(self.rows(), self.free.len(), rows)
    }

    fn known(&self) -> Vec<Known> {
        let mut known = self.ends.knowledge.of(self.model, self.free);
        for prior in known.iter_mut().filter_map(|known| known.prior.as_mut()) {
            prior.sd /= self.noise;
        }
        known
    }
}
