//! Tests with exact small-sample distributions, for normal runs of equal, unknown covariance.
//!
//! They hold if, in each direction of driving, the model can explain any mean along one or more directions v of the pose and none along the
//! others. An example is the square with E_d and E_b, where both rotate the end point about the centre. The remaining coordinates of the
//! pose (K with K v = 0, two contrasts for a square) then have mean zero in both directions of driving. Source: the growth-curve model of
//! Potthoff & Roy (1964), with Rao's (1965) covariance adjustment.

use super::moments::{Moments, Shift};
use nalgebra::{Matrix3x2, Vector3};

/// Wilks' Λ = |E|/|E + H| that both means are zero, as an exact F: statistic and degrees of freedom.
///
/// Two hypotheses of q coordinates: F = (1 - √Λ)/√Λ · (ν - q + 1)/q ~ F(2q, 2(ν - q + 1)); with one coordinate
/// F = (1 - Λ)/Λ · ν/2 ~ F(2, ν). `None` for too few runs, or runs without scatter.
pub(crate) fn wilks(moments: &Moments) -> Option<(f64, [f64; 2])> {
    let (q, freedom) = (moments.size as f64, moments.freedom());
    let rest = freedom - q + 1.0;
    if rest <= 0.0 || q == 0.0 {
        return None;
    }
    let lambda = moments.scatter.cholesky()?.determinant() / moments.about_zero().cholesky()?.determinant();
    if moments.size == 1 {
        return Some(((1.0 - lambda) / lambda * freedom / 2.0, [2.0, freedom]));
    }
    let root = lambda.sqrt();
    Some(((1.0 - root) / root * rest / q, [2.0 * q, 2.0 * rest]))
}

/// An effect that moves both means along one direction u, by w_cw and w_ccw.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub weights: [f64; 2],
    pub along: Vector3<f64>,
}

/// Rao's t² for the size of a pattern, and the size: the component along u, adjusted for its covariance with all others, whose means are
/// zero for any size. F(1, N - q), exact.
pub(crate) struct Rao {
    pub size: f64,
    pub f: f64,
    pub freedom: f64,
}

impl Pattern {
    /// The pattern of two columns, if they have one direction: a second one below a tenth is second order.
    pub fn of(columns: &Shift) -> Option<Pattern> {
        const SECOND_ORDER: f64 = 0.1;
        let svd = Matrix3x2::from_columns(columns).svd(true, true);
        let [first, second] = [svd.singular_values[0], svd.singular_values[1]];
        if !(first > 0.0) || second > SECOND_ORDER * first {
            return None;
        }
        let (u, v) = (svd.u?, svd.v_t?);
        Some(Pattern { weights: [first * v[(0, 0)], first * v[(0, 1)]], along: u.column(0).into_owned() })
    }

    /// The test; `None` where the runs have no scatter.
    pub fn test(&self, moments: &Moments) -> Option<Rao> {
        let w = self.weights;
        let squares = (0..2).map(|g| moments.count(g) * w[g] * w[g]).sum::<f64>();
        let shift = moments.means[0] * (moments.count(0) * w[0]) + moments.means[1] * (moments.count(1) * w[1]);
        // Scatter about this pattern: N - 1 degrees of freedom.
        let about = moments.about_zero() - shift * shift.transpose() / squares;
        let cholesky = about.cholesky()?;
        let (by_along, by_shift) = (cholesky.solve(&self.along), cholesky.solve(&shift));
        let (aa, as_, ss) = (self.along.dot(&by_along), self.along.dot(&by_shift), shift.dot(&by_shift));
        let freedom = (moments.counts[0] + moments.counts[1]) as f64 - moments.size as f64;
        let adjusted = 1.0 + ((ss - as_ * as_ / aa) / squares).max(0.0);
        let f = freedom * as_ * as_ / (aa * squares * adjusted);
        Some(Rao { size: as_ / (aa * squares), f, freedom })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::stats::f_upper_tail;

    fn moments(counts: [usize; 2], size: usize, trial: u64) -> Moments {
        Moments::draw(counts, size, &mut Stream::new(8, 0, trial))
    }

    /// 10 000 null tests each, seed 8: 0.05 ± 0.0022 (one standard error); 3.5 of them are allowed.
    #[test]
    fn both_tests_have_their_size_for_even_and_uneven_numbers_of_runs() {
        for (counts, size) in [([5, 5], 2), ([5, 5], 1), ([3, 3], 2), ([4, 7], 3), ([3, 6], 2)] {
            let along = Vector3::from_fn(|i, _| if i < size { 1.0 - 0.4 * i as f64 } else { 0.0 });
            let pattern = Pattern { weights: [1.0, -0.7], along };
            let trials = 10_000;
            let (mut omnibus, mut single) = (0, 0);
            for trial in 0..trials {
                let m = moments(counts, size, trial);
                let (f, freedom) = wilks(&m).unwrap();
                omnibus += u32::from(f_upper_tail(f, freedom) < 0.05);
                let rao = pattern.test(&m).unwrap();
                single += u32::from(f_upper_tail(rao.f, [1.0, rao.freedom]) < 0.05);
            }
            for (name, count) in [("wilks", omnibus), ("rao", single)] {
                let share = f64::from(count) / trials as f64;
                assert!((share - 0.05).abs() < 3.5 * 0.0022, "{name} {counts:?} {size}: {share}");
            }
        }
    }

    /// Oracle: the regression of u'z on the pattern and on v'z, worked run by run.
    #[test]
    fn raos_test_is_the_regression_with_the_other_contrast_as_a_covariate() {
        let mut stream = Stream::new(4, 0, 0);
        let counts = [4, 6];
        let runs: Vec<(usize, Vector3<f64>)> = (0..10)
            .map(|i| {
                let group = usize::from(i >= counts[0]);
                let (a, b) = (stream.normal(), stream.normal());
                (group, Vector3::new(a + 0.5, 0.6 * a + b, 0.0))
            })
            .collect();
        let along = Vector3::new(0.8, 0.6, 0.0);
        let weights = [1.5, -1.0];
        let rao = Pattern { weights, along }.test(&Moments::of(&runs, 2)).unwrap();
        let across = Vector3::new(-0.6, 0.8, 0.0);
        let design =
            nalgebra::DMatrix::from_fn(10, 2, |i, j| if j == 0 { weights[runs[i].0] } else { across.dot(&runs[i].1) });
        let response = nalgebra::DVector::from_fn(10, |i, _| along.dot(&runs[i].1));
        let inverse = (design.transpose() * &design).try_inverse().unwrap();
        let coefficients = &inverse * design.transpose() * &response;
        let variance = (&response - &design * &coefficients).norm_squared() / 8.0;
        let t_squared = coefficients[0].powi(2) / (variance * inverse[(0, 0)]);
        assert!((rao.f / t_squared - 1.0).abs() < 1e-10, "{} {t_squared}", rao.f);
        assert!((rao.size - coefficients[0]).abs() < 1e-10 && rao.freedom == 8.0);
    }

    #[test]
    fn columns_of_two_directions_are_no_pattern() {
        let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
        assert!(Pattern::of(&[at(1.0, 0.0), at(0.0, 1.0)]).is_none());
        assert!(Pattern::of(&[at(0.0, 0.0), at(0.0, 0.0)]).is_none());
        let p = Pattern::of(&[at(2.0, 2.0), at(-1.0, -1.0)]).unwrap();
        for (group, expected) in [at(2.0, 2.0), at(-1.0, -1.0)].iter().enumerate() {
            assert!((p.along * p.weights[group] - expected).norm() < 1e-12);
        }
    }
}
