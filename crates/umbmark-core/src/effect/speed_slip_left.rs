//! Slip of the left wheel that grows with its speed.

use super::slip_powers::OF_LEFT_WHEEL;
use super::speed_slip::{CREEP, PER_SPEED, creeps};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::SpeedSlipLeft;

pub(super) static EFFECT: Entry = Entry::of::<SpeedSlipLeft>().wheels::<SpeedSlipLeft>();

impl Effect for SpeedSlipLeft {
    const ABOUT: About = About {
        name: "speed_slip_left",
        title: "slip that grows with speed, left wheel",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "speed-slip-left",
            meaning: "share of its travel that the left wheel loses per m/s of its speed",
            ..PER_SPEED
        }],
        equation: "s_L ← (1 - k |v_L|) s_L,  v_L the speed of its rim",
        physics: CREEP,
        signature: "Legs curve to the left by k v/b per metre, and turns lose half the share. On legs of a single speed it looks like \
                    E_d.",
        confused_with: &["wheel_diameter_ratio", "speed_slip_right", "missed_counts"],
        separated_by: "a long straight leg at two speeds: the curvature from E_d is the same at both",
        source: "linear creep of a rolling tyre; 1.5 % per m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        creeps(p[0], "the left wheel gets")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &OF_LEFT_WHEEL
    }
}
