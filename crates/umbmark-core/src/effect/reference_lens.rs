//! A camera whose lens bends its picture.

use super::words::{deg, either, mm};
use super::{About, ActsOn, Effect, Entry, Shown, Sight, SightLaw, Tried};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// Radial distortion of the measured poses about the middle of a camera's picture.
pub struct ReferenceLens;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceLens>().seen::<ReferenceLens>();

impl Effect for ReferenceLens {
    const ABOUT: About = About {
        name: "reference_lens",
        title: "lens distortion of the reference",
        acts_on: ActsOn::Reference,
        parameters: &[
            Parameter::size(
                "k1_per_m2",
                "lens-k1",
                "1/m²",
                2e-3,
                (-0.1, 0.1),
                "share by which distances from the middle of the picture look longer, 1 m from it",
            ),
            Parameter::size(
                "k2_per_m4",
                "lens-k2",
                "1/m⁴",
                1e-4,
                (-0.01, 0.01),
                "the same, of the fourth power of the distance",
            ),
            Parameter {
                typical: 1.0,
                ..Parameter::shape(
                    "centre_x_m",
                    "lens-x",
                    "m",
                    0.0,
                    (-1e7, 1e7),
                    "middle of the picture, in the frame of the measured poses",
                )
            },
            Parameter {
                typical: 1.0,
                ..Parameter::shape(
                    "centre_y_m",
                    "lens-y",
                    "m",
                    0.0,
                    (-1e7, 1e7),
                    "middle of the picture, in the frame of the measured poses",
                )
            },
            Parameter::shape(
                "headings",
                "lens-headings",
                "",
                1.0,
                (-1.0, 2.0),
                "1 where the heading is measured in the same picture, 0 where it is not",
            ),
        ],
        equation: "(x, y) ← c + g d,  g = 1 + k₁ |d|² + k₂ |d|⁴,  d = (x, y) - c;  θ ← θ + h ∠(u, g u + g'/|d| (u·d) d),  u = (cos θ, sin θ)",
        physics: "A camera over the floor sees the robot through a lens whose distortion was not, or not well, corrected: away from the \
                  middle of the picture, distances look longer (k > 0) or shorter (k < 0). A heading that is measured by two points of the \
                  same picture is bent with them (h = 1).",
        signature: "The robot seems to drive a longer way, and on curves, near the edge of the picture than in its middle, whatever \
                    wheel leads and whichever way it drives. In the mean over the room it looks like E_s.",
        confused_with: &["scale", "reference_stretch"],
        separated_by: "the same straight leg, by tape, in the middle of the picture and at its edge",
        source: "radial distortion (D. C. Brown, Decentering distortion of lenses, 1966); 2 mm at 1 m are assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        let out = 8.0 * p[0] + 32.0 * p[1];
        format!(
            "2 m from the middle of the picture, at ({}, {}) m, the reference shows the robot {} too far {}, and its heading up to {} off.",
            libm::round(100.0 * p[2]) / 100.0 + 0.0,
            libm::round(100.0 * p[3]) / 100.0 + 0.0,
            mm(out),
            either(out, "out", "in"),
            deg(p[4] * (4.0 * p[0] + 32.0 * p[1]))
        )
    }

    /// The middle of the picture is tried in the middle of what was seen, and halfway from there to each edge of it; headings in
    /// the picture or not.
    fn tried(shown: &Shown) -> Vec<Tried> {
        let Some([least, most]) = shown.extent else { return Vec::new() };
        let middle = [0, 1].map(|k| 0.5 * (least[k] + most[k]));
        let halfway = [0, 1].map(|k| 0.25 * (most[k] - least[k]));
        let at = |[right, up, headings]: [f64; 3]| {
            let [x, y] = [middle[0] + right * halfway[0], middle[1] + up * halfway[1]];
            vec![("centre_x_m", x), ("centre_y_m", y), ("headings", headings)]
        };
        let places = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        [1.0, 0.0].into_iter().flat_map(|headings| places.map(|[x, y]| at([x, y, headings]))).collect()
    }
}

