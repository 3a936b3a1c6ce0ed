//! How far a filtered measurement is behind the robot.

use crate::effect::{Context, Evaluate, Filter};
use crate::geometry::Pose2;

/// A run that moves so soon after its first sample was moving before it \[s\].
const AT_ONCE: f64 = 1e-9;

/// The distance from a filtered pose to the true one, `dℓ/dt = d pose/dt - ℓ/τ`, while a robot goes through the pieces of its track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Behind<T> {
    filter: Filter<T>,
    /// In x, y and heading \[m, m, rad\].
    lag: [T; 3],
    /// When \[s\]; `None` before the first piece.
    time: Option<f64>,
    /// Of the last piece: its duration \[s\], the share of the lag that it leaves, and the share of its own way that it adds.
    last: (f64, T, T),
}

impl<T: Evaluate> Behind<T> {
    pub fn new(filter: Filter<T>) -> Behind<T> {
        let [nothing, one] = [T::from(0.0), T::from(1.0)];
        Behind { filter, lag: [nothing; 3], time: None, last: (0.0, one, one) }
    }

    fn shares(&mut self, duration: f64) -> (T, T) {
        if duration != self.last.0 {
            let left = (-(self.filter.time_constant.recip() * duration)).exponential();
            // Of what takes no time, nothing is followed yet.
            let added = match duration {
                0.0 => T::from(1.0),
                _ => self.filter.time_constant * (1.0 / duration) * (-left + 1.0),
            };
            self.last = (duration, left, added);
        }
        (self.last.1, self.last.2)
    }

    /// The robot stands until then.
    pub fn rest(&mut self, until: f64) {
        let duration = self.time.map_or(0.0, |time| until - time);
        if duration > 0.0 {
            let left = self.shares(duration).0;
            self.lag.iter_mut().for_each(|lag| *lag *= left);
            self.time = Some(until);
        }
    }

    /// The robot goes from a pose to another at constant speed, on a piece of its track, and is there `until` then.
    pub fn goes(&mut self, at: &Context, (from, to): (&Pose2<T>, &Pose2<T>), until: f64) {
        let began = self.time.map_or(at.time, |time| time.max(at.time));
        let way = [to.x - from.x, to.y - from.y, to.heading - from.heading];
        if self.time.is_none() && at.recorded && at.time <= AT_ONCE && at.duration > 0.0 {
            self.lag = way.map(|way| way * (1.0 / at.duration) * self.filter.time_constant);
        }
        self.time = self.time.or(Some(at.time));
        self.rest(at.time);
        let duration = until - began;
        if duration < 0.0 {
            return;
        }
        let (left, added) = self.shares(duration);
        for (lag, way) in self.lag.iter_mut().zip(way) {
            *lag = *lag * left + way * added;
        }
        self.time = Some(until);
    }

    /// The filtered pose.
    pub fn seen(&self, pose: &Pose2<T>) -> Pose2<T> {
        let [x, y, heading] = self.lag.map(|lag| lag * self.filter.share);
        Pose2 { x: pose.x - x, y: pose.y - y, heading: pose.heading - heading }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_way_that_takes_no_time_nothing_is_followed_yet() {
        let mut behind = Behind::new(Filter { share: 1.0, time_constant: 0.1 });
        let at = |time: f64, duration: f64| Context { time, duration, ..Context::default() };
        let poses = [0.0, 0.2, 0.5].map(|x| Pose2::new(x, 0.0, 0.0));
        behind.goes(&at(1.0, 1.0), (&poses[0], &poses[1]), 2.0);
        let before = behind.seen(&poses[1]);
        behind.goes(&at(2.0, 0.0), (&poses[1], &poses[2]), 2.0);
        let after = behind.seen(&poses[2]);
        assert!((after.x - before.x).abs() < 1e-15 && before.x < 0.2, "{before:?} {after:?}");
    }
}
