//! Slip ahead that grows with the speed of the body and turns nothing.

use super::slip_powers::AHEAD;
use super::speed_slip::{PER_SPEED, creeps};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::ForwardSlip;

pub(super) static EFFECT: Entry = Entry::of::<ForwardSlip>().wheels::<ForwardSlip>();

impl Effect for ForwardSlip {
    const ABOUT: About = About {
        name: "forward_slip",
        title: "slip ahead that grows with speed, rotations unchanged",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "forward-slip",
            meaning: "share of the way ahead that is lost per m/s of the body's speed",
            ..PER_SPEED
        }],
        equation: "s_w ← s_w - k |v| (s_L + s_R)/2  for both wheels, v the mean speed of their rims",
        physics: "What holds the robot back, such as air or a load that it pulls, is shared by both wheels, and both creep at the same speed: \
                  the robot gets less far, and turns as far as it counts.",
        signature: "Ways are short by the share k v, and headings are right. At a single speed this is E_s with E_b of the same size.",
        confused_with: &["body_speed_slip", "speed_slip", "squared_forward_slip", "scale", "wheelbase"],
        separated_by: "an arc at each of two speeds, with its heading measured at the end",
        source: "linear creep of a rolling tyre at a common slip speed; 1.5 % per m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        creeps(p[0], "the body gets")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &AHEAD
    }
}
