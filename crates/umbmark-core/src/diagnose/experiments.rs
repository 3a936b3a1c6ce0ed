//! What to measure next: the experiment that would tell apart what the last one could not.
//!
//! For rivals j and k and a design d, the distance of "the truth is j, at its usual size" from everything that the model with k
//! can predict, old and new data together: Δ_jk(d) = min over p, s of ‖W (a_j t_j - A p - a_k s)‖, in standard deviations. The worth
//! of a design is Δ² a minute: T-optimality (Atkinson & Fedorov 1975).

pub(super) mod design;

use super::ends::{Asked, Ends, Fitted};
use super::{DiagnoseError, Experiment, Suspect};
use crate::effect::Entry;
use crate::parameter::Parameter;
use crate::stats::normal_quantile;
use design::{Design, Noise, designs, todays};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Less than a standard deviation is no experiment.
const LEAST: f64 = 1.0;

/// Two effects that the data does not tell apart.
struct Rivals {
    names: [&'static str; 2],
    /// What each may be, as an index into the columns of a design; the second is `None` where the model has it already.
    columns: (usize, Option<usize>),
}

/// Experiments for every class of more than one effect, and for every absorbed one; the most telling per minute first.
pub(super) fn next_experiments(
    ends: &Ends,
    fitted: &Fitted,
    asked: &Asked,
    ranking: &[Suspect],
) -> Result<Vec<Experiment>, DiagnoseError> {
    let (sizes, rivals) = rivals(asked, ranking);
    let Some(noise) = Noise::of(ends, fitted).filter(|_| !rivals.is_empty()) else { return Ok(Vec::new()) };
    let today = Columns::of(&todays(ends), fitted, &sizes, &noise)?;
    let designs = designs(ends);
    let columns: Vec<Columns> =
        designs.par_iter().map(|design| Columns::of(design, fitted, &sizes, &noise)).collect::<Result<_, _>>()?;
    let both: Vec<Columns> = columns.iter().map(|new| today.with(new)).collect();
    let mut experiments: Vec<Experiment> = Vec::new();
    for pair in &rivals {
        let told = designs.iter().zip(&both).map(|(design, columns)| Experiment {
            separates: pair.names,
            experiment: design.what.clone(),
            minutes: design.minutes(),
            sd: columns.distance(pair, &sizes),
        });
        experiments.extend(best(told.collect()));
    }
    experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(experiments)
}

pub(super) fn worth(experiment: &Experiment) -> f64 {
    experiment.sd * experiment.sd / experiment.minutes
}

/// Of those that tell with 90 % power at 5 %, the one worth most a minute; else the one that tells most, if any does.
pub(super) fn best(told: Vec<Experiment>) -> Option<Experiment> {
    let surely = normal_quantile(0.975) + normal_quantile(0.9);
    let sure = told.iter().filter(|e| e.sd >= surely).max_by(|a, b| worth(a).total_cmp(&worth(b))).cloned();
    sure.or_else(|| told.into_iter().filter(|e| e.sd >= LEAST).max_by(|a, b| a.sd.total_cmp(&b.sd)))
}

type SizeOf = (&'static Entry, &'static Parameter);

/// The pairs, and the sizes that they are about.
fn rivals(asked: &Asked, ranking: &[Suspect]) -> (Vec<SizeOf>, Vec<Rivals>) {
    let mut sizes: Vec<SizeOf> = Vec::new();
    let mut pairs = Vec::new();
    let mut number = |effect: &'static Entry, parameter: &'static Parameter| {
        sizes.iter().position(|(e, p)| *e == effect && p.name == parameter.name).unwrap_or_else(|| {
            sizes.push((effect, parameter));
            sizes.len() - 1
        })
    };
    let classes = asked.classes();
    for suspect in ranking {
        let of_best = |i: &usize| {
            let unit = &asked.units[*i];
            unit.effect.about.name == suspect.best && unit.parameter.name == suspect.estimate[0].parameter
        };
        let Some(class) = classes.iter().find(|class| class.iter().any(of_best)) else { continue };
        let Some(best) = class.iter().find(|i| of_best(i)).map(|i| &asked.units[*i]) else { continue };
        let first = number(best.effect, best.parameter);
        for other in class.iter().map(|i| &asked.units[*i]).filter(|u| u.effect != best.effect) {
            let second = number(other.effect, other.parameter);
            let names = [best.effect.about.name, other.effect.about.name];
            pairs.push(Rivals { names, columns: (first, Some(second)) });
        }
    }
    for (effect, parameter, by) in asked.absorbed.iter().copied() {
        pairs.push(Rivals { names: [by, effect.about.name], columns: (number(effect, parameter), None) });
    }
    (sizes, pairs)
}

/// What an experiment would show of the model's free parameters and of some sizes, in standard deviations.
struct Columns {
    base: Vec<DVector<f64>>,
    sizes: Vec<DVector<f64>>,
}

impl Columns {
    fn of(design: &Design, fitted: &Fitted, sizes: &[SizeOf], noise: &Noise) -> Result<Columns, DiagnoseError> {
        let model = &fitted.model;
        let stages = design.stages(model.robot(), noise);
        let base = fitted.free.iter().map(|index| design.column(model, *index, &stages)).collect();
        let of_size = |(effect, parameter): &SizeOf| -> Result<DVector<f64>, DiagnoseError> {
            let mut with = model.clone();
            with.add(effect.about.name)?;
            let names = super::ends::names(&with);
            let index = names.iter().position(|n| *n == (effect.about.name, parameter.name)).unwrap_or(0);
            Ok(design.column(&with, index, &stages))
        };
        Ok(Columns { base, sizes: sizes.iter().map(of_size).collect::<Result<_, _>>()? })
    }

