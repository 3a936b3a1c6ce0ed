//! What the files of a dataset are called, and what stands in them for a number that is to be filled in.

use std::path::{Path, PathBuf};

pub(crate) const ROBOT: &str = "robot.toml";
pub(crate) const RETURNS: &str = "returns.csv";
pub(crate) const RUNS: &str = "runs";

/// What stands in place of a number that is to be filled in. A file that still has it is refused.
pub(crate) const FILL_IN: &str = "fill in";

/// The robot.toml of a file in `folder`: in it, or above it where it is called runs.
pub(crate) fn robot_beside(folder: &Path) -> Option<PathBuf> {
    let in_runs = folder.file_name().is_some_and(|name| name == RUNS);
    let above = in_runs.then(|| folder.join("..").join(ROBOT));
    [Some(folder.join(ROBOT)), above].into_iter().flatten().find(|robot| robot.is_file())
}
