//! Where along a run the log lost time: rows of a fixed length, while the reference went by a clock.
//!
//! Both see the same robot change between driving and turning, so the moments of these changes set one clock by the other, change by change.

use super::{ReferencePose, TickLog};
use crate::drive::Robot;
use crate::geometry::wrap;

/// Speeds are taken over so much time on either side \[s\].
const HALF_WINDOW: f64 = 0.25;
/// A robot rests where it moves at less than this share of its usual speed.
const REST: f64 = 0.3;
/// No move is shorter than this \[s\].
const SHORTEST: f64 = 0.6;
/// A part of a run did not take longer, as a share, than this.
const MAX_DEPARTURE: f64 = 1.0;

/// What a robot does in a row.
#[derive(Clone, Copy, PartialEq)]
enum Doing {
    Resting,
    Driving,
    Turning,
}

impl TickLog {
    /// Finds where the time was lost that the rows of a log are short of, where the changes between driving and turning show it, and gives each row
    /// the pose of its moment.
    ///
    /// Asks for a log with a [clock excess](TickLog::clock_excess), and with a pose and a heading at each row that were spread evenly over its rows by
    /// the reference's clock. Whether it found anything; else the log stays as it is.
    pub fn find_lost_time(&mut self, robot: &Robot) -> bool {
        let rows = self.time.len();
        if rows < 3 || self.reference.len() != rows {
            return false;
        }
        let poses: Option<Vec<[f64; 3]>> =
            self.reference.iter().map(|pose| Some([pose.x, pose.y, pose.heading?])).collect();
        let Some(poses) = poses else { return false };
        let row = (self.time[rows - 1] - self.time[0]) / (rows - 1) as f64;
        let arm = 0.5 * robot.drive.wheelbase();
        let [counted, seen] = [self.believed(robot), unrolled(&poses)].map(|track| changes(&track, row, arm));
        if counted.len() < 2 || counted.len() != seen.len() || counted.iter().zip(&seen).any(|(a, b)| a.1 != b.1) {
            return false;
        }
        let knots = |found: &[(usize, Doing)]| {
            let all: Vec<f64> = std::iter::once(0)
                .chain(found.iter().map(|(row, _)| *row))
                .chain([rows - 1])
                .map(|row| row as f64)
                .collect();
            all
        };
        let (counted, seen) = (knots(&counted), knots(&seen));
        let slopes: Vec<f64> = counted
            .windows(2)
            .zip(seen.windows(2))
            .map(|(rows, poses)| (poses[1] - poses[0]) / (rows[1] - rows[0]))
            .collect();
        let whole = 1.0 + self.clock_excess;
        if slopes.iter().any(|slope| !((slope * whole - 1.0).abs() < MAX_DEPARTURE)) {
            return false;
        }
        let mut part = 0;
        let mut along = Vec::with_capacity(rows);
        for sample in 0..rows {
            while part + 1 < slopes.len() && sample as f64 > counted[part + 1] {
                part += 1;
            }
            along.push(slopes[part] * whole - 1.0);
            let at = seen[part] + slopes[part] * (sample as f64 - counted[part]);
            let before = (at.max(0.0) as usize).min(rows - 2);
            let share = (at - before as f64).clamp(0.0, 1.0);
            let [from, to] = [poses[before], poses[before + 1]];
            let turned = wrap(to[2] - from[2]);
            self.reference[sample] = ReferencePose {
                sample,
                x: from[0] + share * (to[0] - from[0]),
                y: from[1] + share * (to[1] - from[1]),
                heading: Some(wrap(from[2] + share * turned)),
            };
        }
        self.clock_excess_along = along;
        true
    }

    /// Ways ahead and to the left in the frame of the body \[m\], and the heading \[rad\], at each row.
    fn believed(&self, robot: &Robot) -> Vec<[f64; 3]> {
        let (per_tick, asides) = (robot.metres_per_tick(), self.asides(robot));
        let at = |sample: usize| {
            let [left, right] = [self.left[sample] * per_tick.left, self.right[sample] * per_tick.right];
            let aside = asides.get(sample).map_or(0.0, |[way, _]| *way);
            [0.5 * (left + right), aside, (right - left) / robot.drive.wheelbase()]
        };
        (0..self.time.len()).map(at).collect()
    }
}

