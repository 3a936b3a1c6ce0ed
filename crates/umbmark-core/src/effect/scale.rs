//! E_s: the scale.

use super::words::{either, mm};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::Scale;

pub(super) static EFFECT: Entry = Entry::of::<Scale>().wheels::<Scale>();

impl Effect for Scale {
    const ABOUT: About = About {
        name: "scale",
        title: "scale, E_s",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::ratio(
            "e_s",
            "es",
            4e-3,
            (0.2, 5.0),
            "E_s = mean true wheel diameter / mean nominal wheel diameter",
        )],
        equation: "s_L ← E_s s_L,  s_R ← E_s s_R",
        physics: "The mean of both wheel diameters differs from the nominal one, by wear, load, or the error of the tape measure, which \
                  leaves 0.3 to 0.5 %.",
        signature: "Legs are longer than the odometry says, which a closed square does not show. Turns are larger by the same share, \
                    which looks like E_b. A square determines only E_b/E_s.",
        confused_with: &[
            "wheelbase",
            "turn_slip",
            "turn_slip_rate",
            "speed_slip",
            "body_speed_slip",
            "forward_slip",
            "squared_speed_slip",
            "squared_forward_slip",
            "link_length",
            "rear_truck",
            "bumps",
            "reference_lens",
            "reference_stretch",
        ],
        separated_by: "the length of one straight leg, by tape; the pose at a stop",
        source: "Borenstein & Feng (1995), section 2",
    };

    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL.and(DriveKind::Ackermann).and(DriveKind::Clapper);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let (off, word) = (p[0] - 1.0, either(p[0] - 1.0, "long", "short"));
        format!("A metre by odometry is {} too {word} on the floor.", mm(off))
    }
}
