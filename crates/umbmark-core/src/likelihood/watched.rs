//! Simulated runs that were observed on the way, for tests.

use crate::dataset::{Dataset, Run};
use crate::effect::{Model, TestKind};
use crate::path::{Direction, Path, SQUARE, SpeedProfile};
use crate::simulate::{Odometry, Phase, Simulator, Truth};

/// `runs` squares of 2 m each way, watched at 20 Hz.
pub(crate) fn watched(model: &Model, runs: u64, seed: u64) -> Dataset {
    watched_on(&Path::new(&SQUARE, &[2.0], SpeedProfile::default()).unwrap(), model, runs, seed)
}

/// `runs` runs each way on a path, watched at 20 Hz.
pub(crate) fn watched_on(path: &Path, model: &Model, runs: u64, seed: u64) -> Dataset {
    let robot = model.robot();
    let mut simulator = Simulator::new(robot, path, Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(model);
    let mut data = Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs: vec![], ..Dataset::default() };
    for (direction, number) in Direction::BOTH.into_iter().flat_map(|d| (0..runs).map(move |n| (d, n))) {
        simulator.open(&mut truth, seed, 2 * number + direction as u64);
        let recording = simulator.record(&mut truth, direction, TestKind::Systematic, [100.0, 20.0]).unwrap();
        data.runs.push(Run {
            name: format!("{}_{number}", direction.name()),
            number: number as u32,
            direction: Some(direction),
            test: TestKind::Systematic,
            log: Some(recording.log),
            returned: Some(recording.returned),
        });
    }
    data
}
