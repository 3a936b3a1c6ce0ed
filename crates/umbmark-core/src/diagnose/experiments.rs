//! What to measure next: the experiment that would separate the effects that the last one could not.
//!
//! For rivals j and k and a design d, this is the distance between the prediction of j at its usual size and the closest prediction of the
//! model with k, for old and new data together: Δ_jk(d) = min over p, s of ‖W (a_j t_j - A p - a_k s)‖, in standard deviations. The worth
//! of a design is Δ² a minute: T-optimality (Atkinson & Fedorov 1975).

pub(super) mod design;

use super::ends::asked::Asked;
use super::suspect::Suspect;
use crate::effect::{Entry, Model, Number};
use crate::evidence::FitError;
use crate::evidence::ends::{Ends, Fitted, names};
use crate::parameter::Parameter;
use crate::stats::normal_quantile;
use design::{Design, Noise, designs, todays};
pub(crate) use design::{MINUTES_A_RUN, minutes};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A further experiment that separates two effects.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The two.
    pub separates: [&'static str; 2],
    /// What to do, in words.
    pub experiment: String,
    /// How long it takes.
    pub minutes: f64,
    /// Separation of the two afterwards, in standard deviations; 3.3 is detected with 90 % power.
    pub sd: f64,
}

/// Minimum separation in standard deviations.
const LEAST: f64 = 1.0;

/// Two effects that the data does not separate.
struct Rivals {
    names: [&'static str; 2],
    /// The sizes of each, as indices into the columns of a design; empty if the model already has the effect.
    sizes: [Vec<usize>; 2],
}

/// Experiments for every class of more than one effect, and for every absorbed one; the most informative per minute first.
pub(super) fn next_experiments(
    ends: &Ends,
    fitted: &Fitted,
    asked: &Asked,
    ranking: &[Suspect],
) -> Result<Vec<Experiment>, FitError> {
    let (sizes, rivals) = rivals(asked, ranking);
    if rivals.is_empty() {
        return Ok(Vec::new());
    }
    let Some(offer) = Offer::new(ends, fitted, sizes)? else { return Ok(Vec::new()) };
    let mut experiments: Vec<Experiment> = rivals.iter().filter_map(|pair| best(offer.told(pair))).collect();
    experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(experiments)
}

/// Every available experiment that separates two effects, the most informative per minute first; none if the runs have no scatter.
///
/// Each effect has its usual size; of its sizes that show at all, the one that is hardest to separate counts. The effects of the model are
/// fitted.
pub(crate) fn separating(
    ends: &Ends,
    model: &Model,
    [first, second]: [&'static Entry; 2],
) -> Result<Vec<Experiment>, FitError> {
    let fitted = Fitted::new(ends, model)?;
    let mut sizes: Vec<SizeOf> = Vec::new();
    let of_both = [first, second].map(|entry| {
        let numbers = entry.about.parameters.iter().filter(|p| p.choices().is_empty() && !has(model, entry));
        numbers
            .map(|parameter| {
                sizes.push((entry, parameter));
                sizes.len() - 1
            })
            .collect::<Vec<usize>>()
    });
    let Some(offer) = Offer::new(ends, &fitted, sizes)? else { return Ok(Vec::new()) };
    // Thresholds and scatters change no mean, and some sizes show nowhere: the effect is recognised by its other sizes.
    let shows = |size: &usize| {
        let alone = |columns: &Columns| columns.beside(*size, &[]) * offer.sizes[*size].1.typical;
        offer.columns.iter().any(|columns| alone(columns) >= LEAST)
    };
    let pair = Rivals {
        names: [first.about.name, second.about.name],
        sizes: of_both.map(|numbers| numbers.into_iter().filter(shows).collect()),
    };
    let mut experiments = offer.told(&pair);
    experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(experiments)
}

fn has(model: &Model, entry: &Entry) -> bool {
    model.parts().iter().any(|part| part.effect.name() == entry.about.name)
}

/// The model with at most one of two effects: if both are fitted, the first is kept.
pub(super) fn with_one_of(model: &Model, [first, second]: [&Entry; 2]) -> Result<Model, FitError> {
    if has(model, first) && has(model, second) { without(model, second) } else { Ok(model.clone()) }
}

/// The model without an effect of the catalogue.
fn without(model: &Model, entry: &Entry) -> Result<Model, FitError> {
    let mut rest = Model::new(model.robot());
    for part in model.parts().iter().filter(|part| part.effect.name() != entry.about.name) {
        *rest.add(part.effect.name())? = part.clone();
    }
    Ok(rest)
}

/// The response of every available design, together with the data.
struct Offer {
    designs: Vec<Design>,
    columns: Vec<Columns>,
    sizes: Vec<SizeOf>,
}

impl Offer {
    fn new(ends: &Ends, fitted: &Fitted, sizes: Vec<SizeOf>) -> Result<Option<Offer>, FitError> {
        let Some(noise) = Noise::of(ends, fitted) else { return Ok(None) };
        let today = Columns::of(&todays(ends), fitted, &sizes, &noise)?;
        let designs = designs(ends);
        let together = |design: &Design| Ok(today.with(&Columns::of(design, fitted, &sizes, &noise)?));
        let columns = designs.par_iter().map(together).collect::<Result<_, FitError>>()?;
        Ok(Some(Offer { designs, columns, sizes }))
    }

    /// Every design, for one pair.
    fn told(&self, pair: &Rivals) -> Vec<Experiment> {
        let experiment = |(design, columns): (&Design, &Columns)| Experiment {
            separates: pair.names,
            experiment: design.what.clone(),
            minutes: design.minutes(),
            sd: columns.distance(pair, &self.sizes),
        };
        self.designs.iter().zip(&self.columns).map(experiment).collect()
    }
}

/// k \[m^0.5\] of the wheel noise that gives the scatter of the runs.
pub(crate) fn wheel_noise(ends: &Ends, fitted: &Fitted) -> Option<f64> {
    Noise::of(ends, fitted).map(|noise| noise.variance.sqrt())
}

pub(super) fn worth(experiment: &Experiment) -> f64 {
    experiment.sd * experiment.sd / experiment.minutes
}

/// Of the experiments with 90 % power at 5 %, the most informative per minute; otherwise the one with the largest separation, if any.
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
            pairs.push(Rivals { names, sizes: [vec![first], vec![second]] });
        }
    }
    for (effect, parameter, by) in asked.absorbed.iter().copied() {
        pairs.push(Rivals { names: [by, effect.about.name], sizes: [vec![], vec![number(effect, parameter)]] });
    }
    (sizes, pairs)
}