/// Poses with headings that go on where they pass a half turn.
fn unrolled(poses: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut heading = poses[0][2];
    poses
        .iter()
        .map(|[x, y, now]| {
            heading += wrap(now - heading);
            [*x, *y, heading]
        })
        .collect()
}

/// The rows at which a robot changes between driving and turning, and what it does then. A rest between the two is halved.
fn changes(track: &[[f64; 3]], row: f64, arm: f64) -> Vec<(usize, Doing)> {
    let half = ((HALF_WINDOW / row).round() as usize).max(1);
    let moved = |sample: usize| {
        let [from, to] = [track[sample.saturating_sub(half)], track[(sample + half).min(track.len() - 1)]];
        [libm::hypot(to[0] - from[0], to[1] - from[1]), arm * (to[2] - from[2]).abs()]
    };
    let moved: Vec<[f64; 2]> = (0..track.len()).map(moved).collect();
    let mut sizes: Vec<f64> = moved.iter().map(|[way, turn]| way + turn).collect();
    sizes.sort_by(f64::total_cmp);
    let least = REST * sizes[sizes.len() * 7 / 10];
    let mut parts: Vec<(usize, Doing)> = Vec::new();
    for (sample, [way, turn]) in moved.iter().enumerate() {
        let doing = if way + turn <= least {
            Doing::Resting
        } else if turn > way {
            Doing::Turning
        } else {
            Doing::Driving
        };
        if parts.last().is_none_or(|(_, last)| *last != doing) {
            parts.push((sample, doing));
        }
    }
    without_short(&mut parts, track.len(), (SHORTEST / row) as usize);
    let mut found: Vec<(usize, Doing)> = Vec::new();
    let mut last = None;
    for (place, (begin, doing)) in parts.iter().enumerate() {
        if *doing == Doing::Resting {
            continue;
        }
        if last.is_some_and(|last| last != *doing) {
            let rest = parts[place - 1];
            found.push((if rest.1 == Doing::Resting { (rest.0 + begin) / 2 } else { *begin }, *doing));
        }
        last = Some(*doing);
    }
    found
}

