//! References that tell headings only: the constant rate of a gyro, and the way along the headings.

use super::TickLog;
use super::dead_reckoning::for_each_pose;
use crate::drive::Robot;
use crate::geometry::{Displacement2, Pose2, wrap};
use crate::stats::robust;

/// The wheels stand where they make no count for so long \[s\]; the body may sway so long before and after \[s\].
const REST: f64 = 0.6;
const SWAY: f64 = 0.2;
/// Rests of so long in all show the rate of a gyro \[s\].
const ENOUGH: f64 = 1.0;
/// Noise of the heading of a gyro at least, and of a usual one \[rad/√s\]: 1 and 2 degrees per root hour. The latter counts as much as rests of
/// the time behind it \[s\].
const QUIET: f64 = 3e-4;
const USUAL: f64 = 6e-4;
const BELIEVED: f64 = 2.0;
/// Length of the windows in which turns are compared with those of the wheels \[s\].
const WINDOW: f64 = 0.5;

/// A rate below this is none \[rad/s\]: 2 degrees an hour.
const NONE: f64 = 1e-5;

/// The headings that rates of turning add up to, from 0 \[rad\]: each rate holds since the reading before.
///
/// Of an instrument that shows means that is exact, and of another one the headings are half a period early, which is found as a delay.
/// Trapezoids would take the mean of two readings, and round the beginnings and ends of turns.
pub fn headings_of(time: &[f64], rates: &[f64]) -> Vec<f64> {
    let mut heading = 0.0;
    let rest = time.windows(2).zip(rates.iter().skip(1)).map(|(time, rate)| {
        heading += rate * (time[1] - time[0]);
        heading
    });
    time.first().map(|_| 0.0).into_iter().chain(rest).collect()
}

/// The rate that a gyro shows of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// \[rad/s\]
    pub rate: f64,
    /// How long the robot rested in all \[s\]; 0 where the rate follows from the turns of the wheels.
    pub rested: f64,
}

impl TickLog {
    /// Takes a gyro's own constant rate out of the headings: that which it shows while the wheels stand or, where they hardly do, that by
    /// which its turns differ from those of the wheels. What is left of it, and how it drifts, is for the fit.
    fn without_bias(&mut self, robot: &Robot) -> Option<Bias> {
        let bias = self.bias_at_rest().or_else(|| self.bias_by_wheels(robot)).filter(|bias| bias.rate.abs() >= NONE)?;
        let began = self.time[self.reference.first()?.sample];
        for pose in &mut self.reference {
            let since = self.time[pose.sample] - began;
            pose.heading = pose.heading.map(|heading| heading - bias.rate * since);
        }
        Some(bias)
    }

    /// Makes headings ready, where the reference tells headings only: without the constant rate of a gyro, each where the counted way along them
    /// leads. Says what rate was taken out.
    pub fn place_headings(&mut self, robot: &Robot) -> Option<Bias> {
        if !self.headings_only {
            return None;
        }
        let bias = if self.relative { self.without_bias(robot) } else { None };
        self.follow_headings(robot);
        bias
    }

    /// The noise of a gyro's heading \[rad/√s\]: how it wanders while the wheels stand; near that of a usual one where they hardly do.
    ///
    /// The means of both halves of a rest of time T differ by a walk of variance q²T/3, and hardly by the noise of single readings.
    pub fn gyro_noise(&self) -> f64 {
        let rate = self.bias_at_rest().map_or(0.0, |bias| bias.rate);
        let (mut squares, mut thirds) = (USUAL * USUAL * BELIEVED / 3.0, BELIEVED / 3.0);
        for still in self.rests() {
            let (first, second) = still.split_at(still.len() / 2);
            let mean =
                |half: &[(f64, f64)], of: fn(&(f64, f64)) -> f64| half.iter().map(of).sum::<f64>() / half.len() as f64;
            let ([Some(from), Some(to)], true) = ([still.first(), still.last()], !first.is_empty()) else { continue };
            let apart = |of: fn(&(f64, f64)) -> f64| mean(second, of) - mean(first, of);
            squares += (apart(|row| row.1) - rate * apart(|row| row.0)).powi(2);
            thirds += (to.0 - from.0) / 3.0;
        }
        (squares / thirds).sqrt().max(QUIET)
    }

    fn bias_at_rest(&self) -> Option<Bias> {
        let (mut turned, mut rested) = (0.0, 0.0);
        for still in self.rests() {
            if let [first, .., last] = still[..] {
                rested += last.0 - first.0;
                turned += last.1 - first.1;
            }
        }
        (rested >= ENOUGH).then(|| Bias { rate: turned / rested, rested })
    }

    /// Times and headings while the wheels stand, rest by rest.
    fn rests(&self) -> impl Iterator<Item = Vec<(f64, f64)>> {
        let rests = self.reference.chunk_by(move |a, b| self.is_at_rest(a.sample, b.sample));
        rests.filter_map(|resting| {
            let [from, to] = [resting[0], resting[resting.len() - 1]].map(|pose| self.time[pose.sample]);
            let timed = resting.iter().filter_map(|pose| Some((self.time[pose.sample], pose.heading?)));
            let still = timed.filter(|(time, _)| *time >= from + SWAY && *time <= to - SWAY);
            (to - from >= REST).then(|| still.collect())
        })
    }

