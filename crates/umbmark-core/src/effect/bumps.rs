//! Accidental bumps, and the geometry of a bump.

use super::words::{deg, size};
use super::{About, ActsOn, Bump, BumpLaw, Effect, Entry, Stretch};
use crate::drive::{DriveKind, DriveKinds, Robot, Wheel};
use crate::parameter::{DefaultValue, Parameter};
use crate::random::Stream;

/// Bumps under either wheel as a Poisson process in the distance that the wheel rolls.
pub struct Bumps;

pub(super) static EFFECT: Entry = Entry::of::<Bumps>().bumps::<Bumps>();

impl Effect for Bumps {
    const ABOUT: About = About {
        name: "bumps",
        title: "bumps met by chance",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter::size(
                "rate_per_m",
                "bump-rate",
                "1/m",
                0.1,
                (0.0, 1000.0),
                "bumps per metre rolled, of each wheel; of a base on rollers, of the wheels on either side of its course",
            ),
            Parameter { flag: "random-bump-height", ..HEIGHT },
            Parameter { flag: "random-bump-wheel-radius", ..WHEEL_RADIUS },
            Parameter { flag: "random-bump-profile", ..PROFILE },
        ],
        equation: EXTRA_TRAVEL,
        physics: "A wheel that climbs over an obstacle follows a path that is longer than the floor below it, so its encoder counts \
                  more than the body advances. An uneven floor has such obstacles at random places.",
        signature: "On average the robot falls short, by a scale error of -rate · D. The scatter consists of sharp heading steps of D/b \
                    towards the wheel that was bumped; it adds rate · D² per metre to the variance of each wheel.",
        confused_with: &["wheel_noise", "scale"],
        separated_by: "the heading increments of a track: they are skewed and have spikes, while those of wheel noise are smooth",
        source: "geometry of a rolling circle; the 0.6 degree of Borenstein & Feng (1995), section 3.3, for 10 mm follows \
                 for wheel radii of 66 to 75 mm",
    };

    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL
        .and(DriveKind::Synchro)
        .and(DriveKind::Mecanum)
        .and(DriveKind::Omni3)
        .and(DriveKind::Omni4);

    fn means(p: &[f64], robot: &Robot) -> String {
        let lost = lost_travel(p[1], p[2], p[3]);
        format!(
            "Each wheel meets {} bumps in 10 m, and each turns the robot by {}.",
            size(10.0 * p[0]),
            deg(lost / robot.drive.wheelbase())
        )
    }
}

impl BumpLaw for Bumps {
    fn bumps(p: &[f64], stretch: &Stretch, stream: &mut Stream, met: &mut Vec<Bump>) {
        if p[0] == 0.0 {
            return;
        }
        let (lost, across) = (lost_travel(p[1], p[2], p[3]), stretch.across());
        for (wheel, rolled) in [(Wheel::Left, across.left), (Wheel::Right, across.right)] {
            let expected = p[0] * rolled.abs();
            let mut at = exponential(stream) / expected;
            while at < 1.0 {
                met.push(Bump { at, wheel, lost: lost.copysign(rolled) });
                at += exponential(stream) / expected;
            }
        }
    }
}

fn exponential(stream: &mut Stream) -> f64 {
    -libm::log(1.0 - stream.uniform())
}

pub(super) const EXTRA_TRAVEL: &str =
    "edge: D = 2R(ψ - sin ψ), cos ψ = 1 - h/R;  cable: D = 2(R + h/2)(φ - sin φ), cos φ = (R - h/2)/(R + h/2)";

pub(super) const HEIGHT: Parameter =
    Parameter::shape("height_m", "bump-height", "m", 0.010, (0.0, 1.0), "height of the obstacle");

pub(super) const WHEEL_RADIUS: Parameter = Parameter {
    default: DefaultValue::OfRobot(|robot| robot.wheel_radius()),
    ..Parameter::shape(
        "wheel_radius_m",
        "bump-wheel-radius",
        "m",
        0.075,
        (1e-3, 10.0),
        "radius of the wheel that climbs it",
    )
};

pub(super) const PROFILE: Parameter = Parameter::choice(
    "profile",
    "bump-profile",
    &["cable", "edge"],
    0,
    "a round cable lying on the floor, or a thin edge",
);

/// Travel that the encoder counts and the body does not make \[m\], from the effect's parameters.
pub(super) fn lost_travel(height: f64, wheel_radius: f64, profile: f64) -> f64 {
    extra_travel(height, wheel_radius, profile == 0.0)
}

