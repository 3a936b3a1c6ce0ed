//! What a test of n + n return poses is asked: the residuals of a fitted model, and every size of every missing effect.

use super::exact::Pattern;
use super::fitted::names;
use super::moments::{Moments, Whitened};
use super::{Ends, Fitted, mirrored};
use crate::diagnose::{DiagnoseError, Unseen, Why, candidates, classes};
use crate::effect::{CATALOGUE, Context, Entry, Model, Sight};
use crate::drive::WheelTravel;
use crate::geometry::Pose2;
use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector, Vector3};

/// An effect that moves the means by less than this many standard deviations at its usual size is not asked.
const VISIBLE: f64 = 0.5;
/// Singular values of the model's own directions below this share of the largest are second order.
const SECOND_ORDER: f64 = 0.1;
/// A parameter that makes up less than this share of an absorbed effect is not named.
const SHARE: f64 = 0.1;

/// One size of an effect, as the means would show it.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub effect: &'static Entry,
    pub parameter: &'static Parameter,
    /// Shift of both means by a unit of the size, in the coordinates of [`Asked::moments`].
    pub columns: [DVector<f64>; 2],
    /// Where the exact test applies.
    pub pattern: Option<Pattern>,
    /// The shift in standard deviations of the means, less what the model absorbs.
    pub shift: DVector<f64>,
}

/// Residuals and what is asked of them.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    /// In coordinates in which the pooled scatter is the identity (times ν).
    pub moments: Moments,
    /// The residuals in the same coordinates, with their group.
    pub runs: Vec<(usize, DVector<f64>)>,
    /// What the model explains besides; empty where the coordinates leave it out already.
    pub base: Vec<[DVector<f64>; 2]>,
    /// The sizes that can be seen.
    pub units: Vec<Unit>,
    /// The effects that cannot.
    pub unseen: Vec<Unseen>,
    /// Absorbed effects, by their largest size, and the effect of the model that absorbs them.
    pub absorbed: Vec<(&'static Entry, &'static Parameter, &'static str)>,
}

impl Asked {
    /// `None` where the runs have too little scatter for any test.
    pub fn new(ends: &Ends, fitted: &Fitted) -> Result<Option<Asked>, DiagnoseError> {
        let d = ends.coordinates();
        let groups: Vec<usize> = ends.runs.iter().map(|run| run.direction as usize).collect();
        let poses = |v: &Vector3<f64>| DVector::from_column_slice(&v.as_slice()[..d]);
        let raw: Vec<(usize, DVector<f64>)> =
            groups.iter().zip(&fitted.residuals).map(|(g, r)| (*g, poses(r))).collect();
        let raw_moments = Moments::of(&raw);
        let Some(whitener) = whitener(&raw_moments) else { return Ok(None) };
        let of_model: Vec<[DVector<f64>; 2]> = (0..fitted.free.len())
            .map(|j| {
                let columns = fitted.jacobian.iter().map(|slope| &whitener * slope.column(j).rows(0, d));
                means(&groups, columns, d)
            })
            .collect();
        let (map, base) = reduced(&of_model, d);
        let runs: Vec<(usize, DVector<f64>)> = raw.iter().map(|(g, r)| (*g, &map * (&whitener * r))).collect();
        let base = base.iter().map(|pattern| pattern.each_ref().map(|p| &map * p)).collect();
        let moments = Moments::of(&runs);
        let mut asked = Asked { moments, runs, base, units: Vec::new(), unseen: Vec::new(), absorbed: Vec::new() };
        asked.ask(ends, fitted, &whitener, &map, &of_model, &groups)?;
        Ok(Some(asked))
    }

    fn ask(
        &mut self,
        ends: &Ends,
        fitted: &Fitted,
        whitener: &DMatrix<f64>,
        map: &DMatrix<f64>,
        of_model: &[[DVector<f64>; 2]],
        groups: &[usize],
    ) -> Result<(), DiagnoseError> {
        let d = ends.coordinates();
        let counts = [self.moments.count(0), self.moments.count(1)];
        let moved = candidates::of_tracks(&fitted.model, |varies| ends.tracks(varies))?;
        for candidate in &moved {
            let (mut visible, mut raw_largest, mut largest) = (Vec::new(), 0.0_f64, None);
            for size in &candidate.sizes {
                let of_tracks: Vec<Pose2> = size.columns.iter().map(|c| c[0]).collect();
                let shifts = ends.of_runs(&of_tracks).map(|(direction, pose)| {
                    let shift = mirrored(direction, &Vector3::new(pose.x, pose.y, pose.heading));
                    whitener * shift.rows(0, d)
                });
                let full = means(groups, shifts, d);
                let columns = full.each_ref().map(|c| map * c);
                let typical = size.parameter.typical;
                let raw = typical * stacked(&full, counts).norm();
                if raw > raw_largest {
                    (raw_largest, largest) = (raw, Some((full, size.parameter)));
                }
                let Some(whitened) = Whitened::new(&self.moments, &self.base) else { continue };
                let shift = whitened.column(&columns);
                if typical * shift.norm() >= VISIBLE {
                    let pattern = if self.base.is_empty() { Pattern::of(&columns) } else { None };
                    let (effect, parameter) = (candidate.effect, size.parameter);
                    visible.push(Unit { effect, parameter, columns, pattern, shift });
                }
            }
            if visible.is_empty() {
                let name = candidate.effect.about.name;
                let mut by = Vec::new();
                if let Some((full, parameter)) = largest.filter(|_| raw_largest >= VISIBLE) {
                    by = absorbers(&full, of_model, fitted, counts);
                    self.absorbed.extend(by.iter().map(|effect| (candidate.effect, parameter, *effect)));
                }
                let why = if by.is_empty() { Why::BelowNoise } else { Why::Absorbed(by) };
                self.unseen.push(Unseen { effect: name, why });
            }
            self.units.append(&mut visible);
        }
        let still = CATALOGUE.iter().filter(|entry| {
            moved.iter().all(|c| c.effect != *entry)
                && fitted.model.parts().iter().all(|part| part.effect != *entry)
                && moves_means(entry, &fitted.model)
        });
        self.unseen.extend(still.map(|entry| Unseen { effect: entry.about.name, why: Why::BelowNoise }));
        Ok(())
    }

