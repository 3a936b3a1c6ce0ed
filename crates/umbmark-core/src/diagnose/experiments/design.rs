//! Experiments that can be done with a tape measure, and the scatter of their poses.

use crate::drive::{Robot, WheelTravel};
use crate::effect::{Chain, Context, Derived, Evaluate, across, course_angle};
use crate::evidence::ends::{Ends, Fitted};
use crate::evidence::noise_shape::trucks;
use crate::geometry::{Displacement2, Dual, Pose2};
use crate::path::{
    CIRCLE, DIAGONAL_SQUARE, Direction, FIXED_SQUARE, Path, SIDEWAYS_SQUARE, SLIDE, SPIN, SQUARE, STRAIGHT, Shape,
    SpeedProfile,
};
use crate::replay::Track;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix3xX, Vector3};

/// Time to carry the robot to START, align it and write down the end pose \[min\].
pub(crate) const MINUTES_A_RUN: f64 = 1.0;
/// Time to measure a pose on the way by tape \[min\].
const MINUTES_A_STOP: f64 = 0.5;
/// Standard deviations of a tape and a protractor: 2 mm and 0.15 degrees.
const TAPE: [f64; 3] = [2e-3, 2e-3, 2.6e-3];

/// How poses scatter: wheel noise along the way and the tape at its end.
pub(super) struct Noise {
    /// Variance of each wheel's travel a metre \[m\].
    pub variance: f64,
    /// 3, or 2 where headings are not measured.
    coordinates: usize,
}

impl Noise {
    /// Wheel noise that gives the scatter of the runs; `None` if they have no scatter.
    pub fn of(ends: &Ends, fitted: &Fitted) -> Option<Noise> {
        let d = ends.coordinates();
        let shape = ends.noise_shape()?.view((0, 0), (d, d)).into_owned().cholesky()?;
        let (scatter, freedom) = fitted.scatter(ends);
        let variance = shape.solve(&scatter.view((0, 0), (d, d)).into_owned()).trace() / d as f64;
        (freedom > 0 && variance > 0.0).then_some(Noise { variance, coordinates: d })
    }
}

/// Runs of one kind.
struct Leg {
    track: Track,
    runs: usize,
    /// Heading at START in the room \[rad\], relative to that of the data.
    turned: f64,
    /// How long one run takes \[min\].
    minutes: f64,
}

/// From one observation of a run to the next.
pub(super) struct Stage {
    /// Propagation of a pose error.
    carried: Matrix3<f64>,
    /// Lower triangular root of the covariance of the innovations.
    factor: DMatrix<f64>,
    /// Gain of the filter.
    gain: Matrix3xX<f64>,
}

/// An experiment.
pub(super) struct Design {
    pub what: String,
    legs: Vec<Leg>,
}

impl Design {
    pub fn minutes(&self) -> f64 {
        self.legs.iter().map(|leg| leg.runs as f64 * leg.minutes).sum()
    }

    /// How noise grows along each kind of run.
    pub fn stages(&self, robot: &Robot, noise: &Noise) -> Vec<Vec<Stage>> {
        self.legs.iter().map(|leg| leg.stages(robot, noise)).collect()
    }

    /// Derivatives of all observations by some numbers, in standard deviations: the innovation of each, given the earlier ones.
    pub fn columns(&self, derived: &Derived, stages: &[Vec<Stage>]) -> Vec<DVector<f64>> {
        let poses: Vec<Vec<Pose2<Dual>>> = self.legs.iter().map(|leg| leg.poses(&derived.chain)).collect();
        (0..derived.numbers.len()).map(|lane| self.column(&poses, lane, stages)).collect()
    }

    fn column(&self, poses: &[Vec<Pose2<Dual>>], lane: usize, stages: &[Vec<Stage>]) -> DVector<f64> {
        let mut rows = Vec::new();
        for ((leg, poses), stages) in self.legs.iter().zip(poses).zip(stages) {
            let mut known = Vector3::zeros();
            for (pose, stage) in poses.iter().zip(stages) {
                known = stage.carried * known;
                let slope = pose.slope(lane);
                let seen = Vector3::new(slope.x, slope.y, slope.heading);
                let new = (seen - known).rows(0, stage.factor.nrows()).into_owned();
                known += &stage.gain * &new;
                let whitened = stage.factor.solve_lower_triangular(&new).unwrap_or(new);
                rows.extend(whitened.iter().map(|w| w * (leg.runs as f64).sqrt()));
            }
        }
        DVector::from_vec(rows)
    }
}

