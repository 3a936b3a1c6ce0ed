//! The files of umbmark: data sets of measured robots, robots, models and long studies, read and written.
//!
//! [`load`] takes a folder (`robot.toml`, `returns.csv`, `runs/*.csv`, `runs/*.mcap`; or one of OptiOdom) or one file of it.
//! Inside, a file of `layout` recognises, reads and writes one layout, a `Recording` mends rows and counts, the core's [`synchronise`](umbmark_core::synchronise) sets the clock of a track by the motion and
//! puts its poses into the log, `start_frame` moves them into the frame of START, and an `Assembly` matches returns with
//! logs.
//!
//! ```no_run
//! let data = umbmark_io::load("my_robot")?;
//! println!("{} runs of {}", data.runs.len(), data.nominal_robot()?.name);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod alike;
mod assembly;
pub mod checkpoint;
mod closures;
mod column_names;
mod columns;
mod conditions;
mod contents;
mod controller_file;
mod corrected;
mod csv_text;

mod distribution_table;
mod document;
mod error;
pub mod export;
mod file_names;
mod filled_in;
mod fleet;
mod foreign;
mod known_numbers;
mod label;
mod layout;
mod lines;
mod lock;
mod model_file;
mod model_text;
#[cfg(test)]
mod mutated_input;

mod parameter_file;
mod probe;
mod proposal;
mod reading_memory;
mod recorded;
mod recording;
mod remedy;
mod robot_file;
mod robot_text;
mod save;
mod sheet;
mod source;
mod spool;
mod stale;
mod start_frame;
mod template;
mod together;

mod track_rows;
mod unfinished;
mod watch_state;
mod wheel_names;
pub mod whole_file;

pub use column_names::ColumnNames;
pub use contents::{contents, has_logs};
pub use controller_file::read_controller;
pub use corrected::CorrectedFormat;
pub use error::{At, DatasetError, LineProblem};
pub use fleet::fleet_in;
pub use known_numbers::{KnownNumber, KnownNumbers};
pub use layout::Layout;
pub use layout::csv::save;
pub use layout::mcap::save_mcap;
pub use layout::messages::{LogProblem, Topics};
pub use model_file::{Doubt, ModelFile};
pub use parameter_file::{ParameterFile, parse_parameters, read_parameters};
pub use proposal::{Proposal, ProposedNumber};
pub use reading_memory::memory_to_read;
pub use recorded::{Recorded, assemble};
pub use remedy::{Argument, Remedy, Words};
pub use robot_file::RobotFile;
pub use save::Existing;
pub use template::{template, write_template};
pub use together::{load_together, load_together_of};
pub use unfinished::take_away_unfinished;
pub use watch_state::{StateError, WatchState};

use std::path::Path;
use umbmark_core::dataset::Dataset;
use umbmark_core::drive::Robot;

/// Reads a dataset folder, an OptiOdom folder, or one file of either. Never touches what it reads.
///
/// A single file is taken with the `robot.toml` beside it, if there is one.
pub fn load(path: impl AsRef<Path>) -> Result<Dataset, DatasetError> {
    load_with(path, &Topics::default())
}

/// Reads a dataset whose MCAP logs hold wheels and reference on the given topics.
pub fn load_with(path: impl AsRef<Path>, topics: &Topics) -> Result<Dataset, DatasetError> {
    layout::load(path.as_ref(), topics, None)
}

/// The same of logs beside which no robot stands: they are of `robot`, where another does not stand there.
pub fn load_of(path: impl AsRef<Path>, topics: &Topics, robot: &Robot) -> Result<Dataset, DatasetError> {
    layout::load(path.as_ref(), topics, Some(&RobotFile::new(robot.clone(), None)))
}
