//! A run as a model predicts it: the pose after each piece, and how its error grows.

use super::Growth;
use crate::effect::Chain;
use crate::geometry::Pose2;
use crate::replay::{Moment, Track};

/// Mean rate of change of the tracked pose over some observations: the effect of a delay of one second.
///
/// A point at r from the middle of the axle moves at v + ω J r.
pub(super) fn velocity(places: &[Pose2], tracked: &[Pose2], moments: &[Moment]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for ((place, tracked), Moment { sight, .. }) in places.iter().zip(tracked).zip(moments) {
        let (sine, cosine) = libm::sincos(place.heading);
        let (x, y) = (tracked.x - place.x, tracked.y - place.y);
        let mut rates =
            [sight.speed * cosine - sight.turn_rate * y, sight.speed * sine + sight.turn_rate * x, sight.turn_rate];
        if sight.speed_aside != 0.0 {
            rates[0] -= sight.speed_aside * sine;
            rates[1] += sight.speed_aside * cosine;
        }
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
    /// Direction of motion in each piece from the heading \[rad\]; 0 of a drive that does not move sideways.
    courses: Vec<f64>,
}

impl Walk {
    pub fn new(track: &Track, chain: &Chain<f64>) -> Walk {
        let (mut pose, mut way, mut turned, mut rolled) = (track.start(chain), 0.0, 0.0, 0.0);
        let mut walk = Walk {
            places: vec![pose],
            way: vec![way],
            turned: vec![turned],
            rolled: vec![rolled],
            courses: Vec::new(),
        };
        for (travel, at) in track.travel().iter().zip(track.contexts()) {
            let motion = chain.displacement(&at.at_pose(&pose), travel);
            pose.advance(&motion);
            let (mut gone, mut course) = (motion.forward.abs(), 0.0);
            if at.aside.way != 0.0 {
                gone = libm::hypot(motion.forward, motion.sideways);
                course = libm::atan2(motion.sideways, motion.forward);
            }
            way += gone;
            walk.courses.push(course);
            turned += motion.rotation.abs();
            rolled += travel.rolled().max(at.aside.way.abs());
            walk.places.push(pose);
            walk.way.push(way);
            walk.turned.push(turned);
            walk.rolled.push(rolled);
        }
        walk
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
            let (sine, cosine) = libm::sincos(0.5 * (a.heading + b.heading) + self.courses[piece]);
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
