//! The tests with n + n return poses: the residuals of a fitted model against every size of every effect that it lacks.

use super::exact::{Pattern, wilks};
use super::moments::{Both, Moments, Shift, Whitened};
use crate::diagnose::candidates::Size;
use crate::diagnose::likeness::Likeness;
use crate::diagnose::unseen::{Unseen, Why};
use crate::diagnose::{candidates, classes};
use crate::effect::Entry;
use crate::evidence::FitError;
use crate::evidence::ends::{Ends, Fitted, mirrored, names};
use crate::fit::RANK_TOLERANCE;
use crate::geometry::Pose2;
use crate::parameter::Parameter;
use crate::stats::f_upper_tail;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// An effect that moves the means by fewer standard deviations than this at its usual size is not tested.
const VISIBLE: f64 = 0.5;
/// A parameter that makes up less than this share of an absorbed effect is not named.
const SHARE: f64 = 0.1;

/// A shift of the mean poses, clockwise and counter-clockwise, whitened.
type Columns = [DVector<f64>; 2];

/// One size of an effect, and its response in the means.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub effect: &'static Entry,
    pub parameter: &'static Parameter,
    /// Shift of both means by a unit of the size, in the coordinates of [`Asked::moments`].
    pub columns: Shift,
    /// Where the exact test applies.
    pub pattern: Option<Pattern>,
    /// The shift in standard deviations of the means, without the part that the model absorbs.
    pub shift: Both,
}

/// Residuals, and the effects that they are tested for.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    /// In coordinates in which the pooled scatter is the identity (times ν).
    pub moments: Moments,
    /// The residuals in the same coordinates, with their group.
    pub runs: Vec<(usize, Vector3<f64>)>,
    /// Covariance of evenly noisy wheels in the same coordinates, scaled to the scatter.
    expected: Option<Matrix3<f64>>,
    /// Columns of the model that are projected out; empty if the coordinates already exclude them.
    pub base: Vec<Shift>,
    /// The sizes that can be seen.
    pub units: Vec<Unit>,
    /// The effects that cannot.
    pub unseen: Vec<Unseen>,
    /// Absorbed effects, by their largest size, and the effect of the model that absorbs them.
    pub absorbed: Vec<(&'static Entry, &'static Parameter, &'static str)>,
}

/// From end poses to the coordinates of the tests.
struct Frame {
    groups: Vec<usize>,
    counts: [f64; 2],
    coordinates: usize,
    /// L⁻¹ with L Lᵀ the pooled covariance.
    whitener: DMatrix<f64>,
    /// Applied after it, in each group.
    maps: [DMatrix<f64>; 2],
    /// What the model's free parameters do to the means, whitened.
    of_model: Vec<Columns>,
}

impl Asked {
    /// `None` if the runs have too little scatter for any test.
    pub fn new(ends: &Ends, fitted: &Fitted) -> Result<Option<Asked>, FitError> {
        let Some((mut asked, frame)) = Asked::residuals(ends, fitted) else { return Ok(None) };
        asked.ask(ends, fitted, &frame)?;
        Ok(Some(asked))
    }

    /// Only the test of the whole model, without any effect.
    pub fn nothing(ends: &Ends, fitted: &Fitted) -> Option<Asked> {
        Asked::residuals(ends, fitted).map(|(asked, _)| asked)
    }

    /// p of the test of the whole model by Wilks' Λ, where it applies.
    pub fn wilks_p(ends: &Ends, fitted: &Fitted) -> Option<f64> {
        let asked = Asked::nothing(ends, fitted)?;
        let (f, freedom) = wilks(&asked.moments).filter(|_| asked.base.is_empty())?;
        Some(f_upper_tail(f, freedom))
    }

