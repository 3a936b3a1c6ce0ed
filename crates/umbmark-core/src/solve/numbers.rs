//! From the values of a model to the numbers of a robot.

use super::off::Off;
use crate::calibrate::{self, Correction, Method};
use crate::effect::Model;
use crate::evidence::Estimate;
use crate::learn::Learnt;
use crate::stats::{Interval, f_upper_tail, student_t_quantile};
use nalgebra::{DMatrix, DVector, Matrix3};

/// Step of the numeric derivatives of a drive's numbers, which are products of few factors.
const STEP: f64 = 1e-5;

/// A number of the robot, old and new.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Its key in robot.toml, with its unit.
    pub key: &'static str,
    /// As the robot has it now.
    pub old: f64,
    /// As it should be.
    pub new: f64,
    /// Interval of the new value; `None` where the runs are too few, or an effect that moves it alone was not fitted.
    pub interval: Option<Interval>,
    /// By how much writing it lowers the error \[m\], with the others; see [`solve`](super).
    pub worth: Option<f64>,
}

/// The numbers that a model changes, with intervals that hold with probability 1 - `size`, and whether all of them together differ
/// from the old ones by more than chance (an F test of that size).
pub(super) fn of(learnt: &Learnt, size: f64) -> (Vec<Change>, bool) {
    let model = &learnt.model;
    let drive = &model.robot().drive;
    let values = model.own_values();
    let Ok(corrected) = drive.with_own(&values) else { return (Vec::new(), false) };
    let own = Own::of(model, &learnt.diagnosis.fitted, &learnt.diagnosis.correlations);
    let (slopes, freedom) = (own.slopes(model), own.freedom().unwrap_or(0.0));
    let Own { shown, covariance } = own;
    let covariance = known(covariance);
    let t = student_t_quantile(1.0 - 0.5 * size, freedom.max(1.0));
    let (keys, old, new) = (drive.kind().parameters(), drive.values(), corrected.values());
    let open = open(model, &values, &shown);
    let change = |(place, own): (usize, &DVector<f64>)| {
        let half = covariance.as_ref().filter(|_| !open.contains(&place));
        let half = half.map(|covariance| t * deviation(covariance, own)).filter(|half| half.is_finite());
        let (key, old, new) = (keys[place].name, old[place], new[place]);
        let interval = half.map(|half| Interval::around(new, half));
        (own.amax() > 0.0).then_some(Change { key, old, new, interval, worth: None })
    };
    let changes: Vec<Change> = slopes.iter().enumerate().filter_map(change).collect();
    let needed = covariance.map_or(changes.iter().any(|c| c.new != c.old), |covariance| {
        let nothing = Model::new(model.robot()).own_values();
        let off = DVector::from_iterator(shown.len(), shown.iter().map(|(k, _)| values[*k] - nothing[*k]));
        let squares = covariance.cholesky().map_or(0.0, |cholesky| cholesky.solve(&off).dot(&off));
        !shown.is_empty() && f_upper_tail(squares / shown.len() as f64, [shown.len() as f64, freedom.max(1.0)]) < size
    });
    (changes, needed)
}

/// The three ratios of a differential drive as one more estimate; `None` where none was fitted.
pub(super) fn estimate(learnt: &Learnt) -> Option<calibrate::Estimate> {
    let own = Own::of(&learnt.model, &learnt.diagnosis.fitted, &learnt.diagnosis.correlations);
    let freedom = own.freedom()?;
    let Own { shown, covariance } = own;
    let covariance = known(covariance).map(|covariance| {
        let mut all = Matrix3::zeros();
        for (i, (row, _)) in shown.iter().enumerate() {
            for (j, (column, _)) in shown.iter().enumerate() {
                all[(*row, *column)] = covariance[(i, j)];
            }
        }
        all
    });
    Some(calibrate::Estimate {
        shown: [0, 1, 2].map(|which| shown.iter().any(|(own, _)| *own == which)),
        covariance,
        ..calibrate::Estimate::new(Method::Model, Correction::of(&learnt.model), freedom)
    })
}

