//! The shape of the scatter that evenly noisy wheels give an end pose.

pub(crate) mod trucks;

use crate::drive::{DifferentialDrive, WheelTravel};
use crate::effect::{across, course_angle};
use crate::geometry::{Displacement2, Pose2};
use crate::replay::Track;
use nalgebra::{Matrix3, Vector3};

/// Pieces that each travel is cut into: the integrals along a leg are then exact to a part in a thousand.
const PIECES: usize = 16;

/// Covariance of the end pose (x, y, heading) for white noise of unit variance per metre on each wheel.
///
/// Σ = ∫ g_L g_Lᵀ |ds_L| + g_R g_Rᵀ |ds_R|, where g is the shift of the end pose by a unit of wheel travel at the pose q on the way:
/// half of it along the heading, and a turn ±1/b of the rest of the path about q. To first order, along the nominal path.
/// Source: the noise model of Chong & Kleeman, ICRA 1997. A base that moves sideways is one whose axle stands across its course. Of two trucks with a link, that of the front one.
pub(crate) fn end_covariance(track: &Track, drive: &DifferentialDrive) -> Matrix3<f64> {
    if let Some(convoy) = track.convoy() {
        return trucks::gathered(convoy, drive, 0..convoy.steps().len());
    }
    let displaced = |pose: Pose2, (travel, left): &(WheelTravel, f64), share: f64| {
        let motion = drive.displacement(&travel.scaled(share));
        pose.moved(&Displacement2 { sideways: left * share, ..motion })
    };
    let pieces = || track.travel().iter().zip(track.contexts()).map(|(travel, at)| (*travel, at.aside.way));
    let end = pieces().fold(Pose2::IDENTITY, |pose, piece| displaced(pose, &piece, 1.0));
    let turn = 1.0 / drive.wheelbase();
    let (mut sum, mut pose) = (Matrix3::zeros(), Pose2::IDENTITY);
    for moved in pieces() {
        let (rolled, aside) = (across(&moved.0, moved.1), course_angle(&moved.0, moved.1));
        for piece in 0..PIECES {
            let at = displaced(pose, &moved, (piece as f64 + 0.5) / PIECES as f64);
            let (sine, cosine) = libm::sincos(at.heading + aside);
            let along = 0.5 * Vector3::new(cosine, sine, 0.0);
            let about = turn * Vector3::new(at.y - end.y, end.x - at.x, 1.0);
            for (shift, rolled) in [(along - about, rolled.left), (along + about, rolled.right)] {
                sum += shift * shift.transpose() * (rolled.abs() / PIECES as f64);
            }
        }
        pose = displaced(pose, &moved, 1.0);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::path::{Direction, Path, SQUARE, STRAIGHT, SpeedProfile, WAYPOINTS};
    use crate::random::Stream;

    /// Oracle: integrals by hand for a straight line of length s. Heading 2s/b², sideways 2s³/(3b²), their covariance
    /// s²/b², forward s/2.
    #[test]
    fn a_straight_line_scatters_as_the_integrals_say() {
        let (length, b) = (10.0, 0.340);
        let path = Path::new(&STRAIGHT, &[length], SpeedProfile::default()).unwrap();
        let robot = Robot::labmate();
        let sigma = end_covariance(&Track::from_path(&path, Direction::Ccw, &robot), &robot.drive);
        let expected = [
            ((0, 0), length / 2.0),
            ((1, 1), 2.0 * length.powi(3) / (3.0 * b * b)),
            ((2, 2), 2.0 * length / (b * b)),
            ((1, 2), length * length / (b * b)),
            ((0, 1), 0.0),
        ];
        for (at, value) in expected {
            assert!((sigma[at] - value).abs() < 1e-3 * value.max(1e-6), "{at:?}: {} {value}", sigma[at]);
        }
    }

    /// Oracle: differences of the end where one wheel rolls a little more in one slice of the way after the other.
    #[test]
    fn a_path_that_ends_elsewhere_scatters_as_the_influence_of_every_slice_says() {
        let robot = Robot::labmate();
        let path = Path::new(&WAYPOINTS, &[1.0, 0.0, 1.5, 1.0, 0.2, 1.4], SpeedProfile::default()).unwrap();
        let track = Track::from_path(&path, Direction::Ccw, &robot);
        let slices: Vec<WheelTravel> =
            track.travel().iter().flat_map(|travel| (0..100).map(|_| travel.scaled(0.01))).collect();
        let end = |slices: &[WheelTravel]| {
            let end = slices.iter().fold(Pose2::IDENTITY, |pose, s| pose.moved(&robot.drive.displacement(s)));
            Vector3::new(end.x, end.y, end.heading)
        };
        let (mut sum, h) = (Matrix3::zeros(), 1e-5);
        for i in 0..slices.len() {
            for (by, rolled) in [
                (WheelTravel { left: h, right: 0.0 }, slices[i].left),
                (WheelTravel { left: 0.0, right: h }, slices[i].right),
            ] {
                let at = |sign: f64| {
                    let mut changed = slices.clone();
                    changed[i].left += sign * by.left;
                    changed[i].right += sign * by.right;
                    end(&changed)
                };
                let slope = (at(1.0) - at(-1.0)) / (2.0 * h);
                sum += slope * slope.transpose() * rolled.abs();
            }
        }
        let expected = end_covariance(&track, &robot.drive);
        for i in 0..3 {
            for j in 0..3 {
                let scale = (sum[(i, i)] * sum[(j, j)]).sqrt();
                assert!((sum[(i, j)] - expected[(i, j)]).abs() < 2e-3 * scale, "{sum} {expected}");
            }
        }
    }

    /// Oracle: 4000 squares driven in steps of a centimetre with noise on each wheel; seed 21; both directions.
    #[test]
    fn a_square_scatters_as_simulated_and_mirrors_with_its_direction() {
        let robot = Robot::labmate();
        let path = Path::new(&SQUARE, &[1.0], SpeedProfile::default()).unwrap();
        let [cw, ccw] = Direction::BOTH.map(|d| end_covariance(&Track::from_path(&path, d, &robot), &robot.drive));
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        assert!((mirror * ccw * mirror - cw).abs().max() < 1e-12);
        let track = Track::from_path(&path, Direction::Ccw, &robot);
        let (k, draws) = (1e-3, 4000);
        let mut sum = Matrix3::zeros();
        for draw in 0..draws {
            let mut stream = Stream::new(21, 0, draw);
            let mut pose = Pose2::IDENTITY;
            for travel in track.travel() {
                let steps = (travel.left.abs() * 100.0).ceil();
                for _ in 0..steps as usize {
                    let mut noisy = |s: f64| s / steps + k * (s.abs() / steps).sqrt() * stream.normal();
                    let step = WheelTravel { left: noisy(travel.left), right: noisy(travel.right) };
                    pose = pose.moved(&robot.drive.displacement(&step));
                }
            }
            let error = Vector3::new(pose.x, pose.y, pose.heading - 4.0 * std::f64::consts::FRAC_PI_2);
            sum += error * error.transpose() / (k * k * draws as f64);
        }
        for i in 0..3 {
            for j in 0..3 {
                let scale = (ccw[(i, i)] * ccw[(j, j)]).sqrt();
                assert!((sum[(i, j)] - ccw[(i, j)]).abs() < 0.08 * scale, "{i} {j}: {} {}", sum[(i, j)], ccw[(i, j)]);
            }
        }
    }
}
