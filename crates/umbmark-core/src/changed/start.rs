//! Whether a START that lies elsewhere accounts for a change of return errors.
//!
//! A tape and a protractor laid out from a START that is turned by θ and moved by s turn and move the absolute poses of both directions alike. With
//! their means a, those c of the computed poses, their headings h, and the pooled scatter S of the runs,
//!
//! ```text
//! z = ( R(-θ) (a_cw - a_ccw)_after - (c_cw - c_ccw)_after - (a_cw - a_ccw - c_cw + c_ccw)_before,  (h_after - h_before) - θ of each direction )
//! T² = min over θ of zᵀ V⁻¹ z,   V from Σ S/n over the four means,   F = T² (ν - q + 1)/(ν q)
//! ```
//!
//! has q and ν - q + 1 degrees of freedom where it is START; ν are those of the scatter. s is in none of the contrasts z. With headings q is 3. Without
//! headings a START that is not turned is tried first, with q = 2, then one that is turned by at most [`MOST_UNSEEN`], with q = 1: the eye sees more.
//!
//! Source: Hotelling (1931), Annals of Mathematical Statistics 2, 360.

use super::Learned;
use crate::dataset::ReturnError;
use crate::effect::Model;
use crate::evidence::{AnyEvidence, Ends};
use crate::geometry::wrap;
use crate::path::Direction;
use crate::score::{Cluster, Scatter};
use crate::stats::f_upper_tail;
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};

/// How far START lies elsewhere, if that is what changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartMoved {
    /// Along the first leg \[m\].
    pub x: f64,
    /// To its left \[m\].
    pub y: f64,
    /// \[rad\]; `None` where the returns have no headings and a START that did not turn accounts for the change.
    pub heading: Option<f64>,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// Largest turn of START where no heading was measured \[rad\].
const MOST_UNSEEN: f64 = 0.052;

/// Largest turn of START where headings were measured \[rad\].
const MOST_SEEN: f64 = 0.5;

/// Steps of Newton's method for the turn; it is found in three.
const STEPS: usize = 20;

/// What a turn of START has to account for: two coordinates of the position, the heading of each direction.
type Contrasts = SVector<f64, 4>;

/// The means of a test, clockwise and counter-clockwise.
struct Returns {
    /// Of the return errors.
    errors: [Cluster; 2],
    /// Of the computed poses, x and y.
    computed: [Vector2<f64>; 2],
    scatter: Scatter,
}

/// Both tests, and how the means scatter.
struct Pair {
    before: Returns,
    after: Returns,
    inverse: SMatrix<f64, 4, 4>,
    /// ν.
    freedom: f64,
    with_heading: bool,
}

/// Where START went, if that accounts for the change at this size of the test; `None` for tracks, and where one direction was not driven.
pub(super) fn of(tests: &[Learned; 2], size: f64) -> Option<StartMoved> {
    let pair = Pair::of(tests)?;
    let not_turned = || pair.moved(0.0, 2.0);
    let turned = || {
        let most = if pair.with_heading { MOST_SEEN } else { MOST_UNSEEN };
        let turn = pair.turn().filter(|turn| turn.abs() <= most)?;
        let moved = pair.moved(turn, if pair.with_heading { 3.0 } else { 1.0 })?;
        Some(StartMoved { heading: Some(turn), ..moved })
    };
    let accounts = |moved: &StartMoved| moved.p >= size;
    let first = if pair.with_heading { None } else { not_turned() };
    first.filter(accounts).or_else(|| turned().filter(accounts))
}

impl Pair {
    fn of(tests: &[Learned; 2]) -> Option<Pair> {
        let [before, after] = [Returns::of(&tests[0])?, Returns::of(&tests[1])?];
        let with_heading = before.scatter.with_heading && after.scatter.with_heading;
        let freedoms = [&before, &after].map(|test| test.scatter.degrees_of_freedom as f64);
        let freedom = freedoms[0] + freedoms[1];
        let [cw, ccw] = [(0, Direction::Cw), (1, Direction::Ccw)].map(|(side, direction)| {
            let pooled = before.scatter.of(direction) * freedoms[0] + after.scatter.of(direction) * freedoms[1];
            let each = [&before, &after].map(|test| 1.0 / test.errors[side].n as f64);
            pooled * ((each[0] + each[1]) / freedom)
        });
        let mut variance = SMatrix::<f64, 4, 4>::identity();
        variance.fixed_view_mut::<2, 2>(0, 0).copy_from(&at_position(&(cw + ccw)));
        if with_heading {
            for (row, side, sign) in [(2, &cw, 1.0), (3, &ccw, -1.0)] {
                variance[(row, row)] = side[(2, 2)];
                for axis in 0..2 {
                    variance[(axis, row)] = sign * side[(axis, 2)];
                    variance[(row, axis)] = sign * side[(axis, 2)];
                }
            }
        }
        Some(Pair { inverse: variance.try_inverse()?, before, after, freedom, with_heading })
    }

