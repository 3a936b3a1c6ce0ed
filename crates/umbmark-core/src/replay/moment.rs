//! The moment that a measurement shows: its time stamp minus the delay of the reference.

use super::track::Track;
use crate::effect::{Aside, Chain, Context, Evaluate, Sight};

/// Steps of time that rounding makes \[s\].
const ROUNDING: f64 = 1e-9;

/// Where in a track a measurement was really taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Number of pieces completed by then.
    pub made: usize,
    /// Completed share of the next piece; below 0 before the beginning of a log, above 1 of the last piece after its end.
    pub share: f64,
    /// The measurement, with the speed and the turn rate at that moment.
    pub sight: Sight,
}

impl Moment {
    /// Pieces completed by then, and the share of the next that the log has.
    pub fn reached(&self) -> f64 {
        self.made as f64 + self.share.clamp(0.0, 1.0)
    }
}

/// Goes through the moments of a track in the order of time.
pub(super) struct Moments<'a> {
    track: &'a Track,
    made: usize,
}

impl<'a> Moments<'a> {
    pub fn new(track: &'a Track) -> Moments<'a> {
        Moments { track, made: 0 }
    }

    /// The moment of a measurement with the delay `late`; moments must be requested in order.
    pub fn next(&mut self, sight: &Sight, late: f64) -> Moment {
        let contexts = &self.track.contexts;
        let time = sight.time - late;
        let ends = |at: &Context| at.time + at.duration;
        while self.made < contexts.len() && ends(&contexts[self.made]) <= time + ROUNDING {
            self.made += 1;
        }
        let still = Sight { late, speed: 0.0, speed_aside: 0.0, turn_rate: 0.0, ..*sight };
        let in_piece = |made: usize| {
            let at = &contexts[made];
            let gone = if at.duration > 0.0 { (time - at.time) / at.duration } else { 0.0 };
            let (share, pace) = course(at, self.track.ratio(made), gone);
            let (speed, turn_rate) = if at.recorded {
                let off = gone.clamp(0.0, 1.0) - 0.5;
                let change = 0.5 * (at.speed_change[0] + at.speed_change[1]);
                (at.speed + off * change, at.turn_rate + off * at.turn_rate_change)
            } else {
                (pace * at.speed, pace * at.turn_rate)
            };
            Moment { made, share, sight: Sight { speed, speed_aside: at.aside.speed, turn_rate, ..still } }
        };
        match contexts.get(self.made) {
            Some(at) if time >= at.time - ROUNDING || self.made == 0 && at.time <= ROUNDING => in_piece(self.made),
            None if contexts.last().is_some_and(|at| ends(at) >= self.track.duration - ROUNDING && ends(at) < time) => {
                in_piece(self.made - 1)
            }
            _ => Moment { made: self.made, share: 0.0, sight: still },
        }
    }
}

/// Which wheel is the faster one in a piece.
fn faster(at: &Context) -> usize {
    usize::from(at.wheel_speed[1].abs() > at.wheel_speed[0].abs())
}

/// Share of a piece that is made after a share of its time, and the speed there over its mean: the cubic that has the speeds of both ends,
/// which are `ratio` times as long as the way is. Beyond the ends of the log the robot keeps its speed.
fn course(at: &Context, ratio: f64, gone: f64) -> (f64, f64) {
    let (mean, half) = (at.wheel_speed[faster(at)], 0.5 * at.speed_change[faster(at)]);
    // Of a base that moves sideways, no wheel of the axle says how far it got.
    if at.aside != Aside::NONE || !(0.0..=1.0).contains(&gone) || half.abs() > mean.abs() || mean == 0.0 {
        return (gone, 1.0);
    }
    let [from, to] = [mean - half, mean + half].map(|speed| speed / mean * ratio);
    let cubic = from + to - 2.0;
    let square = 3.0 - 2.0 * from - to;
    (gone * (from + gone * (square + gone * cubic)), (from + gone * (2.0 * square + gone * 3.0 * cubic)) / ratio)
}

impl Track {
    /// The way that the speeds at both ends of a piece would make in its time over its own. The speeds of a recorded piece are smoothed, so
    /// the ratio is 1.
    fn ratio(&self, made: usize) -> f64 {
        let (at, travel) = (&self.contexts[made], &self.travel[made]);
        let own = [travel.left, travel.right][faster(at)];
        if at.recorded || own == 0.0 { 1.0 } else { at.duration * at.wheel_speed[faster(at)] / own }
    }

