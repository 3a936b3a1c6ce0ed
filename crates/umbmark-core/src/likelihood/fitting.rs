//! The free parameters of a model, fitted to whole tracks.

use super::fitted::{Ended, Fitted, Slopes};
use super::noise::Noise;
use super::observed::{Column, Observed, ObservedRun};
use super::products::{ABSORBED, gram, share_left};
use crate::effect::{Derived, Model, ModelError, Number, find};
use crate::fit::{Known, Options, Problem, least_squares};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::cell::RefCell;
use std::sync::Arc;

/// Effects of the reference that every track may have; they are projected out before the robot is judged.
pub const NUISANCE: [&str; 3] = ["reference_delay", "marker_offset", "marker_yaw"];

/// Rounds in which outliers are looked for.
const ROUNDS: usize = 3;
/// Stops where a step changes no parameter by more than a millionth.
const STOP: Options =
    Options { iterations: 12, step_tolerance: 1e-7, decrease_tolerance: 1e-8, cautious: true, frugal: true };
/// Duration of a piece in which a model that is some per cent off stays near the measured positions \[s\].
const PIECE: f64 = 15.0;
/// Precise enough for an estimate of the noise, which projects out the free values anyway.
const NEARLY: Options = Options { decrease_tolerance: 1e-5, ..STOP };
/// For a start from values that were already fitted.
const AGAIN: Options = Options { cautious: false, ..STOP };
const NEARLY_AGAIN: Options = Options { cautious: false, ..NEARLY };

impl Observed {
    /// Fits all free values of a model but those `held`, and the noise.
    pub fn fit(&self, model: &Model, from: &Noise, held: &[usize]) -> Result<Fitted, ModelError> {
        let mut fitted = self.whole().unfitted(model, from);
        fitted.free.retain(|value| !held.contains(value));
        if !self.has_headings() {
            fitted.begin_in_pieces()?;
        }
        fitted.settle(&NEARLY)?;
        fitted.observed.runs.iter_mut().for_each(|run| run.linear = true);
        fitted.observed = fitted.observed.along(&fitted.model);
        fitted.settle_once(&NEARLY_AGAIN)?;
        // A large outlier can hide a smaller one, so the search is repeated.
        for _ in 0..ROUNDS {
            let found = fitted.beyond_noise();
            if found.is_empty() {
                break;
            }
            for ((run, block), deviations) in found {
                fitted.outliers.push(fitted.outlier((run, block), f64::from_bits(deviations)));
                fitted.observed.runs[run].start_afresh(block, &fitted.model.chain());
            }
            fitted.settle(&NEARLY_AGAIN)?;
        }
        fitted.refit_by(&AGAIN)?;
        Ok(fitted)
    }

    /// A model as it is, ready to be fitted.
    pub fn unfitted(&self, model: &Model, noise: &Noise) -> Fitted {
        let slopes = self.moving(model);
        Fitted {
            observed: self.along(model),
            model: model.clone(),
            noise: *noise,
            reference: vec![Vec::new(); self.runs.len()],
            free: slopes.free.clone(),
            covariance: None,
            usual_noise: false,
            taken: Vec::new(),
            outliers: self.jumps(),
            held: Vec::new(),
            ended: Ended::default(),
            slopes,
        }
    }

    /// Free values of a model that change at least one observed pose.
    pub fn free_values(&self, model: &Model) -> Vec<usize> {
        self.moving(model).free
    }

    /// The same values, and how they move the poses.
    fn moving(&self, model: &Model) -> Slopes {
        let free = model.free_places();
        let mut columns = self.columns(model, &free);
        let moves = |k: &usize| columns.iter().any(|run| run[*k].iter().any(|c| *c != [0.0; 3]));
        let moving: Vec<usize> = (0..free.len()).filter(moves).collect();
        for run in &mut columns {
            *run = moving.iter().map(|k| std::mem::take(&mut run[*k])).collect();
        }
        let free = moving.iter().map(|k| free[*k]).collect();
        Slopes { values: model.values().collect(), free, columns: Arc::new(columns) }
    }

