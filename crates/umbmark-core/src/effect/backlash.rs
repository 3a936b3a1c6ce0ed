//! Play between motor and wheel.

use super::words::{deg, mm};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::Backlash;

pub(super) static EFFECT: Entry = Entry::of::<Backlash>().wheels::<Backlash>();

impl Effect for Backlash {
    const ABOUT: About = About {
        name: "backlash",
        title: "gear backlash, encoders on the motors",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::size(
            "play_m",
            "backlash",
            "m",
            5e-4,
            (-0.1, 0.1),
            "play at the rim, counted and not driven when a wheel reverses",
        )],
        equation: "s_w ← s_w ∓ w  where the wheel begins to roll forward (-) or backward (+) after the opposite",
        physics: "The encoder sits on the motor's shaft. When the motor changes direction, it counts while the gear teeth cross their \
                  play and the wheel stands still.",
        signature: "The heading steps by w/b when a turn begins, and steps back when the next leg begins. Only the step of the last \
                    turn remains in the return pose: -w/b in ccw and +w/b in cw, often less than the scatter.",
        confused_with: &["caster_kick"],
        separated_by: "turning each wheel by hand while its motor is held; a track, which shows the steps",
        source: "geometry; hobby drives with about 1 degree of body heading are reported, 0.5 mm is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        format!(
            "There are {} of play at the rim: where a turn begins the heading jumps by {}, and back where the next leg does.",
            mm(p[0]),
            deg(p[0] / robot.drive.wheelbase())
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn every_turn_is_short_by_the_play_and_every_leg_makes_up_for_it() {
        for play in [1e-3, -1e-3] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("backlash", "play_m", play)], direction);
                for (index, stop) in stops.iter().enumerate() {
                    let turns = (index as f64 + 1.0) / 2.0;
                    let short = if index % 2 == 1 { play / 0.34 } else { 0.0 };
                    let expected = sign * (FRAC_PI_2 * turns.floor() - short);
                    assert!((stop.heading - expected).abs() < 1e-12, "{index}: {stop:?}");
                }
            }
        }
    }
}
