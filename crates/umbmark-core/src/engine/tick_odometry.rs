//! Tick-exact odometry.

use super::digital_line::DigitalLine;
use super::mid_heading::MidHeading;
use super::{Instructions, Letter, Motion, TickGeometry, WheelLine, word};
use crate::geometry::{Pose2, Real};

mod lanes;
#[cfg(target_arch = "x86_64")]
mod x86;

/// Odometry that is updated at every tick of either counter, each tick an exact circular arc.
///
/// The motion of a segment is the ordered product of its ticks, computed in O(log ticks) operations by
/// [`word_product`](super::word_product). Simultaneous ticks count as one joint step: two equal wheels in step drive
/// exactly straight.
///
/// The order of the ticks is exact; rounding moves the end by less than 1e-12 m up to 1e5 ticks, for any ratio of the
/// wheel speeds, and by less than 2e-11 m at 1e7.
#[derive(Clone, Copy, Debug)]
pub struct TickOdometry {
    geometry: TickGeometry,
    left: MidHeading<f64>,
    right: MidHeading<f64>,
    /// Rounding errors of the angles of a left and a right tick \[rad\].
    rounded_off: [f64; 2],
    instructions: Instructions,
}

impl TickOdometry {
    /// Odometry with these tick lengths and this wheelbase.
    pub fn new(geometry: TickGeometry) -> TickOdometry {
        let tick = |letter| MidHeading::of_letter(&geometry, letter, [false; 2]);
        // One fused operation: the remainder of a division, exactly.
        let rounded_off = |length: f64, angle: f64| angle.mul_add(-geometry.wheelbase(), length) / geometry.wheelbase();
        TickOdometry {
            geometry,
            left: tick(Letter::Left),
            right: tick(Letter::Right),
            rounded_off: [
                rounded_off(geometry.left(), -geometry.heading([1, 0])),
                rounded_off(geometry.right(), geometry.heading([0, 1])),
            ],
            instructions: Instructions::best(),
        }
    }

    /// The same odometry, with registers no wider than these: the same bits, maybe slower.
    pub fn limited_to(self, instructions: Instructions) -> TickOdometry {
        TickOdometry { instructions: self.instructions.min(instructions), ..self }
    }

    /// What a tick is worth.
    pub fn geometry(&self) -> &TickGeometry {
        &self.geometry
    }

    /// The motion that the ticks along `line` report.
    ///
    /// ```
    /// use umbmark_core::engine::{TickGeometry, TickOdometry, WheelLine};
    /// // A quarter turn to the left on the spot: π/2 · 0.34 m / 2 per wheel, in ticks of 1 mm.
    /// let odometry = TickOdometry::new(TickGeometry::new(1e-3, 1e-3, 0.34)?);
    /// let ticks = std::f64::consts::FRAC_PI_2 * 170.0;
    /// let motion = odometry.motion(&WheelLine::from_ticks([0.5, 0.5], [-ticks, ticks])?);
    /// assert!((motion.pose.heading - std::f64::consts::FRAC_PI_2).abs() < 2e-3 / 0.34);
    /// # Ok::<(), umbmark_core::engine::EngineError>(())
    /// ```
    #[inline]
    pub fn motion(&self, line: &WheelLine) -> Motion {
        let backward = line.backward();
        let product = word::product(&DigitalLine::new(line), |letter| match letter {
            Letter::Left => self.left.reversed_if(backward[0]),
            Letter::Right => self.right.reversed_if(backward[1]),
            Letter::Joint => MidHeading::of_letter(&self.geometry, letter, backward),
        });
        let [x, y, cosine, sine] = product.end();
        let heading = self.geometry.heading(line.counts());
        let motion = Motion { pose: Pose2 { x, y, heading }, cosine, sine };
        if lanes::fits(line) { motion } else { self.less_rounding(line.counts(), motion) }
    }

    /// The motion of a long line, corrected for the sum of the rounding errors of its tick angles, which act like a miscalibration of
    /// 1e-16.
    ///
    /// The heading errs by a share of the way that is done. To first order that moves the end of an arc of length l and
    /// rotation 2h, as seen from halfway, by (l/2) (sinc' h, sinc h) for each radian at its end.
    #[cold]
    fn less_rounding(&self, counts: [i64; 2], motion: Motion) -> Motion {
        let turned = counts[1] as f64 * self.rounded_off[1] - counts[0] as f64 * self.rounded_off[0];
        let half = 0.5 * motion.pose.heading;
        let (sinc, c) = half.sinc_cos();
        let s = sinc * half;
        let slope = if half.abs() < 1e-3 { -half / 3.0 } else { (c - sinc) / half };
        let moved = 0.5 * self.geometry.distance(counts) * turned;
        let (ahead, aside) = (moved * slope, moved * sinc);
        Motion {
            pose: Pose2 {
                x: motion.pose.x + (c * ahead - s * aside),
                y: motion.pose.y + (s * ahead + c * aside),
                heading: motion.pose.heading,
            },
            cosine: motion.cosine - turned * motion.sine,
            sine: motion.sine + turned * motion.cosine,
        }
    }

    /// The motions that the ticks along `lines` report, into the `motions` of the same places.
    ///
    /// The same bits as one by one, several lines at once where the machine can ([`Instructions`]). Neighbours that are
    /// alike, legs beside legs and turns beside turns, go fastest. Only as many are computed as the shorter of the two
    /// slices has.
    pub fn motions<L: AsRef<WheelLine>>(&self, lines: &[L], motions: &mut [Motion]) {
        #[cfg(target_arch = "x86_64")]
        if self.instructions > Instructions::Portable {
            return self.motions_in_lanes(lines, motions);
        }
        lines.iter().zip(motions).for_each(|(line, motion)| *motion = self.motion(line.as_ref()));
    }
}

#[cfg(test)]
mod tests;
