//! Tracks in the frame of the room, re-expressed in the frame of START.
//!
//! The poses of a log are meant to be in the frame of START: origin where the robot's odometry was set to zero, x axis
//! along its heading. Then the poses measured before the first motion lie at the origin but for noise and for the
//! misplacement of the robot by hand, and they are kept. A track that begins farther away than anyone misplaces a robot
//! is in the frame of the room; it is turned and shifted by the mean of the poses measured before the first motion.

use super::TickLog;
use super::dead_reckoning::{mean_pose, standing_at_start};
use super::error::DatasetError;
use crate::geometry::{Pose2, wrap};

/// Misplacement by hand stays below these \[m, rad\].
const HAND: (f64, f64) = (0.10, 0.10);
/// Less is not worth a word \[m, rad\].
const SMALL: (f64, f64) = (0.010, 0.010);

/// Moves the track of a log into the frame of START, where it is not there yet.
pub(super) fn move_to_start(file: &str, log: &mut TickLog, warnings: &mut Vec<String>) -> Result<(), DatasetError> {
    let Some(start) = mean_pose(standing_at_start(log)) else { return Ok(()) };
    let distance = libm::hypot(start.x, start.y);
    let turn = wrap(start.heading.unwrap_or(0.0));
    let beyond = |limit: (f64, f64)| distance > limit.0 || turn.abs() > limit.1;
    let place = format!("{:.3} m and {:.1} deg from the origin", distance, turn.to_degrees());
    if !beyond(HAND) {
        if beyond(SMALL) {
            warnings.push(format!("{file}: the track starts {place}; taken as misplacement of the robot at START"));
        }
        return Ok(());
    }
    let Some(heading) = start.heading else {
        let distance = (distance * 1e3).round() / 1e3;
        return Err(DatasetError::NoStartHeading { file: file.to_owned(), distance });
    };
    let start = Pose2::new(start.x, start.y, heading);
    for pose in &mut log.reference {
        let seen = start.between(&Pose2::new(pose.x, pose.y, pose.heading.unwrap_or(heading)));
        (pose.x, pose.y, pose.heading) = (seen.x, seen.y, pose.heading.map(|_| seen.heading));
    }
    warnings.push(format!(
        "{file}: the track starts {place}; taken as poses in the room, and turned into the frame of START"
    ));
    Ok(())
}