impl SightLaw for ReferenceLens {
    fn seen<T: Real>(p: &[T], at: &Sight, pose: &mut Pose2<T>) {
        let Some(room) = at.room else { return };
        // The middle of the picture in the frame of the pose.
        let (sine, cosine) = libm::sincos(room.heading);
        let (x, y) = (p[2] - room.x, p[3] - room.y);
        let (x, y) = (pose.x - (x * cosine + y * sine), pose.y - (y * cosine - x * sine));
        let square = x * x + y * y;
        let further = square * (p[0] + p[1] * square);
        let (ahead_y, ahead_x) = pose.heading.sine_cosine();
        let (along, across) = (ahead_x * x + ahead_y * y, ahead_x * y - ahead_y * x);
        let bent = along * (p[0] + p[1] * square * 2.0) * 2.0;
        let tangent = bent * across / (further + 1.0 + bent * along);
        let value = tangent.value();
        pose.heading += p[4] * tangent.mapped(libm::atan(value), 1.0 / (1.0 + value * value));
        pose.x += further * x;
        pose.y += further * y;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Setting, ccw_and_cw, circle_end_with, model_with, stops_with};
    use crate::drive::Robot;
    use crate::geometry::{Pose2, wrap};
    use crate::path::{Direction, Path};
    use crate::replay::Track;

    fn lens(k1: f64, k2: f64, headings: f64) -> [Setting<'static>; 5] {
        let values = [("k1_per_m2", k1), ("k2_per_m4", k2), ("centre_x_m", 1.0), ("centre_y_m", -1.0)];
        let [a, b, c, d] = values.map(|(name, value)| ("reference_lens", name, value));
        [a, b, c, d, ("reference_lens", "headings", headings)]
    }

    #[test]
    fn a_place_is_shown_farther_from_the_middle_by_the_share_of_its_squared_distance() {
        for share in [1e-3, -1e-3] {
            for (direction, sign) in ccw_and_cw() {
                // After the first leg the robot is at (4, 0), 3 m and 1 m from the middle; after the second at (4, 4) or (4, -4).
                let stops = stops_with(&lens(share, 0.0, 0.0), direction);
                let (dx, dy) = (3.0, 1.0);
                assert!((stops[0].x - (4.0 + share * 10.0 * dx)).abs() < 1e-9, "{:?}", stops[0]);
                assert!((stops[0].y - share * 10.0 * dy).abs() < 1e-9, "{:?}", stops[0]);
                let square = 9.0 + (4.0 * sign + 1.0).powi(2);
                assert!((stops[2].x - (4.0 + share * square * dx)).abs() < 1e-9, "{:?}", stops[2]);
                let fourth = stops_with(&lens(0.0, 0.1 * share, 0.0), direction);
                assert!((fourth[2].x - (4.0 + 0.1 * share * square * square * dx)).abs() < 1e-9, "{:?}", fourth[2]);
                assert_eq!(stops[2].heading, stops_with(&[], direction)[2].heading);
            }
        }
    }

    /// The direction of a short line between two places that are both shown by the lens.
    #[test]
    fn a_heading_turns_with_a_line_in_the_picture() {
        let (k1, k2) = (2e-3, -1e-4);
        let mut most: f64 = 0.0;
        for (direction, _) in ccw_and_cw() {
            for (seen, plain) in stops_with(&lens(k1, k2, 1.0), direction).iter().zip(&stops_with(&[], direction)) {
                let shown = |ahead: f64| {
                    let x = plain.x + ahead * libm::cos(plain.heading) - 1.0;
                    let y = plain.y + ahead * libm::sin(plain.heading) + 1.0;
                    let square = x * x + y * y;
                    let longer = 1.0 + k1 * square + k2 * square * square;
                    (longer * x, longer * y)
                };
                let ((x0, y0), (x1, y1)) = (shown(-1e-4), shown(1e-4));
                let off = wrap(libm::atan2(y1 - y0, x1 - x0) - seen.heading);
                assert!(off.abs() < 1e-8, "{off} at {seen:?}");
                most = most.max((seen.heading - plain.heading).abs());
            }
        }
        assert!(most > 5e-3, "{most}");
    }

    #[test]
    fn the_middle_is_in_the_frame_of_the_reference_and_a_tape_has_no_lens() {
        let lens = lens(1e-3, 0.0, 1.0);
        let track = Track::with_stops(&Path::umbmark(), Direction::Ccw, &Robot::labmate());
        let room = Pose2::new(0.5, 2.0, 0.7);
        let (plain, chain) = (track.poses(&model_with(&[]).chain()), model_with(&lens).chain());
        for (seen, plain) in track.seen_in(room).poses(&chain).iter().zip(&plain) {
            let (seen, plain) = (room.compose(seen), room.compose(plain));
            let (dx, dy) = (plain.x - 1.0, plain.y + 1.0);
            let further = 1e-3 * (dx * dx + dy * dy);
            assert!((seen.x - plain.x - further * dx).abs() < 1e-9 && (seen.y - plain.y - further * dy).abs() < 1e-9);
        }
        for direction in Direction::BOTH {
            assert_eq!(circle_end_with(&lens, direction), circle_end_with(&[], direction));
        }
    }
}
