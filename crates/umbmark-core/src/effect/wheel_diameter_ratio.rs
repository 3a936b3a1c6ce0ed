//! E_d: unequal wheel diameters.

use super::words::{deg, either, mm, side};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::WheelDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<WheelDiameterRatio>().wheels::<WheelDiameterRatio>();

impl Effect for WheelDiameterRatio {
    const ABOUT: About = About {
        name: "wheel_diameter_ratio",
        title: "unequal wheel diameters, E_d",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::ratio(
            "e_d",
            "ed",
            1.21e-3,
            (0.5, 2.0),
            "E_d = D_R/D_L, the ratio of the true wheel diameters beyond their nominal ratio",
        )],
        equation: "s_R ← s_R · 2 E_d/(1 + E_d),  s_L ← s_L · 2/(1 + E_d)",
        physics: "No two tyres have exactly the same diameter, and a load off the centre line compresses one tyre more than the other. \
                  The larger wheel rolls further for the same count.",
        signature: "A straight leg becomes an arc of curvature (E_d - 1)/b. Turns on the spot do not change. The return heading error \
                    is L (E_d - 1)/b per side in both driving directions.",
        confused_with: &[
            "direction_dependent_wheelbase",
            "leg_kick",
            "speed_slip_left",
            "speed_slip_right",
            "missed_counts",
        ],
        separated_by: "a long straight leg, on which the heading error grows with distance; turns on the spot, which it does not change",
        source: "Borenstein & Feng (1995), section 2; split: Borenstein & Feng (1996), IEEE Trans. Robotics and \
                 Automation 12(6)",
    };

    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL.and(DriveKind::Clapper);

    fn means(p: &[f64], robot: &Robot) -> String {
        let ratio = 2.0 * (p[0] - 1.0) / (p[0] + 1.0);
        let mean = 0.5 * (robot.drive.wheel_diameter_left() + robot.drive.wheel_diameter_right());
        let (larger, turned) = (either(ratio, "right", "left"), ratio / robot.drive.wheelbase());
        format!(
            "The {larger} wheel is {} larger in diameter than the other: each metre ahead turns the robot by {} to the {}.",
            mm(ratio * mean),
            deg(turned),
            side(turned)
        )
    }
}
