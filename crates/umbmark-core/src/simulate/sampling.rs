//! When the counters are read along a move.

use super::Leg;
use crate::engine::{Instructions, Motion, Profile, SampledOdometry, TickGeometry, Update, WheelLine};

/// Odometry of a robot that reads its counters at a fixed rate, along moves with acceleration ramps.
///
/// The clock ticks on through the moves and pauses. Readings on the ramps are looked up one by one; those at constant
/// speed, nearly all, go through the engine's fast path for equal steps. Splitting a move there rounds its wheel angles to 2^-32
/// tick.
#[derive(Debug)]
pub(super) struct SampledMoves {
    odometry: SampledOdometry,
    courses: [Vec<Readings>; 2],
}

/// The readings of one move, as shares of its travel.
#[derive(Clone, Debug)]
struct Readings {
    /// On the way up, relative to the last of them.
    up: Profile,
    /// Share of the travel done when readings at constant speed begin.
    cruise_from: f64,
    /// Share of the travel done when they end.
    cruise_to: f64,
    /// How many there are.
    cruise: u32,
    /// On the way down, as shares of what is left then; the last is 1.
    down: Profile,
}

impl Readings {
    fn new(leg: &Leg, rate: f64) -> Readings {
        let period = 1.0 / rate;
        let first = (leg.begins * rate).floor() as u64 + 1;
        let at = |k: u64| k as f64 * period - leg.begins;
        let profile = &leg.profile;
        let (mut up, mut down) = (Vec::new(), Vec::new());
        let (mut from, mut to, mut cruise) = (0.0, 0.0, 0);
        for k in first.. {
            let time = at(k);
            let share = profile.fraction(time);
            if time < profile.ramp {
                up.push(share);
            } else if time <= profile.ramp + profile.cruise {
                if from == 0.0 {
                    up.push(share);
                    from = share;
                } else {
                    cruise += 1;
                }
                to = share;
            } else {
                down.push(share);
            }
            if time >= profile.duration() {
                break;
            }
        }
        if from == 0.0 {
            // Too short for a reading at constant speed: all of it is one ramp.
            up.append(&mut down);
            (from, to) = (1.0, 1.0);
        }
        let rest = 1.0 - to;
        Readings {
            up: Profile::new(up.iter().map(|share| share / from)),
            cruise_from: from,
            cruise_to: to,
            cruise,
            down: Profile::new(down.iter().map(|share| if rest > 0.0 { (share - to) / rest } else { 1.0 })),
        }
    }
}

impl SampledMoves {
    pub(super) fn new(geometry: TickGeometry, update: Update, rate: f64, courses: [&[Leg]; 2]) -> SampledMoves {
        SampledMoves {
            odometry: SampledOdometry::new(geometry, update),
            courses: courses.map(|legs| legs.iter().map(|leg| Readings::new(leg, rate)).collect()),
        }
    }

    pub(super) fn limited_to(self, instructions: Instructions) -> SampledMoves {
        SampledMoves { odometry: self.odometry.limited_to(instructions), ..self }
    }

    /// The motion that the counters report for move `index` of course `course`, driven along `line`.
    pub(super) fn motion(&mut self, course: usize, index: usize, line: &WheelLine) -> Motion {
        let readings = &self.courses[course][index];
        let up_to = |share: f64| line.travel().map(|units| (units as f64 * share) as i64);
        let (a, b) = (up_to(readings.cruise_from), up_to(readings.cruise_to));
        let piece =
            |start, travel| WheelLine::new(start, travel).expect("a piece of a line is no longer than the line");
        let up = piece(line.start(), a);
        let motion = self.odometry.along(&up, &readings.up);
        if readings.cruise_from == 1.0 {
            return motion;
        }
        let level = piece(up.end_phases(), [b[0] - a[0], b[1] - a[1]]);
        let down = piece(level.end_phases(), [line.travel()[0] - b[0], line.travel()[1] - b[1]]);
        let motion = motion.then(&self.odometry.at_constant_rate(&level, readings.cruise));
        motion.then(&self.odometry.along(&down, &readings.down))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Robot, WheelTravel};
    use crate::path::SpeedProfile;

    fn leg(travel: f64, begins: f64) -> Leg {
        Leg {
            travel: WheelTravel { left: travel, right: travel },
            left: 0.0,
            stop: [0; 2],
            counting: Robot::labmate().counting(travel, 0.0).unwrap(),
            begins,
            profile: SpeedProfile::default().over(travel),
        }
    }

    #[test]
    fn readings_in_pieces_are_the_readings_of_the_whole_profile() {
        let geometry = TickGeometry::new(0.2e-3, 0.2e-3, 0.34).unwrap();
        for (travel, begins) in [(4.0, 0.0), (4.0, 13.777), (0.05, 1.234), (0.3, 0.5)] {
            let leg = leg(travel, begins);
            // Numbers without common measure, so that no tick falls on a reading.
            let ticks = travel / 0.200_127e-3;
            let line = WheelLine::from_ticks([0.2513, 0.7531], [ticks, ticks * 0.973_13]).unwrap();
            let mut moves = SampledMoves::new(geometry, Update::Midpoint, 100.0, [&[leg], &[]]);
            let motion = moves.motion(0, 0, &line);
            let whole = SampledOdometry::new(geometry, Update::Midpoint);
            let first = (begins * 100.0).floor() + 1.0;
            let shares = (0..100_000).map(|k| leg.profile.fraction((first + f64::from(k)) / 100.0 - begins));
            let expected = whole.with_profile(&line, shares.take_while(|s| *s < 1.0).chain([1.0]));
            let gap = motion.pose.between(&expected.pose);
            assert!(gap.x.abs() < 1e-9 && gap.y.abs() < 1e-9 && gap.heading.abs() < 1e-12, "{travel} {begins} {gap:?}");
        }
    }

    #[test]
    fn a_hundred_hertz_reads_a_leg_of_twenty_one_seconds_two_thousand_one_hundred_times() {
        let readings = Readings::new(&leg(4.0, 0.0), 100.0);
        // 1 s up and 1 s down at 0.2 m/s², 19 s between.
        let count = readings.up.readings() + readings.cruise as usize + readings.down.readings();
        assert_eq!(count, 2100);
        assert!((readings.cruise_from - 0.1 / 4.0).abs() < 1e-12);
    }
}