    /// Derivatives of the predicted poses by some of the values of a model: run by run, one column a value.
    pub fn columns(&self, model: &Model, values: &[usize]) -> Vec<Vec<Column>> {
        let chains: Vec<_> = model.chains(values).collect();
        let of_run = |run: &ObservedRun| chains.iter().flat_map(|(chain, count)| run.columns(chain, *count)).collect();
        self.runs.par_iter().map(of_run).collect()
    }

    /// The same by numbers that change only the measurement, for the model about which the runs are linearised.
    fn columns_of_sight(&self, model: &Model, values: &[usize]) -> Vec<Vec<Column>> {
        let (plain, chains) = (model.chain(), model.chains(values).collect::<Vec<_>>());
        let of_chain = |run: &ObservedRun, (chain, count): &(_, usize)| run.columns_of_sight((&plain, chain), *count);
        let of_run = |run: &ObservedRun| chains.iter().flat_map(|chain| of_chain(run, chain)).collect();
        self.runs.par_iter().map(of_run).collect()
    }

    /// The same as [`Observed::columns`], and the residuals of the model.
    fn columns_and_residuals(&self, model: &Model, values: &[usize]) -> (Vec<Vec<Column>>, Vec<Column>) {
        let chains: Vec<_> = model.chains(values).collect();
        let of_run = |run: &ObservedRun| match &chains[..] {
            [] => (Vec::new(), run.residuals(&model.chain())),
            [(first, count), others @ ..] => {
                let (mut columns, residuals) = run.columns_and_residuals(first, *count);
                columns.extend(others.iter().flat_map(|(chain, count)| run.columns(chain, *count)));
                (columns, residuals)
            }
        };
        self.runs.par_iter().map(of_run).unzip()
    }

    /// Derivatives of the predicted poses by numbers that the model has or may have, at the model about which the runs are linearised: run
    /// by run, one column per number.
    pub fn columns_of(&self, model: &Model, numbers: &[Number]) -> Result<Vec<Vec<Column>>, ModelError> {
        let derived = model.derived(numbers)?;
        Ok(self.runs.par_iter().map(|run| run.columns_of(&derived, numbers.len())).collect())
    }
}

impl ObservedRun {
    /// One column for each of `count` numbers, at the model about which the run is linearised.
    pub(crate) fn columns_of(&self, derived: &[Derived], count: usize) -> Vec<Column> {
        let mut columns = vec![Column::new(); count];
        for Derived { chain, plain, numbers, seen_only } in derived {
            let count = numbers.len();
            let own =
                if *seen_only { self.columns_of_sight((plain, chain), count) } else { self.columns(chain, count) };
            numbers.iter().zip(own).for_each(|(number, column)| columns[*number] = column);
        }
        columns
    }
}

impl Slopes {
    fn of(observed: &Observed, model: &Model, free: &[usize]) -> Slopes {
        let columns = Arc::new(observed.columns(model, free));
        Slopes { values: model.values().collect(), free: free.to_vec(), columns }
    }
}

impl Fitted {
    /// Distance of one of the free values from the value without effect; 0 for a shape.
    pub fn departure(&self, free: usize) -> f64 {
        let place = self.free[free];
        self.model.values().nth(place).zip(self.model.nothing(place)).map_or(0.0, |(value, nothing)| value - nothing)
    }

    /// Earlier measurements of free values: which of these, how far it is above the value, and its standard deviation.
    pub fn priors(&self) -> Vec<(usize, f64, f64)> {
        let values: Vec<f64> = self.model.values().collect();
        let known = self.observed.knowledge.of(&self.model, &self.free);
        let of = |(k, known): (usize, Known)| known.prior.map(|p| (k, p.mean - values[self.free[k]], p.sd));
        known.into_iter().enumerate().filter_map(of).collect()
    }

