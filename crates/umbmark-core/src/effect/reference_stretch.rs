//! A reference whose axes have different scales.

use super::words::percent;
use super::{About, ActsOn, Effect, Entry, Shown, Sight, SightLaw, Tried};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// Ways that the reference shows longer in one direction of the room than across it.
pub struct ReferenceStretch;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceStretch>().seen::<ReferenceStretch>();

impl Effect for ReferenceStretch {
    const ABOUT: About = About {
        name: "reference_stretch",
        title: "unequal scales of the reference's axes",
        acts_on: ActsOn::Reference,
        parameters: &[
            Parameter::size(
                "along_m_per_m",
                "stretch-along",
                "m/m",
                2e-3,
                (-0.2, 0.2),
                "share by which ways along x look longer, and ways along y shorter",
            ),
            Parameter::size(
                "diagonal_m_per_m",
                "stretch-diagonal",
                "m/m",
                2e-3,
                (-0.2, 0.2),
                "the same along the diagonal between x and y, and across it",
            ),
            Parameter::shape(
                "headings",
                "stretch-headings",
                "",
                1.0,
                (-1.0, 2.0),
                "1 where the heading is measured in the same picture, 0 where it is not",
            ),
        ],
        equation: "(x, y) ← ((1 + a) x + d y, (1 - a) y + d x);  θ ← θ + h ∠(u, ((1 + a) u_x + d u_y, (1 - a) u_y + d u_x)),  u = (cos θ, sin θ)",
        physics: "The axes of the room were set by two lengths that were not equally right, or are not at right angles: markers of the room \
                  that were measured badly, a camera that looks at the floor aslant, anchors at wrong places. A heading that is measured by \
                  two points of the same picture is bent with it (h = 1).",
        signature: "Straights are longer in one direction of the room than across it, both ways alike, and those between lean to the longer \
                    side. In the mean over the room it looks like E_s.",
        confused_with: &["scale", "reference_lens"],
        separated_by: "straight legs along and across the longer direction, by tape",
        source: "affine distortion of a picture; 2 mm per metre are assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        let (size, direction) = stretch(p);
        format!(
            "A metre at {:.0} deg in the room looks {} longer than across it. Which of the two is right, the reference does not say: E_s may be {} off either way.",
            direction.to_degrees(),
            percent(2.0 * size),
            percent(size)
        )
    }

    /// The longer direction may be the right one, or the shorter.
    fn unknown_scale(p: &[f64]) -> f64 {
        stretch(p).0
    }

    fn tried(_shown: &Shown) -> Vec<Tried> {
        [1.0, 0.0].map(|headings| vec![("headings", headings)]).into()
    }
}

/// The share by which ways look longer in one direction, and that direction \[rad\].
fn stretch(p: &[f64]) -> (f64, f64) {
    (libm::hypot(p[0], p[1]), 0.5 * libm::atan2(p[1], p[0]))
}

impl SightLaw for ReferenceStretch {
    fn seen<T: Real>(p: &[T], at: &Sight, pose: &mut Pose2<T>) {
        let Some(room) = at.room else { return };
        // Both directions in the frame of the pose.
        let (sine, cosine) = libm::sincos(2.0 * room.heading);
        let (along, diagonal) = (p[0] * cosine + p[1] * sine, p[1] * cosine - p[0] * sine);
        let (x, y) = (pose.x, pose.y);
        let (ahead_y, ahead_x) = pose.heading.sine_cosine();
        let (same, twice) = (ahead_x * ahead_x - ahead_y * ahead_y, ahead_x * ahead_y * 2.0);
        let tangent = (diagonal * same - along * twice) / (along * same + diagonal * twice + 1.0);
        let value = tangent.value();
        pose.heading += p[2] * tangent.mapped(libm::atan(value), 1.0 / (1.0 + value * value));
        pose.x += along * x + diagonal * y;
        pose.y += diagonal * x - along * y;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Setting, ccw_and_cw, circle_end_with, model_with, stops_with};
    use super::*;
    use crate::geometry::wrap;
    use crate::path::{Direction, Path};
    use crate::replay::Track;

