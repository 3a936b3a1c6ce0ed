//! Odometry that moves along the heading at the beginning of each step.

use super::words::{deg, size};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::EncoderSampling;

pub(super) static EFFECT: Entry = Entry::of::<EncoderSampling>().body::<EncoderSampling>();

impl Effect for EncoderSampling {
    const ABOUT: About = About {
        name: "encoder_sampling",
        title: "sampling with Euler steps",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "period_s",
            "encoder-period",
            "s",
            0.05,
            (-10.0, 10.0),
            "time between two steps of the robot's own odometry",
        )],
        equation: "(forward, sideways) ← R(ω T/2) (forward, sideways),  not where the ticks were recorded",
        physics: "Odometry that moves along the heading from the beginning of each step places every chord of an arc too far outside, \
                  by half the rotation of the step. Recorded ticks are integrated along exact arcs here, so this effect corrects \
                  nothing in them.",
        signature: "A square shows nothing, because the robot either drives straight or turns on the spot. On circles the course is off \
                    by ω T/2.",
        confused_with: &[],
        separated_by: "replaying the recorded ticks: the error must disappear",
        source: "Euler's rule against the mid-point rule; 50 ms is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "Steps of {} ms lay each chord of an arc too far outside: at 1 rad/s the course is {} off.",
            size(1e3 * p[0]),
            deg(0.5 * p[0])
        )
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::WheelTravel;
    use crate::effect::tests::{ccw_and_cw, model_with, stops_with};
    use crate::effect::{BodyLaw, Context};
    use crate::geometry::Pose2;

    #[test]
    fn it_turns_the_end_of_euler_steps_onto_the_arc() {
        let (speed, period, n) = (0.5, 0.05, 100);
        for rate in [0.4, -0.4] {
            let (mut x, mut y) = (0.0, 0.0);
            for step in 0..n {
                let heading = rate * period * f64::from(step);
                x += speed * period * libm::cos(heading);
                y += speed * period * libm::sin(heading);
            }
            let turned = rate * period * f64::from(n);
            let mut motion = Pose2::new(x, y, turned).log();
            EncoderSampling::body(
                &[period],
                &Context { turn_rate: rate, ..Context::default() }.as_believed(),
                &mut motion,
            );
            let end = Pose2::exp(&motion);
            let radius = speed / rate;
            let arc = (radius * libm::sin(turned), radius * (1.0 - libm::cos(turned)));
            // A chord is shorter than its arc by (ωT)²/24.
            assert!((end.x - arc.0).abs() < 1e-4 && (end.y - arc.1).abs() < 1e-4, "{end:?} {arc:?}");
            assert!((x - arc.0).hypot(y - arc.1) > 0.01);
        }
    }

    #[test]
    fn the_square_and_recorded_ticks_know_nothing_of_it() {
        let model = [("encoder_sampling", "period_s", 0.5)];
        for (direction, _) in ccw_and_cw() {
            let end = stops_with(&model, direction)[7];
            assert!(end.x.hypot(end.y) < 1e-12);
        }
        let chain = model_with(&model).chain();
        let at = Context { turn_rate: 0.3, recorded: true, ..Context::default() };
        let moved = chain.displacement(&at.as_believed(), &WheelTravel { left: 0.1, right: 0.2 });
        assert_eq!(moved.sideways, 0.0);
    }
}