/// Length of the wheel-centre path over a fixed obstacle of height h, less the floor below it \[m\].
///
/// The wheel's instantaneous centre is the contact, so the encoder counts the length of the wheel-centre path: over a thin
/// edge two arcs of radius R, over a round cable (diameter h) two arcs of radius R + h/2,
///
/// edge: D = 2R(ψ - sin ψ), cos ψ = 1 - h/R; cable: D = 2(R + r)(φ - sin φ), cos φ = (R - r)/(R + r), r = h/2.
///
/// For small h both tend to (2√2/3) h^1.5/√R. The robot turns by D/b towards the wheel that met it. An edge higher than
/// the wheel's axle counts as one at the axle.
///
/// ```
/// # use umbmark_core::effect::extra_travel;
/// assert!((extra_travel(0.010, 0.075, false) - 3.51e-3).abs() < 5e-6);
/// assert!((extra_travel(0.010, 0.075, true) - 3.40e-3).abs() < 5e-6);
/// ```
pub fn extra_travel(height: f64, wheel_radius: f64, round: bool) -> f64 {
    let (radius, cosine) = if round {
        let r = 0.5 * height;
        (wheel_radius + r, (wheel_radius - r) / (wheel_radius + r))
    } else {
        (wheel_radius, 1.0 - height / wheel_radius)
    };
    let angle = libm::acos(cosine.clamp(0.0, 1.0));
    2.0 * radius * (angle - libm::sin(angle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::WheelTravel;
    use crate::effect::TestKind;
    use crate::path::Direction;

    /// The wheel-centre height above a floor with an obstacle, found by lowering a disc until it touches: an oracle that
    /// knows neither arcs nor angles.
    fn centre_height(x: f64, radius: f64, height: f64, round: bool) -> f64 {
        let r = if round { 0.5 * height } else { 0.0 };
        let centre = if round { r } else { height };
        let reach = radius + r;
        let over = if x.abs() < reach { centre + (reach * reach - x * x).sqrt() } else { f64::NEG_INFINITY };
        radius.max(over)
    }

    #[test]
    fn the_extra_travel_is_the_length_of_the_wheel_centre_path_less_the_floor() {
        for (radius, height) in [(0.075_f64, 0.010_f64), (0.042, 0.008), (0.075, 0.001)] {
            for round in [false, true] {
                let half_span = 2.0 * (radius * height).sqrt() + 0.01;
                let n = 400_000;
                let h =
                    |i: usize| centre_height(-half_span + 2.0 * half_span * i as f64 / n as f64, radius, height, round);
                let dx = 2.0 * half_span / n as f64;
                let length: f64 = (0..n).map(|i| libm::hypot(dx, h(i + 1) - h(i))).sum();
                let extra = length - 2.0 * half_span;
                let formula = extra_travel(height, radius, round);
                assert!((extra - formula).abs() < 1e-6, "{radius} {height} {round}: {extra} {formula}");
            }
        }
    }

    #[test]
    fn a_ten_millimetre_bump_turns_a_labmate_by_0_592_or_0_573_degrees() {
        let degrees = |round| (extra_travel(0.010, 0.075, round) / 0.340).to_degrees();
        assert!((degrees(false) - 0.592).abs() < 5e-4, "{}", degrees(false));
        assert!((degrees(true) - 0.573).abs() < 5e-4, "{}", degrees(true));
    }

    #[test]
    fn poisson_bumps_come_at_the_stated_rate_evenly_and_under_both_wheels() {
        let stretch = Stretch {
            index: 0,
            direction: Direction::Ccw,
            test: TestKind::Systematic,
            travel: WheelTravel { left: -2.0, right: 2.0 },
            left: 0.0,
        };
        let (mut met, mut stream) = (Vec::new(), Stream::new(1, 2, 3));
        let repeats = 20_000;
        for _ in 0..repeats {
            Bumps::bumps(&[1.5, 0.01, 0.075, 0.0], &stretch, &mut stream, &mut met);
        }
        // Expected 3 per wheel and stretch; standard error of the mean count sqrt(6/20000) = 0.017.
        let count = met.len() as f64 / f64::from(repeats);
        assert!((count - 6.0).abs() < 4.0 * 0.0173, "{count}");
        let middle = met.iter().map(|b| b.at).sum::<f64>() / met.len() as f64;
        assert!((middle - 0.5).abs() < 4.0 * 0.289 / (met.len() as f64).sqrt(), "{middle}");
        assert!(met.iter().all(|b| (b.lost < 0.0) == (b.wheel == Wheel::Left) && (0.0..1.0).contains(&b.at)));
    }
}
