//! Odometry of a base on wheels with rollers, from the counters of three or four wheels.

use super::{Motion, UNITS_PER_TICK};
use crate::drive::{MOST_WHEELS, Rollers};
use crate::geometry::Displacement2;

/// A motion of all wheels with rollers at constant ratios of their speeds: as [`WheelLine`](super::WheelLine), of up to [`MOST_WHEELS`]
/// wheels. Those that a base does not have stay at zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RollerLine {
    /// Position of each wheel within its tick at the start, in units of 2^-32 tick, at least 0 and below 2^32.
    pub start: [i64; MOST_WHEELS],
    /// Travel of each wheel in units of 2^-32 tick.
    pub travel: [i64; MOST_WHEELS],
}

impl RollerLine {
    /// By how much each counter has changed when a share of the travel is made.
    #[inline]
    pub fn counts_at(&self, share: f64) -> [i64; MOST_WHEELS] {
        std::array::from_fn(|wheel| {
            let travel = if share >= 1.0 { self.travel[wheel] } else { (self.travel[wheel] as f64 * share) as i64 };
            (self.start[wheel] + travel).div_euclid(UNITS_PER_TICK)
        })
    }

    /// Travel of each wheel \[ticks\], fractions included.
    #[inline]
    pub fn ticks(&self) -> [f64; MOST_WHEELS] {
        self.travel.map(|units| units as f64 / UNITS_PER_TICK as f64)
    }
}

/// Odometry from the counts of all wheels: the motion that fits them best, an exact arc with its way to the side from reading to reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollerOdometry {
    /// Motion of the base for a count of each wheel: ahead \[m\], left \[m\], turn \[rad\].
    per_count: [[f64; 3]; MOST_WHEELS],
}

impl RollerOdometry {
    /// Of these wheels, with so many counts a revolution.
    pub fn new(rollers: &Rollers, per_revolution: f64) -> RollerOdometry {
        let metres = rollers.metres_per_count(per_revolution);
        let mut per_count = [[0.0; 3]; MOST_WHEELS];
        for (wheel, (motion, metres)) in per_count.iter_mut().zip(metres).enumerate() {
            let mut alone = vec![0.0; rollers.wheels().len()];
            alone[wheel] = metres;
            let Displacement2 { forward, sideways, rotation } = rollers.motion(&alone);
            *motion = [forward, sideways, rotation];
        }
        RollerOdometry { per_count }
    }

    /// The motion of the base for such counts, fractions included.
    #[inline]
    pub fn displacement(&self, counts: [f64; MOST_WHEELS]) -> Displacement2 {
        let sum = |k: usize| (0..MOST_WHEELS).map(|wheel| counts[wheel] * self.per_count[wheel][k]).sum();
        Displacement2 { forward: sum(0), sideways: sum(1), rotation: sum(2) }
    }

    /// The motion that the counters report, read often along a line from rest to rest.
    ///
    /// While a wheel rolls, its counter is half a tick behind it in the mean over the readings: at the start it gains as much on its
    /// position within the tick, and at the end it loses that. The reported motion is thus an arc between two small ones:
    ///
    /// ```text
    /// exp(C (φ - 1/2)) exp(C n) exp(C (1/2 - φ')),   n ticks of travel from phase φ to phase φ', C the motion for a count
    /// ```
    ///
    /// A counter that does not change says nothing. The heading is exactly that of the counts. What is neglected is where the readings fall
    /// within the ticks: with 2000 ticks a revolution, moves of 4 m read a hundred times a second end 2 µm (mecanum) and 3 µm (three omni
    /// wheels) elsewhere in the mean and at most 10 µm, where the counts of the whole move as one arc are 0.6 mm and 0.8 mm off.
    pub fn motion(&self, line: &RollerLine) -> Motion {
        let unit = |units: i64| units as f64 / UNITS_PER_TICK as f64;
        let parts: [[f64; 3]; MOST_WHEELS] = std::array::from_fn(|wheel| {
            let end = line.start[wheel] + line.travel[wheel];
            if end.div_euclid(UNITS_PER_TICK) == 0 {
                return [0.0; 3];
            }
            [unit(line.start[wheel]) - 0.5, unit(line.travel[wheel]), 0.5 - unit(end.rem_euclid(UNITS_PER_TICK))]
        });
        let [begin, roll, end] = [0, 1, 2].map(|part| Motion::exp(&self.displacement(parts.map(|wheel| wheel[part]))));
        begin.then(&roll).then(&end)
    }

    /// The motion that the counters report where they are read when these shares of the travel are made, the last of which is all: exact,
    /// reading by reading.
    pub fn read(&self, line: &RollerLine, shares: impl Iterator<Item = f64>) -> Motion {
        let (mut motion, mut before) = (Motion::IDENTITY, [0; MOST_WHEELS]);
        for share in shares {
            let now = line.counts_at(share);
            if now != before {
                let gained = std::array::from_fn(|wheel| (now[wheel] - before[wheel]) as f64);
                motion = motion.then(&Motion::exp(&self.displacement(gained)));
                before = now;
            }
        }
        motion
    }

