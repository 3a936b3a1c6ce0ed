//! E_b: the effective wheelbase.

use super::words::{deg, mm};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::Wheelbase;

pub(super) static EFFECT: Entry = Entry::of::<Wheelbase>().body::<Wheelbase>();

impl Effect for Wheelbase {
    const ABOUT: About = About {
        name: "wheelbase",
        title: "effective wheelbase, E_b",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio("e_b", "eb", 8e-3, (0.2, 5.0), "E_b = effective wheelbase / nominal wheelbase")],
        equation: "Δθ ← Δθ / E_b",
        physics: "A tyre touches the floor in an area, not in a point, and the point about which it turns is uncertain by up to 1 % of \
                  the wheelbase. Scrub in turns on the spot acts the same way and is part of the measured value.",
        signature: "Every turn is too small (E_b > 1) or too large (E_b < 1). The return heading error per side is -(E_b - 1) π/2 in \
                    ccw runs and the opposite in cw runs.",
        confused_with: &[
            "scale",
            "turn_slip",
            "turn_slip_rate",
            "speed_slip",
            "body_speed_slip",
            "forward_slip",
            "squared_speed_slip",
            "squared_forward_slip",
            "caster_kick",
            "centripetal_load",
            "roller_scale",
            "sideways_turn_slip",
        ],
        separated_by: "turns on the spot, together with one straight leg measured by tape",
        source: "Borenstein & Feng (1995), section 2",
    };

    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL.and(DriveKind::Clapper);

    fn means(p: &[f64], robot: &Robot) -> String {
        let b = robot.drive.wheelbase();
        format!(
            "The robot turns as if its wheels stood {} apart, not {}: 90 degrees by its odometry are {}.",
            mm(p[0] * b),
            mm(b),
            deg(std::f64::consts::FRAC_PI_2 / p[0])
        )
    }
}
