//! Trajectories for tools that compare them: measured and computed poses of each run.

use super::super::error::DatasetError;
use super::super::label::label;
use super::super::save::{Existing, put};
use super::super::tum::tum_text;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, ReferencePose};
use umbmark_core::run::dead_reckoning::computed_poses;

pub(super) fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let robot = data.nominal_robot()?;
    let mut files = BTreeMap::new();
    let (mut poses, mut without_heading) = (0, 0);
    for (run, log) in super::logs(data) {
        let name = label(run.test, run.direction, run.number);
        let computed = log.time.iter().zip(computed_poses(log, robot));
        let text = tum_text("poses computed from the wheel counts", computed.map(|(t, p)| (*t, p.x, p.y, p.heading)));
        files.insert(PathBuf::from(format!("{name}_odometry.tum")), text);
        let headed = |pose: &ReferencePose| Some((log.time[pose.sample], pose.x, pose.y, pose.heading?));
        let measured: Vec<_> = log.reference.iter().filter_map(headed).collect();
        poses += measured.len();
        without_heading += log.reference.len() - measured.len();
        if !measured.is_empty() {
            let text = tum_text("measured poses", measured.into_iter());
            files.insert(PathBuf::from(format!("{name}_reference.tum")), text);
        }
    }
    if files.is_empty() {
        let reason = "no run has a log, and trajectories are made of logs".into();
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    put(folder, &files, existing, |_| Ok(()))?;
    let mut lost = vec!["counts, robot and path: trajectories hold poses only".to_owned()];
    if without_heading > 0 {
        lost.push(format!("{without_heading} measured poses without a heading, of {}", poses + without_heading));
    }
    if data.runs.iter().any(|run| run.returned.is_some()) {
        lost.push("return errors: they are the difference of the last poses".into());
    }
    if poses > 0 {
        lost.push("full turns of headings".into());
    }
    Ok(lost)
}
