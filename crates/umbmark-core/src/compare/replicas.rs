//! Simulated tests of the same size, and how the measured statistics rank among them.

use super::statistics::{Quantity, Statistic};
use crate::dataset::ReturnError;
use crate::diagnose::Options;
use crate::effect::{Model, TestKind};
use crate::evidence::ends::{Ends, Fitted, mirrored};
use crate::path::Direction;
use crate::random::Stream;
use crate::simulate::{Odometry, Phase, Simulator, Truth};
use nalgebra::{Matrix3, Vector3};

const REPLICAS: u64 = 12;

/// Source of the scatter of simulated tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseSource {
    /// The model's own random effects.
    Model,
    /// The measured runs' scatter about the mean of their direction, both directions pooled, for a model without noise.
    Pooled,
}

type Errors = [Vec<Vector3<f64>>; 2];

/// Return errors, clockwise and counter-clockwise, of many simulated tests.
pub(super) struct Replicas {
    pub source: NoiseSource,
    tests: Vec<Errors>,
    with_heading: bool,
}

impl Replicas {
    pub fn new(model: &Model, ends: &Ends, fitted: &Fitted, options: &Options) -> Replicas {
        let with_heading = ends.with_heading;
        match of_model(model, ends, options) {
            Some(tests) => Replicas { source: NoiseSource::Model, tests, with_heading },
            None => {
                let tests = of_scatter(model, ends, &fitted.scatter(ends).0, options);
                Replicas { source: NoiseSource::Pooled, tests, with_heading }
            }
        }
    }

    /// Every statistic with its p, and the p of the smallest of them.
    pub fn judge(&self, ends: &Ends, model: &Model) -> (Vec<Statistic>, f64) {
        let measured = by_direction(ends, &ends.errors());
        let predicted = predicted(ends, model);
        let mut statistics = Vec::new();
        let mut ranks: Vec<Vec<f64>> = Vec::new();
        for direction in Direction::BOTH {
            let group = direction as usize;
            for quantity in Quantity::ALL {
                if measured[group].len() < quantity.needs() || (quantity.needs_heading() && !self.with_heading) {
                    continue;
                }
                let told = self.place(&measured, &predicted, group, quantity);
                statistics.push(Statistic {
                    direction,
                    quantity,
                    measured: quantity.of(&measured[group]),
                    predicted: told.predicted,
                    p: told.p,
                });
                ranks.push(told.of_replicas);
            }
        }
        let smallest = statistics.iter().map(|s| s.p).fold(1.0, f64::min);
        let as_small =
            (0..self.tests.len()).filter(|test| ranks.iter().map(|p| p[*test]).fold(1.0, f64::min) <= smallest).count();
        (statistics, (1 + as_small) as f64 / (1 + self.tests.len()) as f64)
    }

    fn place(&self, measured: &Errors, predicted: &Errors, group: usize, quantity: Quantity) -> PredictiveCheck {
        let mut draws: Vec<f64> = self.tests.iter().map(|test| quantity.of(&test[group])).collect();
        let centre = match quantity.mean_of() {
            Some(_) => quantity.of(&predicted[group]),
            None => {
                let mut sorted = draws.clone();
                sorted.sort_by(f64::total_cmp);
                sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
            }
        };
        let mut seen = quantity.of(&measured[group]) - centre;
        draws.iter_mut().for_each(|draw| *draw -= centre);
        // The pooled scatter is itself an estimate, so a mean is scaled by the scatter of its own test, as in Student's t.
        if let (Some(coordinate), NoiseSource::Pooled) = (quantity.mean_of(), self.source) {
            seen /= pooled_deviation(measured, coordinate);
            for (draw, test) in draws.iter_mut().zip(&self.tests) {
                *draw /= pooled_deviation(test, coordinate);
            }
        }
        let mut sorted: Vec<f64> = draws.clone();
        sorted.sort_by(f64::total_cmp);
        let p = |value: f64| {
            let below = sorted.partition_point(|s| *s < value);
            let above = sorted.len() - sorted.partition_point(|s| *s <= value);
            let equal = sorted.len() - below - above;
            (2.0 * (1 + equal + below.min(above)) as f64 / (1 + sorted.len()) as f64).min(1.0)
        };
        PredictiveCheck { predicted: centre, p: p(seen), of_replicas: draws.iter().map(|d| p(*d)).collect() }
    }
}

