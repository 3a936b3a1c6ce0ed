//! A smooth as a curve over what it depends on, with its interval.

use super::examination::Examination;
use super::finding::Finding;
use super::smooth::{ALONG_THE_WAY, Covariate, Exposure, Motion, Piece, Scales};
use crate::stats::normal_quantile;
use nalgebra::DVector;
use std::f64::consts::{PI, TAU};

/// Points of a curve.
const POINTS: usize = 17;
/// Maximum distance after a turn that is drawn \[m\].
const FAR_FROM_TURN: f64 = 0.6;

/// A smooth dependence, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Unit of what it depends on; empty for a pure number.
    pub at_unit: &'static str,
    /// Unit of what it adds.
    pub unit: String,
    /// In increasing order.
    pub points: Vec<CurvePoint>,
}

/// A place on a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// What it depends on.
    pub at: f64,
    /// What it adds.
    pub value: f64,
    /// Half the width of its 95 % interval, taken by itself.
    pub half_width: f64,
}

/// The curve of a smooth that was found: f(x) = Σ c_k f_k(x), with var f = fᵀ C f.
pub fn curve(exam: &Examination, finding: &Finding, covariate: &Covariate, motion: Motion) -> Curve {
    let scales = Scales::new(&exam.fitted.observed);
    let own = &exam.asked[finding.answer.asked].columns;
    let shown: Vec<usize> =
        finding.answer.columns.iter().filter_map(|column| own.iter().position(|c| c == column)).collect();
    let wide = normal_quantile(0.975);
    let mut basis = vec![0.0; covariate.terms];
    let point = |at: f64| {
        (covariate.basis)(at / (covariate.scale)(&scales), &mut basis);
        let basis = DVector::from_fn(shown.len(), |k, _| basis[shown[k]]);
        let variance = (&finding.answer.covariance * &basis).dot(&basis);
        CurvePoint { at, value: basis.dot(&finding.answer.step), half_width: wide * variance.max(0.0).sqrt() }
    };
    let added = if motion == Motion::Yaw { "rad" } else { "m" };
    Curve {
        at_unit: covariate.unit,
        unit: format!("{added}/{}", covariate.exposure.unit()),
        points: places(exam, covariate, &scales).into_iter().map(point).collect(),
    }
}

/// Places at which a curve is given: over the range of the covariate in the runs.
fn places(exam: &Examination, covariate: &Covariate, scales: &Scales) -> Vec<f64> {
    let (low, high) = match covariate.exposure {
        Exposure::WheelWay(_) => (0.0, TAU),
        _ if covariate.name == "heading" => (-PI, PI),
        _ if covariate.name == ALONG_THE_WAY => (-1.0, 1.0),
        _ => range(exam, covariate, scales),
    };
    let high = if covariate.name.starts_with("since_turn") { high.min(FAR_FROM_TURN) } else { high };
    let points = if covariate.terms == 1 { 2 } else { POINTS };
    let share = |k: usize| k as f64 / (points - 1) as f64;
    (0..points).map(|k| low + (high - low) * share(k)).collect()
}

/// The least and the greatest value of a covariate along all runs.
fn range(exam: &Examination, covariate: &Covariate, scales: &Scales) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for track in exam.fitted.observed.tracks() {
        let way = track.length().max(f64::MIN_POSITIVE);
        for at in track.contexts() {
            let piece = Piece::believed(at, way, scales);
            if piece.counts(covariate) {
                let value = (covariate.value)(&piece);
                (low, high) = (low.min(value), high.max(value));
            }
        }
    }
    if low < high { (low, high) } else { (0.0, (covariate.scale)(scales)) }
}

#[cfg(test)]
mod tests {
    use super::super::smooth::COVARIATES;
    use super::super::tests::complete;
    use super::*;

    #[test]
    fn a_curve_is_told_over_all_that_the_runs_show() {
        let exam = complete();
        let scales = Scales::new(&exam.fitted.observed);
        let of = |name: &str| places(exam, COVARIATES.iter().find(|c| c.name == name).unwrap(), &scales);
        let ends = |name: &str| of(name)[..].iter().fold((f64::MAX, f64::MIN), |(a, b), at| (a.min(*at), b.max(*at)));
        let near = |(low, high): (f64, f64), (from, to): (f64, f64)| (low - from).abs() + (high - to).abs() < 0.03;
        assert!(near(ends("speed"), (0.0, scales.speed)) && of("speed").len() == POINTS, "{:?}", of("speed"));
        assert!(near(ends("turn_rate"), (-scales.turn_rate, scales.turn_rate)), "{:?}", of("turn_rate"));
        assert!(near(ends("since_turn"), (0.0, FAR_FROM_TURN)), "{:?}", of("since_turn"));
        assert_eq!((of("direction"), ends("wheel_angle_left")), (vec![-1.0, 1.0], (0.0, TAU)));
    }
}
