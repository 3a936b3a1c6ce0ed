//! A carpet whose pile leans one way.

use super::floor_slope::{DRIFT, DRIFT_X, DRIFT_Y, carried, drift};
use super::{About, ActsOn, BodyLaw, Context, Effect, Entry, at_work};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// A drift along the pile, whatever the heading.
pub struct CarpetNap;

pub(super) static EFFECT: Entry = Entry::of::<CarpetNap>().body::<CarpetNap>();

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
        physics: "Fibres that lean one way lie down under the wheel and carry it along: a drift with the pile, proportional \
                  to the way driven.",
        signature: "That of a sloping floor, to the last digit: the return point is off by the drift times the length of the \
                    path, alike in ccw and cw. It ends where the carpet does.",
        confused_with: &["floor_slope", "start_pose"],
        separated_by: "turning the carpet by 90 degrees: nap turns with it, slope stays. Nothing else does",
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

impl BodyLaw for CarpetNap {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
        drift(p, at, motion);
    }
}