    /// Takes as start values those that fit the runs in short pieces, if the whole runs are nearer to them.
    ///
    /// Without headings, a wheelbase that is a few per cent off turns a long way by a right angle and more against the measured one, and a fit
    /// from there ends in another minimum. In a piece of some seconds it cannot.
    fn begin_in_pieces(&mut self) -> Result<(), ModelError> {
        let squares = |observed: &Observed, model: &Model| {
            let chain = model.chain();
            let of_run = |run: &ObservedRun| run.residuals_along(&chain).iter().map(|[x, y, _]| x * x + y * y).sum();
            observed.runs.par_iter().map(of_run).collect::<Vec<f64>>().iter().sum::<f64>()
        };
        let mut pieces = self.observed.in_pieces(PIECE).unfitted(&self.model, &self.noise);
        pieces.free.retain(|value| self.free.contains(value));
        pieces.refit_by(&NEARLY)?;
        let whole = self.observed.along(&pieces.model);
        if squares(&whole, &pieces.model) < squares(&self.observed, &self.model) {
            (self.observed, self.model) = (whole, pieces.model);
        }
        Ok(())
    }

    /// Fits values and noise alternately; the first fit of the values uses `options`.
    fn settle(&mut self, options: &Options) -> Result<(), ModelError> {
        self.settle_once(options)?;
        self.settle_once(&NEARLY_AGAIN)
    }

    fn settle_once(&mut self, options: &Options) -> Result<(), ModelError> {
        self.refit_by(options)?;
        let (chain, columns) = (self.model.chain(), self.all_columns());
        self.noise = Noise::estimate(&self.observed, &chain, &columns, &self.noise);
        Ok(())
    }

    /// Derivatives of the predicted poses by the free values: run by run, one column a value.
    pub fn columns(&self) -> Arc<Vec<Vec<Column>>> {
        if self.slopes.fit(&self.model, &self.free) {
            return Arc::clone(&self.slopes.columns);
        }
        Slopes::of(&self.observed, &self.model, &self.free).columns
    }

    /// The same, those of the effects of the reference that are fitted along, and the residuals.
    pub fn all_columns(&self) -> Vec<Vec<Column>> {
        let (chain, own) = (self.model.chain(), self.columns());
        let runs = self.observed.runs.par_iter().zip(own.par_iter()).zip(&self.reference);
        runs.map(|((run, own), reference)| [&own[..], reference, &[run.residuals_along(&chain)]].concat()).collect()
    }

    /// Fits the free values under the noise as it is, and the effects of the reference with them.
    ///
    /// If a marker yaw of 6 mrad is not fitted too, E_d changes by 1 %: the direction of a leg shows where the robot went, the measured
    /// heading where the marker pointed.
    pub fn refit(&mut self) -> Result<(), ModelError> {
        self.refit_by(&STOP)
    }

    fn refit_by(&mut self, options: &Options) -> Result<(), ModelError> {
        if !self.slopes.fit(&self.model, &self.free) {
            self.slopes = Slopes::of(&self.observed, &self.model, &self.free);
        }
        let fitted_too = self.reference_fitted_too()?;
        let start: Vec<f64> = self.model.values().collect();
        let mut start: Vec<f64> = self.free.iter().map(|i| start[*i]).collect();
        start.resize(self.free.len() + fitted_too.len(), 0.0);
        let tracks = Tracks { fitted: self, fitted_too: &fitted_too, last: RefCell::default() };
        let fit = least_squares(&tracks, &start, options);
        let last = tracks.last.into_inner();
        let own = self.free.len();
        self.held = (0..own).filter(|k| fit.held[*k]).map(|k| self.free[k]).collect();
        self.ended = Ended { termination: fit.termination, steps: fit.iterations };
        self.model = self.model.with_values(&self.free, &fit.values[..own])?;
        let covariance = fit.covariance().map(|all| all.view((0, 0), (own, own)).into_owned());
        self.covariance = covariance.map(|covariance| within_usual_sizes(covariance, &self.model, &self.free));
        match last {
            Some(At { observed: Some(observed), slopes, reference }) if slopes.fit(&self.model, &self.free) => {
                (self.observed, self.slopes, self.reference) = (observed, slopes, reference);
            }
            last => {
                self.slopes = last.map_or_else(|| self.slopes.clone(), |last| last.slopes);
                self.observed = self.observed.along(&self.model);
            }
        }
        Ok(())
    }

