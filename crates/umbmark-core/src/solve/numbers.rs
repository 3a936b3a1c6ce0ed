//! From the values of a model to the numbers of a robot.

use super::off::Off;
use super::others::Other;
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
    /// Interval of the new value; `None` where the runs are too few.
    pub interval: Option<Interval>,
    /// By how much writing it lowers the error \[m\], with the others; see [`solve`](super).
    pub worth: Option<f64>,
}

/// The numbers that a model changes, with intervals that hold with probability 1 - `size`, and whether all of them together differ
/// from the old ones by more than chance (an F test of that size).
pub(super) fn of(learnt: &Learnt, others: &[Other], size: f64) -> (Vec<Change>, bool) {
    let model = &learnt.model;
    let drive = &model.robot().drive;
    let values = Correction::of(model).values();
    let Ok(corrected) = drive.corrected(values) else { return (Vec::new(), false) };
    let shown = shown(learnt);
    let slopes: Vec<Vec<f64>> = shown.iter().map(|(which, _)| slope(model, values, *which)).collect();
    let covariance = covariance(learnt, others, &shown);
    let freedom = shown.first().map_or(0.0, |(_, estimate)| estimate.degrees_of_freedom);
    let t = student_t_quantile(1.0 - 0.5 * size, freedom.max(1.0));
    let keys = drive.kind().parameters().iter().map(|parameter| parameter.name);
    let numbers = keys.zip(drive.values().into_iter().zip(corrected.values())).enumerate();
    let change = |(place, (key, (old, new))): (usize, (&'static str, (f64, f64)))| {
        let own = DVector::from_iterator(slopes.len(), slopes.iter().map(|slope| slope[place]));
        let half = covariance.as_ref().map(|c| t * (c * &own).dot(&own).max(0.0).sqrt());
        let interval = half.filter(|half| half.is_finite()).map(|half| Interval::around(new, half));
        (own.amax() > 0.0).then_some(Change { key, old, new, interval, worth: None })
    };
    let changes: Vec<Change> = numbers.filter_map(change).collect();
    let needed = covariance.map_or(changes.iter().any(|c| c.new != c.old), |covariance| {
        let nothing = Correction::of(&Model::new(model.robot())).values();
        let off = DVector::from_iterator(shown.len(), shown.iter().map(|(k, _)| values[*k] - nothing[*k]));
        let squares = covariance.cholesky().map_or(0.0, |cholesky| cholesky.solve(&off).dot(&off));
        !shown.is_empty() && f_upper_tail(squares / shown.len() as f64, [shown.len() as f64, freedom.max(1.0)]) < size
    });
    (changes, needed)
}

/// The three ratios of a differential drive as one more estimate; `None` where none was fitted.
pub(super) fn estimate(learnt: &Learnt, others: &[Other]) -> Option<calibrate::Estimate> {
    let shown = shown(learnt);
    let (_, first) = shown.first()?;
    let covariance = covariance(learnt, others, &shown).map(|covariance| {
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
        ..calibrate::Estimate::new(Method::Model, Correction::of(&learnt.model), first.degrees_of_freedom)
    })
}

/// The first effects that were fitted, each by its place among the three.
fn shown(learnt: &Learnt) -> Vec<(usize, &Estimate)> {
    let first = learnt.model.robot().drive.first_effects();
    let of = |(which, effect): (usize, &&str)| {
        Some((which, learnt.diagnosis.fitted.iter().find(|estimate| estimate.effect == *effect)?))
    };
    first.iter().enumerate().filter_map(of).collect()
}

/// Covariance of those; `None` where some standard error is not known.
///
/// Where another effect would do, the distance d of its values is one more error, L d dᵀ, with L its likelihood beside the one that was added.
///
/// Source: Buckland, Burnham & Augustin (1997), Biometrics 53, 603: the variance of an estimate after a model was selected.
fn covariance(learnt: &Learnt, others: &[Other], shown: &[(usize, &Estimate)]) -> Option<DMatrix<f64>> {
    let (fitted, correlations) = (&learnt.diagnosis.fitted, &learnt.diagnosis.correlations);
    let place = |estimate: &Estimate| fitted.iter().position(|own| own == estimate);
    let places: Vec<usize> = shown.iter().map(|(_, estimate)| place(estimate)).collect::<Option<_>>()?;
    let correlation = |i: usize, j: usize| match correlations.get(i).and_then(|row| row.get(j)) {
        Some(correlation) if correlations.len() == fitted.len() => *correlation,
        _ => f64::from(u8::from(i == j)),
    };
    let of = |i: usize, j: usize| {
        let [i, j] = [places[i], places[j]];
        correlation(i, j) * fitted[i].standard_error * fitted[j].standard_error
    };
    let mut covariance = DMatrix::from_fn(places.len(), places.len(), of);
    for other in others {
        let off = DVector::from_iterator(shown.len(), shown.iter().map(|(which, _)| other.off[*which]));
        covariance.ger(other.likelihood, &off, &off, 1.0);
    }
    covariance.iter().all(|value| value.is_finite()).then_some(covariance)
}

/// Derivatives of the drive's numbers by the value of a first effect; zero where the drive cannot have them.
pub(crate) fn slope(model: &Model, values: [f64; 3], which: usize) -> Vec<f64> {
    let drive = &model.robot().drive;
    let at = |step: f64| {
        let mut moved = values;
        moved[which] += step;
        drive.corrected(moved).map(|drive| drive.values())
    };
    match (at(STEP), at(-STEP)) {
        (Ok(above), Ok(below)) => above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect(),
        _ => vec![0.0; drive.values().len()],
    }
}

/// Shares what the first effects are worth among the numbers that each moves, in proportion to how far, as a share of the number, it
/// moves them.
pub(super) fn share(changes: &mut [Change], off: &Off, model: &Model) {
    let drive = &model.robot().drive;
    let nothing = Correction::of(&Model::new(model.robot())).values();
    let values = Correction::of(model).values();
    let keys: Vec<&str> = drive.kind().parameters().iter().map(|parameter| parameter.name).collect();
    changes.iter_mut().for_each(|change| change.worth = Some(0.0));
    let first = drive.first_effects();
    for part in &off.written {
        let Some(which) = first.iter().position(|effect| *effect == part.name) else { continue };
        let mut moved = nothing;
        moved[which] = values[which];
        let Ok(moved) = drive.corrected(moved) else { continue };
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
