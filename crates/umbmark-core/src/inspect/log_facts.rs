//! What one log is like.

use super::heading_off;
use super::moves::MovesFound;
use super::wheels::{Wheels, by_motion, by_path};
use crate::drive::Robot;
use crate::geometry::wrap;
use crate::path::{Direction, Path};
use crate::run::dead_reckoning::{computed_poses, mean_pose, standing_at_end, standing_at_start};
use crate::run::{Mended, ReferencePose, Run, TickLog};
use crate::setup::Setup;
use crate::stats::Measured;

/// Figures of one log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogFacts {
    /// The run's name.
    pub name: String,
    /// Its direction.
    pub direction: Option<Direction>,
    /// How many samples.
    pub rows: usize,
    /// From the first to the last sample \[s\].
    pub duration: f64,
    /// One over the median time between samples \[Hz\].
    pub rate: f64,
    /// Departure from the median time between samples that 99 % stay below, as a share of it.
    pub jitter: f64,
    /// Longest time between samples \[s\].
    pub longest_gap: f64,
    /// Times between samples that are more than five usual ones.
    pub gaps: usize,
    /// Defects that were corrected while it was read.
    pub mended: Mended,
    /// Length of the path of the axle's centre by the ticks \[m\], where the robot is known.
    pub length: Option<f64>,
    /// Of wheels with rollers, more than three of them: what no motion of the body explains of their ways, root mean square over the wheels, summed
    /// without its sign over steps of at least 2 cm, as a share of the length.
    pub disagreement: Option<f64>,
    /// Heading at the end by the ticks, full turns counted \[rad\], where the robot is known.
    pub heading: Option<f64>,
    /// How far that is from the path's own heading \[rad\], where the path is known.
    pub heading_off: Option<f64>,
    /// Whether the wheels are what they are called: by the motion of all runs or, without poses on the way, by the path; `None` where
    /// neither tells.
    pub wheels: Option<Wheels>,
    /// What the robot did, where it is known.
    pub moves: Option<MovesFound>,
    /// By how much later than taken its poses are stamped, in the middle of the run \[s\]; `None` where the motion does not tell.
    pub delay: Option<Measured>,
    /// The absolute poses.
    pub reference: Option<ReferenceFacts>,
}

/// Where on the way absolute poses were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// Only before the first and after the last motion.
    AtTheEnds,
    /// At some places on the way.
    OnTheWay,
    /// At least twice a metre.
    Track,
}

impl std::fmt::Display for Coverage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Coverage::AtTheEnds => "at the ends only",
            Coverage::OnTheWay => "at places on the way",
            Coverage::Track => "a track",
        })
    }
}

/// Figures of the absolute poses of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceFacts {
    /// How many poses.
    pub poses: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Poses per second of the log \[Hz\].
    pub rate: f64,
    /// Where they are.
    pub coverage: Coverage,
    /// Longest time without a pose, from the first sample to the last \[s\].
    pub longest_gap: f64,
    /// Standard deviation (n - 1) of each coordinate while the robot stands \[m\], from five poses on.
    pub noise: Option<f64>,
    /// Standard deviation (n - 1) of the heading while the robot stands \[rad\], from five poses on.
    pub heading_noise: Option<f64>,
}

/// The fewest poses that noise is told from.
const FEWEST: usize = 5;

impl LogFacts {
    pub(super) fn of(run: &Run, robot: Option<&Robot>, path: Option<&Path>, setup: Option<&Setup>) -> Option<LogFacts> {
        let log = run.log.as_ref()?;
        let (first, last) = (*log.time.first()?, *log.time.last()?);
        let mut steps: Vec<f64> = log.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let period = *steps.get(steps.len() / 2)?;
        let mut departures: Vec<f64> = steps.iter().map(|step| (step - period).abs() / period).collect();
        departures.sort_by(f64::total_cmp);
        let poses = robot.map(|robot| computed_poses(log, robot)).unwrap_or_default();
        let length = robot.map(|robot| length(log, robot));
        Some(LogFacts {
            name: run.name.clone(),
            direction: run.direction,
            rows: log.time.len(),
            duration: last - first,
            rate: 1.0 / period,
            jitter: departures[(departures.len() - 1) * 99 / 100],
            longest_gap: *steps.last()?,
            gaps: steps.iter().filter(|step| **step > 5.0 * period).count(),
            mended: log.mended,
            length,
            disagreement: robot.and_then(|robot| disagreement(log, robot, length.unwrap_or(0.0))),
            heading: poses.last().map(|pose| pose.heading),
            heading_off: path.and_then(|path| Some(heading_off(path, run.direction, poses.last()?))),
            wheels: setup
                .and_then(|setup| by_motion(setup, &run.name))
                .or_else(|| by_path(log, run.direction, robot?, path?)),
            moves: robot.map(|robot| MovesFound::of(log, robot)),
            delay: setup.and_then(|setup| setup.of_run(&run.name)?.delay),
            reference: ReferenceFacts::of(log, length.unwrap_or(0.0)),
        })
    }
}