struct PredictiveCheck {
    predicted: f64,
    p: f64,
    /// p of each simulated test among the others.
    of_replicas: Vec<f64>,
}

fn pooled_deviation(errors: &Errors, coordinate: usize) -> f64 {
    let (mut squares, mut freedom) = (0.0, 0);
    for of_direction in errors.iter().filter(|e| !e.is_empty()) {
        let mean = of_direction.iter().map(|e| e[coordinate]).sum::<f64>() / of_direction.len() as f64;
        squares += of_direction.iter().map(|e| (e[coordinate] - mean) * (e[coordinate] - mean)).sum::<f64>();
        freedom += of_direction.len() - 1;
    }
    (squares / freedom.max(1) as f64).sqrt().max(1e-12)
}

fn by_direction(ends: &Ends, errors: &[Vector3<f64>]) -> Errors {
    Direction::BOTH.map(|direction| {
        let all = ends.runs.iter().zip(errors);
        all.filter(|(run, _)| run.direction == direction).map(|(_, error)| *error).collect()
    })
}

/// Return errors that a model predicts without noise.
fn predicted(ends: &Ends, model: &Model) -> Errors {
    let errors: Vec<Vector3<f64>> =
        ends.errors().iter().zip(ends.residuals(model)).map(|(error, residual)| error - residual).collect();
    by_direction(ends, &errors)
}

/// Tests simulated by the model; `None` if it has no noise or the path is unknown.
fn of_model(model: &Model, ends: &Ends, options: &Options) -> Option<Vec<Errors>> {
    let path = ends.path.as_ref()?;
    let mut simulator = Simulator::new(model.robot(), path, Odometry::Continuous, Phase::Edge).ok()?;
    let mut truth = Truth::new(model);
    let counts = ends.counts();
    let mut test = |trial: u64| -> Errors {
        simulator.open(&mut truth, options.seed, trial);
        let mut errors = counts.map(|n| vec![ReturnError::default(); n]);
        simulator.test(&mut truth, TestKind::Systematic, errors.each_mut().map(Vec::as_mut_slice));
        errors.map(|of| of.iter().map(|e| Vector3::new(e.x, e.y, e.heading.unwrap_or(0.0))).collect())
    };
    let first = test(0);
    let noisy = first.iter().flat_map(|errors| errors.windows(2)).any(|pair| pair[0] != pair[1]);
    noisy.then(|| (0..options.draws as u64).map(test).collect())
}

/// Tests whose runs scatter about the predictions as the measured ones do about their means.
fn of_scatter(model: &Model, ends: &Ends, scatter: &Matrix3<f64>, options: &Options) -> Vec<Errors> {
    let d = ends.coordinates();
    let factor = scatter.view((0, 0), (d, d)).into_owned().cholesky().map(|c| c.l());
    let mut root = Matrix3::zeros();
    if let Some(factor) = factor {
        root.view_mut((0, 0), (d, d)).copy_from(&factor);
    }
    let predicted = predicted(ends, model);
    let test = |draw: u64| {
        let mut stream = Stream::new(options.seed, REPLICAS, draw);
        Direction::BOTH.map(|direction| {
            let noisy = |error: &Vector3<f64>| {
                let noise = root * Vector3::new(stream.normal(), stream.normal(), stream.normal());
                error + mirrored(direction, &noise)
            };
            predicted[direction as usize].iter().map(noisy).collect()
        })
    };
    (0..options.draws as u64).map(test).collect()
}