    /// The same with a size added to what the model explains.
    pub fn explaining(&self, unit: &Unit) -> Asked {
        let mut more = self.clone();
        more.base.push(unit.columns.clone());
        let whitened = Whitened::new(&more.moments, &more.base);
        more.units.retain_mut(|other| {
            let Some(whitened) = &whitened else { return false };
            other.shift = whitened.column(&other.columns);
            other.pattern = None;
            other.effect != unit.effect && other.parameter.typical * other.shift.norm() >= VISIBLE
        });
        more
    }

    /// Units that these means cannot tell apart, as indices.
    pub fn classes(&self) -> Vec<Vec<usize>> {
        let shifts: Vec<DVector<f64>> = self.units.iter().map(|unit| unit.shift.clone()).collect();
        classes::complete_linkage(&shifts, classes::ALIKE)
    }
}

/// L⁻¹ with L Lᵀ the pooled covariance; `None` where it is singular but for rounding.
fn whitener(moments: &Moments) -> Option<DMatrix<f64>> {
    const ROUNDING: f64 = 1e-9;
    let covariance = &moments.scatter / moments.freedom();
    let scales = DVector::from_fn(covariance.nrows(), |i, _| covariance[(i, i)].sqrt());
    // Scatter that is rounding beside the residuals themselves is none.
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
fn means(groups: &[usize], of_runs: impl Iterator<Item = DVector<f64>>, size: usize) -> [DVector<f64>; 2] {
    let runs: Vec<(usize, DVector<f64>)> = groups.iter().copied().zip(of_runs).collect();
    let mut sums = [DVector::zeros(size), DVector::zeros(size)];
    for (group, v) in &runs {
        sums[*group] += v;
    }
    [0, 1].map(|g| &sums[g] / runs.iter().filter(|(group, _)| *group == g).count().max(1) as f64)
}

fn stacked(pattern: &[DVector<f64>; 2], counts: [f64; 2]) -> DVector<f64> {
    let size = pattern[0].len();
    DVector::from_fn(2 * size, |i, _| counts[i / size].sqrt() * pattern[i / size][i % size])
}

/// Coordinates for the tests, and what of the model is left in them.
///
/// Where the model explains any mean along k directions in both groups (2k parameters), those directions are left out
/// and exact tests apply. Otherwise all are kept, and the model is the base of least squares.
fn reduced(of_model: &[[DVector<f64>; 2]], d: usize) -> (DMatrix<f64>, Vec<[DVector<f64>; 2]>) {
    let everything = DMatrix::identity(d, d);
    if of_model.is_empty() {
        return (everything, Vec::new());
    }
    let columns: Vec<DVector<f64>> = of_model.iter().flatten().cloned().collect();
    let Some((u, singular)) = full_left(&DMatrix::from_columns(&columns)) else {
        return (everything, of_model.to_vec());
    };
    let rank = singular.iter().filter(|s| **s > SECOND_ORDER * singular[0]).count();
    if of_model.len() != 2 * rank || rank >= d {
        return (everything, of_model.to_vec());
    }
    (u.columns(rank, d - rank).transpose(), Vec::new())
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

/// The effects of the model whose parameters do what an effect does.
fn absorbers(
    full: &[DVector<f64>; 2],
    of_model: &[[DVector<f64>; 2]],
    fitted: &Fitted,
    counts: [f64; 2],
) -> Vec<&'static str> {
    if of_model.is_empty() {
        return Vec::new();
    }
    let columns: Vec<DVector<f64>> = of_model.iter().map(|pattern| stacked(pattern, counts)).collect();
    let target = stacked(full, counts);
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

/// Whether an effect at its usual sizes changes any motion, start or sight other than by chance.
fn moves_means(entry: &'static Entry, model: &Model) -> bool {
    let plain = Model::new(model.robot());
    let mut with = plain.clone();
    for parameter in entry.about.parameters.iter().filter(|p| p.choices.is_empty()) {
        let usual = parameter.default.resolve(model.robot()) + parameter.typical;
        if with.set(entry.about.name, parameter.name, usual).is_err() {
            return false;
        }
    }
    let at = Context {
        heading: 0.7,
        duration: 0.1,
        speed: 0.3,
        turn_rate: 0.4,
        wheel_speed: [0.2, 0.4],
        speed_change: [0.02, 0.03],
        wheel_angle: [1.0, 2.0],
        wheel_rotation: [0.3, 0.4],
        reversed: [1.0, -1.0],
        distance: 3.0,
        time: 10.0,
        session_distance: 20.0,
        since_turn: 0.05,
        length: 0.03,
        last_turn: 1.0,
        run: 2.0,
        direction: 1.0,
        recorded: true,
    };
    let sight = Sight { time: 10.0, speed: 0.3, turn_rate: 0.4 };
    let all = |model: &Model| {
        let chain = model.chain();
        let travel = WheelTravel { left: 0.02, right: 0.04 };
        (chain.start(), chain.displacement(&at, &travel), chain.seen(&sight, &Pose2::new(1.0, 2.0, 0.5)))
    };
    all(&plain) != all(&with)
}