/// Responses of an experiment to the model's free parameters and to some sizes, in standard deviations.
struct Columns {
    base: Vec<DVector<f64>>,
    sizes: Vec<DVector<f64>>,
}

impl Columns {
    fn of(design: &Design, fitted: &Fitted, sizes: &[SizeOf], noise: &Noise) -> Result<Columns, FitError> {
        let model = &fitted.model;
        let stages = design.stages(model.robot(), noise);
        let names = names(model);
        let own = fitted.free.iter().map(|index| names[*index]);
        let asked = own.chain(sizes.iter().map(|(effect, parameter)| (effect.about.name, parameter.name)));
        let numbers: Vec<Number> = asked.map(|(effect, parameter)| Number::of(effect, parameter)).collect();
        let mut columns = vec![DVector::zeros(0); numbers.len()];
        for derived in model.derived(&numbers)? {
            let made = design.columns(&derived, &stages);
            derived.numbers.iter().zip(made).for_each(|(number, column)| columns[*number] = column);
        }
        let sizes = columns.split_off(fitted.free.len());
        Ok(Columns { base: columns, sizes })
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

    /// Separation of two rivals in standard deviations: the smaller of both directions.
    fn distance(&self, pair: &Rivals, sizes: &[SizeOf]) -> f64 {
        let apart = |truth: usize, rivals: &[usize]| self.beside(truth, rivals) * sizes[truth].1.typical;
        let [a, b] = &pair.sizes;
        let ways = a.iter().map(|j| apart(*j, b)).chain(b.iter().map(|k| apart(*k, a)));
        ways.reduce(f64::min).unwrap_or(0.0)
    }

    /// Residual response to a unit of a size, with the model and these sizes fitted.
    fn beside(&self, size: usize, rivals: &[usize]) -> f64 {
        let others: Vec<&DVector<f64>> = self.base.iter().chain(rivals.iter().map(|k| &self.sizes[*k])).collect();
        residual(&self.sizes[size], &others)
    }
}

/// Norm of a column after projection on the complement of others (Gram-Schmidt, twice).
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_experiments_that_tell_surely_the_one_worth_most_a_minute_is_best_else_the_one_that_tells_most() {
        let told = |sd: f64, minutes: f64| Experiment { separates: ["a", "b"], experiment: String::new(), minutes, sd };
        let best = |told: &[Experiment]| best(told.to_vec()).map(|e| (e.sd, e.minutes));
        // With 3.24 standard deviations, nine of ten tests at 5 % detect the difference.
        assert_eq!(best(&[told(4.0, 10.0), told(3.3, 5.0), told(3.2, 1.0), told(8.0, 60.0)]), Some((3.3, 5.0)));
        assert_eq!(best(&[told(3.1, 60.0), told(3.0, 1.0)]), Some((3.1, 60.0)));
        assert_eq!(best(&[told(0.99 * LEAST, 1.0)]), None);
    }
}
