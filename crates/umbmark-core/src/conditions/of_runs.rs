//! What each run by itself says of the numbers of a model.
//!
//! Runs whose levels are all the same are fitted together, so a model is linearised where these runs have it. With whitened derivatives X_r and
//! residuals e_r of a run, the reference's part fitted out, its information A_r = X_rᵀX_r and its score s_r = X_rᵀe_r about the fitted values θ̂ are
//! all that it says: rows R_r with R_rᵀR_r = A_r and right sides R_r θ̂ + R_r⁻ᵀ s_r, of unit variance.

use super::ConditionsError;
use super::numbers::Number;
use crate::changed::is_of_test;
use crate::dataset::Dataset;
use crate::dataset::stated::Condition;
use crate::effect::Model;
use crate::evidence::ends::names;
use crate::evidence::tracks::{self, Projected, System, fit, trusted, without_silent_taken};
use crate::evidence::{Ends, Evidence, FitError, Level, ends};
use crate::likelihood::{Fitted, Noise, Observed};
use crate::watch::Watch;
use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A direction in which a run has less than this share of its largest information says nothing.
const NOTHING: f64 = 1e-10;

/// Eigenvalues are found in a few steps each.
const STEPS: usize = 10_000;

/// Rows of unit variance: one column a number, and what they should be.
#[derive(Clone, Debug)]
pub(super) struct OfRun {
    pub rows: DMatrix<f64>,
    pub right: DVector<f64>,
}

/// Runs of one level of everything, fitted together.
struct Group {
    /// Which of a model's numbers were fitted.
    numbers: Vec<Number>,
    values: Vec<f64>,
    /// Of each run, by its place: its information and its score.
    runs: Vec<(usize, DMatrix<f64>, DVector<f64>)>,
}

/// The evidence of all runs.
pub(super) struct Runs {
    evidence: Kind,
    /// Their names.
    pub names: Vec<String>,
}

enum Kind {
    Ends(Box<Ends>),
    /// A set each: the reference of another set may stand elsewhere.
    Tracks(Vec<Observed>),
}

impl Runs {
    pub fn of(data: &Dataset, level: Level) -> Result<Runs, FitError> {
        let mut names: Vec<String> = Vec::new();
        let evidence = match level {
            Level::Ends => {
                let ends = Ends::examined(data)?;
                ends.check_columns()?;
                names.extend(ends.runs.iter().map(|run| run.name.clone()));
                Kind::Ends(Box::new(ends))
            }
            Level::Tracks => {
                let of_set = |set: &Cow<Dataset>| tracks::of(set);
                let observed = sets(data).iter().map(of_set).collect::<Result<Vec<_>, _>>()?;
                for set in &observed {
                    set.check_columns()?;
                    for run in &set.runs {
                        if names.last() != Some(&run.log) {
                            names.push(run.log.clone());
                        }
                    }
                }
                Kind::Tracks(observed)
            }
        };
        Ok(Runs { evidence, names })
    }

    /// What each run says of the numbers that some of them show.
    pub fn said(
        &self,
        model: &Model,
        conditions: &[Condition],
        watch: &Watch,
    ) -> Result<(Vec<Number>, Vec<OfRun>), ConditionsError> {
        let groups = match &self.evidence {
            Kind::Ends(all) => self.of_ends(all, model, conditions)?,
            Kind::Tracks(sets) => self.of_tracks(sets, model, conditions, watch)?,
        };
        let mut numbers: Vec<Number> = Vec::new();
        for number in Number::of(model) {
            if groups.iter().any(|group| group.numbers.contains(&number)) {
                numbers.push(number);
            }
        }
        let mut said =
            vec![OfRun { rows: DMatrix::zeros(0, numbers.len()), right: DVector::zeros(0) }; self.names.len()];
        for group in &groups {
            let places: Vec<usize> =
                group.numbers.iter().filter_map(|own| numbers.iter().position(|number| number == own)).collect();
            let lengths = group.lengths();
            for (run, information, score) in &group.runs {
                said[*run] = rows(information, score, group, &lengths).spread(&places, numbers.len());
            }
        }
        Ok((numbers, said))
    }

