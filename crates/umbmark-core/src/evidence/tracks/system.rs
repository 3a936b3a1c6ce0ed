//! The linear system of a model: its residuals, and their derivatives by its parameters and by the effects that it may be missing. Only
//! products of whitened columns are kept, summed run by run; every test and every fold of a cross-validation follows from them.

use super::packed::Packed;
use crate::likelihood::{
    ABSORBED, Column, Noise, Observed, ObservedRun, ScaledCholesky, gram, scaled_cholesky, solver,
};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::AddAssign;

/// A part of a run that is treated as independent of the others.
#[derive(Clone, Debug)]
pub struct Unit {
    /// The run.
    pub run: usize,
    /// The fold that is left out with it: its run, or this part alone if there are few runs.
    pub fold: usize,
    /// Products of whitened columns.
    pub white: Packed,
    /// Number of whitened rows.
    pub rows: usize,
}

/// Products of columns over all units. The last column is the residual.
#[derive(Clone, Debug)]
pub struct System {
    /// Quarters of runs.
    pub units: Vec<Unit>,
    /// Number of columns, the residual included.
    pub width: usize,
    /// Products of all columns over all units.
    pub whole: DMatrix<f64>,
    /// Number of rows of all units.
    pub rows: usize,
}

/// With fewer runs, quarters of runs are left out: of two runs, one alone determines too little.
const FEW: usize = 4;

/// How many parts of the data are left out in turn.
pub fn folds_of(observed: &Observed) -> usize {
    if observed.runs.len() >= FEW {
        return observed.runs.len();
    }
    let quarters = |run: &ObservedRun| run.blocks.chunk_by(|a, b| a.unit == b.unit).count();
    observed.runs.iter().map(quarters).sum()
}

impl System {
    /// Whitens the columns of every run and sums their products by unit. `columns` holds, run by run, all columns and last
    /// the residual.
    pub fn new(observed: &Observed, noise: &Noise, columns: &[Vec<Column>]) -> System {
        let width = columns.first().map_or(0, Vec::len);
        let units = observed.runs.par_iter().zip(columns).enumerate().flat_map_iter(|(index, (run, columns))| {
            let columns: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).collect();
            let white = noise.whiten(run, &columns);
            let mut rest = &white.values[..];
            let quarters = white.block.chunk_by(|a, b| run.blocks[*a].unit == run.blocks[*b].unit);
            let unit = |quarter: &[usize]| {
                let values;
                (values, rest) = rest.split_at(quarter.len() * width);
                Unit { run: index, fold: index, rows: quarter.len(), white: Packed::of(&gram(values, width)) }
            };
            quarters.map(unit).collect::<Vec<_>>()
        });
        let mut units: Vec<Unit> = units.collect();
        if observed.runs.len() < FEW {
            units.iter_mut().enumerate().for_each(|(index, unit)| unit.fold = index);
        }
        let mut whole = DMatrix::zeros(width, width);
        units.iter().for_each(|unit| whole += &unit.white);
        System { rows: units.iter().map(|unit| unit.rows).sum(), units, width, whole }
    }

    /// With the residuals of earlier measurements, which every fold has: the column of each, how far it is above the value there is now, and its
    /// standard deviation.
    pub fn with_priors(mut self, priors: &[(usize, f64, f64)]) -> System {
        let residual = self.residual();
        for &(column, above, sd) in priors {
            let row = [(column, 1.0 / sd), (residual, above / sd)];
            for ((i, a), (j, b)) in row.iter().flat_map(|a| row.map(|b| (*a, b))) {
                self.whole[(i, j)] += a * b;
            }
        }
        self
    }

    /// Products of the same columns, with multiples of some of them added to the residual.
    pub fn with_added(products: &DMatrix<f64>, columns: &[usize], times: &[f64]) -> DMatrix<f64> {
        let (mut products, residual) = (products.clone(), products.ncols() - 1);
        for (column, times) in columns.iter().zip(times) {
            let own = products.column(*column) * *times;
            products.column_mut(residual).add_assign(&own);
        }
        for (column, times) in columns.iter().zip(times) {
            let own = products.row(*column) * *times;
            products.row_mut(residual).add_assign(&own);
        }
        products
    }

    /// The residual's column.
    pub fn residual(&self) -> usize {
        self.width - 1
    }

    /// How many folds there are.
    pub fn folds(&self) -> usize {
        self.units.last().map_or(0, |unit| unit.fold + 1)
    }

    /// The units of one fold.
    pub fn of_fold(&self, fold: usize) -> impl Iterator<Item = &Unit> {
        self.units.iter().filter(move |unit| unit.fold == fold)
    }

    /// Which fold the blocks of a run belong to, by their quarter.
    pub fn folds_of(&self, run: usize) -> impl Iterator<Item = usize> + '_ {
        self.units.iter().filter(move |unit| unit.run == run).map(|unit| unit.fold)
    }

    /// Products of all columns over all folds but one.
    pub fn without(&self, fold: usize) -> DMatrix<f64> {
        let mut sum = self.whole.clone();
        self.of_fold(fold).for_each(|unit| sum -= &unit.white);
        sum
    }
}

