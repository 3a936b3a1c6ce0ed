//! Errors in metres and degrees along the way, in the fitted runs and in held-out runs.

use super::system::System;
use crate::likelihood::{Column, Observed, ObservedRun, gram};
use crate::setup::PoseNoise;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Share by which the errors in held-out runs must fall for an effect to count: less is not worth a parameter.
pub(crate) const LEAST_GAIN: f64 = 0.02;
/// An effect is dropped if positions or headings of held-out runs become worse by this share and neither becomes better.
const HARM: f64 = 0.1;

/// Root mean square errors along the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misses {
    /// Of the position, distance \[m\].
    pub position: f64,
    /// Of the heading \[rad\]; `None` where none was measured.
    pub heading: Option<f64>,
    /// Of the innovations, in standard deviations.
    pub white: f64,
}

impl Misses {
    /// The largest relative decrease against `before`: of position, heading or innovation errors. An effect that acts within
    /// centimetres hardly changes the position error.
    pub fn gain(&self, before: &Misses) -> f64 {
        let heading = self.heading.zip(before.heading).map_or(f64::NEG_INFINITY, |(now, then)| fall(now, then));
        fall(self.position, before.position).max(heading).max(fall(self.white, before.white))
    }

    /// Whether positions or headings are worse than `before` by more than chance while neither is better.
    pub fn harms(&self, before: &Misses) -> bool {
        let [least, most] = self.falls(before);
        most < LEAST_GAIN && least < -HARM
    }

    /// Relative decreases of the position and heading errors against `before`, the smaller decrease first.
    pub fn falls(&self, before: &Misses) -> [f64; 2] {
        let position = fall(self.position, before.position);
        let heading = self.heading.zip(before.heading).map_or(position, |(now, then)| fall(now, then));
        [position.min(heading), position.max(heading)]
    }

    /// Relative decrease of the innovations against `before`, both in standard deviations of one noise.
    pub fn white_fall(&self, before: &Misses) -> f64 {
        fall(self.white, before.white)
    }
}

fn fall(now: f64, then: f64) -> f64 {
    if then > 0.0 { 1.0 - now / then } else { 0.0 }
}

/// Products of residuals and columns in metres and radians, fold by fold, with START fitted to the first poses. A fold is a run, or a
/// quarter of one if there are few runs.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// The columns of the system that are in it, the residual last.
    which: Vec<usize>,
    folds: Vec<Fold>,
    /// Products of whitened columns and their number of rows, fold by fold.
    white: Vec<(DMatrix<f64>, usize)>,
}

#[derive(Clone, Debug)]
struct Fold {
    position: DMatrix<f64>,
    heading: DMatrix<f64>,
    /// Number of positions and of headings.
    counts: [usize; 2],
}

impl Errors {
    /// The errors of all runs; `columns` holds all columns run by run, `which` says which may be used, the residual last. START is fitted
    /// where it was measured, and where the track jumps.
    pub fn new(observed: &Observed, system: &System, columns: &[Vec<Column>], which: Vec<usize>) -> Errors {
        let of_fold = |fold: usize| {
            let (mut sum, mut rows) = (DMatrix::zeros(which.len(), which.len()), 0);
            for unit in system.of_fold(fold) {
                sum += DMatrix::from_fn(which.len(), which.len(), |i, j| unit.white[(which[i], which[j])]);
                rows += unit.rows;
            }
            (sum, rows)
        };
        let noise = observed.setup.noise;
        let white = (0..system.folds()).into_par_iter().map(of_fold).collect();
        let runs = observed.runs.par_iter().zip(columns).enumerate();
        let folds = runs.flat_map_iter(|(index, (run, columns))| {
            let mut folds: Vec<usize> = system.folds_of(index).collect();
            folds.dedup();
            let by_quarter = folds.len() > 1;
            Fold::of_run(run, noise, columns, &which, by_quarter.then_some(folds.len()))
        });
        Errors { folds: folds.collect(), white, which }
    }

    /// Errors that remain when each fold is predicted with its own values: `of_fold` gives pairs of columns and values.
    pub fn misses(&self, of_fold: impl Fn(usize) -> (Vec<usize>, DVector<f64>) + Send + Sync) -> Misses {
        self.misses_of(&self.squares(of_fold))
    }

    /// The same from the squares of all folds.
    pub fn misses_of(&self, squares: &[[f64; 3]]) -> Misses {
        let counts = self.folds.iter().zip(&self.white).fold([0; 3], |[positions, headings, rows], (fold, white)| {
            [positions + fold.counts[0], headings + fold.counts[1], rows + white.1]
        });
        let root = |k: usize| (squares.iter().map(|fold| fold[k]).sum::<f64>() / counts[k].max(1) as f64).sqrt();
        Misses { position: root(0), heading: (counts[1] > 0).then(|| root(1)), white: root(2) }
    }

    /// Sums of squares that are left in each fold: of positions, headings and innovations.
    pub fn squares(&self, of_fold: impl Fn(usize) -> (Vec<usize>, DVector<f64>) + Send + Sync) -> Vec<[f64; 3]> {
        let of_fold = |(index, (fold, white)): (usize, (&Fold, &(DMatrix<f64>, usize)))| {
            let weights = self.weights(&of_fold(index));
            [&fold.position, &fold.heading, &white.0].map(|products| (products * &weights).dot(&weights).max(0.0))
        };
        let folds: Vec<_> = self.folds.iter().zip(&self.white).enumerate().collect();
        folds.into_par_iter().map(of_fold).collect()
    }

