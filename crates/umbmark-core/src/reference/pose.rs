//! Whole poses.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "pose",
    about: "motion capture, a tag that a camera in the room sees, a scan matched to a map: position and heading",
    position: Told::InRoom,
    heading: Told::InRoom,
    shows: "poses show E_d, E_b and E_s; the clock, the lever arm and the yaw of the tracked body are fitted",
};