    fn of_ends(&self, all: &Ends, model: &Model, conditions: &[Condition]) -> Result<Vec<Group>, ConditionsError> {
        let whole = ends::Fitted::new(all, model).map_err(|source| ConditionsError::Fit { group: None, source })?;
        let of_group = |runs: Vec<usize>| {
            let own = all.only(&runs);
            // One direction alone hardly tells E_d from E_b.
            if own.enough() {
                let fitted = ends::Fitted::new(&own, model)
                    .map_err(|source| ConditionsError::Fit { group: Some(named(conditions, runs[0])), source })?;
                let places: Vec<usize> = (0..runs.len()).collect();
                return Ok(of_ends(&own, &fitted, &places, &runs));
            }
            Ok(of_ends(all, &whole, &runs, &runs))
        };
        groups(conditions, 0..self.names.len()).into_iter().map(of_group).collect()
    }

    fn of_tracks(
        &self,
        sets: &[Observed],
        model: &Model,
        conditions: &[Condition],
        watch: &Watch,
    ) -> Result<Vec<Group>, ConditionsError> {
        let place = |name: &String| self.names.iter().position(|own| own == name).unwrap_or(0);
        let mut found = Vec::new();
        let mut done = 0;
        for set in sets {
            let mut places: Vec<usize> = set.runs.iter().map(|run| place(&run.log)).collect();
            places.dedup();
            for runs in groups(conditions, places) {
                let of_group = |run: &&crate::likelihood::ObservedRun| runs.contains(&place(&run.log));
                let own = Observed { runs: set.runs.iter().filter(of_group).cloned().collect(), ..set.clone() };
                let group = of_tracks(&own, model, &place)
                    .map_err(|source| ConditionsError::Fit { group: Some(named(conditions, runs[0])), source })?;
                found.push(group);
                done += runs.len();
                (watch.progress)(done as f64 / self.names.len() as f64);
                if watch.is_stopped() {
                    return Err(ConditionsError::Stopped);
                }
            }
        }
        Ok(found)
    }
}

/// The datasets that were read as one, each by itself.
fn sets(data: &Dataset) -> Vec<Cow<'_, Dataset>> {
    if data.sessions.is_empty() {
        return vec![Cow::Borrowed(data)];
    }
    let ends = data.sessions.iter().skip(1).map(|session| session.first).chain([data.runs.len()]);
    let part = |(session, end): (&crate::dataset::Session, usize)| {
        let path = data.path.clone();
        Cow::Owned(Dataset { runs: data.runs[session.first..end].to_vec(), path, ..without_runs(data) })
    };
    data.sessions.iter().zip(ends).map(part).collect()
}

fn without_runs(data: &Dataset) -> Dataset {
    Dataset { robot: data.robot.clone(), reference_frame: data.reference_frame, ..Dataset::default() }
}

/// Runs that have the same levels of all conditions, in their order.
fn groups(conditions: &[Condition], runs: impl IntoIterator<Item = usize>) -> Vec<Vec<usize>> {
    let levels = |run: usize| -> Vec<Option<u64>> {
        let is_level = |condition: &&Condition| matches!(condition.kind, super::Kind::Levels(_));
        conditions.iter().filter(is_level).map(|condition| condition.of_runs[run].map(f64::to_bits)).collect()
    };
    let mut found: Vec<(Vec<Option<u64>>, Vec<usize>)> = Vec::new();
    for run in runs {
        let own = levels(run);
        match found.iter_mut().find(|(known, _)| *known == own) {
            Some((_, group)) => group.push(run),
            None => found.push((own, vec![run])),
        }
    }
    found.into_iter().map(|(_, runs)| runs).collect()
}

/// What the levels of a run are called.
fn named(conditions: &[Condition], run: usize) -> String {
    let of = |condition: &Condition| {
        let super::Kind::Levels(levels) = &condition.kind else { return None };
        let level = condition.of_runs[run].map_or("not stated", |level| &levels[level as usize]);
        Some(format!("{} {level}", condition.names[0]))
    };
    conditions.iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

/// `places` are those of the runs in the fit, `runs` those among all.
fn of_ends(all: &Ends, fitted: &ends::Fitted, places: &[usize], runs: &[usize]) -> Group {
    let (asked, numbers) = asked(&fitted.model, &fitted.free);
    let values: Vec<f64> = fitted.model.values().collect();
    let d = all.coordinates();
    let of_run = |(place, run): (&usize, &usize)| {
        let own = &all.runs[*place];
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, own.direction.sign(), own.direction.sign()));
        let weight = (mirror * own.weight * mirror).view((0, 0), (d, d)).into_owned();
        let slopes = &weight * fitted.jacobian[*place].select_columns(&asked).rows(0, d);
        let left = &weight * fitted.residuals[*place].rows(0, d);
        (*run, slopes.tr_mul(&slopes), slopes.tr_mul(&left).column(0).into_owned())
    };
    Group {
        numbers,
        values: asked.iter().map(|k| values[fitted.free[*k]]).collect(),
        runs: places.iter().zip(runs).map(of_run).collect(),
    }
}

