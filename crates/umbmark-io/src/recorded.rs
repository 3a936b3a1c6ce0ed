//! Logs that are in memory, put together as those of files are.

use super::assembly::Assembly;
use super::error::DatasetError;
use super::label;
use super::recording::Recording;
use super::robot_file::RobotFile;
use umbmark_core::dataset::{Dataset, ReferencePose};
use umbmark_core::drive::Robot;
use umbmark_core::path::Path;
use umbmark_core::run::dead_reckoning::EndPose;

/// A log in memory, with the columns of `runs/*.csv` as they were recorded: counters may roll over, and poses may have a frame of their
/// own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Its name, read as that of a file: `cw_01` tells direction and number.
    pub name: String,
    /// What messages call the columns of time, left and right counter.
    pub columns: [String; 3],
    /// Time of each row \[s\].
    pub time: Vec<f64>,
    /// Readings of the left and the right counter.
    pub counts: [Vec<f64>; 2],
    /// Absolute poses, in the order of their rows.
    pub reference: Vec<ReferencePose>,
}

/// The dataset of a robot and logs in memory. Rows are mended and START is found as for files; messages count rows from 0.
///
/// # Errors
///
/// Where a file with these rows would be refused.
pub fn assemble(robot: Option<Robot>, path: Option<Path>, logs: Vec<Recorded>) -> Result<Dataset, DatasetError> {
    let mut assembly = Assembly::new(robot.map(|robot| RobotFile::new(robot, path.clone())));
    for Recorded { name, columns, time, counts, reference } in logs {
        let lines = (0..time.len()).collect();
        let file = name.clone();
        let (columns, counts) = (columns.to_vec(), counts.to_vec());
        let recording = Recording { file, columns, lines, time, counts, reference, ..Recording::default() };
        assembly.add_recording(recording, None, &name, label::parse(&name), EndPose::Standing)?;
    }
    Ok(Dataset { path, ..assembly.finish()? })
}
