//! A run that is unlike the others: of another robot, or with a reference of another scale.

use super::examination::Examination;
use crate::diagnose::reason::Reason;
use crate::evidence::tracks::Misses;
use crate::likelihood::solver;
use crate::stats::chi_squared_upper_tail;
use nalgebra::{DMatrix, DVector};

/// Fewest runs of which one can be unlike the others.
const FEWEST: usize = 3;
/// A run is unlike the others where the first effects of it differ from those of the others with a p of at most this, over all runs, ...
const SURE: f64 = 1e-6;
/// ... one of them by more than this, ...
const LEAST_DIFFERENCE: f64 = 0.002;
/// ... where all are within this of the model's, as one linear step estimates nothing further away, ...
const FAR: f64 = 0.1;
/// ... and where its errors along the way fall by this share with its own.
const LEAST_FALL: f64 = 0.5;

/// A run that is unlike the others.
#[derive(Clone, Debug, PartialEq)]
pub struct OddRun {
    /// Its name.
    pub run: String,
    /// The first effect that differs most, as it is called.
    pub effect: &'static str,
    /// Its ratio by this run alone.
    pub own: f64,
    /// The same by the other runs.
    pub others: f64,
}

impl OddRun {
    /// In a sentence, without a full stop.
    pub fn sentence(&self) -> String {
        let OddRun { run, effect, own, others } = self;
        format!(
            "run {run} is unlike the others: its {effect} is {own:.5}, theirs {others:.5}. Was it this robot, with these wheels and this \
             reference? Leave the run out, or give it as a dataset of its own"
        )
    }
}

/// The reason for doubt from the run that is most unlike the others, where one is.
///
/// Beside the other values of the model, the first effects of a run and those of all others are estimated from the products of their whitened
/// columns. Their difference, by its covariance, is χ² distributed where the robot is the same.
pub(super) fn odd_run(exam: &Examination) -> Option<Reason> {
    let columns = first_columns(exam);
    let runs = exam.fitted.observed.runs.len();
    if columns.is_empty() || runs < FEWEST {
        return None;
    }
    let told = (0..runs).filter_map(|run| Difference::of(exam, run, &columns));
    let told = told.filter(|told| told.p * runs as f64 <= SURE && told.is_near()).min_by(|a, b| a.p.total_cmp(&b.p))?;
    let (place, off) = told.steps().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (off.abs() > LEAST_DIFFERENCE && told.fall(exam, &columns) >= LEAST_FALL).then(|| {
        let value = exam.fitted.model.values().nth(exam.fitted.free[columns[place]]).unwrap_or(1.0);
        Reason::OddRun(OddRun {
            run: exam.fitted.observed.runs[told.run].name.clone(),
            effect: exam.name(columns[place]).unwrap_or_default(),
            own: value + told.own[place],
            others: value + told.others[place],
        })
    })
}

/// Columns of the first effects of the drive that are fitted.
pub(super) fn first_columns(exam: &Examination) -> Vec<usize> {
    let first = exam.fitted.model.robot().drive.first_effects();
    let is_first = |column: &usize| exam.name(*column).is_some_and(|name| first.contains(&name));
    exam.free.iter().copied().filter(is_first).collect()
}

/// Products of the whitened columns over a run.
pub(super) fn products_of(exam: &Examination, run: usize) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(exam.system.width, exam.system.width);
    exam.system.units.iter().filter(|unit| unit.run == run).for_each(|unit| products += &unit.white);
    products
}

/// The steps from the model's values that products of columns estimate, the other values as they are, and their covariance.
pub(super) fn steps(
    exam: &Examination,
    products: &DMatrix<f64>,
    columns: &[usize],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let solver = solver(products, columns)?;
    let right = DMatrix::from_fn(columns.len(), 1, |i, _| products[(columns[i], exam.system.residual())]);
    let covariance = solver.solve(&DMatrix::identity(columns.len(), columns.len()));
    Some((solver.solve(&right).column(0).into_owned(), covariance))
}

/// How the first effects of a run differ from those of the others.
struct Difference {
    run: usize,
    /// Steps of the columns by this run alone, and by the others.
    own: DVector<f64>,
    others: DVector<f64>,
    p: f64,
}

impl Difference {
    /// `None` where the run, or the others, do not determine all of them.
    fn of(exam: &Examination, run: usize, columns: &[usize]) -> Option<Difference> {
        let products = products_of(exam, run);
        let rest = &exam.system.whole - &products;
        let [(own, of_own), (others, of_others)] = [steps(exam, &products, columns)?, steps(exam, &rest, columns)?];
        let difference = &own - &others;
        let statistic = (of_own + of_others).cholesky()?.solve(&difference).dot(&difference);
        Some(Difference { run, own, others, p: chi_squared_upper_tail(statistic, columns.len() as f64) })
    }

    /// Whether both are near the model's values.
    fn is_near(&self) -> bool {
        self.own.iter().chain(self.others.iter()).all(|step| step.abs() < FAR)
    }

    fn steps(&self) -> impl Iterator<Item = f64> + '_ {
        self.own.iter().zip(self.others.iter()).map(|(own, others)| own - others)
    }

    /// By which share the errors of this run along the way fall with its own values instead of those of the others: positions or headings.
    fn fall(&self, exam: &Examination, columns: &[usize]) -> f64 {
        let folds: Vec<usize> = exam.system.folds_of(self.run).collect();
        let left = |values: &DVector<f64>| {
            let squares = exam.errors.squares(|_| (columns.to_vec(), values.clone()));
            let of = |k: usize| folds.iter().map(|fold| squares[*fold][k]).sum::<f64>().sqrt();
            Misses { position: of(0), heading: Some(of(1)).filter(|heading| *heading > 0.0), white: of(2) }
        };
        let [_, most] = left(&self.own).falls(&left(&self.others));
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::diagnose::tracks::diagnose;
    use crate::diagnose::{Options, Verdict, first_model};
    use crate::drive::Robot;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    /// The runs that are called unlike the others where the fifth of six is of a robot with another wheelbase.
    fn odd(e_b: f64) -> (Verdict, Vec<OddRun>) {
        let mut data = watched(&robot_with(&[]), 3, 5);
        let others = watched(&robot_with(&[("wheelbase", "e_b", e_b)]), 3, 5);
        data.runs[4] = others.runs[4].clone();
        let observed = Observed::new(&data, &Robot::labmate()).unwrap();
        let diagnosis = diagnose(&observed, &first_model(&data).unwrap(), &Options::default()).unwrap();
        let told = diagnosis.reasons.iter().filter_map(|reason| match reason {
            Reason::OddRun(odd) => Some(odd.clone()),
            _ => None,
        });
        (diagnosis.verdict, told.collect())
    }

    #[test]
    fn a_run_of_another_robot_is_named_with_what_differs_and_one_of_the_same_robot_is_not() {
        let own = robot_with(&[]).get("wheelbase", "e_b").unwrap();
        let (verdict, told) = odd(1.01 * own);
        let [told] = &told[..] else { panic!("{told:?}") };
        assert_eq!((verdict, &*told.run, told.effect), (Verdict::NotExplained, "ccw_1", "wheelbase"));
        assert!((told.own / (1.01 * own) - 1.0).abs() < 1e-3 && (told.others / own - 1.0).abs() < 1e-3, "{told:?}");
        assert!(Reason::OddRun(told.clone()).forbids_writing());
        assert_eq!(odd(own).1, []);
    }
}
