//! Whether a START that lies elsewhere accounts for a change of return errors.
//!
//! A START that moves by (x, y, θ) between two tests adds the same to the return errors of both directions, as long as θ times the return errors
//! themselves is within their scatter: a START that is turned by more is not recognised. With the mean return errors m of each test and
//! direction and the pooled scatter S of the runs,
//!
//! ```text
//! u = (m_cw - m_ccw)_after - (m_cw - m_ccw)_before,   T² = uᵀ V⁻¹ u,   V = Σ S/n over the four means
//! F = T² (ν - k + 1)/(ν k)
//! ```
//!
//! has k and ν - k + 1 degrees of freedom where it is START (k coordinates, ν those of the scatter).
//!
//! Source: Hotelling (1931), Annals of Mathematical Statistics 2, 360.

use super::Learned;
use crate::dataset::ReturnError;
use crate::evidence::{AnyEvidence, Ends};
use crate::path::Direction;
use crate::score::{Cluster, Scatter};
use crate::stats::f_upper_tail;
use nalgebra::{Matrix3, Vector3};

/// How far START lies elsewhere, if that is what changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartMoved {
    /// Along the first leg \[m\].
    pub x: f64,
    /// To its left \[m\].
    pub y: f64,
    /// \[rad\]; `None` where the returns have no headings.
    pub heading: Option<f64>,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// The return errors of a test, clockwise and counter-clockwise.
struct Returns {
    clusters: [Cluster; 2],
    scatter: Scatter,
}

/// Where START went, if that accounts for the change at this size of the test; `None` for tracks, and where one direction was not driven.
pub(super) fn of(tests: &[Learned; 2], size: f64) -> Option<StartMoved> {
    let [before, after] = [Returns::of(&tests[0])?, Returns::of(&tests[1])?];
    let with_heading = before.scatter.with_heading && after.scatter.with_heading;
    let k = if with_heading { 3 } else { 2 };
    let moved = [0, 1].map(|side| mean(&after.clusters[side]) - mean(&before.clusters[side]));
    let freedoms = [&before, &after].map(|test| test.scatter.degrees_of_freedom as f64);
    let freedom = freedoms[0] + freedoms[1];
    let mut variance = Matrix3::zeros();
    for test in [&before, &after] {
        for (cluster, direction) in test.clusters.iter().zip([Direction::Cw, Direction::Ccw]) {
            let pooled = before.scatter.of(direction) * freedoms[0] + after.scatter.of(direction) * freedoms[1];
            variance += pooled / (freedom * cluster.n as f64);
        }
    }
    let apart = (moved[0] - moved[1]).rows(0, k).into_owned();
    let inverse = variance.view((0, 0), (k, k)).into_owned().try_inverse()?;
    let statistic = apart.dot(&(inverse * &apart));
    let others = freedom - k as f64 + 1.0;
    if others <= 0.0 {
        return None;
    }
    let p = f_upper_tail(statistic * others / (freedom * k as f64), [k as f64, others]);
    let both = 0.5 * (moved[0] + moved[1]);
    (p >= size).then_some(StartMoved { x: both.x, y: both.y, heading: with_heading.then_some(both.z), p })
}

impl Returns {
    fn of(test: &Learned) -> Option<Returns> {
        let AnyEvidence::Ends(ends) = &test.evidence else { return None };
        let [cw, ccw] = [Direction::Cw, Direction::Ccw].map(|direction| errors(ends, direction));
        let clusters = [Cluster::of(&cw)?, Cluster::of(&ccw)?];
        Some(Returns { clusters, scatter: Scatter::pooled(&cw, &ccw)? })
    }
}

fn errors(ends: &Ends, direction: Direction) -> Vec<ReturnError> {
    let error =
        |left: &Vector3<f64>| ReturnError { x: left.x, y: left.y, heading: ends.with_heading.then_some(left.z) };
    let all = ends.errors();
    ends.runs.iter().zip(&all).filter(|(run, _)| run.direction == direction).map(|(_, left)| error(left)).collect()
}

fn mean(cluster: &Cluster) -> Vector3<f64> {
    Vector3::new(cluster.x, cluster.y, cluster.heading.unwrap_or(0.0))
}
