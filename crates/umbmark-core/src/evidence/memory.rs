//! How much memory the tests of a model need, told before they begin.

use super::Level;
use crate::dataset::{Dataset, TickLog};
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::likelihood::BLOCK;
use crate::run::dead_reckoning::computed_poses;

/// Memory for each block of a track and each return pose \[bytes\]: measured with `umbmark diagnose` on a differential drive, 10 runs of 438
/// blocks, 24 of 548 and 250 of 438 (18 to 20 kB a block), and 2000 to 20 000 return poses (25 to 28 kB).
const PER_BLOCK: u64 = 20_000;
const PER_RETURN: u64 = 27_000;
/// Memory for each reading of the counters \[bytes\].
const PER_READING: u64 = 500;

/// About how much memory [`diagnose`](crate::diagnose::diagnose), [`learn`](crate::learn::learn) and all that is made of them need for a
/// dataset \[bytes\].
///
/// Every known error source has a column, with a row a block of poses; all of them are kept, for they are looked at again and again. The
/// figure holds within a quarter for drives of two wheels; steered ones have fewer error sources.
pub fn memory_of_tests(data: &Dataset) -> u64 {
    let Some(robot) = &data.robot else { return 0 };
    let runs = data.runs.iter().filter(|run| run.test == TestKind::Systematic);
    match Level::of(data) {
        Level::Ends => PER_RETURN * runs.count() as u64,
        Level::Tracks => {
            let logs = runs.filter_map(|run| run.log.as_ref());
            logs.map(|log| PER_BLOCK * blocks(log, robot) + PER_READING * log.time.len() as u64).sum()
        }
    }
}

/// How many blocks the poses of a log make.
fn blocks(log: &TickLog, robot: &Robot) -> u64 {
    let poses = computed_poses(log, robot);
    let (mut count, mut way, mut turned) = (0, f64::INFINITY, 0.0);
    let mut before = 0;
    for sample in log.reference.iter().map(|pose| pose.sample).filter(|sample| *sample < poses.len()) {
        for pair in poses[before..=sample].windows(2) {
            way += libm::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y);
            turned += (pair[1].heading - pair[0].heading).abs();
        }
        before = sample;
        if way >= BLOCK.0 || turned >= BLOCK.1 {
            (count, way, turned) = (count + 1, 0.0, 0.0);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Model;
    use crate::likelihood::{Observed, watched::watched};

    #[test]
    fn blocks_are_counted_as_they_are_made_and_cost_what_was_measured() {
        let robot = Robot::labmate();
        let data = watched(&Model::new(&robot), 2, 3);
        let made: usize = Observed::new(&data, &robot).unwrap().runs.iter().map(|run| run.blocks.len()).sum();
        let counted: u64 = data.runs.iter().filter_map(|run| run.log.as_ref()).map(|log| blocks(log, &robot)).sum();
        assert!(counted.abs_diff(made as u64) * 20 <= made as u64, "{counted} counted, {made} made");
        let readings: usize = data.runs.iter().filter_map(|run| run.log.as_ref()).map(|log| log.time.len()).sum();
        assert_eq!(memory_of_tests(&data), 20_000 * counted + 500 * readings as u64);
        assert_eq!(memory_of_tests(&Dataset { robot: None, ..data }), 0);
    }
}