    /// Which numbers of the effects of the reference that the model lacks its free values cannot absorb; [`lacking`] lists these numbers. Their
    /// columns are kept.
    fn reference_fitted_too(&mut self) -> Result<Vec<usize>, ModelError> {
        let (with, lacking) = lacking(&self.model)?;
        let mut columns = self.observed.columns_of_sight(&with, &lacking);
        let both: Vec<Vec<Column>> = self.columns().iter().zip(&columns).map(|(a, b)| [&a[..], b].concat()).collect();
        let stacked = self.stacked(&self.observed, &both);
        let products = gram(stacked.transpose().as_slice(), stacked.ncols());
        let mut base: Vec<usize> = (0..self.free.len()).collect();
        for column in self.free.len()..products.ncols() {
            if share_left(&products, &base, column) > ABSORBED {
                base.push(column);
            }
        }
        let kept: Vec<usize> = base[self.free.len()..].iter().map(|column| column - self.free.len()).collect();
        columns.iter_mut().for_each(|run| *run = kept.iter().map(|column| run[*column].clone()).collect());
        self.reference = columns;
        Ok(kept.into_iter().map(|column| lacking[column]).collect())
    }

    /// Whitens one set of columns a run into one matrix.
    fn stacked(&self, observed: &Observed, columns: &[Vec<Column>]) -> DMatrix<f64> {
        let runs: Vec<Vec<f64>> = observed
            .runs
            .par_iter()
            .zip(columns)
            .map(|(run, columns)| {
                let columns: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).collect();
                self.noise.whiten(run, &columns).values
            })
            .collect();
        let width = columns.first().map_or(0, Vec::len);
        let values: Vec<f64> = runs.concat();
        DMatrix::from_row_slice(values.len() / width.max(1), width, &values)
    }
}

/// A covariance where shapes that the runs leave open are known to within their usual sizes.
///
/// A threshold below every speed that was driven may be any of these: it shifts E_d as it shifts, in the linear model without limit, and the
/// interval of E_d would be as wide as the thresholds are that no robot has. A shape is open where its interval holds zero; its usual size is
/// then a measurement of it with this standard deviation.
fn within_usual_sizes(mut covariance: DMatrix<f64>, model: &Model, free: &[usize]) -> DMatrix<f64> {
    let values: Vec<f64> = model.values().collect();
    for (own, place) in free.iter().enumerate() {
        let (value, variance) = (values[*place], covariance[(own, own)]);
        let Some(usual) = model.usual_shape(*place).filter(|_| value * value < OPEN * OPEN * variance) else {
            continue;
        };
        let column = covariance.column(own).into_owned();
        covariance.ger(-1.0 / (variance + usual * usual), &column, &column, 1.0);
    }
    covariance
}

/// A shape is open where it is less than this many standard errors from zero.
const OPEN: f64 = 2.0;

/// Remark on values that were fitted with noise of the usual sizes.
pub const USUAL_NOISE: &str = "Held-out runs are predicted better with noise of the usual sizes than with the fitted noise, which may have \
     absorbed something that the model lacks. The values are those under noise of the usual sizes; their intervals come from leaving out one \
     run after the other.";

/// A model with the effects of the reference that it lacks, and their places among its values.
fn lacking(model: &Model) -> Result<(Model, Vec<usize>), ModelError> {
    let known = |name: &&str| model.parts().iter().any(|part| part.effect.name() == *name);
    let names: Vec<&str> = NUISANCE.into_iter().filter(|name| !known(name)).collect();
    let mut with = model.clone();
    for name in &names {
        with.add(name)?;
    }
    let mut places = Vec::new();
    for name in names {
        let parameters = find(name)?.about.parameters;
        places.extend(parameters.iter().filter_map(|parameter| with.place_of(name, parameter.name)));
    }
    Ok((with, places))
}

/// The free values of a model, and behind them the sizes of the effects of the reference.
struct Tracks<'a> {
    fitted: &'a Fitted,
    /// Which effects of the reference these are.
    fitted_too: &'a [usize],
    /// Where the last Jacobian was computed; `None` where only that at the start was.
    last: RefCell<Option<At>>,
}

/// What was computed for one model of a fit.
struct At {
    /// The runs linearised about it; `None` where they stay as they were.
    observed: Option<Observed>,
    slopes: Slopes,
    reference: Vec<Vec<Column>>,
}