impl Leg {
    /// Observed poses in the frame of START, for any heading of START in the room.
    fn poses<T: Evaluate>(&self, chain: &Chain<T>) -> Vec<Pose2<T>> {
        if self.turned == 0.0 { self.track.poses(chain) } else { self.track.poses_turned(chain, self.turned) }
    }

    /// How noise grows and is observed along the run: a Kalman filter, whose gains do not depend on the observations.
    fn stages(&self, robot: &Robot, noise: &Noise) -> Vec<Stage> {
        let d = noise.coordinates;
        let tape = Matrix3::from_diagonal(&Vector3::from(TAPE.map(|sd| sd * sd)));
        let (mut covariance, mut before, mut made) = (Matrix3::zeros(), Pose2::IDENTITY, 0);
        let mut stages = Vec::new();
        for after in self.track.seen_after() {
            let (gathered, now) = self.gathered(robot, before, made..*after);
            let mut carried = Matrix3::identity();
            carried[(0, 2)] = before.y - now.y;
            carried[(1, 2)] = now.x - before.x;
            covariance = carried * covariance * carried.transpose() + gathered * noise.variance;
            let seen = (covariance + tape).view((0, 0), (d, d)).into_owned();
            // The tape's own variance keeps it from being singular.
            let Some(cholesky) = seen.cholesky() else { continue };
            let gain = covariance.columns(0, d) * cholesky.inverse();
            covariance -= &gain * covariance.rows(0, d);
            stages.push(Stage { carried, factor: cholesky.l(), gain });
            (before, made) = (now, *after);
        }
        stages
    }

    /// Covariance that wheel noise of unit variance per metre accumulates over some pieces, and the nominal pose after them. For two trucks
    /// it contains the new noise of the front one; errors that propagate between the trucks are neglected.
    fn gathered(&self, robot: &Robot, from: Pose2, pieces: std::ops::Range<usize>) -> (Matrix3<f64>, Pose2) {
        if let Some(convoy) = self.track.convoy() {
            let end = convoy.meant(pieces.end)[0];
            return (trucks::gathered(convoy, &robot.drive, pieces), end);
        }
        let moved = |share: f64, travel: &WheelTravel, at: &Context| {
            let motion = robot.drive.displacement(&travel.scaled(share));
            Displacement2 { sideways: share * at.aside.way, ..motion }
        };
        let pieces = || self.track.travel()[pieces.clone()].iter().zip(&self.track.contexts()[pieces.clone()]);
        let end = pieces().fold(from, |pose, (travel, at)| pose.moved(&moved(1.0, travel, at)));
        let turn = 1.0 / robot.drive.wheelbase();
        let (mut sum, mut pose) = (Matrix3::zeros(), from);
        for (travel, context) in pieces() {
            let at = pose.moved(&moved(0.5, travel, context));
            let left = context.aside.way;
            let (sine, cosine) = libm::sincos(at.heading + course_angle(travel, left));
            let along = Vector3::new(cosine, sine, 0.0) * 0.5;
            let about = Vector3::new(at.y - end.y, end.x - at.x, 1.0) * turn;
            let rolled = across(travel, left);
            for (shift, rolled) in [(along - about, rolled.left), (along + about, rolled.right)] {
                sum += shift * shift.transpose() * rolled.abs();
            }
            pose = pose.moved(&moved(1.0, travel, context));
        }
        (sum, end)
    }
}