/// The columns of a system with some of them fitted out.
#[derive(Clone, Debug)]
pub struct Projected {
    /// Products of the rests.
    pub products: DMatrix<f64>,
    /// Regression coefficients of every column on the fitted columns, one row per fitted column.
    pub coefficients: DMatrix<f64>,
    /// The columns that were fitted out.
    pub base: Vec<usize>,
    solver: Option<ScaledCholesky>,
}

impl Projected {
    /// Fits the columns `base` out of all columns.
    pub fn new(products: &DMatrix<f64>, base: &[usize]) -> Projected {
        let cross = DMatrix::from_fn(base.len(), products.ncols(), |i, j| products[(base[i], j)]);
        let solver = solver(products, base);
        let coefficients =
            solver.as_ref().map_or_else(|| DMatrix::zeros(base.len(), products.ncols()), |s| s.solve(&cross));
        let products = products - cross.tr_mul(&coefficients);
        Projected { products, coefficients, base: base.to_vec(), solver }
    }

    /// Whether hardly anything of a column in `whole` remains after the projection.
    pub fn absorbed(&self, whole: &DMatrix<f64>, column: usize) -> bool {
        self.products[(column, column)] <= ABSORBED * whole[(column, column)]
    }

    /// Decrease of the sum of squares if a group of columns, none of them absorbed, is fitted, and their values.
    pub fn drop(&self, group: &[usize]) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let residual = self.products.ncols() - 1;
        let information = self.information(group);
        let score = DVector::from_fn(group.len(), |i, _| self.products[(group[i], residual)]);
        let solver = scaled_cholesky(&information)?;
        let step = solver.solve(&DMatrix::from_column_slice(group.len(), 1, score.as_slice()));
        let inverse = solver.solve(&DMatrix::identity(group.len(), group.len()));
        let step = DVector::from_column_slice(step.as_slice());
        Some((score.dot(&step), step, inverse))
    }

    /// Values of some columns fitted together.
    pub fn fit(products: &DMatrix<f64>, columns: &[usize]) -> DVector<f64> {
        let score = DMatrix::from_fn(columns.len(), 1, |i, _| products[(columns[i], products.ncols() - 1)]);
        let values = solver(products, columns).map(|solver| solver.solve(&score));
        values.map_or_else(|| DVector::zeros(columns.len()), |values| values.column(0).into_owned())
    }

    /// How well the columns `to` can reproduce the response of the columns `from` at `values`, as a cosine.
    pub fn likeness(&self, from: &[usize], values: &DVector<f64>, to: &[usize]) -> f64 {
        let response = |k: usize| from.iter().zip(values.iter()).map(|(j, v)| self.products[(k, *j)] * v).sum::<f64>();
        let whole: f64 = from.iter().zip(values.iter()).map(|(k, v)| response(*k) * v).sum();
        let information = self.information(to);
        let cross = DMatrix::from_fn(to.len(), 1, |i, _| response(to[i]));
        match scaled_cholesky(&information) {
            Some(solver) if whole > 0.0 => (cross.dot(&solver.solve(&cross)) / whole).clamp(0.0, 1.0).sqrt(),
            _ => 0.0,
        }
    }

    /// Score of a unit for a group of columns, and the projection of the group's columns on the orthonormalised base columns in that unit.
    pub fn score(&self, unit: &Packed, group: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
        let residual = self.products.ncols() - 1;
        let between =
            |from: &[usize], to: &[usize]| DMatrix::from_fn(from.len(), to.len(), |i, j| unit[(from[i], to[j])]);
        let taken = DMatrix::from_fn(self.base.len(), group.len(), |i, k| self.coefficients[(i, group[k])]);
        let held = between(&self.base, group) - between(&self.base, &self.base) * &taken;
        let observed = between(group, &[residual]) - taken.tr_mul(&between(&self.base, &[residual]));
        let scores = observed.column(0) - held.tr_mul(&self.coefficients.column(residual));
        let half = self.solver.as_ref().map_or_else(|| DMatrix::zeros(0, group.len()), |solver| solver.half(&held));
        (scores, half)
    }

    /// Contribution of a unit to the products of a group's columns, with the base projected out.
    pub fn information_of(&self, unit: &Packed, group: &[usize]) -> DMatrix<f64> {
        let between =
            |from: &[usize], to: &[usize]| DMatrix::from_fn(from.len(), to.len(), |i, j| unit[(from[i], to[j])]);
        let taken = DMatrix::from_fn(self.base.len(), group.len(), |i, k| self.coefficients[(i, group[k])]);
        let shared = taken.tr_mul(&between(&self.base, group));
        let fitted = taken.tr_mul(&(between(&self.base, &self.base) * &taken));
        between(group, group) - &shared - shared.transpose() + fitted
    }

    /// Products of a group's columns, with the base projected out.
    pub fn information(&self, group: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(group.len(), group.len(), |i, j| self.products[(group[i], group[j])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    const BASE: [usize; 2] = [0, 1];
    const GROUP: [usize; 3] = [2, 4, 5];
    const OTHERS: [usize; 2] = [3, 5];
    const RESIDUAL: usize = 6;

    /// Four units of three runs: their rows, and the system of their products.
    fn system() -> (Vec<DMatrix<f64>>, System) {
        let mut stream = Stream::new(5, 0, 0);
        let rows: Vec<_> = (0..4).map(|_| DMatrix::from_fn(10, 7, |_, k| (1.0 + k as f64) * stream.normal())).collect();
        let unit = |(rows, run): (&DMatrix<f64>, usize)| Unit {
            run,
            fold: run,
            white: Packed::of(&rows.tr_mul(rows)),
            rows: rows.nrows(),
        };
        let units: Vec<Unit> = rows.iter().zip([0, 1, 1, 2]).map(unit).collect();
        let whole = units.iter().map(|unit| unit.white.whole()).sum();
        (rows, System { rows: 40, units, width: 7, whole })
    }

    /// Rows stacked on top of each other.
    fn stacked<'a>(rows: impl IntoIterator<Item = &'a DMatrix<f64>>) -> DMatrix<f64> {
        let rows: Vec<_> = rows.into_iter().flat_map(|rows| rows.row_iter()).collect();
        DMatrix::from_rows(&rows)
    }

    /// Coefficients of least squares, by singular values.
    fn regressed(y: &DMatrix<f64>, by: &DMatrix<f64>) -> DMatrix<f64> {
        by.clone().svd(true, true).solve(y, 1e-12).unwrap()
    }

    fn rest(y: &DMatrix<f64>, by: &DMatrix<f64>) -> DMatrix<f64> {
        y - by * regressed(y, by)
    }

    fn near(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
        a.shape() == b.shape() && (a - b).iter().all(|off| off.abs() < 1e-8 * (1.0 + b.amax()))
    }

    #[test]
    fn a_group_takes_off_what_fitting_it_beside_the_base_does() {
        let (rows, system) = system();
        let all = stacked(&rows);
        let (base, group, y) = (all.select_columns(&BASE), all.select_columns(&GROUP), all.select_columns(&[RESIDUAL]));
        let both = all.select_columns(&[&BASE[..], &GROUP].concat());
        let (drop, step, covariance) = Projected::new(&system.whole, &BASE).drop(&GROUP).unwrap();
        assert!((drop - (rest(&y, &base).norm_squared() - rest(&y, &both).norm_squared())).abs() < 1e-8);
        assert!(near(
            &DMatrix::from_column_slice(3, 1, step.as_slice()),
            &regressed(&y, &both).rows(2, 3).into_owned()
        ));
        let left = rest(&group, &base);
        assert!(near(&covariance, &left.tr_mul(&left).try_inverse().unwrap()));
        let fitted = Projected::fit(&system.whole, &GROUP);
        assert!(near(&DMatrix::from_column_slice(3, 1, fitted.as_slice()), &regressed(&y, &group)));
    }

    #[test]
    fn units_have_their_share_of_scores_and_information_beside_what_all_of_them_fit() {
        let (rows, system) = system();
        let all = stacked(&rows);
        let base = all.select_columns(&BASE);
        let factor = base.tr_mul(&base).cholesky().unwrap();
        let left = rest(&all, &base);
        let projected = Projected::new(&system.whole, &BASE);
        let mut sum = DVector::zeros(3);
        for (index, unit) in system.units.iter().enumerate() {
            let own = left.rows(10 * index, 10);
            let (group, y) = (own.select_columns(&GROUP), own.select_columns(&[RESIDUAL]));
            let (score, held) = projected.score(&unit.white, &GROUP);
            assert!(near(&DMatrix::from_column_slice(3, 1, score.as_slice()), &group.tr_mul(&y)));
            let shared = rows[index].select_columns(&BASE).tr_mul(&group);
            // Every square root of the base's products gives the same products of projections.
            assert!(near(&held.tr_mul(&held), &shared.tr_mul(&factor.solve(&shared))));
            assert!(near(&projected.information_of(&unit.white, &GROUP), &group.tr_mul(&group)));
            sum += score;
        }
        assert!((sum - DVector::from_fn(3, |i, _| projected.products[(GROUP[i], RESIDUAL)])).amax() < 1e-8);
    }

    #[test]
    fn likeness_is_the_cosine_between_a_response_and_the_nearest_of_others() {
        let (rows, system) = system();
        let all = stacked(&rows);
        let left = rest(&all, &all.select_columns(&BASE));
        let values = DVector::from_column_slice(&[1.0, -0.5, 0.2]);
        let response = left.select_columns(&GROUP) * DMatrix::from_column_slice(3, 1, values.as_slice());
        let other = &response - rest(&response, &left.select_columns(&OTHERS));
        let likeness = Projected::new(&system.whole, &BASE).likeness(&GROUP, &values, &OTHERS);
        assert!((likeness - other.norm() / response.norm()).abs() < 1e-9, "{likeness}");
    }

    #[test]
    fn a_run_is_left_out_with_all_of_its_units() {
        let (rows, system) = system();
        for (run, kept) in [(0, [1, 2, 3].to_vec()), (1, [0, 3].to_vec()), (2, [0, 1, 2].to_vec())] {
            let others = stacked(kept.iter().map(|unit| &rows[*unit]));
            assert!(near(&system.without(run), &others.tr_mul(&others)));
        }
    }

    #[test]
    fn a_column_is_absorbed_by_one_that_is_nearly_the_same() {
        let (mut rows, _) = system();
        let alike = |rows: &mut DMatrix<f64>, off: f64| {
            let column = rows.column(0) + rows.column(2) * off;
            rows.set_column(3, &column);
        };
        // The columns' lengths differ by a factor of three, so a hundredth of the one is a thirtieth of the other.
        for (off, absorbed) in [(0.003, true), (0.01, false)] {
            rows.iter_mut().for_each(|rows| alike(rows, off));
            let all = stacked(&rows);
            let whole = all.tr_mul(&all);
            assert_eq!(Projected::new(&whole, &BASE).absorbed(&whole, 3), absorbed, "{off}");
        }
    }
}