impl Tracks<'_> {
    fn model(&self, parameters: &[f64]) -> Result<Model, ModelError> {
        self.fitted.model.with_values(&self.fitted.free, &parameters[..self.fitted.free.len()])
    }

    /// Residuals by a model other than that of the start, with all derivatives.
    ///
    /// Where terms of second order are removed, the runs are linearised about each model anew. With those of another model, a model that turns
    /// the robot by a further angle α seems to shorten its way by α²/2: the fit would stay where it began, with an interval much too narrow.
    fn at(&self, model: &Model) -> Result<(At, Vec<Column>), ModelError> {
        let fitted = self.fitted;
        let (values, free) = (model.values().collect(), fitted.free.clone());
        let slopes = |columns| Slopes { values, free, columns: Arc::new(columns) };
        if !fitted.observed.runs.iter().any(ObservedRun::is_linearised) {
            let (columns, residuals) = fitted.observed.columns_and_residuals(model, &fitted.free);
            return Ok((
                At { observed: None, slopes: slopes(columns), reference: fitted.reference.clone() },
                residuals,
            ));
        }
        let (observed, chain) = (fitted.observed.along(model), model.chain());
        let residuals = observed.runs.par_iter().map(|run| run.residuals_along(&chain)).collect();
        let columns = observed.columns(model, &fitted.free);
        let reference = observed.columns_of_sight(&lacking(model)?.0, self.fitted_too);
        Ok((At { observed: Some(observed), slopes: slopes(columns), reference }, residuals))
    }

    /// Whitened residuals and derivatives.
    fn whitened(
        &self,
        (observed, slopes, reference): (&Observed, &Slopes, &[Vec<Column>]),
        residuals: Vec<Column>,
        sizes: &[f64],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let all = slopes.columns.iter().zip(reference).zip(residuals).map(|((own, reference), mut left)| {
            for (column, size) in reference.iter().zip(sizes) {
                left.iter_mut().zip(column).for_each(|(l, c)| (0..3).for_each(|k| l[k] -= size * c[k]));
            }
            [&own[..], reference, &[left]].concat()
        });
        let stacked = self.fitted.stacked(observed, &all.collect::<Vec<_>>());
        let width = slopes.free.len() + sizes.len();
        (stacked.column(width).into_owned(), -stacked.columns(0, width))
    }
}

impl Problem for Tracks<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        self.both(parameters).0
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        self.both(parameters).1
    }

    fn both(&self, parameters: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        let fitted = self.fitted;
        let impossible = || (DVector::from_element(1, f64::INFINITY), DMatrix::zeros(1, parameters.len()));
        let Ok(model) = self.model(parameters) else { return impossible() };
        let sizes = &parameters[fitted.free.len()..];
        // Where a fit begins, all is known.
        if self.last.borrow().is_none() && model == fitted.model {
            let chain = model.chain();
            let residuals = fitted.observed.runs.par_iter().map(|run| run.residuals_along(&chain)).collect();
            return self.whitened((&fitted.observed, &fitted.slopes, &fitted.reference), residuals, sizes);
        }
        let Ok((at, residuals)) = self.at(&model) else { return impossible() };
        let observed = at.observed.as_ref().unwrap_or(&fitted.observed);
        let both = self.whitened((observed, &at.slopes, &at.reference), residuals, sizes);
        self.last.replace(Some(at));
        both
    }

    fn known(&self) -> Vec<Known> {
        self.fitted.observed.knowledge.of(&self.fitted.model, &self.fitted.free)
    }
}

#[cfg(test)]
mod tests {
    use super::super::watched::{watched, watched_on};
    use super::*;
    use crate::diagnose::first_model;
    use crate::drive::Robot;
    use crate::path::{Path, SpeedProfile, WAYPOINTS};
    use crate::random::Stream;