/// The own effects of a drive that were fitted: what its numbers follow from.
pub(crate) struct Own<'a> {
    /// Each by its place among them, with its estimate.
    pub shown: Vec<(usize, &'a Estimate)>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

impl<'a> Own<'a> {
    /// Those among all estimates of a model, with the correlations of these in the same order.
    pub fn of(model: &Model, fitted: &'a [Estimate], correlations: &[Vec<f64>]) -> Own<'a> {
        let own = model.robot().drive.own_effects();
        let place = |(which, effect): (usize, &&str)| {
            Some((which, fitted.iter().position(|estimate| estimate.effect == *effect)?))
        };
        let places: Vec<(usize, usize)> = own.iter().enumerate().filter_map(place).collect();
        let correlation = |i: usize, j: usize| match correlations.get(i).and_then(|row| row.get(j)) {
            Some(correlation) if correlations.len() == fitted.len() => *correlation,
            _ => f64::from(u8::from(i == j)),
        };
        let of = |i: usize, j: usize| {
            let [i, j] = [places[i].1, places[j].1];
            correlation(i, j) * fitted[i].standard_error * fitted[j].standard_error
        };
        let covariance = DMatrix::from_fn(places.len(), places.len(), of);
        Own { shown: places.into_iter().map(|(which, place)| (which, &fitted[place])).collect(), covariance }
    }

    /// Degrees of freedom of their estimates; `None` where none was fitted.
    pub fn freedom(&self) -> Option<f64> {
        self.shown.first().map(|(_, estimate)| estimate.degrees_of_freedom)
    }

    /// For each number of the drive, its derivatives by the values of these effects.
    pub fn slopes(&self, model: &Model) -> Vec<DVector<f64>> {
        let values = model.own_values();
        let slopes: Vec<Vec<f64>> = self.shown.iter().map(|(which, _)| slope(model, &values, *which)).collect();
        let of = |place: usize| DVector::from_iterator(slopes.len(), slopes.iter().map(|slope| slope[place]));
        (0..model.robot().drive.values().len()).map(of).collect()
    }
}

/// A covariance; `None` where some standard error is not known.
fn known(covariance: DMatrix<f64>) -> Option<DMatrix<f64>> {
    covariance.iter().all(|value| value.is_finite()).then_some(covariance)
}

/// Standard deviation of a sum of values with these weights.
pub(crate) fn deviation(covariance: &DMatrix<f64>, weights: &DVector<f64>) -> f64 {
    (covariance * weights).dot(weights).max(0.0).sqrt()
}

/// Derivatives of the drive's numbers by the value of an own effect; zero where the drive cannot have them.
fn slope(model: &Model, values: &[f64], which: usize) -> Vec<f64> {
    let drive = &model.robot().drive;
    let at = |step: f64| {
        let mut moved = values.to_vec();
        moved[which] += step;
        drive.with_own(&moved).map(|drive| drive.values())
    };
    match (at(STEP), at(-STEP)) {
        (Ok(above), Ok(below)) => above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect(),
        _ => vec![0.0; drive.values().len()],
    }
}

/// The numbers, by their places, that an own effect which was not fitted moves alone: the others, which move them too, do not tell how sure they are.
fn open(model: &Model, values: &[f64], shown: &[(usize, &Estimate)]) -> Vec<usize> {
    let lacks = |which: &usize| shown.iter().all(|(own, _)| own != which);
    let alone = |which: usize| {
        let slope = slope(model, values, which);
        let mut moved = (0..slope.len()).filter(|place| slope[*place] != 0.0);
        moved.next().filter(|_| moved.next().is_none())
    };
    (0..values.len()).filter(lacks).filter_map(alone).collect()
}

/// Shares what the own effects are worth among the numbers that each moves, in proportion to how far, as a share of the number, it
/// moves them.
pub(super) fn share(changes: &mut [Change], off: &Off, model: &Model) {
    let drive = &model.robot().drive;
    let nothing = Model::new(model.robot()).own_values();
    let values = model.own_values();
    let keys: Vec<&str> = drive.kind().parameters().iter().map(|parameter| parameter.name).collect();
    changes.iter_mut().for_each(|change| change.worth = Some(0.0));
    let own = drive.own_effects();
    for part in &off.written {
        let Some(which) = own.iter().position(|effect| *effect == part.name) else { continue };
        let mut moved = nothing.clone();
        moved[which] = values[which];
        let Ok(moved) = drive.with_own(&moved) else { continue };
        let far = |key: &str| {
            let place = keys.iter().position(|own| *own == key)?;
            let (old, new) = (drive.values()[place], moved.values()[place]);
            Some((new - old).abs() / if old == 0.0 { 1.0 } else { old.abs() })
        };
        let total: f64 = changes.iter().filter_map(|change| far(change.key)).sum();
        for change in changes.iter_mut() {
            let share = far(change.key).filter(|_| total > 0.0).map_or(0.0, |far| far / total);
            change.worth = change.worth.map(|worth| worth + share * part.worth);
        }
    }
}