fn of_tracks(observed: &Observed, model: &Model, place: &impl Fn(&String) -> usize) -> Result<Group, FitError> {
    let (fitted, _) = without_silent_taken(fit(observed, model)?)?;
    let fitted: Fitted = trusted(fitted)?.into_fitted();
    let noise = if fitted.usual_noise { Noise::default() } else { fitted.noise };
    let system = System::new(&fitted.observed, &noise, &fitted.all_columns());
    let (asked, numbers) = asked(&fitted.model, &fitted.free);
    let base: Vec<usize> = (0..system.residual()).filter(|column| !asked.contains(column)).collect();
    let projected = Projected::new(&system.whole, &base);
    let width = asked.len();
    let mut runs: BTreeMap<usize, (DMatrix<f64>, DVector<f64>)> = BTreeMap::new();
    for unit in &system.units {
        let run = place(&fitted.observed.runs[unit.run].log);
        let own = runs.entry(run).or_insert_with(|| (DMatrix::zeros(width, width), DVector::zeros(width)));
        own.0 += projected.information_of(&unit.white, &asked);
        own.1 += projected.score(&unit.white, &asked).0;
    }
    let values: Vec<f64> = fitted.model.values().collect();
    Ok(Group {
        numbers,
        values: asked.iter().map(|k| values[fitted.free[*k]]).collect(),
        runs: runs.into_iter().map(|(run, (information, score))| (run, information, score)).collect(),
    })
}

/// Places among the fitted values of those that are the robot's, and what they are.
fn asked(model: &Model, free: &[usize]) -> (Vec<usize>, Vec<Number>) {
    let names = names(model);
    let own = |effect: &str| model.parts().iter().any(|part| part.effect.name() == effect && !is_of_test(part));
    let places: Vec<usize> = (0..free.len()).filter(|k| own(names[free[*k]].0)).collect();
    let number = |k: &usize| Number { effect: names[free[*k]].0, parameter: names[free[*k]].1 };
    let numbers = places.iter().map(number).collect();
    (places, numbers)
}

impl Group {
    /// By which the numbers are divided to be alike.
    fn lengths(&self) -> Vec<f64> {
        let sum = |k: usize| self.runs.iter().map(|(_, information, _)| information[(k, k)]).sum::<f64>().sqrt();
        (0..self.numbers.len()).map(sum).map(|length| if length > 0.0 { length } else { 1.0 }).collect()
    }
}

fn rows(information: &DMatrix<f64>, score: &DVector<f64>, group: &Group, lengths: &[f64]) -> OfRun {
    let p = lengths.len();
    let scaled = DMatrix::from_fn(p, p, |i, j| information[(i, j)] / (lengths[i] * lengths[j]));
    let is_finite = scaled.iter().chain(score).all(|value| value.is_finite());
    let Some(eigen) = is_finite.then(|| SymmetricEigen::try_new(scaled, f64::EPSILON, STEPS)).flatten() else {
        return OfRun { rows: DMatrix::zeros(0, p), right: DVector::zeros(0) };
    };
    let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let said: Vec<usize> = (0..p).filter(|k| eigen.eigenvalues[*k] > NOTHING * largest).collect();
    let rows = DMatrix::from_fn(said.len(), p, |row, k| {
        eigen.eigenvalues[said[row]].sqrt() * eigen.eigenvectors[(k, said[row])] * lengths[k]
    });
    let step = DVector::from_fn(said.len(), |row, _| {
        let along: f64 = (0..p).map(|k| eigen.eigenvectors[(k, said[row])] * score[k] / lengths[k]).sum();
        along / eigen.eigenvalues[said[row]].sqrt()
    });
    let right = &rows * DVector::from_column_slice(&group.values) + step;
    OfRun { rows, right }
}

impl OfRun {
    /// The same with a column for each of `width` numbers.
    fn spread(self, places: &[usize], width: usize) -> OfRun {
        let mut rows = DMatrix::zeros(self.rows.nrows(), width);
        places.iter().enumerate().for_each(|(own, place)| rows.set_column(*place, &self.rows.column(own)));
        OfRun { rows, right: self.right }
    }
}
