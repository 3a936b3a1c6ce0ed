//! What a segment of odometry reports.

use super::TickGeometry;
use crate::geometry::{Displacement2, Pose2, Real};

/// The rigid motion that the counters report for a segment, with the cosine and sine of its heading.
///
/// Keeping them makes a chain of motions cost four multiplications each and no trigonometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where the segment ends as seen from where it began. The heading is (n_R δ_R - n_L δ_L) / b of the counts, full
    /// turns included.
    pub pose: Pose2,
    /// cos(heading)
    pub cosine: f64,
    /// sin(heading)
    pub sine: f64,
}

impl Default for Motion {
    fn default() -> Motion {
        Motion::IDENTITY
    }
}

impl From<Pose2> for Motion {
    fn from(pose: Pose2) -> Motion {
        let (sine, cosine) = pose.heading.sine_cosine();
        Motion { pose, cosine, sine }
    }
}

impl Motion {
    /// No motion.
    pub const IDENTITY: Motion = Motion { pose: Pose2::IDENTITY, cosine: 1.0, sine: 0.0 };

    /// The motion of a constant twist: as [`Pose2::exp`], with the cosine and sine of its rotation for little more.
    ///
    /// ```
    /// # use umbmark_core::{engine::Motion, geometry::{Displacement2, Pose2}};
    /// let arc = Displacement2 { forward: 2.0, sideways: 0.1, rotation: -0.7 };
    /// let (motion, pose) = (Motion::exp(&arc), Pose2::exp(&arc));
    /// assert!((motion.pose.x - pose.x).abs() < 1e-15 && (motion.sine + 0.7_f64.sin()).abs() < 1e-15);
    /// ```
    #[inline]
    pub fn exp(displacement: &Displacement2) -> Motion {
        let half = 0.5 * displacement.rotation;
        let (sinc, cosine) = half.sinc_cos();
        let sine = sinc * half;
        let (forward, sideways) = (sinc * displacement.forward, sinc * displacement.sideways);
        Motion {
            pose: Pose2 {
                x: cosine * forward - sine * sideways,
                y: sine * forward + cosine * sideways,
                heading: displacement.rotation,
            },
            cosine: cosine * cosine - sine * sine,
            sine: 2.0 * cosine * sine,
        }
    }

    /// A motion that ends at (x, y) \[m\] with the heading of these changes of the counters (left, right).
    pub(super) fn with_counts(x: f64, y: f64, counts: [i64; 2], geometry: &TickGeometry) -> Motion {
        Motion::from(Pose2 { x: x + 0.0, y: y + 0.0, heading: geometry.heading(counts) })
    }

    /// This motion, then `next` in the frame where this one ends.
    ///
    /// ```
    /// # use umbmark_core::{engine::Motion, geometry::Pose2};
    /// let quarter = Motion::from(Pose2::new(1.0, 1.0, std::f64::consts::FRAC_PI_2));
    /// let square = quarter.then(&quarter).then(&quarter).then(&quarter);
    /// assert!(square.pose.x.abs() < 1e-15 && square.pose.y.abs() < 1e-15);
    /// ```
    #[inline]
    pub fn then(&self, next: &Motion) -> Motion {
        let Motion { pose, cosine, sine } = *self;
        Motion {
            pose: Pose2 {
                x: pose.x + (cosine * next.pose.x - sine * next.pose.y),
                y: pose.y + (sine * next.pose.x + cosine * next.pose.y),
                heading: pose.heading + next.pose.heading,
            },
            cosine: cosine * next.cosine - sine * next.sine,
            sine: sine * next.cosine + cosine * next.sine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_twist_ends_at_its_exponential_and_faces_along_its_rotation() {
        for rotation in [-7.0, -std::f64::consts::PI, -0.7, -1e-9, 0.0, 0.3, 2.0, std::f64::consts::TAU] {
            for (forward, sideways) in [(2.0, 0.1), (-0.5, 0.0), (0.0, -3.0), (0.0, 0.0)] {
                let twist = Displacement2 { forward, sideways, rotation };
                let (motion, pose) = (Motion::exp(&twist), Pose2::exp(&twist));
                let gap = [motion.pose.x - pose.x, motion.pose.y - pose.y, motion.pose.heading - pose.heading];
                let turn = [motion.cosine - libm::cos(rotation), motion.sine - libm::sin(rotation)];
                assert!(gap.iter().chain(&turn).all(|d| d.abs() < 2e-15), "{twist:?}: {motion:?} {pose:?}");
            }
        }
    }

    #[test]
    fn a_chain_of_motions_is_the_composition_of_their_poses() {
        let (mut chain, mut pose) = (Motion::IDENTITY, Pose2::IDENTITY);
        for k in -4..5 {
            let step = Pose2::new(0.3 * f64::from(k), 1.0, 0.9 * f64::from(k));
            chain = chain.then(&Motion::from(step));
            pose = pose.compose(&step);
            assert!(
                (chain.pose.x - pose.x).abs() < 1e-14 && (chain.pose.y - pose.y).abs() < 1e-14,
                "{chain:?} {pose:?}"
            );
            assert_eq!(chain.pose.heading, pose.heading);
            assert!((chain.cosine - libm::cos(pose.heading)).abs() < 1e-14);
            assert!((chain.sine - libm::sin(pose.heading)).abs() < 1e-14);
        }
    }
}
