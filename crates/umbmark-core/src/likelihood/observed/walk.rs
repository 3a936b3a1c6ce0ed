//! A run as a model predicts it: the pose after each piece, and how its error grows.

use super::Growth;
use crate::effect::{Chain, Context};
use crate::geometry::{Displacement2, Pose2};
use crate::replay::{Moment, Track};

/// Mean rate of change of the tracked pose over some observations: the effect of a delay of one second.
///
/// A point at r from the middle of the axle moves at v + ω J r.
pub(super) fn velocity(places: &[Pose2], tracked: &[Pose2], moments: &[Moment]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for ((place, tracked), Moment { sight, .. }) in places.iter().zip(tracked).zip(moments) {
        let (sine, cosine) = libm::sincos(place.heading);
        let (x, y) = (tracked.x - place.x, tracked.y - place.y);
        let rates =
            [sight.speed * cosine - sight.turn_rate * y, sight.speed * sine + sight.turn_rate * x, sight.turn_rate];
        for (total, rate) in sum.iter_mut().zip(rates) {
            *total += rate / places.len() as f64;
        }
    }
    sum
}

/// Predicted pose after each piece, with distance driven, rotation and mean way of the wheels until then.
pub(super) struct Walk {
    pub places: Vec<Pose2>,
    pub way: Vec<f64>,
    pub turned: Vec<f64>,
    pub rolled: Vec<f64>,
    /// How far the robot is beside these places because the wheels did not turn evenly within the pieces.
    pub beside: Vec<[f64; 2]>,
}

/// How far to the left of an arc the robot ends whose speed v and turn rate ω change evenly within a recorded piece of duration T \[m\]:
/// T²(ω dv - v dω)/12.
fn uneven(at: &Context, motion: &Displacement2) -> f64 {
    if !at.recorded {
        return 0.0;
    }
    let change = 0.5 * (at.speed_change[0] + at.speed_change[1]);
    at.duration * (motion.rotation * change - motion.forward * at.turn_rate_change) / 12.0
}

impl Walk {
    pub fn new(track: &Track, chain: &Chain<f64>) -> Walk {
        let (mut pose, mut way, mut turned, mut rolled) = (track.start(chain), 0.0, 0.0, 0.0);
        let mut beside = [0.0; 2];
        let mut walk = Walk {
            places: vec![pose],
            way: vec![way],
            turned: vec![turned],
            rolled: vec![rolled],
            beside: vec![beside],
        };
        for (travel, at) in track.travel().iter().zip(track.contexts()) {
            let motion = chain.displacement(&at.at_pose(&pose), travel);
            let (sine, cosine) = libm::sincos(pose.heading + 0.5 * motion.rotation);
            let aside = uneven(at, &motion);
            beside = [beside[0] - sine * aside, beside[1] + cosine * aside];
            pose.advance(&motion);
            way += motion.forward.abs();
            turned += motion.rotation.abs();
            rolled += travel.rolled();
            walk.places.push(pose);
            walk.way.push(way);
            walk.turned.push(turned);
            walk.rolled.push(rolled);
            walk.beside.push(beside);
        }
        walk
    }

    /// How far the robot is beside the place at a moment.
    pub fn beside_at(&self, moment: &Moment) -> [f64; 2] {
        let from = self.beside[moment.made];
        self.beside
            .get(moment.made + 1)
            .map_or(from, |to| std::array::from_fn(|k| from[k] + moment.share.clamp(0.0, 1.0) * (to[k] - from[k])))
    }

    /// The pose at a moment.
    pub fn at(&self, moment: &Moment) -> Pose2 {
        let from = &self.places[moment.made];
        self.places.get(moment.made + 1).map_or(*from, |to| from.toward(to, moment.share))
    }

    /// How the error grows from a place on the walk (pieces made, and the share of the next) until the last of `seen`, each piece weighted by
    /// the share of these places that see it, to the power 0, 1 and 2.
    pub fn growths(&self, mut from: f64, seen: impl ExactSizeIterator<Item = f64>) -> [Growth; 3] {
        let mut growths = [Growth::default(); 3];
        let count = seen.len() as f64;
        for (index, to) in seen.enumerate() {
            let share = (count - index as f64) / count;
            for (growth, weight) in growths.iter_mut().zip([1.0, share, share * share]) {
                self.grow(growth, weight, from, to);
            }
            from = from.max(to);
        }
        growths
    }

