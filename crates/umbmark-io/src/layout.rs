//! The layouts that datasets are written in.
//!
//! A layout holds what it can hold; what it cannot is said in words, never left out silently.

mod optiodom;
mod returns;
mod tum;

use super::error::DatasetError;
use super::mcap::save_mcap;
use super::save::{Existing, save};
use std::path::Path;
use umbmark_core::dataset::{Dataset, Run, TickLog};

/// A layout that datasets are written in.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// What it is called.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    write: Write,
}

/// Writes a dataset into a folder and says what is lost.
type Write = fn(&Dataset, &Path, Existing) -> Result<Vec<String>, DatasetError>;

/// All of them.
pub static LAYOUTS: &[Layout] = &[
    Layout { name: "csv", about: "robot.toml, returns.csv and runs/*.csv: holds everything", write: csv },
    Layout { name: "mcap", about: "the same with logs of ROS 2, runs/*.mcap; one run as NAME.mcap", write: mcap },
    Layout { name: "optiodom", about: "a set of OptiOdom: *_metadata.csv and *_run-NN.csv", write: optiodom::write },
    Layout { name: "tum", about: "TUM trajectories: *_reference.tum and *_odometry.tum", write: tum::write },
    Layout { name: "returns", about: "the return sheet alone: returns.csv", write: returns::write },
];

impl Layout {
    /// The layout of a name.
    pub fn named(name: &str) -> Option<&'static Layout> {
        LAYOUTS.iter().find(|layout| layout.name == name)
    }

    /// The layout that the name of a place asks for: `mcap` where it ends in `.mcap`, else `csv`.
    pub fn of_place(place: impl AsRef<Path>) -> &'static Layout {
        let is_log = place.as_ref().extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
        &LAYOUTS[usize::from(is_log)]
    }

    /// Writes a dataset into a folder, and says what this layout cannot hold, one sentence each.
    ///
    /// # Errors
    ///
    /// Where files are there already and are to be kept, where the layout can hold nothing of the dataset, and where the
    /// system does not let us write.
    pub fn write(
        &self,
        data: &Dataset,
        folder: impl AsRef<Path>,
        existing: Existing,
    ) -> Result<Vec<String>, DatasetError> {
        (self.write)(data, folder.as_ref(), existing)
    }
}

fn logs(data: &Dataset) -> impl Iterator<Item = (&Run, &TickLog)> {
    data.runs.iter().filter_map(|run| Some((run, run.log.as_ref()?)))
}

fn mcap(data: &Dataset, place: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    save_mcap(data, place, existing)
}

/// The project's own layout. Counts between two readings, which a track put there, are no counts of a counter that rolls over:
/// then they are written as they are, unrolled.
fn csv(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let between = |log: &TickLog| log.left.iter().chain(&log.right).any(|ticks| ticks.fract() != 0.0);
    let robot = data.nominal_robot()?;
    let encoder = &robot.encoder;
    if encoder.counter_bits().is_none() || !logs(data).any(|(_, log)| between(log)) {
        return save(data, folder, existing).map(|()| Vec::new());
    }
    let mut unrolled = data.clone();
    let mut robot = robot.clone();
    robot.encoder = encoder.without_roll_over();
    unrolled.robot = Some(robot);
    save(&unrolled, folder, existing)?;
    Ok(vec!["counter_bits: counts were put between readings, so all are written with their roll-overs undone".into()])
}

#[cfg(test)]
mod tests;