    /// z at a turn of START, and its slope.
    fn contrasts(&self, turn: f64) -> (Contrasts, Contrasts) {
        let (sin, cos) = libm::sincos(turn);
        let back = Matrix2::new(cos, sin, -sin, cos);
        let slope = Matrix2::new(-sin, cos, -cos, -sin);
        let absolute = self.after.apart() + self.after.computed_apart();
        let position = back * absolute - self.after.computed_apart() - self.before.apart();
        let (mut z, mut slopes) = (Contrasts::zeros(), Contrasts::zeros());
        z.fixed_rows_mut::<2>(0).copy_from(&position);
        slopes.fixed_rows_mut::<2>(0).copy_from(&(slope * absolute));
        if self.with_heading {
            for side in 0..2 {
                z[2 + side] = wrap(self.after.heading(side) - self.before.heading(side) - turn);
                slopes[2 + side] = -1.0;
            }
        }
        (z, slopes)
    }

    /// The turn that leaves least; `None` where Newton's method finds none.
    fn turn(&self) -> Option<f64> {
        let mut turn = 0.0;
        for _ in 0..STEPS {
            let (z, slopes) = self.contrasts(turn);
            let step = -slopes.dot(&(self.inverse * z)) / slopes.dot(&(self.inverse * slopes));
            if !step.is_finite() {
                return None;
            }
            turn = wrap(turn + step);
            if step.abs() < 1e-10 {
                return Some(turn);
            }
        }
        None
    }

    /// Where START is after this turn, and p of what it leaves with so many degrees of freedom.
    fn moved(&self, turn: f64, q: f64) -> Option<StartMoved> {
        let (z, _) = self.contrasts(turn);
        let others = self.freedom - q + 1.0;
        if others <= 0.0 {
            return None;
        }
        let p = f_upper_tail(z.dot(&(self.inverse * z)) * others / (self.freedom * q), [q, others]);
        let (sin, cos) = libm::sincos(turn);
        let turned = Matrix2::new(cos, -sin, sin, cos);
        let by = |side: usize| {
            let [before, after] = [&self.before, &self.after].map(|test| test.error(side));
            let computed = self.after.computed[side];
            after + computed - turned * (before + computed)
        };
        let both = 0.5 * (by(0) + by(1));
        Some(StartMoved { x: both.x, y: both.y, heading: None, p })
    }
}

impl Returns {
    fn of(test: &Learned) -> Option<Returns> {
        let AnyEvidence::Ends(ends) = &test.evidence else { return None };
        let [cw, ccw] = [Direction::Cw, Direction::Ccw].map(|direction| errors(ends, direction));
        let errors = [Cluster::of(&cw)?, Cluster::of(&ccw)?];
        let computed = [Direction::Cw, Direction::Ccw].map(|direction| mean_computed(ends, direction));
        Some(Returns { errors, computed, scatter: Scatter::pooled(&cw, &ccw)? })
    }

    fn error(&self, side: usize) -> Vector2<f64> {
        Vector2::new(self.errors[side].x, self.errors[side].y)
    }

    fn heading(&self, side: usize) -> f64 {
        self.errors[side].heading.unwrap_or(0.0)
    }

    fn apart(&self) -> Vector2<f64> {
        self.error(0) - self.error(1)
    }

    fn computed_apart(&self) -> Vector2<f64> {
        self.computed[0] - self.computed[1]
    }
}

fn at_position(covariance: &Matrix3<f64>) -> Matrix2<f64> {
    covariance.fixed_view::<2, 2>(0, 0).into_owned()
}

fn errors(ends: &Ends, direction: Direction) -> Vec<ReturnError> {
    let error =
        |left: &Vector3<f64>| ReturnError { x: left.x, y: left.y, heading: ends.with_heading.then_some(left.z) };
    let all = ends.errors();
    ends.runs.iter().zip(&all).filter(|(run, _)| run.direction == direction).map(|(_, left)| error(left)).collect()
}

fn mean_computed(ends: &Ends, direction: Direction) -> Vector2<f64> {
    let nominal = Model::new(&ends.robot);
    let values: Vec<f64> = nominal.values().collect();
    let all = ends.predict::<f64>(&nominal, &values);
    let of_direction: Vec<Vector2<f64>> = ends
        .runs
        .iter()
        .zip(all)
        .filter(|(run, _)| run.direction == direction)
        .map(|(_, pose)| Vector2::new(pose.x, pose.y))
        .collect();
    of_direction.iter().sum::<Vector2<f64>>() / of_direction.len().max(1) as f64
}
