//! What is watched of a run, and what the numbers of the robot have to do with it.

use crate::calibrate::{Correction, drive_again};
use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::geometry::{Pose2, wrap};
use crate::path::{Direction, Path};
use crate::run::TickLog;
use crate::run::dead_reckoning::{computed_end, computed_poses};
use serde::{Deserialize, Serialize};

/// E_d, E_b and E_s.
pub const NUMBERS: usize = 3;

/// What is watched of a run: its return error and, where it was tracked, its scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Observation {
    /// Its name.
    pub name: String,
    /// Its direction; counter-clockwise where the path has none.
    pub direction: Direction,
    /// Computed length of its way \[m\], where it has counts.
    pub way_m: Option<f64>,
    /// ε_x \[m\].
    pub x_m: f64,
    /// ε_y \[m\].
    pub y_m: f64,
    /// ε_θ \[rad\], where the heading was measured.
    pub heading_rad: Option<f64>,
    /// Logarithm of measured over computed size of its track, where it was tracked.
    pub scale: Option<f64>,
    /// Derivatives of x, y, heading and scale by E_d, E_b and E_s.
    pub slopes: [[f64; NUMBERS]; 4],
}

/// The runs of a dataset that can be watched, in the order of their sessions and numbers, and why others cannot.
pub(super) fn of(data: &Dataset, robot: &Robot) -> (Vec<Observation>, Vec<(String, &'static str)>) {
    let mut by_path = [None; 2];
    let session = |place: usize| data.sessions.iter().rposition(|session| session.first <= place);
    let mut runs: Vec<(usize, &Run)> = data.runs.iter().enumerate().collect();
    runs.retain(|(_, run)| run.test == TestKind::Systematic);
    runs.sort_by_key(|(place, run)| (session(*place), run.number, *place));
    let (mut seen, mut left) = (Vec::new(), Vec::new());
    for (_, run) in runs {
        match observed(run, robot, data.path.as_ref(), &mut by_path) {
            Ok(observation) => seen.push(observation),
            Err(reason) => left.push((run.name.clone(), reason)),
        }
    }
    (seen, left)
}

type Slopes = [[f64; NUMBERS]; 4];

fn observed(
    run: &Run,
    robot: &Robot,
    path: Option<&Path>,
    by_path: &mut [Option<Slopes>; 2],
) -> Result<Observation, &'static str> {
    let returned = run.returned.ok_or("it has no return error")?;
    let direction = run.direction.unwrap_or(Direction::Ccw);
    let log = run.log.as_ref().filter(|log| !log.reference.is_empty() && !log.relative && !log.headings_only);
    let scale = log.and_then(|log| scale_of(log, &computed_poses(log, robot)));
    let slopes = match (log, path) {
        (Some(log), _) => of_log(log, robot),
        (None, Some(path)) => match by_path[direction as usize] {
            Some(slopes) => Some(slopes),
            None => slopes_at(robot, path, direction, &Correction::NONE).inspect(|slopes| {
                by_path[direction as usize] = Some(*slopes);
            }),
        },
        (None, None) => return Err("neither its path nor its counts are known"),
    };
    let slopes = slopes.ok_or("its counts cannot be followed")?;
    let finite = [returned.x, returned.y, returned.heading.unwrap_or(0.0)].iter().all(|value| value.is_finite());
    if !finite || !slopes.as_flattened().iter().all(|slope| slope.is_finite()) {
        return Err("its numbers are not finite");
    }
    Ok(Observation {
        name: run.name.clone(),
        direction,
        way_m: log.map(|log| way_of(log, robot)),
        x_m: returned.x,
        y_m: returned.y,
        heading_rad: returned.heading,
        scale,
        slopes,
    })
}

/// Step of the derivatives.
const STEP: f64 = 1e-4;

/// One of the three ratios moved.
fn moved(at: &Correction, number: usize, by: f64) -> Correction {
    let mut values = at.values();
    values[number] += by;
    Correction::from_values(values)
}