/// The experiment that was done.
pub(super) fn todays(ends: &Ends) -> Design {
    let tracks = ends.tracks(true);
    let numbers: Vec<usize> = (0..tracks.len()).collect();
    let used: Vec<(Direction, usize)> = ends.of_runs(&numbers).map(|(direction, track)| (direction, *track)).collect();
    let leg = |(number, track): (usize, &&Track)| {
        let own = || used.iter().filter(|(_, track)| *track == number);
        let planned = ends.path.as_ref().filter(|_| !ends.is_recorded()).zip(own().next());
        let track = planned.map_or_else(
            || (*track).clone(),
            |(path, (direction, _))| Track::planned(path, *direction, &ends.robot, false),
        );
        Leg { track, runs: own().count(), turned: 0.0, minutes: 0.0 }
    };
    Design { what: "the data".into(), legs: tracks.iter().enumerate().map(leg).collect() }
}

/// All available experiments for this robot and floor.
pub(super) fn designs(ends: &Ends) -> Vec<Design> {
    let robot = &ends.robot;
    let speed = ends.path.as_ref().map_or_else(SpeedProfile::default, |path| path.speed);
    let [top, acceleration, pause] = speed.values();
    let faster = SpeedProfile::new(2.0 * top, acceleration, pause).unwrap_or(speed);
    let of = |shape: &'static Shape, values: &[f64], speed| Path::new(shape, values, speed).ok();
    let mut offered = vec![
        plain("a straight of 10 m by tape, 5 runs", of(&STRAIGHT, &[10.0], speed), robot, 5, false),
        plain("a straight of 10 m at double speed, 5 runs", of(&STRAIGHT, &[10.0], faster), robot, 5, false),
        plain("5 turns on the spot each way, 3 runs each", of(&SPIN, &[5.0], speed), robot, 3, true),
        plain("5 turns on the spot at double rate each way, 3 runs each", of(&SPIN, &[5.0], faster), robot, 3, true),
        plain("circles of 1 m radius, 2 turns each way, 3 runs each", of(&CIRCLE, &[1.0, 2.0], speed), robot, 3, true),
        plain("a way of 10 m to the side by tape, 5 runs", of(&SLIDE, &[10.0], speed), robot, 5, false),
    ];
    let side = ends.path.as_ref().and_then(|path| path.values().first().copied()).unwrap_or(2.0);
    for (how, shape) in [
        ("at a fixed heading", &FIXED_SQUARE),
        ("on its corner", &DIAGONAL_SQUARE),
        ("driven to the side", &SIDEWAYS_SQUARE),
    ] {
        let what = format!("a square of {side} m {how}, 3 runs each way");
        let driven = ends.path.as_ref().is_some_and(|path| std::ptr::eq(path.shape(), shape));
        offered.push(plain(&what, of(shape, &[side], speed).filter(|_| !driven), robot, 3, true));
    }
    if let Some(path) = &ends.path {
        let quarter = std::f64::consts::FRAC_PI_2;
        offered.push(again(path, robot, "the pose taped at every stop", true, 0.0));
        offered.push(again(path, robot, "START turned by 90 deg in the room", false, quarter));
        if let Some(trucks) = robot.drive.trucks().filter(|trucks| trucks.corrects()) {
            let plain = Robot { drive: trucks.with_correction(false).into(), ..robot.clone() };
            offered.push(again(path, &plain, "the correction by the link switched off", false, 0.0));
        }
        let double = of(path.shape(), path.values(), faster);
        offered.push(plain("the same path at double speed, 3 runs each way", double, robot, 3, true));
        if std::ptr::eq(path.shape(), &SQUARE) {
            let side = 0.5 * path.values()[0];
            let what = format!("a square of {side} m, 3 runs each way");
            offered.push(plain(&what, of(&SQUARE, &[side], speed), robot, 3, true));
        }
    }
    offered.into_iter().flatten().collect()
}

/// A path driven unchanged, in one direction or both.
fn plain(what: &str, path: Option<Path>, robot: &Robot, runs: usize, both: bool) -> Option<Design> {
    let path = path.filter(|path| path.suits(robot))?;
    let directions: &[Direction] = if both { &Direction::BOTH } else { &[Direction::Ccw] };
    let leg = |d: &Direction| Leg {
        track: Track::planned(&path, *d, robot, false),
        runs,
        turned: 0.0,
        minutes: MINUTES_A_RUN + minutes(&path, robot),
    };
    Some(Design { what: what.into(), legs: directions.iter().map(leg).collect() })
}