    /// The residuals in the coordinates of the tests, with no effects to test yet.
    fn residuals(ends: &Ends, fitted: &Fitted) -> Option<(Asked, Frame)> {
        let d = ends.coordinates();
        let groups: Vec<usize> = ends.runs.iter().map(|run| run.direction as usize).collect();
        let raw: Vec<(usize, Vector3<f64>)> =
            groups.iter().zip(&fitted.residuals).map(|(g, r)| (*g, small(r.rows(0, d).iter()))).collect();
        let whitener = whitener(&Moments::of(&raw, d))?;
        let of_values = |jacobian: &[DMatrix<f64>]| -> Vec<Columns> {
            let column = |j: usize| jacobian.iter().map(move |slope| slope.column(j).rows(0, d).into_owned());
            (0..fitted.free.len()).map(|j| means(&groups, column(j).map(|c| &whitener * c), d)).collect()
        };
        let of_model = of_values(&fitted.jacobian);
        let (maps, base): (_, Vec<Columns>) = reduced(&of_model, &of_values(&fitted.nominal_jacobian(ends)), d);
        let size = maps[0].nrows();
        let mapped = |(g, r): &(usize, Vector3<f64>)| (*g, small((&maps[*g] * (&whitener * r.rows(0, d))).iter()));
        let runs: Vec<(usize, Vector3<f64>)> = raw.iter().map(mapped).collect();
        let moments = Moments::of(&runs, size);
        let base = base.iter().map(small_shift).collect();
        let counts = [moments.count(0), moments.count(1)];
        let expected = ends.noise_shape().and_then(|shape| {
            let map = &maps[1] * &whitener;
            let shape = &map * shape.view((0, 0), (d, d)) * map.transpose();
            let scatter = moments.scatter.view((0, 0), (size, size)).into_owned();
            let scale = shape.clone().cholesky()?.solve(&scatter).trace() / moments.freedom() / size as f64;
            Some(Matrix3::from_fn(|i, j| if i.max(j) < size { scale * shape[(i, j)] } else { 0.0 }))
        });
        let (units, unseen, absorbed) = Default::default();
        let asked = Asked { moments, runs, expected, base, units, unseen, absorbed };
        Some((asked, Frame { groups, counts, coordinates: d, whitener, maps, of_model }))
    }