    fn bias_by_wheels(&self, robot: &Robot) -> Option<Bias> {
        let mut believed = Vec::with_capacity(self.time.len());
        for_each_pose(self, robot, |pose| believed.push(pose.heading));
        let mut rows: Vec<([f64; 2], f64)> = Vec::new();
        let mut from = self.reference.first()?;
        for pose in &self.reference {
            let seconds = self.time[pose.sample] - self.time[from.sample];
            if seconds >= WINDOW {
                let turned = pose.heading? - from.heading?;
                rows.push(([believed[pose.sample] - believed[from.sample], seconds], turned));
                from = pose;
            }
        }
        let [_, rate] = robust::fit_above(&rows, robust::LARGE_SCATTER).values;
        (rows.len() > 2 && rate.is_finite()).then_some(Bias { rate, rested: 0.0 })
    }

    /// Puts each pose of a reference that tells headings only where the counted way along the measured headings leads.
    ///
    /// Between two headings the robot turns as its wheels do, and by a constant share of the way more.
    fn follow_headings(&mut self, robot: &Robot) {
        let mut believed = Vec::with_capacity(self.time.len());
        for_each_pose(self, robot, |pose| believed.push(*pose));
        let mut at: Option<(Pose2, usize)> = None;
        for pose in &mut self.reference {
            let Some(heading) = pose.heading else { continue };
            let here = match at {
                None => Pose2::new(0.0, 0.0, heading),
                Some((before, sample)) => {
                    let steps = believed[sample..=pose.sample].windows(2).map(|pair| pair[0].between(&pair[1]));
                    let steps: Vec<Pose2> = steps.map(|step| Pose2::new(step.x, step.y, wrap(step.heading))).collect();
                    let turned: f64 = steps.iter().map(|step| step.heading).sum();
                    let more = (wrap(heading - before.heading - turned)) / steps.len().max(1) as f64;
                    let go = |pose: Pose2, step: &Pose2| {
                        let Displacement2 { forward, sideways, rotation } = step.log();
                        pose.moved(&Displacement2 { forward, sideways, rotation: rotation + more })
                    };
                    Pose2 { heading, ..steps.iter().fold(before, go) }
                }
            };
            (pose.x, pose.y) = (here.x, here.y);
            at = Some((here, pose.sample));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::ReferencePose;

    /// A robot that rests for 3 s, turns left for 4 s and rests again, read at 50 Hz; its gyro shows 0.01 rad/s more.
    fn log(rests: bool) -> TickLog {
        let time: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k)).collect();
        let angle = |t: f64| if rests { 0.5 * (t - 3.0).clamp(0.0, 4.0) } else { 0.5 * libm::sin(t) };
        let counts = |sign: f64| time.iter().map(|t| (sign * 4000.0 * angle(*t)).round()).collect();
        let (left, right) = (counts(-1.0), counts(1.0));
        let robot = Robot::labmate();
        let per_count = 2.0 * robot.metres_per_tick().left / robot.drive.wheelbase();
        let seen = |(sample, t): (usize, &f64)| {
            let heading = Some(4000.0 * angle(*t) * per_count + 0.01 * t);
            ReferencePose { sample, x: 0.0, y: 0.0, heading }
        };
        let reference = time.iter().enumerate().map(seen).collect();
        TickLog { time, left, right, reference, relative: true, headings_only: true, ..TickLog::default() }
    }

    #[test]
    fn the_rate_of_a_gyro_is_taken_from_rests_or_else_from_the_turns_of_the_wheels() {
        for rests in [true, false] {
            let mut log = log(rests);
            let bias = log.place_headings(&Robot::labmate()).unwrap();
            assert!((bias.rate - 0.01).abs() < 2e-4, "{bias:?}");
            assert!(if rests { (bias.rested - 5.18).abs() < 0.1 } else { bias.rested == 0.0 }, "{bias:?}");
            // Taken out once, it is not there any more.
            assert!(log.clone().without_bias(&Robot::labmate()).is_none_or(|left| left.rate.abs() < 1e-4));
        }
    }

    #[test]
    fn each_rate_holds_since_the_reading_before_and_none_add_up_to_none() {
        assert_eq!(headings_of(&[1.0, 2.0, 4.0], &[9.0, 1.0, 3.0]), [0.0, 1.0, 7.0]);
        assert!(headings_of(&[], &[]).is_empty());
    }

    /// A quarter of a circle of 1 m: the headings are measured, and the way is that of the counts.
    #[test]
    fn positions_are_those_of_the_counted_way_along_the_measured_headings() {
        let robot = Robot::labmate();
        let per_tick = robot.metres_per_tick();
        let time: Vec<f64> = (0..=100).map(|k| 0.1 * f64::from(k)).collect();
        // By its counts the robot drives straight ahead.
        let counts = |per_tick: f64| time.iter().map(|t| 0.05 * std::f64::consts::PI * t / per_tick).collect();
        let (left, right) = (counts(per_tick.left), counts(per_tick.right));
        let seen = |sample: usize| {
            let heading = Some(0.05 * std::f64::consts::PI * time[sample]);
            ReferencePose { sample, x: 0.0, y: 0.0, heading }
        };
        let reference = (0..=100).step_by(5).map(seen).collect();
        let mut log = TickLog { time: time.clone(), left, right, reference, headings_only: true, ..TickLog::default() };
        assert_eq!(log.place_headings(&robot), None);
        let last = log.reference.last().unwrap();
        assert!((last.x - 1.0).abs() < 1e-9 && (last.y - 1.0).abs() < 1e-9, "{last:?}");
    }
}
