//! Motion from each measurement to the next.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "motion",
    about: "scan matching, visual odometry, poses of a map that drifts: how the robot moved since the last measurement",
    position: Told::Steps,
    heading: Told::Steps,
    shows: "steps show E_d, E_b and E_s as far as the sensor's own scale is right; clock, lever arm and yaw of the sensor are fitted, single \
            steps that are wrong are left out, and what the sensor itself adds steadily to each step does not show",
};