/// Length of the path of the axle's centre by the ticks \[m\].
fn length(log: &TickLog, robot: &Robot) -> f64 {
    log.ways(robot).iter().sum()
}

/// Wheels disagree over steps of so much way: over shorter ones, whole counts make them \[m\].
const STEP: f64 = 0.02;

/// What the wheels disagree on, as a share of the way.
fn disagreement(log: &TickLog, robot: &Robot, length: f64) -> Option<f64> {
    let asides = log.asides(robot);
    if asides.is_empty() || log.rollers.len() < 4 || length < STEP {
        return None;
    }
    let (mut gone, mut from, mut apart) = (0.0, 0, 0.0);
    for (sample, way) in log.ways(robot).iter().enumerate() {
        gone += way;
        if gone >= STEP {
            apart += (asides[sample + 1][1] - asides[from][1]).abs();
            (gone, from) = (0.0, sample + 1);
        }
    }
    Some(apart / length)
}

impl ReferenceFacts {
    fn of(log: &TickLog, length: f64) -> Option<ReferenceFacts> {
        let reference = &log.reference;
        let (first, last) = (*log.time.first()?, *log.time.last()?);
        let (start, end) = (standing_at_start(log), standing_at_end(log));
        let on_the_way = reference.len().saturating_sub(start.len() + end.len());
        let coverage = match on_the_way {
            0 => Coverage::AtTheEnds,
            n if n as f64 >= 2.0 * length => Coverage::Track,
            _ => Coverage::OnTheWay,
        };
        let times = reference.iter().map(|pose| log.time[pose.sample]).chain([last]);
        let (longest_gap, _) = times.fold((0.0_f64, first), |(gap, before), time| (gap.max(time - before), time));
        (!reference.is_empty()).then(|| {
            let groups = [start, &end[end.len() / 2..]];
            ReferenceFacts {
                poses: reference.len(),
                headings: reference.iter().filter(|pose| pose.heading.is_some()).count(),
                rate: if last > first { reference.len() as f64 / (last - first) } else { 0.0 },
                coverage,
                longest_gap,
                noise: scatter(&groups, |pose, mean| vec![pose.x - mean.x, pose.y - mean.y])
                    .filter(|_| !log.headings_only),
                heading_noise: scatter(&groups, |pose, mean| {
                    pose.heading.zip(mean.heading).map(|(a, b)| wrap(a - b)).into_iter().collect()
                })
                .filter(|_| !(log.headings_only && log.relative)),
            }
        })
    }
}

/// Pooled standard deviation of the residuals of each group about its own mean.
fn scatter(groups: &[&[ReferencePose]], residuals: impl Fn(&ReferencePose, &ReferencePose) -> Vec<f64>) -> Option<f64> {
    let (mut squares, mut degrees) = (0.0, 0.0);
    for group in groups.iter().filter(|group| group.len() >= FEWEST) {
        let mean = mean_pose(group)?;
        let found: Vec<Vec<f64>> = group.iter().map(|pose| residuals(pose, &mean)).collect();
        squares += found.iter().flatten().map(|r| r * r).sum::<f64>();
        let per_pose = found.iter().map(Vec::len).max().unwrap_or(0);
        degrees += found.iter().map(Vec::len).sum::<usize>().saturating_sub(per_pose) as f64;
    }
    (degrees > 0.0).then(|| (squares / degrees).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_the_standard_deviation_with_n_minus_1_pooled_over_both_coordinates() {
        let pose = |i: usize| ReferencePose { sample: i, x: 10.0 + i as f64, y: 3.0, heading: Some(0.1 * i as f64) };
        let (five, four): (Vec<_>, Vec<_>) = ((0..5).map(pose).collect(), (0..4).map(pose).collect());
        let position = |p: &ReferencePose, m: &ReferencePose| vec![p.x - m.x, p.y - m.y];
        // Squares about the mean: 10 in x and none in y, over 4 + 4 degrees of freedom; four poses are too few to count.
        assert_eq!(scatter(&[&five, &four], position), Some(1.25_f64.sqrt()));
        assert_eq!(scatter(&[&four], position), None);
        let heading = scatter(&[&five], |p, m| vec![p.heading.unwrap() - m.heading.unwrap()]).unwrap();
        assert!((heading - 0.025_f64.sqrt()).abs() < 1e-15);
    }
}
