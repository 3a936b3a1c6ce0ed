//! A whole test written down as a dataset.

use super::{Odometry, Phase, SimulateError, Simulator, Truth};
use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::{Model, TestKind};
use crate::engine::Update;
use crate::path::{Direction, Path};

/// Default sampling rate of the counters, if the robot has none \[Hz\].
const LOG_RATE: f64 = 100.0;

/// Whether bumps are placed, so that there is an extended test to drive.
pub fn is_extended(model: &Model) -> bool {
    model.get("placed_bumps", "count").is_some_and(|count| count > 0.0)
}

/// Drives tests of as many runs \[cw, ccw\] each and writes them down: ticks at the robot's encoder rate, or at 100 Hz, and
/// absolute poses `reference_rate` times a second; at 0 Hz only the last one. Of a drive without [tick
/// logs](crate::drive::DriveKind::has_tick_logs), returns alone. Its random numbers are those of a trial of a seed.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::{Model, TestKind}, path::Path, simulate::record_test};
/// let data = record_test(&Model::new(&Robot::labmate()), &Path::umbmark(), &[TestKind::Systematic], [1, 1], 0.0, [1, 0])?;
/// assert_eq!((data.runs.len(), data.runs[0].name.as_str()), (2, "cw_01"));
/// # Ok::<(), umbmark_core::simulate::SimulateError>(())
/// ```
pub fn record_test(
    model: &Model,
    path: &Path,
    tests: &[TestKind],
    runs: [usize; 2],
    reference_rate: f64,
    [seed, trial]: [u64; 2],
) -> Result<Dataset, SimulateError> {
    let encoder = &model.robot().encoder;
    let rate = encoder.rate().unwrap_or(LOG_RATE);
    let encoder = encoder.with_rate(Some(rate))?;
    let robot = Robot { encoder, ..model.robot().clone() };
    let odometry = Odometry::Sampled { rate, update: Update::Arc };
    let mut simulator = Simulator::new(&robot, path, odometry, Phase::Random)?;
    let mut truth = Truth::new(model);
    simulator.open(&mut truth, seed, trial);
    let at_end = reference_rate == 0.0;
    let mut recorded = Vec::new();
    for &test in tests {
        for (direction, count) in Direction::BOTH.into_iter().zip(runs) {
            for number in 1..=count as u32 {
                let (log, returned) = if robot.drive.kind().has_tick_logs() {
                    let rates = [rate, if at_end { rate } else { reference_rate }];
                    let mut recording = simulator.record(&mut truth, direction, test, rates)?;
                    if at_end {
                        let last = recording.log.reference.len() - 1;
                        recording.log.reference.drain(..last);
                    }
                    (Some(recording.log), recording.returned)
                } else {
                    (None, simulator.run(&mut truth, direction, test))
                };
                let prefix = if test == TestKind::Bumps { "bumps_" } else { "" };
                recorded.push(Run {
                    name: format!("{prefix}{}_{number:02}", direction.name()),
                    number,
                    direction: Some(direction),
                    test,
                    log,
                    returned: Some(returned),
                });
            }
        }
    }
    Ok(Dataset { robot: Some(robot), path: Some(path.clone()), runs: recorded, ..Dataset::default() })
}
