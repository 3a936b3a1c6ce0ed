//! Errors as people see them: metres and degrees along the way, in the runs at hand and in runs left out.

use super::system::{Projected, System};
use crate::likelihood::{Column, Observed, ObservedRun, gram};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Root mean square errors along the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misses {
    /// Of the position, distance \[m\].
    pub position: f64,
    /// Of the heading \[rad\]; `None` where none was measured.
    pub heading: Option<f64>,
    /// Of what is new from pose to pose, in standard deviations.
    pub white: f64,
}

impl Misses {
    /// By what share errors are smaller than `before`: of position, of heading, or of what is new from pose to pose, whichever
    /// falls most. What an effect does within centimetres hardly moves the whole.
    pub fn gain(&self, before: &Misses) -> f64 {
        let heading = self.heading.zip(before.heading).map_or(f64::NEG_INFINITY, |(now, then)| fall(now, then));
        fall(self.position, before.position).max(heading).max(fall(self.white, before.white))
    }
}

fn fall(now: f64, then: f64) -> f64 {
    if then > 0.0 { 1.0 - now / then } else { 0.0 }
}

/// Products of residuals and columns in metres and radians, run by run, START taken from the first pose where it was measured.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// The columns of the system that are in it, the residual last.
    which: Vec<usize>,
    runs: Vec<Run>,
    /// Products of whitened columns and their number of rows, run by run.
    white: Vec<(DMatrix<f64>, usize)>,
}

#[derive(Clone, Debug)]
struct Run {
    position: DMatrix<f64>,
    heading: DMatrix<f64>,
    /// Number of positions and of headings.
    counts: [usize; 2],
}

impl Errors {
    /// The errors of all runs; `columns` holds all columns run by run, `which` says which may be used, the residual last.
    pub fn new(observed: &Observed, system: &System, columns: &[Vec<Column>], which: Vec<usize>) -> Errors {
        let of_run = |run: usize| {
            let (mut sum, mut rows) = (DMatrix::zeros(which.len(), which.len()), 0);
            for unit in system.of_run(run) {
                sum += DMatrix::from_fn(which.len(), which.len(), |i, j| unit.white[(which[i], which[j])]);
                rows += unit.rows;
            }
            (sum, rows)
        };
        let white = (0..observed.runs.len()).into_par_iter().map(of_run).collect();
        let runs = observed.runs.par_iter().zip(columns).map(|(run, columns)| Run::new(run, columns, &which)).collect();
        Errors { which, runs, white }
    }

    /// Errors that are left when each run is predicted with values of its own, `of_run`: pairs of columns and values.
    pub fn misses(&self, of_run: impl Fn(usize) -> (Vec<usize>, DVector<f64>) + Send + Sync) -> Misses {
        let (mut squares, mut counts) = ([0.0; 3], [0; 3]);
        let fitted: Vec<_> = (0..self.runs.len()).into_par_iter().map(of_run).collect();
        for ((run, white), (columns, values)) in self.runs.iter().zip(&self.white).zip(fitted) {
            let mut weights = DVector::zeros(self.which.len());
            weights[self.which.len() - 1] = 1.0;
            for (column, value) in columns.iter().zip(values.iter()) {
                if let Some(place) = self.which.iter().position(|c| c == column) {
                    weights[place] = -value;
                }
            }
            let [positions, headings] = run.counts;
            let parts = [(&run.position, positions), (&run.heading, headings), (&white.0, white.1)];
            for (k, (products, count)) in parts.into_iter().enumerate() {
                squares[k] += (products * &weights).dot(&weights).max(0.0);
                counts[k] += count;
            }
        }
        let root = |k: usize| (squares[k] / counts[k].max(1) as f64).sqrt();
        Misses { position: root(0), heading: (counts[1] > 0).then(|| root(1)), white: root(2) }
    }

    /// Values of some columns that make whole tracks fit best, position and heading errors counting alike; without one run.
    pub fn fit(&self, columns: &[usize], without: Option<usize>) -> DVector<f64> {
        let width = self.which.len();
        let (mut position, mut heading) = (DMatrix::zeros(width, width), DMatrix::zeros(width, width));
        for run in self.runs.iter().enumerate().filter(|(index, _)| Some(*index) != without).map(|(_, run)| run) {
            position += &run.position;
            heading += &run.heading;
        }
        let (far, turned) = (position[(width - 1, width - 1)], heading[(width - 1, width - 1)]);
        let products = if turned > 0.0 { position + heading * (far / turned) } else { position };
        let places = columns.iter().filter_map(|c| self.which.iter().position(|w| w == c)).collect::<Vec<_>>();
        Projected::fit(&products, &places)
    }

