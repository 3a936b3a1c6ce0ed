//! Minimises a smooth function that is evaluated at eight points at once.

use crate::geometry::EIGHT;
use nalgebra::{SMatrix, SVector};

type Point = SVector<f64, EIGHT>;

/// Step of the finite differences for slopes.
const NEAR: f64 = 1e-3;
/// Step of the finite differences for curvatures: their error, that of the cost by the square of the step, must not reach the point that is
/// found, or other last bits of the data lead elsewhere.
const FAR: f64 = 0.03;
/// Step lengths that are tried, in units of the quasi-Newton step.
const LENGTHS: [f64; EIGHT] = [2.0, 1.0, 0.5, 0.25, 0.1, 0.03, 0.01, 0.001];
/// Stops when a step gains less than this.
const ENOUGH: f64 = 0.01;
/// Maximum number of steps.
const STEPS: usize = 40;
/// Lower limit of every curvature.
const FLATTEST: f64 = 0.04;

/// A search for the least value by the method of Broyden, Fletcher, Goldfarb and Shanno (1970).
pub(super) struct Descent {
    at: Point,
    /// Estimate of the inverse Hessian; `None` before the first step.
    inverse: Option<SMatrix<f64, EIGHT, EIGHT>>,
}

impl Descent {
    /// From a point; the first curvatures are those along the coordinates.
    pub fn from(start: [f64; EIGHT]) -> Descent {
        Descent { at: Point::from(start), inverse: None }
    }

    /// Where it is.
    pub fn here(&self) -> [f64; EIGHT] {
        self.at.into()
    }

    /// Descends to the minimum of `cost`, which takes one point per lane. The estimated curvatures are kept for the next, similar cost.
    pub fn descend(&mut self, cost: impl Fn(&[[f64; EIGHT]; EIGHT]) -> [f64; EIGHT]) {
        let around = |at: &Point, by: f64| {
            let points = std::array::from_fn(|i| {
                let mut point = *at;
                point[i] += by;
                point.into()
            });
            Point::from(cost(&points))
        };
        let mut least = cost(&[self.here(); EIGHT])[0];
        let slope_at = |at: &Point, here: f64| (around(at, NEAR) - Point::repeat(here)) / NEAR;
        let (mut slope, mut inverse) = match self.inverse {
            Some(inverse) => (slope_at(&self.at, least), inverse),
            None => {
                let (above, below) = (around(&self.at, FAR), around(&self.at, -FAR));
                let slope = (above - below) / (2.0 * FAR);
                let curvature = (above + below - Point::repeat(2.0 * least)) / (FAR * FAR);
                // Far from the minimum, the slope indicates its distance better than the curvature.
                let inverse = curvature.zip_map(&slope, |c, s| 1.0 / c.max(s.abs()).max(FLATTEST));
                (slope, SMatrix::from_diagonal(&inverse))
            }
        };
        for _ in 0..STEPS {
            let step: Point = -inverse * slope;
            let points = LENGTHS.map(|length| self.at + step * length);
            let costs = cost(&points.map(Into::into));
            let best = (0..EIGHT).filter(|k| costs[*k] < least).min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
            let Some(best) = best else { break };
            let gain = least - costs[best];
            let moved = points[best] - self.at;
            (self.at, least) = (points[best], costs[best]);
            if gain < ENOUGH {
                break;
            }
            let now = slope_at(&self.at, least);
            let turned = now - slope;
            slope = now;
            let along = moved.dot(&turned);
            if along > 0.0 {
                let across = SMatrix::identity() - moved * turned.transpose() / along;
                inverse = across * inverse * across.transpose() + moved * moved.transpose() / along;
            }
        }
        self.inverse = Some(inverse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_in_many_dimensions_is_walked_to_its_end_and_nan_is_a_wall() {
        // A valley like Rosenbrock's, four times, steep as a likelihood of thousands of rows.
        let valley = |x: &[f64; EIGHT]| {
            let of = |pair: &[f64]| {
                if pair[0] > 3.0 {
                    f64::NAN
                } else {
                    10.0 * (pair[1] - pair[0].powi(2)).powi(2) + (1.0 - pair[0]).powi(2)
                }
            };
            x.chunks_exact(2).map(of).sum::<f64>()
        };
        let mut descent = Descent::from([-1.2, 1.0, 1.5, 0.5, 0.0, 0.0, 2.5, 1.0]);
        descent.descend(|points| points.map(|x| 1e3 * valley(&x)));
        assert!(valley(&descent.here()) < 0.1, "{:?}", descent.here());
    }
}
