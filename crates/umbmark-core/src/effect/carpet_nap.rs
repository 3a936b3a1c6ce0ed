//! A carpet whose pile leans one way.

use super::floor_slope::{DRIFT, DRIFT_X, DRIFT_Y, carried};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::CarpetNap;

pub(super) static EFFECT: Entry = Entry::of::<CarpetNap>().body::<CarpetNap>().of_floor();

impl Effect for CarpetNap {
    const ABOUT: About = About {
        name: "carpet_nap",
        title: "drift with the nap of a carpet",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter {
                flag: "nap-x",
                meaning: "drift with the nap along the heading at START, per metre driven",
                ..DRIFT_X
            },
            Parameter {
                flag: "nap-y",
                meaning: "drift with the nap to the left of the heading at START, per metre driven",
                ..DRIFT_Y
            },
        ],
        equation: DRIFT,
        physics: "The fibres of a carpet lean one way. They bend under a rolling wheel and carry it along: the robot drifts with the \
                  pile, in proportion to the distance driven.",
        signature: "The same as a sloping floor: the return point is off by the drift times the length of the path, equally in ccw and \
                    cw. The drift ends where the carpet ends.",
        confused_with: &["floor_slope", "start_pose"],
        separated_by: "turning the carpet by 90 degrees, and nothing else: drift from the nap turns with the carpet, drift from a slope \
                       does not",
        source: "the carpet-drift vector of vacuum robots (patents of iRobot, US 9,223,312 and family); size assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("{}.", carried(p, "on each metre"))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}
