//! A test that turns out exactly as expected.

use super::Setting;
use crate::dataset::{Dataset, ReturnError, Run};
use crate::effect::TestKind;
use crate::evidence::ends::mirrored;
use crate::path::Direction;
use nalgebra::Vector3;

/// A test of n + n runs (3 or more) whose means are the robot's own and whose pooled scatter is the expected one, to rounding.
///
/// Within each direction, run i lies at √(ν/n) · (u cos φ + v sin φ ± w cos φ), φ = 2πi/n, from its mean, where u, v, w are
/// the columns of the covariance's root and the sign is that of the direction: these have mean zero, and their squares add
/// up to ν = 2n - 2 times the covariance.
pub fn expected_dataset(setting: &Setting, n: usize) -> Dataset {
    let places = Direction::BOTH.map(|direction| vec![direction; n]).concat();
    displaced(setting, &places, |_| Vector3::zeros())
}

/// The same with runs in any order, each displaced by some return error of its own; `displacement` is told its place in the session.
pub(super) fn displaced(
    setting: &Setting,
    order: &[Direction],
    displacement: impl Fn(usize) -> Vector3<f64>,
) -> Dataset {
    let mut numbers = [0; 2];
    let run = |(place, direction): (usize, &Direction)| {
        let number = &mut numbers[*direction as usize];
        *number += 1;
        let error = expected(setting, *direction, *number, order.len() / 2) + displacement(place);
        let heading = setting.with_heading.then_some(error.z);
        Run {
            name: format!("{}_{number:02}", direction.name()),
            number: *number as u32,
            direction: Some(*direction),
            test: TestKind::Systematic,
            log: None,
            returned: Some(ReturnError { x: error.x, y: error.y, heading }),
        }
    };
    Dataset {
        robot: Some(setting.robot().clone()),
        path: Some(setting.path.clone()),
        runs: order.iter().enumerate().map(run).collect(),
        ..Dataset::default()
    }
}

/// Return error of run `number` of n in its direction.
fn expected(setting: &Setting, direction: Direction, number: usize, n: usize) -> Vector3<f64> {
    let mean = setting.means[direction as usize];
    let mean = Vector3::new(mean.x, mean.y, mean.heading.unwrap_or(0.0));
    let Some(root) = setting.covariance.cholesky().map(|c| c.l()) else { return mean };
    let (sine, cosine) = libm::sincos(std::f64::consts::TAU * number as f64 / n as f64);
    let from_mean = root * Vector3::new(cosine, sine, direction.sign() * cosine);
    mean + mirrored(direction, &from_mean) * ((2 * n - 2) as f64 / n as f64).sqrt()
}