/// The same path again, three runs each way, with poses taped at the stops or START turned in the room.
fn again(path: &Path, robot: &Robot, how: &str, stops: bool, turned: f64) -> Option<Design> {
    let leg = |d: Direction| {
        let track = Track::planned(path, d, robot, stops);
        let taped = MINUTES_A_STOP * (track.sights().len() - 1) as f64;
        Leg { track, runs: 3, turned, minutes: MINUTES_A_RUN + taped + minutes(path, robot) }
    };
    Some(Design { what: format!("the same path, {how}, 3 runs each way"), legs: Direction::BOTH.map(leg).into() })
}

/// Time on the way \[min\].
pub(crate) fn minutes(path: &Path, robot: &Robot) -> f64 {
    let profiles = path.profiles(Direction::Ccw, &robot.drive);
    let seconds: f64 = profiles.iter().map(|(profile, pause)| profile.duration() + pause).sum();
    seconds / 60.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Model, Number};

    /// Poses at the stops, with the travel of one piece changed.
    fn stops(track: &Track, robot: &Robot, changed: usize, by: WheelTravel) -> DVector<f64> {
        let (mut poses, mut pose) = (vec![Pose2::IDENTITY], Pose2::IDENTITY);
        for (piece, travel) in track.travel().iter().enumerate() {
            let more = if piece == changed { by } else { WheelTravel::default() };
            let travel = WheelTravel { left: travel.left + more.left, right: travel.right + more.right };
            pose = pose.moved(&robot.drive.displacement(&travel));
            poses.push(pose);
        }
        let seen = track.seen_after().iter().map(|made| poses[*made]);
        DVector::from_vec(seen.flat_map(|pose| [pose.x, pose.y, pose.heading]).collect())
    }

    /// Oracle: generalised least squares with the covariance of all poses at once, its noise piece by piece by differences.
    #[test]
    fn what_is_new_at_each_stop_tells_as_much_as_all_poses_with_their_covariance() {
        let robot = Robot::labmate();
        let noise = Noise { variance: 1e-6, coordinates: 3 };
        let track = Track::with_stops(&Path::umbmark(), Direction::Ccw, &robot);
        let leg = Leg { track: track.clone(), runs: 3, turned: 0.0, minutes: 0.0 };
        let design = Design { what: String::new(), legs: vec![leg] };
        let number = |(effect, parameter)| Number::of(effect, parameter);
        let numbers = [("wheel_diameter_ratio", "e_d"), ("wheelbase", "e_b")].map(number);
        let derived = Model::new(&robot).derived(&numbers).unwrap().remove(0);
        let columns = design.columns(&derived, &design.stages(&robot, &noise));

        let rows = 3 * track.seen_after().len();
        let mut covariance = DMatrix::from_fn(rows, rows, |i, j| if i == j { TAPE[i % 3] * TAPE[i % 3] } else { 0.0 });
        let step = 1e-6;
        for (piece, travel) in track.travel().iter().enumerate() {
            for (rolled, left, right) in [(travel.left, step, 0.0), (travel.right, 0.0, step)] {
                let [more, less] =
                    [1.0, -1.0].map(|sign| stops(&track, &robot, piece, WheelTravel { left, right }.scaled(sign)));
                let slope = (more - less) / (2.0 * step);
                covariance += &slope * slope.transpose() * (rolled.abs() * noise.variance);
            }
        }
        let poses = track.poses(&derived.chain);
        let slope = |lane: usize| {
            let slopes = poses.iter().map(|pose| pose.slope(lane)).flat_map(|slope| [slope.x, slope.y, slope.heading]);
            DVector::from_iterator(rows, slopes)
        };
        let factor = covariance.cholesky().unwrap();
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let expected = 3.0 * slope(i).dot(&factor.solve(&slope(j)));
            let told = columns[i].dot(&columns[j]);
            assert!((told / expected - 1.0).abs() < 1e-3, "{i} {j}: {told} {expected}");
        }
    }
}
