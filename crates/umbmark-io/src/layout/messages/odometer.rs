//! Distance and turn of the body, summed up from odometry messages.

use super::clock::Times;
use super::fields::{Fields, Number};
use super::track::{PlanarPose, place};
use umbmark_core::geometry::wrap;

/// Sums from message to message: by the poses, and by the speeds for robots that fill in only these.
#[derive(Default)]
pub(in crate::layout) struct Odometer {
    before: Option<(Times, PlanarPose)>,
    /// Distance \[m\] and turn \[rad\] by the poses.
    by_pose: [f64; 2],
    by_twist: [f64; 2],
    twist: [Vec<f64>; 2],
}

impl Odometer {
    /// Distance and turn up to a message, each step an arc.
    pub fn advance(&mut self, times: &Times, fields: &Fields) -> Result<[f64; 2], String> {
        let now = place(fields)?;
        let heading = now.heading.unwrap_or(0.0);
        if let Some((then, before)) = self.before {
            let start = before.heading.unwrap_or(0.0);
            let turn = wrap(heading - start);
            let (dx, dy) = (now.x - before.x, now.y - before.y);
            let middle = start + 0.5 * turn;
            let chord = libm::copysign(libm::hypot(dx, dy), dx * libm::cos(middle) + dy * libm::sin(middle));
            let half = 0.5 * turn;
            let stretch = if half.abs() < 1e-6 { 1.0 } else { half / libm::sin(half) };
            self.by_pose = [self.by_pose[0] + chord * stretch, self.by_pose[1] + turn];
            let stamped = times.stamped != 0 && then.stamped != 0;
            let (a, b) = if stamped { (then.stamped, times.stamped) } else { (then.logged, times.logged) };
            let seconds = b.saturating_sub(a).max(0) as f64 / 1e9;
            for (sum, rate) in self.by_twist.iter_mut().zip([Number::Speed, Number::TurnRate]) {
                *sum += fields.number(rate) * seconds;
            }
        }
        self.before = Some((*times, now));
        for (column, value) in self.twist.iter_mut().zip(self.by_twist) {
            column.push(value);
        }
        Ok(self.by_pose)
    }

    /// Distance and turn by the speeds, where the poses never change and the speeds are not all zero.
    pub fn twist_alone(&self) -> Option<[Vec<f64>; 2]> {
        let moved = self.by_twist.iter().any(|sum| *sum != 0.0);
        let finite = self.twist.iter().flatten().all(|value| value.is_finite());
        (self.by_pose == [0.0; 2] && moved && finite).then(|| self.twist.clone())
    }
}
