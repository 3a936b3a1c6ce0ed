//! Where a robot is beside the arcs of its odometry, because its wheels did not turn evenly between two readings of the counters.
//!
//! Speed v and turn rate ω that change evenly by dv and dω in a reading of duration T end it T²(ω dv - v dω)/12 to the left of the arc with
//! the same counts. After a share u of it, the robot is ½ u(1 - u) T dv behind the place at which even wheels would be, and its heading
//! ½ u(1 - u) T dω.

use crate::geometry::Pose2;
use crate::replay::{Moment, Track};

/// Steps of time that rounding makes \[s\].
const ROUNDING: f64 = 1e-9;

/// A reading of the counters, as a model predicts the motion in it.
#[derive(Clone, Copy, Debug, Default)]
struct Reading {
    duration: f64,
    forward: f64,
    /// Of a drive that moves sideways by itself, to the left.
    sideways: f64,
    rotation: f64,
}

impl Reading {
    /// Speed ahead and to the left \[m/s\], and turn rate \[rad/s\].
    fn rates(&self) -> [f64; 3] {
        [self.forward / self.duration, self.sideways / self.duration, self.rotation / self.duration]
    }
}

/// What is beside the arcs of a track.
pub(super) struct Uneven<'a> {
    places: &'a [Pose2],
    times: &'a [f64],
    /// Changes of the speeds and of the turn rate in each reading.
    changes: Vec<[f64; 3]>,
    /// How far the robot is beside the place after each piece \[m\].
    beside: Vec<[f64; 2]>,
}

impl<'a> Uneven<'a> {
    /// By the `places` after each piece, and the `times` of the readings since the log began \[s\]; of a track without readings, nothing.
    pub fn new(track: &'a Track, places: &'a [Pose2], times: &'a [f64]) -> Uneven<'a> {
        let reading_of = |time: f64| reading_at(times, time);
        let mut readings: Vec<Reading> =
            times.windows(2).map(|pair| Reading { duration: pair[1] - pair[0], ..Reading::default() }).collect();
        for (at, pair) in track.contexts().iter().zip(places.windows(2)) {
            let Some(reading) = reading_of(at.time).and_then(|k| readings.get_mut(k)) else { continue };
            let (sine, cosine) = libm::sincos(0.5 * (pair[0].heading + pair[1].heading));
            reading.forward += cosine * (pair[1].x - pair[0].x) + sine * (pair[1].y - pair[0].y);
            if at.aside.way != 0.0 {
                reading.sideways += cosine * (pair[1].y - pair[0].y) - sine * (pair[1].x - pair[0].x);
            }
            reading.rotation += pair[1].heading - pair[0].heading;
        }
        let changes: Vec<[f64; 3]> = (0..readings.len()).map(|k| changes(&readings, k)).collect();
        let mut beside = [0.0; 2];
        let mut all = vec![beside];
        for (at, pair) in track.contexts().iter().zip(places.windows(2)) {
            if let Some(k) = reading_of(at.time).filter(|k| *k < readings.len()) {
                let (reading, [faster, sliding, turning]) = (&readings[k], changes[k]);
                let part = (at.duration / reading.duration).min(1.0);
                let aside = reading.duration * (reading.rotation * faster - reading.forward * turning) / 12.0;
                let aside = aside * part;
                let (sine, cosine) = libm::sincos(0.5 * (pair[0].heading + pair[1].heading));
                beside = [beside[0] - sine * aside, beside[1] + cosine * aside];
                if sliding != 0.0 || reading.sideways != 0.0 {
                    let back =
                        reading.duration * (reading.rotation * sliding - reading.sideways * turning) / 12.0 * part;
                    beside = [beside[0] - cosine * back, beside[1] - sine * back];
                }
            }
            all.push(beside);
        }
        Uneven { places, times, changes, beside: all }
    }

    /// How far the robot is from the predicted pose at a moment \[m, m, rad\].
    pub fn at(&self, moment: &Moment) -> [f64; 3] {
        let from = self.beside[moment.made];
        let Some(to) = self.beside.get(moment.made + 1).filter(|_| moment.share != 0.0) else {
            let [x, y, heading] = self.between(moment);
            return [from[0] + x, from[1] + y, heading];
        };
        // The share is that of wheels whose speed changes.
        let share = moment.share.clamp(0.0, 1.0);
        [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]), 0.0]
    }

    /// How far it is from the place at which even wheels would be between two readings.
    fn between(&self, moment: &Moment) -> [f64; 3] {
        let time = moment.sight.time - moment.sight.late;
        let Some(k) = reading_at(self.times, time).filter(|k| *k < self.changes.len()) else { return [0.0; 3] };
        let duration = self.times[k + 1] - self.times[k];
        let share = (time - self.times[k]) / duration;
        let [faster, sliding, turning] =
            self.changes[k].map(|change| 0.5 * share * (1.0 - share).max(0.0) * duration * change);
        let (sine, cosine) = libm::sincos(self.places[moment.made].heading);
        if sliding == 0.0 {
            return [-faster * cosine, -faster * sine, -turning];
        }
        [sliding * sine - faster * cosine, -faster * sine - sliding * cosine, -turning]
    }
}