    fn ask(&mut self, ends: &Ends, fitted: &Fitted, frame: &Frame) -> Result<(), FitError> {
        let Some(whitened) = Whitened::new(&self.moments, &self.base) else { return Ok(()) };
        let moved = candidates::of_tracks(&fitted.model, |varies| ends.tracks(varies))?;
        for candidate in &moved {
            let mut visible = Vec::new();
            let mut largest: Option<(f64, Columns, &'static Parameter)> = None;
            for size in &candidate.sizes {
                let (full, columns) = frame.columns(ends, size);
                let (effect, parameter) = (candidate.effect, size.parameter);
                let raw = parameter.typical * stacked(&full, frame.counts).norm();
                if largest.as_ref().is_none_or(|(most, _, _)| raw > *most) {
                    largest = Some((raw, full, parameter));
                }
                let shift = whitened.column(&columns);
                if parameter.typical * shift.norm() >= VISIBLE {
                    let pattern = if self.base.is_empty() { Pattern::of(&columns) } else { None };
                    visible.push(Unit { effect, parameter, columns, pattern, shift });
                }
            }
            if visible.is_empty() {
                let seen = largest.filter(|(raw, _, _)| *raw >= VISIBLE);
                self.note_unseen(candidate.effect, seen.map(|(_, full, p)| (absorbers(&full, fitted, frame), p)));
            }
            self.units.append(&mut visible);
        }
        let still = candidates::missing(&fitted.model).filter(|entry| moved.iter().all(|c| c.effect != *entry));
        self.unseen.extend(still.map(|entry| Unseen { effect: entry.about.name, why: Why::BelowNoise }));
        Ok(())
    }

    fn note_unseen(&mut self, effect: &'static Entry, absorbed: Option<(Vec<&'static str>, &'static Parameter)>) {
        let name = effect.about.name;
        let why = match absorbed.filter(|(by, _)| !by.is_empty()) {
            Some((by, parameter)) => {
                self.absorbed.extend(by.iter().map(|by| (effect, parameter, *by)));
                Why::Absorbed(by)
            }
            None => Why::BelowNoise,
        };
        self.unseen.push(Unseen { effect: name, why });
    }

    /// The same with a size added to what the model explains.
    pub fn explaining(&self, unit: &Unit) -> Asked {
        let mut more = self.clone();
        more.base.push(unit.columns);
        let whitened = Whitened::new(&more.moments, &more.base);
        more.units.retain_mut(|other| {
            let Some(whitened) = &whitened else { return false };
            other.shift = whitened.column(&other.columns);
            other.pattern = None;
            other.effect != unit.effect && other.parameter.typical * other.shift.norm() >= VISIBLE
        });
        more
    }

    /// Expected decrease of the misfit for each unit.
    ///
    /// The covariance is a mean of the scatter of these few runs and that of evenly noisy wheels, as if the latter came from the same
    /// number of runs. This ranks effects more reliably; no p-value uses it.
    pub fn drops(&self) -> Vec<f64> {
        let mut eked = self.moments.clone();
        if let Some(expected) = &self.expected {
            eked.scatter = 0.5 * (eked.scatter + expected * self.moments.freedom());
        }
        let Some(whitened) = Whitened::new(&eked, &self.base) else { return vec![0.0; self.units.len()] };
        let drop = |unit: &Unit| {
            let column = whitened.column(&unit.columns);
            let along = column.dot(&whitened.means);
            along * along / column.norm_squared()
        };
        self.units.iter().map(drop).collect()
    }

    /// How alike the effects look, each size at its usual value.
    pub fn likeness(&self) -> Likeness {
        let names: Vec<&'static str> = self.units.iter().map(|unit| unit.effect.about.name).collect();
        let shift = |i: usize| self.units[i].shift * self.units[i].parameter.typical;
        Likeness::new(&names, &DMatrix::from_fn(names.len(), names.len(), |i, j| shift(i).dot(&shift(j))))
    }

    /// Classes of units that these means cannot separate, as indices.
    pub fn classes(&self) -> Vec<Vec<usize>> {
        let shift = |unit: &Unit| DVector::from_column_slice(unit.shift.as_slice());
        let shifts: Vec<DVector<f64>> = self.units.iter().map(shift).collect();
        classes::complete_linkage(&shifts, classes::ALIKE)
    }
}

/// L⁻¹ with L Lᵀ the pooled covariance; `None` if it is singular up to rounding.
fn whitener(moments: &Moments) -> Option<DMatrix<f64>> {
    const ROUNDING: f64 = 1e-9;
    let d = moments.size;
    let covariance = moments.scatter.view((0, 0), (d, d)).into_owned() / moments.freedom();
    let scales = DVector::from_fn(d, |i, _| covariance[(i, i)].sqrt());
    // Scatter of the size of rounding errors is treated as zero.
    if scales.iter().any(|s| !(*s > 1e-12)) {
        return None;
    }
    let factor = covariance.cholesky()?.l();
    if (0..scales.len()).any(|i| factor[(i, i)] < ROUNDING * scales[i]) {
        return None;
    }
    factor.solve_lower_triangular(&DMatrix::identity(scales.len(), scales.len()))
}

/// Mean of a vector for each run over the runs of each group.
fn means(groups: &[usize], of_runs: impl Iterator<Item = DVector<f64>>, size: usize) -> Columns {
    let runs: Vec<(usize, DVector<f64>)> = groups.iter().copied().zip(of_runs).collect();
    let mut sums = [DVector::zeros(size), DVector::zeros(size)];
    for (group, v) in &runs {
        sums[*group] += v;
    }
    [0, 1].map(|g| &sums[g] / runs.iter().filter(|(group, _)| *group == g).count().max(1) as f64)
}

/// At most three coordinates, filled up with zeros.
fn small<'a>(coordinates: impl Iterator<Item = &'a f64>) -> Vector3<f64> {
    let mut small = Vector3::zeros();
    small.iter_mut().zip(coordinates).for_each(|(own, value)| *own = *value);
    small
}

fn small_shift(columns: &Columns) -> Shift {
    columns.each_ref().map(|column| small(column.iter()))
}

fn stacked(pattern: &Columns, counts: [f64; 2]) -> DVector<f64> {
    let size = pattern[0].len();
    DVector::from_fn(2 * size, |i, _| counts[i / size].sqrt() * pattern[i / size][i % size])
}