    /// Errors with the residuals as they are.
    pub fn in_sample(&self) -> Misses {
        self.misses(|_| (Vec::new(), DVector::zeros(0)))
    }
}

impl Run {
    fn new(run: &ObservedRun, columns: &[Column], which: &[usize]) -> Run {
        let width = which.len();
        let (mut position, mut heading) = (Vec::new(), Vec::new());
        // Where the frame was measured: at START, and where the run starts anew.
        let mut origin = run.start_seen.then_some(0);
        for (index, block) in run.blocks.iter().enumerate().skip(usize::from(run.start_seen)) {
            if block.afresh {
                origin = Some(index);
                continue;
            }
            let from = run.blocks[origin.unwrap_or(0)].place;
            let (x, y) = (block.place.x - from.x, block.place.y - from.y);
            let aligned = |column: &Column, k: usize| {
                let start = origin.map_or([0.0; 3], |origin| column[origin]);
                column[index][k] - start[k] - start[2] * [-y, x, 0.0][k]
            };
            for k in 0..2 {
                position.extend(which.iter().map(|c| aligned(&columns[*c], k)));
            }
            if block.headings > 0 {
                heading.extend(which.iter().map(|c| aligned(&columns[*c], 2)));
            }
        }
        let counts = [position.len() / width / 2, heading.len() / width];
        Run { position: gram(&position, width), heading: gram(&heading, width), counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    const WHICH: [usize; 4] = [1, 3, 4, 7];

    /// Rows of position and heading of three runs, four columns each, the residual last, and the errors made of them.
    fn errors() -> (Vec<[DMatrix<f64>; 2]>, Errors) {
        let mut stream = Stream::new(4, 0, 0);
        let mut rows = |n: usize| DMatrix::from_fn(n, 4, |_, _| stream.normal());
        let rows: Vec<_> = (0..3).map(|run| [rows(2 * (6 + run)), rows(5)]).collect();
        let run = |(run, [position, heading]): (usize, &[DMatrix<f64>; 2])| Run {
            position: position.tr_mul(position),
            heading: heading.tr_mul(heading),
            counts: [6 + run, 5],
        };
        let runs = rows.iter().enumerate().map(run).collect();
        let white = rows.iter().map(|[position, _]| (4.0 * position.tr_mul(position), position.nrows())).collect();
        (rows, Errors { which: WHICH.to_vec(), runs, white })
    }

    #[test]
    fn misses_are_root_mean_squares_of_what_values_of_columns_leave() {
        let (rows, errors) = errors();
        let values = |run: usize| DVector::from_column_slice(&[0.3, -0.2 * run as f64]);
        // The columns that are not kept are passed over.
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

    /// Oracle: least squares of all rows, those of headings in the unit in which both errors are as large.
    #[test]
    fn whole_tracks_are_fitted_with_positions_and_headings_alike_and_without_the_run_left_out() {
        let (rows, errors) = errors();
        for without in [None, Some(1)] {
            let kept: Vec<_> = rows.iter().enumerate().filter(|(run, _)| Some(*run) != without).collect();
            let far = |of: usize| kept.iter().map(|(_, rows)| rows[of].column(3).norm_squared()).sum::<f64>();
            let unit = (far(0) / far(1)).sqrt();
            let all = kept.iter().flat_map(|(_, [position, heading])| [position.clone(), heading * unit]);
            let all: Vec<_> = all.flat_map(|m| m.row_iter().map(|row| row.into_owned()).collect::<Vec<_>>()).collect();
            let all = DMatrix::from_rows(&all);
            let columns = all.select_columns(&[2, 0]);
            let expected = columns.svd(true, true).solve(&all.column(3).into_owned(), 1e-12).unwrap();
            let values = errors.fit(&[4, 1], without);
            assert!((values - expected).amax() < 1e-9, "{without:?}");
        }
    }

    #[test]
    fn a_gain_is_the_greatest_fall_of_three() {
        let misses = |position, heading, white| Misses { position, heading, white };
        let before = misses(2.0, Some(0.1), 1.0);
        assert_eq!(misses(1.5, Some(0.1), 1.0).gain(&before), 0.25);
        assert_eq!(misses(2.0, Some(0.05), 0.9).gain(&before), 0.5);
        assert_eq!(misses(4.0, None, 0.75).gain(&before), 0.25);
        assert_eq!(misses(0.0, None, 2.0).gain(&misses(0.0, None, 1.0)), 0.0);
    }
}