/// The derivatives of the return error of a path, for a robot with this correction.
#[expect(clippy::needless_range_loop, reason = "indices as in the equation")]
pub(super) fn slopes_at(robot: &Robot, path: &Path, direction: Direction, at: &Correction) -> Option<Slopes> {
    let mut slopes = Slopes::default();
    for number in 0..NUMBERS {
        let error = |by: f64| drive_again(robot, path, direction, &moved(at, number, by), &Correction::NONE);
        let (more, less) = (error(STEP)?, error(-STEP)?);
        let turned = wrap(more.heading.unwrap_or(0.0) - less.heading.unwrap_or(0.0));
        slopes[0][number] = (more.x - less.x) / (2.0 * STEP);
        slopes[1][number] = (more.y - less.y) / (2.0 * STEP);
        slopes[2][number] = turned / (2.0 * STEP);
    }
    Some(slopes)
}

/// The derivatives of the return error and the scale of a log: what the same counts are for another robot.
#[expect(clippy::needless_range_loop, reason = "indices as in the equation")]
fn of_log(log: &TickLog, robot: &Robot) -> Option<Slopes> {
    let nominal = computed_poses(log, robot);
    let mut slopes = Slopes::default();
    for number in 0..NUMBERS {
        let other = |by: f64| {
            let robot = moved(&Correction::NONE, number, by).apply(robot).ok()?;
            let poses = computed_poses(log, &robot);
            // Of a single place there is no size.
            let scale = ratio_of(log, &nominal, |sample, _| poses.get(sample).copied()).unwrap_or(0.0);
            Some((computed_end(log, &robot).0?, scale))
        };
        let ((more, larger), (less, smaller)) = (other(STEP)?, other(-STEP)?);
        let by_step = [more.x - less.x, more.y - less.y, wrap(more.heading - less.heading), larger - smaller];
        (0..4).for_each(|row| slopes[row][number] = by_step[row] / (2.0 * STEP));
    }
    Some(slopes)
}

/// Logarithm of measured over computed size of a track.
fn scale_of(log: &TickLog, computed: &[Pose2]) -> Option<f64> {
    // Poses at both ends only say nothing of the size of a closed path.
    let mut samples: Vec<usize> = log.reference.iter().map(|seen| seen.sample).collect();
    samples.dedup();
    if samples.len() < 3 {
        return None;
    }
    ratio_of(log, computed, |_, seen| Some(Pose2::new(seen.x, seen.y, 0.0)))
}

/// ln |Σ p̄* q| / Σ |p|² of the positions p that were computed and q beside them, both from their means: the similarity with the least squares.
fn ratio_of(
    log: &TickLog,
    computed: &[Pose2],
    beside: impl Fn(usize, &crate::run::ReferencePose) -> Option<Pose2>,
) -> Option<f64> {
    let pairs: Vec<[f64; 4]> = log
        .reference
        .iter()
        .filter_map(|seen| {
            let (p, q) = (computed.get(seen.sample)?, beside(seen.sample, seen)?);
            Some([p.x, p.y, q.x, q.y])
        })
        .collect();
    let n = pairs.len() as f64;
    let mean: [f64; 4] = std::array::from_fn(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>() / n);
    let (mut real, mut imaginary, mut size) = (0.0, 0.0, 0.0);
    for pair in &pairs {
        let [px, py, qx, qy] = std::array::from_fn(|i| pair[i] - mean[i]);
        real += px * qx + py * qy;
        imaginary += px * qy - py * qx;
        size += px * px + py * py;
    }
    let ratio = libm::hypot(real, imaginary) / size;
    (size > 0.0 && ratio > 0.0).then(|| libm::log(ratio)).filter(|scale| scale.is_finite())
}

fn way_of(log: &TickLog, robot: &Robot) -> f64 {
    let poses = computed_poses(log, robot);
    poses.windows(2).map(|pair| libm::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y)).sum()
}
