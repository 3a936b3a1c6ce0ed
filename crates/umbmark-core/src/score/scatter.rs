//! The spread of return errors within a direction, pooled over both.

use crate::dataset::ReturnError;
use crate::geometry::wrap;
use crate::path::Direction;
use crate::score::summary::{Summary, each, summarise};
use nalgebra::Matrix3;

/// Covariance of one run's return error (x, y, heading) about its direction's mean, pooled over both directions.
///
/// The clockwise path is the mirror image of the counter-clockwise one, and so is the scatter of a robot whose two wheels
/// are equally noisy: Σ_cw = M Σ_ccw M with M = diag(1, -1, -1). Clockwise runs are mapped through M before pooling,
/// which gives the covariance n_cw + n_ccw - 2 degrees of freedom in place of n - 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Covariance of a counter-clockwise run \[m, m, rad\]; zero in its third row and column without headings.
    pub covariance: Matrix3<f64>,
    /// ν: its degrees of freedom, the number of runs less the number of directions.
    pub degrees_of_freedom: usize,
    /// Whether every run's heading was measured.
    pub with_heading: bool,
}

impl Scatter {
    /// The pooled scatter of the runs of both directions; `None` where no direction has two runs.
    pub fn pooled<E: Copy + Into<ReturnError>>(cw: &[E], ccw: &[E]) -> Option<Scatter> {
        Scatter::about(&summarise(cw, ccw), cw, ccw)
    }

    /// [`Scatter::pooled`] of runs whose centres of gravity are known.
    pub(super) fn about<E: Copy + Into<ReturnError>>(means: &Summary, cw: &[E], ccw: &[E]) -> Option<Scatter> {
        let with_heading = each(cw).chain(each(ccw)).all(|e| e.heading.is_some());
        let (mut squares, mut degrees_of_freedom) = (Matrix3::zeros(), 0);
        for (errors, mean, sign) in [(cw, means.cw, -1.0), (ccw, means.ccw, 1.0)] {
            let Some(mean) = mean else { continue };
            degrees_of_freedom += errors.len() - 1;
            for error in each(errors) {
                let heading = match (error.heading, mean.heading) {
                    (Some(heading), Some(mean)) if with_heading => wrap(heading - mean),
                    _ => 0.0,
                };
                let from_mean = nalgebra::Vector3::new(error.x - mean.x, sign * (error.y - mean.y), sign * heading);
                squares += from_mean * from_mean.transpose();
            }
        }
        let covariance = squares / degrees_of_freedom.max(1) as f64;
        (degrees_of_freedom > 0).then_some(Scatter { covariance, degrees_of_freedom, with_heading })
    }

    /// Covariance of one run in a direction.
    pub fn of(&self, direction: Direction) -> Matrix3<f64> {
        let mirror = Matrix3::from_diagonal(&nalgebra::Vector3::new(1.0, direction.sign(), direction.sign()));
        mirror * self.covariance * mirror
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, heading: f64) -> ReturnError {
        ReturnError { x, y, heading: Some(heading) }
    }

    #[test]
    fn a_mirrored_cluster_adds_to_the_same_covariance_and_not_to_its_opposite() {
        let ccw = [at(0.1, 0.3, 0.02), at(0.2, 0.1, 0.05), at(-0.1, 0.0, -0.01)];
        let cw = ccw.map(|e| at(e.x, -e.y, -e.heading.unwrap()));
        let (both, alone) = (Scatter::pooled(&cw, &ccw).unwrap(), Scatter::pooled(&[], &ccw).unwrap());
        assert!((both.covariance - alone.covariance).abs().max() < 1e-17);
        assert_eq!((both.degrees_of_freedom, alone.degrees_of_freedom), (4, 2));
        assert!(both.covariance[(0, 1)].abs() > 1e-3, "the example must be correlated");
        assert!((both.of(Direction::Cw)[(0, 1)] + both.covariance[(0, 1)]).abs() < 1e-17);
        assert_eq!(both.of(Direction::Ccw), both.covariance);
    }

    #[test]
    fn single_runs_have_no_scatter_and_a_missing_heading_leaves_headings_out() {
        assert_eq!(Scatter::pooled(&[at(0.0, 0.0, 0.0)], &[at(1.0, 0.0, 0.0)]), None);
        let missing = ReturnError { x: 2.0, y: 0.0, heading: None };
        let s = Scatter::pooled(&[], &[at(0.0, 0.0, 0.5), at(1.0, 0.0, 0.1), missing]).unwrap();
        assert!(!s.with_heading && s.covariance[(2, 2)] == 0.0 && s.covariance[(0, 0)] == 1.0);
    }

    /// Oracle: sums by hand.
    #[test]
    fn headings_scatter_about_their_mean_with_the_position_and_across_the_cut() {
        let s = Scatter::pooled(&[], &[at(0.1, 0.3, 0.02), at(0.2, 0.1, 0.05), at(-0.1, 0.0, -0.01)]).unwrap();
        for (at, sum) in [((2, 2), 0.0018), ((0, 2), 0.009), ((1, 2), 0.003)] {
            assert!((s.covariance[at] - sum / 2.0).abs() < 1e-15, "{at:?}: {}", s.covariance);
        }
        let half = std::f64::consts::PI;
        let astride = Scatter::pooled(&[at(0.0, 0.0, half - 0.01), at(0.0, 0.0, 0.01 - half)], &[]).unwrap();
        assert!((astride.covariance[(2, 2)] - 2e-4).abs() < 1e-12);
    }
}