    /// Factors of the columns and the residual if the columns have these values.
    fn weights(&self, (columns, values): &(Vec<usize>, DVector<f64>)) -> DVector<f64> {
        let mut weights = DVector::zeros(self.which.len());
        weights[self.which.len() - 1] = 1.0;
        for (column, value) in columns.iter().zip(values.iter()) {
            if let Some(place) = self.which.iter().position(|c| c == column) {
                weights[place] = -value;
            }
        }
        weights
    }

    /// Errors with the residuals as they are.
    pub fn in_sample(&self) -> Misses {
        self.misses(|_| (Vec::new(), DVector::zeros(0)))
    }
}

impl Fold {
    /// A run as one fold, or as one for each of some `quarters` of it.
    fn of_run(
        run: &ObservedRun,
        noise: PoseNoise,
        columns: &[Column],
        which: &[usize],
        quarters: Option<usize>,
    ) -> Vec<Fold> {
        let width = which.len();
        let mut rows = vec![[Vec::new(), Vec::new()]; quarters.unwrap_or(1)];
        let mut units: Vec<usize> = run.blocks.iter().map(|block| block.unit).collect();
        units.dedup();
        for stretch in run.stretches([noise.position, noise.heading]) {
            let left: Vec<Vec<[f64; 3]>> = which.iter().map(|c| stretch.less_start(run, &columns[*c])).collect();
            for index in stretch.told() {
                let block = &run.blocks[index];
                let own = |k: usize| left.iter().map(move |column| column[index - stretch.blocks.start][k]);
                let place = units.iter().position(|unit| *unit == block.unit).unwrap_or(0);
                let last = rows.len() - 1;
                let [position, heading] = &mut rows[place.min(last)];
                position.extend(own(0).chain(own(1)));
                if block.headings > 0 {
                    heading.extend(own(2));
                }
            }
        }
        let fold = |[position, heading]: [Vec<f64>; 2]| {
            let counts = [position.len() / width / 2, heading.len() / width];
            Fold { position: gram(&position, width), heading: gram(&heading, width), counts }
        };
        rows.into_iter().map(fold).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn of_positions_and_headings_the_one_that_falls_less_is_told_first() {
        let misses = |position: f64, heading: Option<f64>| Misses { position, heading, white: 1.0 };
        let before = misses(10.0, Some(0.2));
        let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 1e-12 && (b - d).abs() < 1e-12;
        assert!(near(misses(8.0, Some(0.22)).falls(&before), [-0.1, 0.2]));
        assert!(near(misses(11.0, Some(0.15)).falls(&before), [-0.1, 0.25]));
        assert!(near(misses(9.0, None).falls(&before), [0.1, 0.1]));
        assert!((Misses { white: 0.8, ..before }.white_fall(&before) - 0.2).abs() < 1e-12);
    }

    const WHICH: [usize; 4] = [1, 3, 4, 7];

    /// Rows of position and heading of three runs, four columns each, the residual last, and the errors made of them.
    fn errors() -> (Vec<[DMatrix<f64>; 2]>, Errors) {
        let mut stream = Stream::new(4, 0, 0);
        let mut rows = |n: usize| DMatrix::from_fn(n, 4, |_, _| stream.normal());
        let rows: Vec<_> = (0..3).map(|run| [rows(2 * (6 + run)), rows(5)]).collect();
        let fold = |(run, [position, heading]): (usize, &[DMatrix<f64>; 2])| Fold {
            position: position.tr_mul(position),
            heading: heading.tr_mul(heading),
            counts: [6 + run, 5],
        };
        let folds = rows.iter().enumerate().map(fold).collect();
        let white = rows.iter().map(|[position, _]| (4.0 * position.tr_mul(position), position.nrows())).collect();
        (rows, Errors { which: WHICH.to_vec(), folds, white })
    }

    #[test]
    fn misses_are_root_mean_squares_of_what_values_of_columns_leave() {
        let (rows, errors) = errors();
        let values = |run: usize| DVector::from_column_slice(&[0.3, -0.2 * run as f64]);
        // Columns that are not kept are skipped.
        let misses =
            errors.misses(|run| (vec![3, 2, 1], DVector::from_column_slice(&[values(run)[0], 9.0, values(run)[1]])));
        let left = |of: usize| -> f64 {
            let one = |(run, rows): (usize, &[DMatrix<f64>; 2])| {
                let (rows, values) = (&rows[of], values(run));
                (rows.column(3) - rows.column(1) * values[0] - rows.column(0) * values[1]).norm_squared()
            };
            rows.iter().enumerate().map(one).sum()
        };
        assert!((misses.position - (left(0) / 21.0).sqrt()).abs() < 1e-12, "{misses:?}");
        assert!((misses.heading.unwrap() - (left(1) / 15.0).sqrt()).abs() < 1e-12, "{misses:?}");
        assert!((misses.white - (4.0 * left(0) / 42.0).sqrt()).abs() < 1e-12, "{misses:?}");
    }

    #[test]
    fn a_gain_is_the_greatest_fall_of_three() {
        let misses = |position, heading, white| Misses { position, heading, white };
        let before = misses(2.0, Some(0.1), 1.0);
        assert_eq!(misses(1.5, Some(0.1), 1.0).gain(&before), 0.25);
        assert_eq!(misses(2.0, Some(0.05), 0.9).gain(&before), 0.5);
        assert_eq!(misses(4.0, None, 0.75).gain(&before), 0.25);
        assert_eq!(misses(0.0, None, 2.0).gain(&misses(0.0, None, 1.0)), 0.0);
        assert!(misses(2.3, Some(0.1), 0.1).harms(&before));
        assert!(misses(2.0, Some(0.12), 0.1).harms(&before));
        assert!(misses(2.3, None, 0.1).harms(&before));
        assert!(!misses(2.3, Some(0.09), 1.0).harms(&before));
        assert!(!misses(2.1, Some(0.105), 1.0).harms(&before));
    }
}
