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
    /// How far the wheels had rolled at each of the computed places \[m\].
    pub rolled: Vec<f64>,
    /// As measured, each with its place among the computed ones.
    pub measured: Vec<([f64; 2], usize)>,
    /// Whether the measured places make a line.
    pub dense: bool,
}

impl Paths {
    pub(super) fn new(study: &Study) -> Result<Paths, Absent> {
        study.data.nominal_robot().map_err(Absent::because)?;
        let model = study.model()?;
        let Drives { runs, recorded } = Drives::of(&study.data)?;
        let path = |driven: &Driven| {
            let (computed, modelled) = (xy(&driven.computed), xy(&driven.modelled(model)));
            let Driven { run, direction, dense, .. } = *driven;
            let (rolled, measured) = (driven.rolled.clone(), driven.measured.clone());
            RunPath { run, direction, computed, modelled, rolled, measured, dense }
        };
        Ok(Paths { runs: runs.iter().map(path).collect(), recorded })
    }
}

impl RunPath {
    /// The measured places, each with where the robot was by its own count.
    pub fn pairs(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        self.measured.iter().map(|(at, place)| (*at, self.computed[*place]))
    }
}

fn xy(poses: &[Pose2]) -> Vec<[f64; 2]> {
    poses.iter().map(|pose| [pose.x, pose.y]).collect()
}
