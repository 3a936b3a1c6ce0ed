//! Where the runs went: as measured, as computed by the robot, and as a model has it.

use umbmark_core::geometry::Pose2;
use umbmark_core::path::Direction;

use super::{Absent, Driven, Drives, Study};

/// The paths of all runs.
#[derive(Clone, Debug)]
pub struct Paths {
    /// In the order of the dataset.
    pub runs: Vec<RunPath>,
    /// Whether the robot's own paths were recorded; if not, they are those that it was told to drive.
    pub recorded: bool,
}

/// The path of a run.
#[derive(Clone, Debug)]
pub struct RunPath {
    /// Its index in the dataset.
    pub run: usize,
    /// Its sense.
    pub direction: Option<Direction>,
    /// As the robot computed it.
    pub computed: Vec<[f64; 2]>,
    /// As the model has it, beside the computed places.
    pub modelled: Vec<[f64; 2]>,
    /// As measured, each with where the robot computed to be.
    pub measured: Vec<([f64; 2], [f64; 2])>,
    /// Whether the measured places make a line.
    pub dense: bool,
}

impl Paths {
    pub(super) fn new(study: &Study) -> Result<Paths, Absent> {
        study.data.nominal_robot().map_err(Absent::because)?;
        let model = study.model()?;
        let Drives { runs, recorded } = Drives::of(&study.data)?;
        let path = |driven: &Driven| {
            let computed = xy(&driven.computed);
            let measured = driven.measured.iter().map(|(seen, place)| (*seen, computed[*place])).collect();
            let modelled = xy(&driven.modelled(model));
            let Driven { run, direction, dense, .. } = *driven;
            RunPath { run, direction, computed, modelled, measured, dense }
        };
        Ok(Paths { runs: runs.iter().map(path).collect(), recorded })
    }
}

fn xy(poses: &[Pose2]) -> Vec<[f64; 2]> {
    poses.iter().map(|pose| [pose.x, pose.y]).collect()
}