    /// Fifty-six corners turn by 252 degrees more than the nominal robot believes, no heading says so, and rows are missing midway.
    #[test]
    fn a_wheelbase_that_positions_show_late_is_found_from_the_nominal_robot() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for (effect, parameter, value) in
            [("wheelbase", "e_b", 0.95), ("wheel_diameter_ratio", "e_d", 0.997), ("wheel_noise", "k_sqrt_m", 2e-4)]
        {
            model.set(effect, parameter, value).unwrap();
        }
        let laps: Vec<f64> = [[2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]].repeat(14).concat();
        let path = Path::new(&WAYPOINTS, &laps, SpeedProfile::default()).unwrap();
        let mut data = watched_on(&path, &model, 2, 4);
        for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
            log.reference.iter_mut().for_each(|pose| pose.heading = None);
            let missing = log.time.len() / 2..log.time.len() / 2 + 500;
            log.reference.retain(|pose| !missing.contains(&pose.sample));
            for pose in log.reference.iter_mut().filter(|pose| pose.sample >= missing.end) {
                pose.sample -= missing.len();
            }
            for column in [&mut log.time, &mut log.left, &mut log.right] {
                column.drain(missing.clone());
            }
        }
        let observed = Observed::new(&data, &robot).unwrap();
        let fitted = observed.fit(&first_model(&data).unwrap(), &Noise::default(), &[]).unwrap();
        let found = fitted.model.get("wheelbase", "e_b").unwrap();
        assert!((found - 0.95).abs() < 2e-4, "{found}");
    }

    /// Squares have one speed on every leg: a threshold of the speed below it and E_d make the same turn.
    #[test]
    fn a_threshold_that_the_runs_leave_open_is_known_to_its_usual_size_and_widens_e_d_by_no_more() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        model.set("missed_counts", "left_s_per_m", 0.02).unwrap();
        model.set("missed_counts", "right_s_per_m", -0.02).unwrap();
        model.set("missed_counts", "threshold_m_s", 1e-3).unwrap();
        model.add("wheel_diameter_ratio").unwrap();
        let free: Vec<usize> = (0..4).collect();
        let correlated = |variance: f64| {
            let slope = DVector::from_column_slice(&[0.0, 0.0, 1.0, 0.04]);
            DMatrix::from_diagonal(&DVector::from_column_slice(&[1e-8, 1e-8, 0.0, 1e-10]))
                + variance * &slope * slope.transpose()
        };
        // By hand: 70 m/s of threshold are 2.8 of E_d; its usual size of 0.1 m/s is 0.004.
        let known = within_usual_sizes(correlated(4900.0), &model, &free);
        assert!((known[(2, 2)].sqrt() - 0.1).abs() < 1e-5 && (known[(3, 3)].sqrt() - 0.004).abs() < 1e-5, "{known}");
        assert_eq!((known[(0, 0)], known[(1, 1)]), (1e-8, 1e-8));
        // A threshold that is shown stays as it was, and so does a size.
        let shown = correlated(1e-8);
        assert_eq!(within_usual_sizes(shown.clone(), &model, &free), shown);
    }

    #[test]
    fn columns_kept_from_the_fit_are_those_of_the_fitted_model_and_of_no_other() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for (effect, parameter, value) in [("wheelbase", "e_b", 0.99), ("wheel_noise", "k_sqrt_m", 4e-4)] {
            model.set(effect, parameter, value).unwrap();
        }
        let data = watched(&model, 1, 3);
        let observed = Observed::new(&data, &robot).unwrap();
        let mut fitted = observed.fit(&first_model(&data).unwrap(), &Noise::default(), &[]).unwrap();
        assert!(fitted.slopes.fit(&fitted.model, &fitted.free));
        assert_eq!(*fitted.columns(), observed.columns(&fitted.model, &fitted.free));
        fitted.model.set("wheelbase", "e_b", 1.5).unwrap();
        assert_eq!(*fitted.columns(), observed.columns(&fitted.model, &fitted.free));
        fitted.free.pop();
        assert_eq!(*fitted.columns(), observed.columns(&fitted.model, &fitted.free));
    }

    /// Wheels so rough that the heading drifts by 0.1 rad on a square: half of the square of that is a shrink of one in a thousand, four times
    /// the standard error of the mean of eight sets.
    #[test]
    fn a_heading_that_drifts_is_not_taken_for_wheels_that_are_too_small() {
        let robot = Robot::labmate();
        let mut truth = Model::new(&robot);
        truth.set("wheel_noise", "k_sqrt_m", 6e-3).unwrap();
        let mut asked = Model::new(&robot);
        for effect in ["wheel_diameter_ratio", "wheelbase", "scale"] {
            asked.add(effect).unwrap().free = true;
        }
        let (mut off, mut variance) = (0.0, 0.0);
        for seed in 0..8 {
            let observed = Observed::new(&watched(&truth, 8, seed), &robot).unwrap();
            let fitted = observed.fit(&asked, &Noise::default(), &[]).unwrap();
            off += (fitted.model.get("scale", "e_s").unwrap() - 1.0) / 8.0;
            variance += fitted.covariance.unwrap()[(2, 2)] / 64.0;
        }
        assert!(off.abs() < 2.5 * variance.sqrt() && variance.sqrt() < 3e-4, "{off} {}", variance.sqrt());
    }

    /// Eight laps on a floor that turns the robot at random, and does not change its way. Fits that linearised the runs about their start only had
    /// E_d 2.1 standard errors off in the quadratic mean; these, 0.9.
    #[test]
    fn intervals_hold_where_the_heading_drifts_on_a_long_way() {
        let robot = Robot::labmate();
        let laps: Vec<f64> = [[2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]].repeat(8).concat();
        let path = Path::new(&WAYPOINTS, &laps, SpeedProfile::default()).unwrap();
        let mut asked = Model::new(&robot);
        for effect in ["wheel_diameter_ratio", "wheelbase", "scale"] {
            asked.add(effect).unwrap().free = true;
        }
        let sets = 8;
        let mut squares = 0.0;
        for seed in 0..sets {
            let mut data = watched_on(&path, &Model::new(&robot), 1, seed);
            for (run, log) in data.runs.iter_mut().filter_map(|run| run.log.as_mut()).enumerate() {
                let mut random = Stream::new(seed, 1, run as u64);
                let (mut off, mut last, mut at) = (0.0, [0.0; 2], [0.0; 2]);
                for pose in &mut log.reference {
                    let (x, y) = (pose.x - last[0], pose.y - last[1]);
                    off += 7e-3 * libm::hypot(x, y).sqrt() * random.normal();
                    let (sine, cosine) = libm::sincos(off);
                    at = [at[0] + cosine * x - sine * y, at[1] + sine * x + cosine * y];
                    last = [pose.x, pose.y];
                    (pose.x, pose.y) = (at[0] + 3e-4 * random.normal(), at[1] + 3e-4 * random.normal());
                    pose.heading = pose.heading.map(|heading| heading + off + 1e-3 * random.normal());
                }
            }
            let observed = Observed::new(&data, &robot).unwrap();
            let fitted = observed.fit(&asked, &Noise::default(), &[]).unwrap();
            let off = fitted.model.get("wheel_diameter_ratio", "e_d").unwrap() - 1.0;
            squares += off * off / fitted.covariance.unwrap()[(0, 0)] / sets as f64;
        }
        assert!(squares.sqrt() < 1.6, "{}", squares.sqrt());
    }

    #[test]
    fn columns_of_numbers_together_are_those_of_each_by_a_replay_of_its_own() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for (effect, parameter, value) in [
            ("wheelbase", "e_b", 0.99),
            ("crab", "angle_rad", 0.01),
            ("marker_yaw", "yaw_rad", 0.3),
            ("reference_delay", "delay_s", 0.05),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        let observed = Observed::new(&watched(&model, 1, 3), &robot).unwrap().along(&model);
        let of = |entry: &'static crate::effect::Entry| {
            let parameters = entry.about.parameters.iter();
            parameters.map(|p| Number::of(entry.about.name, p.name))
        };
        let numbers: Vec<Number> = crate::effect::of_drive(robot.drive.kind()).flat_map(of).collect();
        let together = observed.columns_of(&model, &numbers).unwrap();
        for (index, number) in numbers.iter().enumerate() {
            let mut with = model.clone();
            with.add(number.effect).unwrap();
            let alone = observed.columns(&with, &[with.place_of(number.effect, number.parameter).unwrap()]);
            for (together, alone) in together.iter().zip(&alone) {
                let most = alone[0].iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
                let pairs = together[index].iter().flatten().zip(alone[0].iter().flatten());
                let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0_f64, f64::max);
                assert!(off <= 1e-10 * most, "{number:?}: {off} of {most}");
            }
        }
    }
}