/// The reading in which a time lies.
fn reading_at(times: &[f64], time: f64) -> Option<usize> {
    times.partition_point(|begun| *begun <= time + ROUNDING).checked_sub(1)
}

/// Changes of the speeds and of the turn rate in a reading, by the readings before and after it; none at the ends of a log.
fn changes(readings: &[Reading], own: usize) -> [f64; 3] {
    let (Some(before), Some(after)) = (own.checked_sub(1).map(|k| &readings[k]), readings.get(own + 1)) else {
        return [0.0; 3];
    };
    let duration = readings[own].duration;
    let between = 0.5 * before.duration + duration + 0.5 * after.duration;
    let (from, to) = (before.rates(), after.rates());
    [0, 1, 2].map(|k| (to[k] - from[k]) * duration / between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Encoder, Robot};
    use crate::effect::Model;
    use crate::likelihood::observed::walk::Walk;
    use crate::run::{PoseRow, TickLog, place};

    const RATE: f64 = 5.0;

    /// Way and heading after so long: both speed up for two seconds at constant rates, one after the other, and slow down likewise.
    fn driven(seconds: f64) -> [f64; 2] {
        let ramp = |t: f64| match t {
            _ if t < 0.0 => 0.0,
            _ if t < 2.0 => 0.25 * t * t,
            _ => t - 1.0,
        };
        [0.4 * (ramp(seconds) - ramp(seconds - 6.0)), 0.7 * (ramp(seconds - 0.4) - ramp(seconds - 5.0))]
    }

    /// Readings five times a second, and poses at these times.
    fn log(robot: &Robot, poses: &[f64]) -> TickLog {
        let per_tick = robot.metres_per_tick();
        let time: Vec<f64> = (0..=45).map(|k| f64::from(k) / RATE).collect();
        let counts = |side: f64, per_tick: f64| -> Vec<f64> {
            let travel = time.iter().map(|t| driven(*t)).map(|[way, turn]| way + side * robot.drive.wheelbase() * turn);
            travel.map(|travel| (travel / per_tick).round()).collect()
        };
        let (left, right) = (counts(-0.5, per_tick.left), counts(0.5, per_tick.right));
        let mut log = TickLog { time, left, right, ..TickLog::default() };
        let rows: Vec<PoseRow> = poses.iter().map(|_| (0.0, 0.0, Some(0.0))).collect();
        assert_eq!(place(&mut log, poses, &rows), 0);
        log
    }

    /// Oracle: the way in steps of 0.1 ms. Poses at readings, and between them, where the log has samples of its own for them. The kinks of
    /// the ramps are uneven within a reading.
    #[test]
    fn where_the_wheels_turn_unevenly_the_robot_is_beside_the_arcs_by_what_is_told() {
        let mut robot = Robot::labmate();
        robot.encoder = Encoder::new(1e9, None, None).unwrap();
        let chain = Model::new(&robot).chain();
        for (poses, most) in [(vec![3.0, 6.0, 9.0], 0.05), ((1..=55).map(|k| 0.163 * f64::from(k)).collect(), 0.5)] {
            let log = log(&robot, &poses);
            let times: Vec<f64> = (0..log.time.len()).filter(|k| !log.is_put_in(*k)).map(|k| log.time[k]).collect();
            let track = Track::from_log(&log, &robot).unwrap();
            let walk = Walk::new(&track, &chain);
            let uneven = Uneven::new(&track, &walk.places, &times);
            let (mut x, mut y, mut step) = (0.0, 0.0, 0);
            let (mut off, mut left) = ([0.0; 2], [0.0; 2]);
            for (time, moment) in poses.iter().zip(track.moments(&chain)) {
                while 1e-4 * f64::from(step) < time - 1e-9 {
                    let [from, to] = [step, step + 1].map(|step| driven(1e-4 * f64::from(step)));
                    let (sine, cosine) = libm::sincos(0.5 * (from[1] + to[1]));
                    (x, y) = (x + (to[0] - from[0]) * cosine, y + (to[0] - from[0]) * sine);
                    step += 1;
                }
                let (pose, beside) = (walk.at(&moment), uneven.at(&moment));
                let turned = driven(*time)[1] - pose.heading;
                off[0] = f64::max(off[0], libm::hypot(x - pose.x, y - pose.y));
                left[0] = f64::max(left[0], libm::hypot(x - pose.x - beside[0], y - pose.y - beside[1]));
                off[1] = f64::max(off[1], turned.abs());
                left[1] = f64::max(left[1], (turned - beside[2]).abs());
            }
            assert!(off[0] > 9e-4 && left[0] < most * off[0], "{off:?} {left:?}");
            assert!(left[1] < 1e-9 || off[1] > 1e-3 && left[1] < 0.3 * off[1], "{off:?} {left:?}");
        }
    }

    #[test]
    fn a_track_without_readings_is_nowhere_beside_itself() {
        let robot = Robot::labmate();
        let log = log(&robot, &[1.0, 2.0]);
        let track = Track::from_log(&log, &robot).unwrap();
        let walk = Walk::new(&track, &Model::new(&robot).chain());
        let uneven = Uneven::new(&track, &walk.places, &[]);
        assert!(track.moments(&Model::new(&robot).chain()).iter().all(|moment| uneven.at(moment) == [0.0; 3]));
    }
}
