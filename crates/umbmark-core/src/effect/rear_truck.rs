//! The rear one of two trucks, if its wheels differ from those of the front one.

use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here, WheelLaw};
use crate::drive::{DriveKind, DriveKinds, Robot, WheelTravel};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// E_d, E_b and E_s of the rear truck, in addition to those of both.
pub struct RearTruck;

const fn ratio(name: &'static str, flag: &'static str, typical: f64, meaning: &'static str) -> Parameter {
    Parameter::ratio(name, flag, typical, (0.5, 2.0), meaning)
}

pub(super) static EFFECT: Entry = Entry::of::<RearTruck>().wheels::<RearTruck>().body::<RearTruck>();

impl Effect for RearTruck {
    const ABOUT: About = About {
        name: "rear_truck",
        title: "wheels of the rear truck",
        acts_on: ActsOn::Wheels,
        parameters: &[
            ratio("e_d", "rear-ed", 2e-3, "E_d of the rear truck over that of the front one"),
            ratio("e_b", "rear-eb", 8e-3, "E_b of the rear truck over that of the front one"),
            ratio("e_s", "rear-es", 4e-3, "E_s of the rear truck over that of the front one"),
        ],
        equation: "of the rear truck alone: s_L ← 2 E_s s_L/(1 + E_d),  s_R ← 2 E_s E_d s_R/(1 + E_d),  Δθ ← Δθ/E_b",
        physics: "The two trucks are of one design, but their wheels differ by wear, load and the error of the tape measure.",
        signature: "With the correction off, nothing shows: the rear truck follows, and the front one is measured. With it on, unequal \
                    wheels of one truck leave half the travel of one period over the link length, a hundredth of what they would cause \
                    alone, and corners cancel most of that. A mean scale of both trucks changes corners.",
        confused_with: &["rotary_zero_difference", "link_length", "scale"],
        separated_by: "driving each truck alone",
        source: "Borenstein & Feng (1995), sections 2 and 4.5",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Clapper);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let more = |value: f64| format!("{} {}", percent(value - 1.0), either(value - 1.0, "more", "less"));
        format!(
            "Beside the front truck's, D_R/D_L of the rear one is {}, its wheelbase {}, its mean wheel {}.",
            more(p[0]),
            more(p[1]),
            more(p[2])
        )
    }

    fn varies(p: &[f64]) -> bool {
        p.iter().any(|ratio| *ratio != 1.0)
    }
}

impl WheelLaw for RearTruck {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        if at.truck > 0.0 {
            let left = p[2] * 2.0 / (p[0] + 1.0);
            travel.left *= left;
            travel.right *= left * p[0];
        }
    }
}

impl BodyLaw for RearTruck {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if at.truck > 0.0 {
            motion.rotation /= p[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, clapper_returned_with, clapper_stops_with};
    use std::f64::consts::TAU;

    /// Oracle: the rear truck alone turns by 2 (E_d - 1)/(E_d + 1)/b a metre; in a period of 18 mm that moves it aside by half of its way,
    /// which turns the link, of 1 m, the other way. The same rules run in Python leave 0.0091 of it after the first leg of 7 m and 0.0007 at the end.
    #[test]
    fn the_correction_leaves_a_hundredth_of_its_unequal_wheels_on_a_leg_and_all_of_its_scale_in_corners() {
        for (direction, sign) in ccw_and_cw() {
            let unequal = clapper_stops_with(&[("rear_truck", "e_d", 1.002)], direction);
            let a_metre = 2.0 * 0.002 / 2.002 / 0.34;
            let left = [-unequal[0].heading / (7.0 * a_metre), -unequal[7].heading / (22.0 * a_metre)];
            assert!((0.008..0.010).contains(&left[0]) && (0.0..0.001).contains(&left[1]), "{left:?}");
            let scaled = clapper_returned_with(&[("rear_truck", "e_s", 1.004)], direction).heading;
            assert!((scaled / (sign * TAU * 0.002) - 1.0).abs() < 0.05, "{scaled}");
        }
    }
}