    /// The moments that the measurements show.
    pub fn moments<T: Evaluate>(&self, chain: &Chain<T>) -> Vec<Moment> {
        let sights = self.seen_after.iter().zip(&self.sights);
        if !chain.has_clock() || self.convoy.is_some() {
            return sights.map(|(made, sight)| Moment { made: *made, share: 0.0, sight: *sight }).collect();
        }
        let mut moments = Moments::new(self);
        sights.map(|(_, sight)| moments.next(sight, chain.late(sight.time).value())).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::dataset::{ReferencePose, TickLog};
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::geometry::Pose2;
    use crate::replay::Track;

    /// Where a robot is that rests for a second, speeds up at 0.4 m/s², turning, for a second, goes on for two and rests again.
    fn way(t: f64) -> f64 {
        match t {
            _ if t < 1.0 => 0.0,
            _ if t < 2.0 => 0.2 * (t - 1.0).powi(2),
            _ if t < 4.0 => 0.2 + 0.4 * (t - 2.0),
            _ if t < 5.0 => 1.0 + 0.4 * (t - 4.0) - 0.2 * (t - 4.0).powi(2),
            _ => 1.2,
        }
    }

    /// Counts of a thousand million a turn, `rate` of them a second, between these times; a pose every 40 ms.
    fn log(from: f64, to: f64, rate: f64) -> TickLog {
        let count = |t: f64, wheel: f64| (wheel * (way(t) - way(from)) / (std::f64::consts::PI * 0.15) * 1e9).round();
        let time: Vec<f64> = (0..=((to - from) * rate).round() as usize).map(|k| k as f64 / rate).collect();
        let of = |wheel: f64| time.iter().map(|t| count(from + t, wheel)).collect::<Vec<f64>>();
        let every = (0.04 * rate).round() as usize;
        let seen = |sample| ReferencePose { sample, x: 0.0, y: 0.0, heading: Some(0.0) };
        let reference = (0..time.len()).step_by(every).map(seen).collect();
        TickLog { left: of(0.9), right: of(1.1), time, reference, ..TickLog::default() }
    }

    fn fine() -> Robot {
        let mut robot = Robot::labmate();
        robot.encoder = crate::drive::Encoder::new(1e9, None, None).unwrap();
        robot
    }

    /// Where the robot truly is after a way from `start`, on its circle.
    fn pose(gone: f64) -> Pose2 {
        let turn = 0.2 * gone / 0.34;
        Pose2::IDENTITY.moved(&crate::geometry::Displacement2 { forward: gone, sideways: 0.0, rotation: turn })
    }

    #[test]
    fn a_late_reference_shows_where_the_robot_was_through_ramps_rests_and_both_ends_of_the_log() {
        let robot = fine();
        for (from, to) in [(0.0, 6.0), (2.5, 3.5)] {
            let log = log(from, to, 100.0);
            let track = Track::from_log(&log, &robot).unwrap();
            for late in [0.0, 0.3, -0.3, 0.0137] {
                let mut model = Model::new(&robot);
                model.set("reference_delay", "delay_s", late).unwrap();
                let poses = track.poses(&model.chain());
                for (k, found) in poses.iter().enumerate() {
                    let time = from + 0.04 * k as f64 - late;
                    let expected = pose(way(time) - way(from));
                    let off = (found.x - expected.x).hypot(found.y - expected.y);
                    assert!(off < 1e-5 && (found.heading - expected.heading).abs() < 1e-5, "{late} {time} {off}");
                }
            }
        }
    }

    #[test]
    fn a_clock_that_loses_is_later_and_later() {
        let (robot, mut model) = (fine(), Model::new(&fine()));
        model.set("reference_clock_rate", "ratio", 0.05).unwrap();
        let track = Track::from_log(&log(0.0, 6.0, 100.0), &robot).unwrap();
        for (k, found) in track.poses(&model.chain()).iter().enumerate() {
            let expected = pose(way(0.04 * k as f64 * 0.95));
            assert!((found.x - expected.x).hypot(found.y - expected.y) < 1e-5);
        }
    }

    #[test]
    fn derivatives_by_the_delay_are_those_of_finite_differences() {
        let (robot, mut model) = (fine(), Model::new(&fine()));
        model.set("reference_delay", "delay_s", 0.1).unwrap();
        let track = Track::from_log(&log(0.0, 6.0, 100.0), &robot).unwrap();
        let slopes = track.poses(&model.chains(&[0]).next().unwrap().0);
        let at = |delay: f64| {
            let mut moved = model.clone();
            moved.set("reference_delay", "delay_s", delay).unwrap();
            track.poses(&moved.chain())
        };
        for (k, ((slope, high), low)) in slopes.iter().zip(at(0.104)).zip(at(0.096)).enumerate() {
            let pairs =
                [(slope.x, high.x - low.x), (slope.y, high.y - low.y), (slope.heading, high.heading - low.heading)];
            for (own, difference) in pairs {
                // Speeds are those over a tenth of a second.
                let of = (k, own.eps[0], difference / 0.008);
                assert!((of.1 - of.2).abs() < 0.02, "{of:?}");
            }
        }
    }
}
