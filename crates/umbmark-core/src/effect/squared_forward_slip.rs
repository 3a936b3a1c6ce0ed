//! Slip ahead that grows with the square of the body's speed and turns nothing.

use super::slip_powers::AHEAD;
use super::squared_speed_slip::{PER_SQUARE, loses};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::SquaredForwardSlip;

pub(super) static EFFECT: Entry = Entry::of::<SquaredForwardSlip>().wheels::<SquaredForwardSlip>();

impl Effect for SquaredForwardSlip {
    const ABOUT: About = About {
        name: "squared_forward_slip",
        title: "slip ahead by the square of the speed",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "squared-forward-slip",
            meaning: "share of the way ahead that is lost at a speed of 1 m/s of the body",
            ..PER_SQUARE
        }],
        equation: "s_w ← s_w - k v² (s_L + s_R)/2  for both wheels, v the mean speed of their rims",
        physics: "The drag of air or water grows with the square of the speed. Both wheels share it and creep at the same speed: the robot \
                  gets less far, and turns as far as it counts.",
        signature: "Ways are short by the share k v², and headings are right. At a single speed this is E_s with E_b of the same size.",
        confused_with: &["forward_slip", "squared_speed_slip", "scale", "wheelbase"],
        separated_by: "one straight leg at each of three speeds, the lowest one slow, measured by tape",
        source: "linear creep of a rolling tyre at a common slip speed, under the drag of air; 3 % at 1 m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        loses(p[0], "the body gets")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &AHEAD
    }
}
