//! Slip of the right wheel that grows with its speed.

use super::slip_powers::OF_RIGHT_WHEEL;
use super::speed_slip::{CREEP, PER_SPEED, creeps};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::SpeedSlipRight;

pub(super) static EFFECT: Entry = Entry::of::<SpeedSlipRight>().wheels::<SpeedSlipRight>();

impl Effect for SpeedSlipRight {
    const ABOUT: About = About {
        name: "speed_slip_right",
        title: "slip that grows with speed, right wheel",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "speed-slip-right",
            meaning: "share of its travel that the right wheel loses per m/s of its speed",
            ..PER_SPEED
        }],
        equation: "s_R ← (1 - k |v_R|) s_R,  v_R the speed of its rim",
        physics: CREEP,
        signature: "Legs curve to the right by k v/b per metre, and turns lose half the share. On legs of a single speed it looks like \
                    E_d.",
        confused_with: &["wheel_diameter_ratio", "speed_slip_left", "missed_counts"],
        separated_by: "a long straight leg at two speeds: the curvature from E_d is the same at both",
        source: "linear creep of a rolling tyre; 1.5 % per m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        creeps(p[0], "the right wheel gets")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &OF_RIGHT_WHEEL
    }
}