    /// Both experiments together.
    fn with(&self, other: &Columns) -> Columns {
        let joined = |a: &[DVector<f64>], b: &[DVector<f64>]| {
            let join = |(a, b): (&DVector<f64>, &DVector<f64>)| {
                DVector::from_iterator(a.len() + b.len(), a.iter().chain(b.iter()).copied())
            };
            a.iter().zip(b).map(join).collect()
        };
        Columns { base: joined(&self.base, &other.base), sizes: joined(&self.sizes, &other.sizes) }
    }

    /// Standard deviations between two rivals: the smaller of both ways.
    fn distance(&self, pair: &Rivals, sizes: &[SizeOf]) -> f64 {
        let apart = |truth: usize, rival: Option<usize>| {
            let others: Vec<&DVector<f64>> = self.base.iter().chain(rival.map(|k| &self.sizes[k])).collect();
            residual(&self.sizes[truth], &others) * sizes[truth].1.typical
        };
        match pair.columns {
            (j, None) => apart(j, None),
            (j, Some(k)) => apart(j, Some(k)).min(apart(k, Some(j))),
        }
    }
}

/// Length of what is left of a column beside the span of others (Gram-Schmidt, twice).
fn residual(column: &DVector<f64>, others: &[&DVector<f64>]) -> f64 {
    const DEPENDENT: f64 = 1e-9;
    if others.is_empty() {
        return column.norm();
    }
    let lengths: Vec<f64> = others.iter().map(|c| c.norm()).collect();
    let unit: Vec<DVector<f64>> =
        others.iter().zip(&lengths).filter(|(_, l)| **l > 0.0).map(|(c, l)| *c / *l).collect();
    if unit.is_empty() {
        return column.norm();
    }
    let svd = DMatrix::from_columns(&unit).svd(true, false);
    let Some(u) = svd.u else { return column.norm() };
    let mut left = column.clone();
    for _ in 0..2 {
        for i in (0..u.ncols()).filter(|i| svd.singular_values[*i] > DEPENDENT) {
            let along = u.column(i).dot(&left);
            left.axpy(-along, &u.column(i), 1.0);
        }
    }
    left.norm()
}