/// Gives what is shorter than a move to its neighbour, the shortest first.
fn without_short(parts: &mut Vec<(usize, Doing)>, rows: usize, least: usize) {
    loop {
        let end = |place: usize| parts.get(place + 1).map_or(rows, |(begin, _)| *begin);
        let shortest = (0..parts.len()).map(|place| (end(place) - parts[place].0, place)).min();
        let Some((_, place)) = shortest.filter(|(length, _)| *length < least && parts.len() > 1) else { return };
        if place == 0 {
            parts.remove(0);
            parts[0].0 = 0;
        } else {
            parts.remove(place);
            if parts.get(place).is_some_and(|(_, doing)| *doing == parts[place - 1].1) {
                parts.remove(place);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::effect::Model;
    use crate::geometry::{Displacement2, Pose2};
    use crate::replay::Track;

    const ROW: f64 = 0.01;

    /// A square with corners turned, whose rows hold the speed in each cycle of 10 ms, while cycles took longer by these shares in each move. A reference
    /// goes by its own clock and is spread evenly over the rows.
    fn square(robot: &Robot, shares: &[f64; 8], sideways: bool) -> TickLog {
        let rollers = robot.drive.rollers().unwrap();
        let per_count = rollers.metres_per_count(robot.encoder.ticks_per_revolution());
        let (mut log, mut pose, mut counts) = (TickLog::default(), Pose2::IDENTITY, vec![0.0; per_count.len()]);
        log.rollers = vec![Vec::new(); per_count.len()];
        let (mut clock, mut times, mut poses) = (0.0, Vec::new(), Vec::new());
        for (place, share) in shares.iter().enumerate() {
            let (ahead, left) = if sideways { (0.0, 0.2) } else { (0.2, 0.0) };
            let (speed, seconds) = if place % 2 == 0 {
                (Displacement2 { forward: ahead, sideways: left, rotation: 0.0 }, 6.0)
            } else {
                (Displacement2 { forward: 0.0, sideways: 0.0, rotation: 0.5 }, std::f64::consts::PI)
            };
            let cycles = (seconds / (1.0 + share) / ROW).round() as usize;
            for _ in 0..cycles {
                log.time.push(ROW * log.time.len() as f64);
                log.rollers.iter_mut().zip(&counts).for_each(|(counts, count)| counts.push(*count));
                times.push(clock);
                poses.push(pose);
                let part = |time: f64| Displacement2 {
                    forward: speed.forward * time,
                    sideways: speed.sideways * time,
                    rotation: speed.rotation * time,
                };
                let ways = rollers.ways_of(&part(ROW));
                counts.iter_mut().zip(ways).zip(&per_count).for_each(|((count, way), per)| *count += way / per);
                pose.advance(&part(ROW * (1.0 + share)));
                clock += ROW * (1.0 + share);
            }
        }
        let rows = log.time.len();
        log.clock_excess = times[rows - 1] / log.time[rows - 1] - 1.0;
        for sample in 0..rows {
            let time = times[rows - 1] * sample as f64 / (rows - 1) as f64;
            let at = times.partition_point(|begun| *begun <= time).max(1) - 1;
            let Pose2 { x, y, heading } = poses[at];
            log.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
        }
        [log.left, log.right] = robot.axle_ticks_of_rollers(&log.rollers).unwrap();
        log
    }

    /// The largest error of a replay with all lost time given back \[m\].
    fn worst(log: &TickLog, robot: &Robot) -> f64 {
        let mut model = Model::new(robot);
        model.set("lost_cycles", "share", 1.0).unwrap();
        let poses = Track::from_log(log, robot).unwrap().poses(&model.chain());
        let off = |(pose, seen): (&Pose2, &ReferencePose)| libm::hypot(pose.x - seen.x, pose.y - seen.y);
        poses.iter().zip(&log.reference).map(off).fold(0.0, f64::max)
    }

    #[test]
    fn time_that_was_lost_unevenly_is_found_where_it_was_lost() {
        let shares = [0.15, 0.08, 0.10, 0.06, 0.10, 0.06, 0.14, 0.08];
        for kind in [DriveKind::Mecanum, DriveKind::Omni3] {
            let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
            for sideways in [false, true] {
                let mut log = square(&robot, &shares, sideways);
                let before = worst(&log, &robot);
                assert!(log.find_lost_time(&robot));
                // In the middle of each move: its own share.
                let mut begin = 0.0;
                for (place, share) in shares.iter().enumerate() {
                    let seconds = if place % 2 == 0 { 6.0 } else { std::f64::consts::PI } / (1.0 + share);
                    let found = log.clock_excess_along[((begin + 0.5 * seconds) / ROW) as usize];
                    assert!((found - share).abs() < 0.012, "{kind:?} {place}: {found}, not {share}");
                    begin += seconds;
                }
                let after = worst(&log, &robot);
                assert!(after < 0.02 && before > 0.06, "{kind:?}: {before} {after}");
            }
        }
    }

    #[test]
    fn a_log_that_shows_no_changes_stays_as_it_is() {
        let robot = Robot { drive: DriveKind::Mecanum.usual(), ..Robot::labmate() };
        let mut log = square(&robot, &[0.1; 8], false);
        log.reference.truncate(100);
        let before = log.clone();
        assert!(!log.find_lost_time(&robot) && log == before);
        let mut whole = square(&robot, &[0.1; 8], false);
        // The reference never turns.
        whole.reference.iter_mut().for_each(|pose| pose.heading = Some(0.0));
        let before = whole.clone();
        assert!(!whole.find_lost_time(&robot) && whole == before);
    }
}