    /// The motion that the counters report where each tick is reckoned by itself, in the order in which they come; ticks of the same moment
    /// together. Slow.
    pub fn one_by_one(&self, line: &RollerLine) -> Motion {
        let mut crossings: Vec<f64> = Vec::new();
        for wheel in 0..MOST_WHEELS {
            let (start, travel) = (line.start[wheel] as f64, line.travel[wheel] as f64);
            let last = (line.start[wheel] + line.travel[wheel]).div_euclid(UNITS_PER_TICK);
            let edges = if last > 0 { 1..=last } else { last + 1..=0 };
            // A counter changes just below an edge where its wheel rolls back.
            crossings.extend(edges.map(|edge| {
                let share = (edge as f64 * UNITS_PER_TICK as f64 - start) / travel;
                if travel < 0.0 { share + 2.0 / -travel } else { share + 2.0 / travel }
            }));
        }
        crossings.sort_by(f64::total_cmp);
        self.read(line, crossings.into_iter().chain([1.0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::path::SpeedProfile;
    use crate::random::Stream;

    const PER_REVOLUTION: f64 = 2000.0;

    /// A line for a motion of the base, with random positions within the ticks at both ends, as the simulator draws them.
    fn line(rollers: &Rollers, motion: &Displacement2, chance: &mut Stream) -> RollerLine {
        let mut line = RollerLine::default();
        let metres = rollers.metres_per_count(PER_REVOLUTION);
        for (wheel, (way, metres)) in rollers.ways_of(motion).iter().zip(metres).enumerate() {
            let mut phase = || (chance.uniform() * UNITS_PER_TICK as f64) as i64;
            let (from, to) = (phase(), phase());
            line.start[wheel] = from;
            line.travel[wheel] = ((way / metres).round() as i64 * UNITS_PER_TICK) + to - from;
        }
        line
    }

    fn moves() -> [Displacement2; 6] {
        let moved = |forward, sideways, rotation| Displacement2 { forward, sideways, rotation };
        [
            moved(4.0, 0.0, 0.0),
            moved(0.0, -4.0, 0.0),
            moved(2.0, 2.0, 0.0),
            moved(0.0, 0.0, std::f64::consts::FRAC_PI_2),
            moved(-1.0, 3.0, 0.0),
            moved(3.0, 1.0, -1.5),
        ]
    }

    /// When a leg is read a hundred times a second, as shares of its travel.
    fn readings(rollers: &Rollers, motion: &Displacement2) -> Vec<f64> {
        let most = rollers.ways_of(motion).into_iter().map(f64::abs).fold(0.0, f64::max);
        let profile = SpeedProfile::default().over(most);
        let count = (100.0 * profile.duration()).ceil() as usize + 1;
        (1..=count).map(|k| profile.fraction((k as f64 - 0.37) * 0.01)).collect()
    }

    #[test]
    fn whole_counts_in_one_reading_are_one_arc() {
        for kind in [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels] {
            let rollers = kind.usual().rollers().unwrap();
            let odometry = RollerOdometry::new(&rollers, PER_REVOLUTION);
            let counts = [1200, -700, 350, if rollers.wheels().len() == 3 { 0 } else { 41 }];
            let line = RollerLine { start: [0; 4], travel: counts.map(|count| count * UNITS_PER_TICK) };
            let metres = rollers.metres_per_count(PER_REVOLUTION);
            let ways: Vec<f64> = metres.iter().zip(counts).map(|(metres, count)| metres * count as f64).collect();
            let expected = Motion::exp(&rollers.motion(&ways));
            let read = odometry.read(&line, [1.0].into_iter());
            let gap = read.pose.between(&expected.pose);
            assert!(gap.x.abs() + gap.y.abs() + gap.heading.abs() < 1e-14, "{gap:?}");
        }
    }

    /// Oracle: the counters read one by one, a hundred times a second.
    #[test]
    fn a_move_at_once_is_what_its_readings_report() {
        let mut chance = Stream::new(7, 7, 7);
        for kind in [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels] {
            let rollers = kind.usual().rollers().unwrap();
            let odometry = RollerOdometry::new(&rollers, PER_REVOLUTION);
            let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0.0);
            let mut by_counts = 0.0_f64;
            for motion in moves() {
                let shares = readings(&rollers, &motion);
                for _ in 0..15 {
                    let line = line(&rollers, &motion, &mut chance);
                    let (quick, read) = (odometry.motion(&line), odometry.read(&line, shares.iter().copied()));
                    assert!((quick.pose.heading - read.pose.heading).abs() < 1e-12);
                    let gap = libm::hypot(quick.pose.x - read.pose.x, quick.pose.y - read.pose.y);
                    (sum, most, count) = (sum + gap, most.max(gap), count + 1.0);
                    let whole = odometry.read(&line, [1.0].into_iter());
                    by_counts = by_counts.max(libm::hypot(whole.pose.x - read.pose.x, whole.pose.y - read.pose.y));
                }
            }
            assert!(sum / count < 8e-6 && most < 5e-5, "{kind:?}: mean {:e}, most {most:e}", sum / count);
            // The half tick at both ends is worth it.
            assert!(by_counts > 10.0 * most, "{by_counts:e} {most:e}");
        }
    }

    /// Oracle: the limit of ever more readings.
    #[test]
    fn ticks_one_by_one_are_the_limit_of_many_readings() {
        let mut chance = Stream::new(8, 8, 8);
        let rollers = DriveKind::Mecanum.usual().rollers().unwrap();
        let odometry = RollerOdometry::new(&rollers, PER_REVOLUTION);
        let motion = Displacement2 { forward: 0.02, sideways: -0.01, rotation: 0.03 };
        for _ in 0..4 {
            let line = line(&rollers, &motion, &mut chance);
            let many = odometry.read(&line, (1..=2_000_000).map(|k| f64::from(k) / 2e6));
            let gap = odometry.one_by_one(&line).pose.between(&many.pose);
            assert!(gap.x.abs() + gap.y.abs() < 1e-12 && gap.heading.abs() < 1e-13, "{gap:?}");
        }
    }
}
