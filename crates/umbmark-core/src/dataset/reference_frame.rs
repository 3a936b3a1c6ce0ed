//! How measured poses are counted, where it is not as it is meant: y to the left of x, headings counter-clockwise.

use crate::run::{ReferencePose, ReferenceTrack};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The table `[reference]` of `robot.toml`. What it says is mended while logs are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReferenceFrame {
    /// y grows to the right of x.
    pub y_mirrored: bool,
    /// Headings grow clockwise.
    pub heading_clockwise: bool,
    /// The tracked body faces backward: its heading is half a turn from the robot's.
    pub heading_backward: bool,
    /// Each pose tells only how the robot moved since the one before: the track drifts.
    pub drifting: bool,
}

impl ReferenceFrame {
    /// Each key with what it says here and what it means.
    pub fn keys(&self) -> [(&'static str, bool, &'static str); 4] {
        [
            ("y_mirrored", self.y_mirrored, "y_ref grows to the right of x_ref"),
            ("heading_clockwise", self.heading_clockwise, "theta_ref grows clockwise"),
            ("heading_backward", self.heading_backward, "theta_ref is that of the robot's tail"),
            ("drifting", self.drifting, "a pose tells the motion since the one before"),
        ]
    }

    /// Poses as they are meant.
    pub fn mend(&self, poses: &mut [ReferencePose]) {
        for pose in poses {
            self.mend_one(&mut pose.y, pose.heading.as_mut());
        }
    }

    /// The same of a track with a clock of its own.
    pub fn mend_track(&self, track: &mut ReferenceTrack) {
        track.y.iter_mut().for_each(|y| self.mend_one(y, None));
        track.heading.iter_mut().flatten().for_each(|heading| self.mend_one(&mut 0.0, Some(heading)));
    }

    fn mend_one(&self, y: &mut f64, heading: Option<&mut f64>) {
        if self.y_mirrored {
            *y = -*y;
        }
        if let Some(heading) = heading {
            let counter_clockwise = if self.heading_clockwise { -*heading } else { *heading };
            *heading = if self.heading_backward { counter_clockwise + PI } else { counter_clockwise };
        }
    }
}
