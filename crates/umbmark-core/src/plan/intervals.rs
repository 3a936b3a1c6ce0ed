//! How wide the interval of E_max,sys will be.

use super::Setting;
use crate::dataset::ReturnError;
use crate::evidence::ends::mirrored;
use crate::path::Direction;
use crate::random::Stream;
use crate::score::{Scatter, e_max_sys_interval, noise_band, summarise};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Purpose of the stream that the runs are drawn from.
const INTERVALS: u64 = 13;

/// E_max,sys of a test of n + n runs, and its interval, over simulated tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedInterval {
    /// n.
    pub runs: usize,
    /// Mean of E_max,sys as measured \[m\]: more than that of the robot, since scatter adds to a distance.
    pub mean: f64,
    /// Its standard deviation from test to test \[m\].
    pub std_dev: f64,
    /// Mean of half the width of its interval \[m\].
    pub half_width: f64,
    /// Share of intervals that hold the E_max,sys of the robot itself.
    pub coverage: f64,
    /// Number of simulated tests.
    pub tests: u32,
    /// What a robot without any systematic error stays below with the same probability \[m\].
    pub noise_band: f64,
}

/// The interval of E_max,sys at each number of runs, by so many simulated tests each, return errors being normal.
pub fn intervals(setting: &Setting, runs: &[usize], level: f64, tests: u32, seed: u64) -> Vec<ExpectedInterval> {
    let root = setting.covariance.cholesky().map_or(Matrix3::zeros(), |c| c.l());
    runs.par_iter().map(|n| interval(setting, &root, *n, level, tests, seed)).collect()
}

fn interval(setting: &Setting, root: &Matrix3<f64>, n: usize, level: f64, tests: u32, seed: u64) -> ExpectedInterval {
    let truth = setting.e_max_sys();
    let (mut sum, mut squares, mut widths, mut held) = (0.0, 0.0, 0.0, 0u32);
    for test in 0..tests {
        let mut stream = Stream::new(seed, INTERVALS, u64::from(test));
        let [cw, ccw] = Direction::BOTH.map(|d| drawn(&setting.means[d as usize], root, d, n, &mut stream));
        let summary = summarise(&cw, &ccw);
        let (Some(cw_mean), Some(ccw_mean), Some(scatter)) = (summary.cw, summary.ccw, Scatter::pooled(&cw, &ccw))
        else {
            continue;
        };
        let from_truth = cw_mean.distance().max(ccw_mean.distance()) - truth;
        let interval = e_max_sys_interval(&cw_mean, &ccw_mean, &scatter, level);
        sum += from_truth;
        squares += from_truth * from_truth;
        widths += 0.5 * (interval.high - interval.low);
        held += u32::from(interval.contains(truth));
    }
    let count = f64::from(tests);
    let mean = sum / count;
    ExpectedInterval {
        runs: n,
        mean: truth + mean,
        std_dev: ((squares / count - mean * mean).max(0.0) * count / (count - 1.0).max(1.0)).sqrt(),
        half_width: widths / count,
        coverage: f64::from(held) / count,
        tests,
        noise_band: noise_band(setting.sigma(), n, n, level),
    }
}

/// n return errors about their mean.
pub(super) fn drawn(
    mean: &ReturnError,
    root: &Matrix3<f64>,
    direction: Direction,
    n: usize,
    stream: &mut Stream,
) -> Vec<ReturnError> {
    let run = |_| {
        let noise = mirrored(direction, &(root * Vector3::new(stream.normal(), stream.normal(), stream.normal())));
        ReturnError { x: mean.x + noise.x, y: mean.y + noise.y, heading: mean.heading.map(|h| h + noise.z) }
    };
    (0..n).map(run).collect()
}