    fn stretched(along: f64, diagonal: f64, headings: f64) -> [Setting<'static>; 3] {
        let values = [("along_m_per_m", along), ("diagonal_m_per_m", diagonal), ("headings", headings)];
        values.map(|(name, value)| ("reference_stretch", name, value))
    }

    #[test]
    fn a_place_moves_along_one_axis_and_back_along_the_other() {
        for share in [4e-3, -4e-3] {
            for (direction, sign) in ccw_and_cw() {
                // After the second leg the robot is at (4, 4) or (4, -4).
                let along = stops_with(&stretched(share, 0.0, 0.0), direction);
                let (x, y) = (4.0, 4.0 * sign);
                assert!((along[2].x - (1.0 + share) * x).abs() < 1e-9, "{:?}", along[2]);
                assert!((along[2].y - (1.0 - share) * y).abs() < 1e-9, "{:?}", along[2]);
                let diagonal = stops_with(&stretched(0.0, share, 0.0), direction);
                assert!((diagonal[2].x - x - share * y).abs() < 1e-9, "{:?}", diagonal[2]);
                assert!((diagonal[2].y - y - share * x).abs() < 1e-9, "{:?}", diagonal[2]);
                assert_eq!(along[2].heading, stops_with(&[], direction)[2].heading);
            }
        }
    }

    /// The direction of a line between two places that are both stretched.
    #[test]
    fn a_heading_turns_with_a_line_in_the_picture() {
        let (along, diagonal) = (1e-2, -6e-3);
        for (direction, _) in ccw_and_cw() {
            let seen = stops_with(&stretched(along, diagonal, 1.0), direction);
            let plain = stops_with(&[], direction);
            assert!(seen.iter().zip(&plain).any(|(seen, plain)| (seen.heading - plain.heading).abs() > 3e-3));
            for (seen, plain) in seen.iter().zip(&plain) {
                let (x, y) = (libm::cos(plain.heading), libm::sin(plain.heading));
                let bent = libm::atan2((1.0 - along) * y + diagonal * x, (1.0 + along) * x + diagonal * y);
                assert!(wrap(bent - seen.heading).abs() < 1e-12, "{seen:?}");
            }
        }
    }

    #[test]
    fn the_axes_are_those_of_the_reference_and_a_tape_has_none() {
        let stretch = stretched(3e-3, 1e-3, 0.0);
        let track = Track::with_stops(&Path::umbmark(), Direction::Ccw, &Robot::labmate());
        let room = Pose2::new(0.5, 2.0, 0.7);
        let (plain, chain) = (track.poses(&model_with(&[]).chain()), model_with(&stretch).chain());
        for (seen, plain) in track.seen_in(room).poses(&chain).iter().zip(&plain) {
            let (seen, plain) = (room.compose(seen), room.compose(plain));
            let (dx, dy) = (plain.x - room.x, plain.y - room.y);
            let shown = [room.x + 1.003 * dx + 1e-3 * dy, room.y + 0.997 * dy + 1e-3 * dx];
            assert!((seen.x - shown[0]).abs() < 1e-9 && (seen.y - shown[1]).abs() < 1e-9);
        }
        for direction in Direction::BOTH {
            assert_eq!(circle_end_with(&stretch, direction), circle_end_with(&[], direction));
        }
    }

    #[test]
    fn it_says_how_far_off_the_scale_may_be() {
        let p = [0.0, -4e-3, 0.0];
        assert!((ReferenceStretch::unknown_scale(&p) - 4e-3).abs() < 1e-12);
        let means = ReferenceStretch::means(&p, &Robot::labmate());
        assert!(means.starts_with("A metre at -45 deg in the room looks 0.800 % longer"), "{means}");
    }
}