impl Frame {
    /// Response of the means to a unit of a size: whitened, and in the coordinates of the tests.
    fn columns(&self, ends: &Ends, size: &Size) -> (Columns, Shift) {
        let of_tracks: Vec<Pose2> = size.columns.iter().map(|c| c[0]).collect();
        let shifts = ends.of_runs(&of_tracks).map(|(direction, pose)| {
            let shift = mirrored(direction, &Vector3::new(pose.x, pose.y, pose.heading));
            &self.whitener * shift.rows(0, self.coordinates)
        });
        let full = means(&self.groups, shifts, self.coordinates);
        let columns = small_shift(&[0, 1].map(|g| &self.maps[g] * &full[g]));
        (full, columns)
    }
}

/// Coordinates for the tests in each group, and the part of the model that remains in them.
///
/// Where the nominal model explains any mean along k directions in both groups (2k parameters), those directions are left out and exact
/// tests apply. Each group leaves out the direction of the fitted model there, which differs from the nominal one by second-order terms,
/// and the other directions stay aligned between groups. Otherwise all coordinates are kept, and the model is the base of least squares.
fn reduced(of_model: &[Columns], nominal: &[Columns], d: usize) -> ([DMatrix<f64>; 2], Vec<Columns>) {
    let everything = || ([DMatrix::identity(d, d), DMatrix::identity(d, d)], of_model.to_vec());
    if of_model.is_empty() {
        return everything();
    }
    let columns: Vec<DVector<f64>> = nominal.iter().flatten().cloned().collect();
    let Some((u, singular)) = full_left(&DMatrix::from_columns(&columns)) else { return everything() };
    let k = singular.iter().filter(|s| **s > RANK_TOLERANCE * singular[0]).count();
    if of_model.len() != 2 * k || k >= d {
        return everything();
    }
    let (explained, rest) = (u.columns(0, k).into_owned(), u.columns(k, d - k).transpose());
    let map = |group: usize| {
        let own: Vec<DVector<f64>> = of_model.iter().map(|pattern| pattern[group].clone()).collect();
        let (u, _) = full_left(&DMatrix::from_columns(&own))?;
        let own = u.columns(0, k).into_owned();
        let aligned = (explained.transpose() * &own).try_inverse()?;
        Some(&rest * (DMatrix::identity(d, d) - own * aligned * explained.transpose()))
    };
    match (map(0), map(1)) {
        (Some(cw), Some(ccw)) => ([cw, ccw], Vec::new()),
        _ => everything(),
    }
}

/// All left singular vectors, by falling singular value.
fn full_left(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, Vec<f64>)> {
    let eigen = (matrix * matrix.transpose()).symmetric_eigen();
    let mut order: Vec<usize> = (0..matrix.nrows()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let singular: Vec<f64> = order.iter().map(|i| eigen.eigenvalues[*i].max(0.0).sqrt()).collect();
    let columns: Vec<_> = order.iter().map(|i| eigen.eigenvectors.column(*i)).collect();
    (singular[0] > 0.0).then(|| (DMatrix::from_columns(&columns), singular))
}

/// The effects of the model that together absorb an effect.
fn absorbers(full: &Columns, fitted: &Fitted, frame: &Frame) -> Vec<&'static str> {
    if frame.of_model.is_empty() {
        return Vec::new();
    }
    let columns: Vec<DVector<f64>> = frame.of_model.iter().map(|pattern| stacked(pattern, frame.counts)).collect();
    let target = stacked(full, frame.counts);
    let svd = DMatrix::from_columns(&columns).svd(true, true);
    let Ok(weights) = svd.solve(&target, 1e-12) else { return Vec::new() };
    let names = names(&fitted.model);
    let mut by: Vec<&'static str> = Vec::new();
    for (j, column) in columns.iter().enumerate() {
        let name = names[fitted.free[j]].0;
        if (weights[j] * column.norm()).abs() > SHARE * target.norm() && !by.contains(&name) {
            by.push(name);
        }
    }
    by
}