    fn grow(&self, growth: &mut Growth, weight: f64, from: f64, to: f64) {
        let last = self.places.len() - 1;
        for piece in (from as usize)..(to.ceil() as usize).min(last) {
            let (begun, ended) = ((from - piece as f64).max(0.0), (to - piece as f64).min(1.0));
            let part = weight * (ended - begun).max(0.0);
            let (a, b) = (&self.places[piece], &self.places[piece + 1]);
            let g = [0.5 * (a.y + b.y), -0.5 * (a.x + b.x), 1.0];
            let outer = [g[0] * g[0], g[1] * g[0], g[1] * g[1], g[0], g[1], 1.0];
            let of = |sum: &[f64]| part * (sum[piece + 1] - sum[piece]);
            let (way, turned, rolled) = (of(&self.way), of(&self.turned), of(&self.rolled));
            let (sine, cosine) = libm::sincos(0.5 * (a.heading + b.heading));
            for (sum, product) in growth.forward.iter_mut().zip([cosine * cosine, cosine * sine, sine * sine]) {
                *sum += rolled * product;
            }
            for (k, product) in outer.into_iter().enumerate() {
                growth.heading_per_metre[k] += way * product;
                growth.heading_per_radian[k] += turned * product;
            }
            growth.way += way;
            growth.rolled += rolled;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Encoder, Robot};
    use crate::effect::Model;
    use crate::run::TickLog;

    /// Way and heading after so long: both speed up for two seconds at constant rates, one after the other, and slow down likewise.
    fn driven(seconds: f64) -> [f64; 2] {
        let ramp = |t: f64| match t {
            _ if t < 0.0 => 0.0,
            _ if t < 2.0 => 0.25 * t * t,
            _ => t - 1.0,
        };
        [0.4 * (ramp(seconds) - ramp(seconds - 6.0)), 0.7 * (ramp(seconds - 0.5) - ramp(seconds - 5.0))]
    }

    /// Oracle: the way in steps of 0.1 ms.
    #[test]
    fn where_the_wheels_turn_unevenly_the_robot_is_beside_the_arcs_by_what_is_told() {
        let mut robot = Robot::labmate();
        robot.encoder = Encoder::new(1e9, None, None).unwrap();
        let (rate, last) = (5.0, 45);
        let per_tick = robot.metres_per_tick();
        let time: Vec<f64> = (0..=last).map(|k| f64::from(k) / rate).collect();
        let counts = |side: f64, per_tick: f64| -> Vec<f64> {
            let travel = time.iter().map(|t| driven(*t)).map(|[way, turn]| way + side * robot.drive.wheelbase() * turn);
            travel.map(|travel| (travel / per_tick).round()).collect()
        };
        let (left, right) = (counts(-0.5, per_tick.left), counts(0.5, per_tick.right));
        let track = Track::from_log(&TickLog { time, left, right, ..TickLog::default() }, &robot).unwrap();
        let walk = Walk::new(&track, &Model::new(&robot).chain());
        let (mut x, mut y) = (0.0, 0.0);
        for step in 0..(1e4 * f64::from(last) / rate) as usize {
            let [from, to] = [step, step + 1].map(|step| driven(1e-4 * step as f64));
            let (sine, cosine) = libm::sincos(0.5 * (from[1] + to[1]));
            (x, y) = (x + (to[0] - from[0]) * cosine, y + (to[0] - from[0]) * sine);
        }
        let (end, beside) = (walk.places.last().unwrap(), walk.beside.last().unwrap());
        let off = libm::hypot(x - end.x, y - end.y);
        let left = libm::hypot(x - end.x - beside[0], y - end.y - beside[1]);
        assert!(off > 1e-3 && left < 0.02 * off, "{off} {left}");
    }
}
