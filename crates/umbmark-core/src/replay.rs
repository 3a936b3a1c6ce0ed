//! Wheel travel back to poses: what a model predicts that an absolute reference will see.
//!
//! ```text
//! recorded ticks --+
//!                  +--> believed wheel travel -> [wheels] -> kinematics -> [body] -> predicted pose
//! commanded moves -+
//! ```
//!
//! The effects are those of [`effect`](crate::effect), the same that simulate. With `f64` a replay gives poses; with
//! [`Dual`](crate::geometry::Dual) it gives poses and columns of their Jacobian, [`LANES`](crate::geometry::LANES) at once. Each
//! sample is an exact arc.

mod error;
mod moment;
mod pace;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::dataset::TickLog;
use crate::drive::{LinkReading, Robot, WheelTravel};
use crate::effect::{Chain, Context, Evaluate, Model, ModelError, Place, Progress, Sight};
use crate::engine::{Convoy, Floor, Predicted, Step};
#[cfg(target_arch = "x86_64")]
use crate::geometry::Instructions;
use crate::geometry::{Displacement2, Pose2};
use crate::path::{Direction, Path, Pieces, SpeedProfile};
use std::sync::Arc;

use error::check;
use moment::Moments;

pub use error::ReplayError;
pub use moment::Moment;

/// The believed wheel travel of one run in small pieces, each with its [`Context`], and the moments of observation.
///
/// Pieces in which nothing moves are dropped. The robot starts where the effects let it
/// stand at START.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::Model, path::{Direction, Path}, replay::Track};
/// let robot = Robot::labmate();
/// let track = Track::from_path(&Path::umbmark(), Direction::Ccw, &robot);
/// let mut model = Model::new(&robot);
/// model.set("wheelbase", "e_b", 337.2 / 340.0)?;
/// model.set("wheel_diameter_ratio", "e_d", 1.00121)?;
/// let end = track.end(&model.chain());
/// assert!((end.x.hypot(end.y) - 0.3056).abs() < 1e-4); // the paper's Table I publishes 310 mm
/// # Ok::<(), umbmark_core::effect::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    travel: Vec<WheelTravel>,
    contexts: Vec<Context>,
    /// How many pieces are made when each observation is taken, never decreasing.
    seen_after: Vec<usize>,
    sights: Vec<Sight>,
    /// From the first sample of a log to the last \[s\].
    duration: f64,
    /// Where START lies in the room.
    origin: Pose2,
    /// Whether it begins at START, rather than somewhere on the way.
    begins: bool,
    /// Of two trucks with a link, whose pieces are the periods of their odometry.
    convoy: Option<Arc<Convoy>>,
}

impl Track {
    /// The track of a recorded run, one piece a sample, observed at each of its reference poses.
    ///
    /// It stands first in its session; see [`Track::from_log_at`].
    pub fn from_log(log: &TickLog, robot: &Robot) -> Result<Track, ReplayError> {
        Track::from_log_at(log, robot, Place::default())
    }

    /// [`Track::from_log`] of a run with its place among others.
    pub fn from_log_at(log: &TickLog, robot: &Robot, place: Place) -> Result<Track, ReplayError> {
        Track::from_log_seen(log, robot, place, log.reference.iter().map(|reference| reference.sample))
    }

    /// [`Track::from_log_at`], observed at some of its samples, in order.
    pub fn from_log_seen(
        log: &TickLog,
        robot: &Robot,
        place: Place,
        samples: impl Iterator<Item = usize>,
    ) -> Result<Track, ReplayError> {
        check(log)?;
        let per_tick = robot.metres_per_tick();
        let speeds = pace::wheel_speeds(log, &per_tick);
        let mut progress = Progress::new(robot, place, true);
        let mut track = Track::empty();
        let mut due = samples.peekable();
        let (mut left, mut right) = (0.0, 0.0);
        for (sample, (l, r)) in log.left.iter().zip(&log.right).enumerate() {
            let before = sample.saturating_sub(1);
            let duration = log.time[sample] - log.time[before];
            let travel = WheelTravel { left: (l - left) * per_tick.left, right: (r - right) * per_tick.right };
            track.push(travel, progress.piece(&travel, duration, speeds[before], speeds[sample]));
            (left, right) = (*l, *r);
            track.duration = log.time[sample] - log.time[0];
            while due.next_if_eq(&sample).is_some() {
                track.observe(sight(track.duration, speeds[sample], robot));
            }
        }
        Ok(track)
    }

    /// The track of a robot that makes the moves of a path as its odometry believes, observed at the end.
    ///
    /// Where only return errors were measured, this is what the robot believed to drive: its controller stops each move
    /// when the odometry says so. Each move is one piece: for models that do not [vary](crate::effect::Model::varies).
    pub fn from_path(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, Pieces::whole, Observed::AtEnd)
    }

    /// [`Track::from_path`] in pieces of a centimetre, for every model.
    pub fn in_pieces(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, Pieces::of, Observed::AtEnd)
    }

    /// [`Track::in_pieces`] observed after every move.
    pub fn with_stops(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, Pieces::of, Observed::AtStops)
    }

    /// [`Track::in_pieces`] observed after every piece.
    pub fn watched(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, Pieces::of, Observed::Always)
    }

    fn along_path(
        path: &Path,
        direction: Direction,
        robot: &Robot,
        cut: fn(&WheelTravel, &SpeedProfile) -> Pieces,
        observed: Observed,
    ) -> Track {
        if let Some(convoy) = Convoy::new(robot, path, direction) {
            return Track::of_trucks(convoy, robot, observed);
        }
        let place = Place { direction: Some(direction), ..Place::default() };
        let mut progress = Progress::new(robot, place, false);
        let mut track = Track::empty();
        let moves = path.moves(direction);
        for (index, m) in moves.iter().enumerate() {
            for piece in cut(&m.wheel_travel(&robot.drive), &path.speed) {
                track.push(piece.travel, progress.piece(&piece.travel, piece.duration, piece.from, piece.to));
                if observed == Observed::Always {
                    track.observe(sight(progress.time(), piece.to, robot));
                }
            }
            progress.piece(&WheelTravel::default(), path.speed.pause(), [0.0; 2], [0.0; 2]);
            if observed == Observed::AtStops || (observed == Observed::AtEnd && index + 1 == moves.len()) {
                track.observe(Sight { time: progress.time(), ..Sight::default() });
            }
        }
        track
    }

    fn empty() -> Track {
        let (travel, contexts, seen_after, sights) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (duration, origin) = (f64::INFINITY, Pose2::IDENTITY);
        Track { travel, contexts, seen_after, sights, duration, origin, begins: true, convoy: None }
    }

    /// The track of a front truck, one piece a period.
    fn of_trucks(convoy: Convoy, robot: &Robot, observed: Observed) -> Track {
        let mut track = Track::empty();
        for (made, step) in (1..).zip(convoy.steps()) {
            track.travel.push(step.travel[0]);
            track.contexts.push(step.contexts[0]);
            let stops = convoy.stops().contains(&made);
            if match observed {
                Observed::Always => true,
                Observed::AtStops => stops,
                Observed::AtEnd => made == convoy.steps().len(),
            } {
                track.observe(sight(step.time, step.speeds[0], robot));
            }
        }
        track.convoy = Some(Arc::new(convoy));
        track
    }

    fn push(&mut self, travel: WheelTravel, at: Context) {
        if travel != WheelTravel::default() || at.speed_change != [0.0; 2] {
            self.travel.push(travel);
            self.contexts.push(at);
        }
    }

    fn observe(&mut self, sight: Sight) {
        self.seen_after.push(self.travel.len());
        self.sights.push(sight);
    }

    /// The travel up to the last observation (or all, where there is none), observed at its end only.
    pub fn cut_at_last(mut self) -> Track {
        let end = self.seen_after.last().copied().unwrap_or(self.travel.len());
        self.travel.truncate(end);
        self.contexts.truncate(end);
        self.seen_after = vec![end];
        self.sights = vec![self.sights.last().copied().unwrap_or_default()];
        self
    }

    /// The same run with its START elsewhere in the room.
    pub fn beginning_at(self, origin: Pose2) -> Track {
        Track { origin, ..self }
    }

    /// Some of the observations, with the travel between them and what is driven within `margin` \[s\] before and after.
    pub fn part(&self, observations: std::ops::Range<usize>, margin: f64) -> Track {
        let sights = self.sights[observations.clone()].to_vec();
        let [first, last] = [sights.first(), sights.last()].map(|sight| sight.map_or(0.0, |sight| sight.time));
        let from = self.contexts.partition_point(|at| at.time + at.duration < first - margin);
        let to = self.contexts.partition_point(|at| at.time <= last + margin).max(from);
        let seen_after = self.seen_after[observations].iter().map(|after| after - from).collect();
        Track {
            travel: self.travel[from..to].to_vec(),
            contexts: self.contexts[from..to].to_vec(),
            seen_after,
            sights,
            duration: self.duration,
            origin: self.origin,
            begins: self.begins && from == 0,
            convoy: None,
        }
    }

    /// Where the robot stands at the beginning.
    #[inline]
    pub fn start<T: Evaluate>(&self, chain: &Chain<T>) -> Pose2<T> {
        let start = if self.begins { chain.start() } else { Pose2::IDENTITY.lift() };
        if self.origin == Pose2::IDENTITY { start } else { self.origin.lift().compose(&start) }
    }

    /// Believed wheel travel of each piece \[m\].
    pub fn travel(&self) -> &[WheelTravel] {
        &self.travel
    }

    /// Where and how each piece is driven.
    pub fn contexts(&self) -> &[Context] {
        &self.contexts
    }

    /// How many elements of [`Track::travel`] are made when each observation is taken, never decreasing.
    pub fn seen_after(&self) -> &[usize] {
        &self.seen_after
    }

    /// The moment of each observation.
    pub fn sights(&self) -> &[Sight] {
        &self.sights
    }

    /// Length that the axle's centre is believed to travel \[m\], forward or backward.
    pub fn length(&self) -> f64 {
        self.travel.iter().map(|t| 0.5 * (t.left + t.right).abs()).sum()
    }

    /// Length that the axle's centre is believed to have travelled after `made` pieces \[m\].
    pub fn way_before(&self, made: usize) -> f64 {
        self.contexts.get(made).map_or_else(|| self.length(), |at| at.distance)
    }

    /// The plan of two trucks with a link.
    pub(crate) fn convoy(&self) -> Option<&Convoy> {
        self.convoy.as_deref()
    }

    /// Calls `seen` with the number of each observation and the pose predicted for it. It allocates nothing.
    #[inline]
    pub fn replay<T: Evaluate>(&self, chain: &Chain<T>, mut seen: impl FnMut(usize, &Pose2<T>)) {
        if let Some(convoy) = &self.convoy {
            return self.replay_trucks(convoy, chain, &Pose2::IDENTITY.lift(), seen);
        }
        if chain.has_clock() {
            return self.replay_late(chain, self.start(chain), |observation, pose, sight| {
                seen(observation, &chain.seen(sight, pose));
            });
        }
        let mut pose = self.start(chain);
        let mut made = 0;
        for (observation, (after, sight)) in self.seen_after.iter().zip(&self.sights).enumerate() {
            pose = self.drive(chain, pose, made..*after);
            made = *after;
            seen(observation, &chain.seen(sight, &pose));
        }
    }

    /// The same by a reference that is late: calls `seen` with the true pose at the moment that each measurement shows.
    fn replay_late<T: Evaluate>(
        &self,
        chain: &Chain<T>,
        from: Pose2<T>,
        mut seen: impl FnMut(usize, &Pose2<T>, &Sight),
    ) {
        let (mut pose, mut made, mut moments) = (from, 0, Moments::new(self));
        for (observation, sight) in self.sights.iter().enumerate() {
            let moment = moments.next(sight, chain.late(sight.time).value());
            // Beyond the end of a log its last piece goes on.
            let whole = moment.made.max(made);
            pose = self.drive(chain, pose, made..whole);
            made = whole;
            let mut there = pose;
            if moment.share != 0.0 {
                let (travel, at) = (&self.travel[moment.made], &self.contexts[moment.made]);
                let motion = chain.displacement(&at.at_pose(&pose), travel);
                let share = moment.share - (whole - moment.made) as f64;
                there.advance(&Displacement2 {
                    forward: motion.forward * share,
                    sideways: motion.sideways * share,
                    rotation: motion.rotation * share,
                });
            }
            seen(observation, &there, &moment.sight);
        }
    }

    /// The poses predicted for all observations, as seen from START, where the robot at START heads `turned` \[rad\] in the room.
    pub(crate) fn poses_turned<T: Evaluate>(&self, chain: &Chain<T>, turned: f64) -> Vec<Pose2<T>> {
        let room: Pose2<T> = Pose2::new(0.0, 0.0, turned).lift();
        let mut poses = Vec::with_capacity(self.seen_after.len());
        if let Some(convoy) = &self.convoy {
            self.replay_trucks(convoy, chain, &room, |_, pose| poses.push(*pose));
            return poses;
        }
        if chain.has_clock() {
            self.replay_late(chain, room.compose(&chain.start()), |_, pose, sight| {
                poses.push(room.inverse().compose(&chain.seen(sight, pose)));
            });
            return poses;
        }
        let mut pose = room.compose(&chain.start());
        let mut made = 0;
        for (after, sight) in self.seen_after.iter().zip(&self.sights) {
            pose = self.drive(chain, pose, made..*after);
            made = *after;
            poses.push(room.inverse().compose(&chain.seen(sight, &pose)));
        }
        poses
    }

    /// Calls `seen` for a front truck. Its odometry is not told where to be but finds out, so what is predicted is how far off it
    /// really is, about where it is to be.
    fn replay_trucks<T: Evaluate>(
        &self,
        convoy: &Convoy,
        chain: &Chain<T>,
        room: &Pose2<T>,
        mut seen: impl FnMut(usize, &Pose2<T>),
    ) {
        let mut floor = Predicted::by(chain);
        let mut trucks = convoy.at_start(room.compose(&chain.start()), &mut floor);
        let mut made = 0;
        for (observation, (after, sight)) in self.seen_after.iter().zip(&self.sights).enumerate() {
            convoy.steps()[made..*after].iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
            made = *after;
            let (real, told) = (chain.seen(sight, &trucks.real[0]), convoy.meant(made)[0]);
            let (real, believed) = (room.inverse().compose(&real), &trucks.believed[0]);
            let pose = Pose2 {
                x: real.x - believed.x + told.x,
                y: real.y - believed.y + told.y,
                heading: real.heading - believed.heading + told.heading,
            };
            seen(observation, &pose);
        }
    }

    #[inline]
    fn drive<T: Evaluate>(&self, chain: &Chain<T>, from: Pose2<T>, pieces: std::ops::Range<usize>) -> Pose2<T> {
        #[cfg(target_arch = "x86_64")]
        match Instructions::best() {
            // SAFETY: the machine was found to have them.
            Instructions::Avx512 if T::WIDE => return unsafe { x86::drive_by_eight(self, chain, from, pieces) },
            // SAFETY: as above.
            Instructions::Avx2 if T::WIDE => return unsafe { x86::drive_by_four(self, chain, from, pieces) },
            _ => {}
        }
        self.drive_plainly(chain, from, pieces)
    }

    #[inline(always)]
    fn drive_plainly<T: Evaluate>(&self, chain: &Chain<T>, from: Pose2<T>, pieces: std::ops::Range<usize>) -> Pose2<T> {
        if chain.reads_place() {
            self.drive_seeing::<T, true>(chain, from, pieces)
        } else {
            self.drive_seeing::<T, false>(chain, from, pieces)
        }
    }

    /// Without `PLACE` effects are told a place that is not followed: to hand it over piece by piece takes a tenth longer.
    #[inline(always)]
    fn drive_seeing<T: Evaluate, const PLACE: bool>(
        &self,
        chain: &Chain<T>,
        from: Pose2<T>,
        pieces: std::ops::Range<usize>,
    ) -> Pose2<T> {
        let pieces = self.travel[pieces.clone()].iter().zip(&self.contexts[pieces]);
        let mut pose = from;
        for (travel, at) in pieces {
            let there = if PLACE { pose } else { Pose2 { heading: pose.heading, ..from } };
            pose.advance(&chain.displacement(&at.at_pose(&there), travel));
        }
        pose
    }

    /// Refuses a model whose formulas are no finite numbers somewhere on the way.
    ///
    /// Where they depend on the place in the room, the way is the one that the model predicts; otherwise it is that of the
    /// believed travel.
    pub fn check(&self, model: &Model) -> Result<(), ModelError> {
        if !model.has_formulas() || !model.reads_place() {
            return model.check_along(&self.contexts);
        }
        let chain = model.chain();
        if let Some(convoy) = &self.convoy {
            let mut floor = Checked { floor: Predicted::by(&chain), model, found: Ok(()) };
            let mut trucks = convoy.at_start(chain.start(), &mut floor);
            convoy.steps().iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
            return floor.found;
        }
        let mut pose = self.start(&chain);
        for (travel, at) in self.travel.iter().zip(&self.contexts) {
            let here = at.at_pose(&pose);
            model.check_along([&here])?;
            pose.advance(&chain.displacement(&here, travel));
        }
        Ok(())
    }

    /// The pose predicted for the end of the travel.
    pub fn end<T: Evaluate>(&self, chain: &Chain<T>) -> Pose2<T> {
        if self.convoy.is_some() {
            return self.poses(chain).pop().unwrap_or_else(|| chain.start());
        }
        let end = self.drive(chain, self.start(chain), 0..self.travel.len());
        chain.seen(&self.sights.last().copied().unwrap_or_default(), &end)
    }

    /// The poses predicted for all observations.
    pub fn poses<T: Evaluate>(&self, chain: &Chain<T>) -> Vec<Pose2<T>> {
        let mut poses = Vec::with_capacity(self.seen_after.len());
        self.replay(chain, |_, pose| poses.push(*pose));
        poses
    }
}

/// Refuses a model whose formulas are no finite numbers somewhere on a path, driven in either direction.
pub fn check_on_path(model: &Model, path: &Path) -> Result<(), ModelError> {
    let directions = Direction::BOTH.into_iter().filter(|_| model.has_formulas());
    directions
        .map(|direction| Track::in_pieces(path, direction, model.robot()))
        .try_for_each(|track| track.check(model))
}

/// A floor by prediction on which the formulas of a model are watched.
struct Checked<'a> {
    floor: Predicted<'a, f64>,
    model: &'a Model,
    found: Result<(), ModelError>,
}

impl Floor<f64> for Checked<'_> {
    fn moved(&mut self, step: &Step, truck: usize, believed: WheelTravel, real: &Pose2) -> Displacement2 {
        if self.found.is_ok() {
            self.found = self.model.check_along([&step.contexts[truck].at_pose(real)]);
        }
        self.floor.moved(step, truck, believed, real)
    }

    fn shown(&mut self, link: LinkReading) -> LinkReading {
        self.floor.shown(link)
    }
}

/// When a robot on a path is observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Observed {
    AtEnd,
    AtStops,
    Always,
}

/// The moment at which the wheels have these speeds \[m/s\].
fn sight(time: f64, [left, right]: [f64; 2], robot: &Robot) -> Sight {
    Sight { time, late: 0.0, speed: 0.5 * (left + right), turn_rate: (right - left) / robot.drive.wheelbase() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::ReferencePose;
    use crate::effect::{Formula, Target};
    use crate::geometry::seeded;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// 1 m wheel circumference, 1000 ticks a turn: a millimetre a tick; wheelbase 0.5 m.
    fn robot() -> Robot {
        use crate::drive::{DifferentialDrive, Encoder};
        let drive = DifferentialDrive::new(0.5, 1.0 / PI, 1.0 / PI).unwrap().into();
        Robot { name: "round numbers".into(), drive, encoder: Encoder::new(1000.0, None, None).unwrap() }
    }

    fn seen(sample: usize) -> ReferencePose {
        ReferencePose { sample, x: 0.0, y: 0.0, heading: None }
    }

    fn log(left: &[f64], right: &[f64], reference: Vec<ReferencePose>) -> TickLog {
        let time = (0..left.len()).map(|i| i as f64).collect();
        TickLog { time, left: left.to_vec(), right: right.to_vec(), reference, ..TickLog::default() }
    }

    /// Straight 2 m, a quarter turn to the left on the spot, straight 1 m; still samples between.
    fn corner() -> TickLog {
        let quarter = 1000.0 * 0.5 * FRAC_PI_2 / 2.0;
        log(
            &[0.0, 2000.0, 2000.0, 2000.0 - quarter, 2000.0 - quarter, 3000.0 - quarter],
            &[0.0, 2000.0, 2000.0, 2000.0 + quarter, 2000.0 + quarter, 3000.0 + quarter],
            [0, 1, 2, 2, 4, 5].map(seen).to_vec(),
        )
    }

    #[test]
    fn poses_belong_to_the_samples_of_their_references_through_standstill_and_repeats() {
        let track = Track::from_log(&corner(), &robot()).unwrap();
        let poses = track.poses(&Model::new(&robot()).chain());
        let expected = [
            (0.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, FRAC_PI_2),
            (2.0, 1.0, FRAC_PI_2),
        ];
        assert_eq!(poses.len(), expected.len());
        for (pose, (x, y, heading)) in poses.iter().zip(expected) {
            assert!((pose.x - x).abs() < 1e-12 && (pose.y - y).abs() < 1e-12 && (pose.heading - heading).abs() < 1e-12);
        }
        assert_eq!(track.travel().iter().filter(|t| **t != WheelTravel::default()).count(), 3);
        assert!((track.length() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn one_sample_of_an_arc_is_exact_to_the_right_as_to_the_left() {
        for sign in [1.0, -1.0] {
            // Half a circle of radius 1 m: wheels at 0.75 and 1.25 m from its centre.
            let (inner, outer) = (1000.0 * 0.75 * PI, 1000.0 * 1.25 * PI);
            let (left, right) = if sign > 0.0 { (inner, outer) } else { (outer, inner) };
            let track = Track::from_log(&log(&[left], &[right], vec![seen(0)]), &robot()).unwrap();
            let end = track.end(&Model::new(&robot()).chain());
            assert!(end.x.abs() < 1e-12 && (end.y - sign * 2.0).abs() < 1e-12, "{end:?}");
        }
    }

    #[test]
    fn the_jacobian_is_that_of_finite_differences_at_every_observation() {
        let robot = robot();
        let mut model = Model::new(&robot);
        for (effect, parameter, value) in
            [("wheel_diameter_ratio", "e_d", 1.01), ("wheelbase", "e_b", 0.98), ("scale", "e_s", 1.02)]
        {
            model.set(effect, parameter, value).unwrap();
        }
        let values: Vec<f64> = model.values().collect();
        for track in [
            Track::from_log(&corner(), &robot).unwrap(),
            Track::from_path(&Path::umbmark(), Direction::Cw, &robot),
            Track::from_path(&Path::umbmark(), Direction::Ccw, &robot),
        ] {
            for i in 0..values.len() {
                let exact = track.poses(&model.chain_with(&seeded(values.iter().copied(), &[i])));
                let at = |step: f64| {
                    let mut moved = values.clone();
                    moved[i] += step;
                    track.poses(&model.chain_with(&moved))
                };
                let h = 1e-5;
                for (k, (high, low)) in at(h).iter().zip(at(-h)).enumerate() {
                    let numeric = [high.x - low.x, high.y - low.y, high.heading - low.heading].map(|d| d / (2.0 * h));
                    let column = [exact[k].x, exact[k].y, exact[k].heading].map(|d| d.eps[0]);
                    for (c, n) in column.iter().zip(numeric) {
                        assert!((c - n).abs() < 1e-6 * (1.0 + n.abs()), "parameter {i}, observation {k}: {c} {n}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_replay_of_duals_has_the_same_bits_in_registers_of_every_width() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for effect in ["wheel_diameter_ratio", "wheel_eccentricity_left", "crab", "caster_kick", "floor_slope_yaw"] {
            model.add(effect).unwrap();
        }
        let formula = Formula::new("own", Target::ForwardScale, "k * sin(x / l) * y", &["k", "l"]).unwrap();
        model.add_formula(formula, &[0.01, 2.0]).unwrap();
        let chain = model.chains(&[0, 1, 2, 3, 4, 5, 6, 7]).next().unwrap().0;
        for direction in Direction::BOTH {
            let track = Track::in_pieces(&Path::umbmark(), direction, &robot);
            let all = || (chain.start(), 0..track.travel.len());
            let ((from, pieces), (start, same)) = (all(), all());
            assert_eq!(track.drive(&chain, from, pieces), track.drive_plainly(&chain, start, same));
        }
    }

    #[test]
    fn impossible_logs_are_refused_with_the_offending_value() {
        let refuse = |log: &TickLog| Track::from_log(log, &robot()).unwrap_err().to_string();
        assert!(refuse(&log(&[0.0, 1.0], &[0.0], vec![])).contains("got 2, 2 and 1"));
        assert!(refuse(&log(&[0.0, f64::NAN], &[0.0, 1.0], vec![])).contains("sample 1 must be finite, got left NaN"));
        assert!(refuse(&log(&[0.0], &[0.0], vec![seen(1)])).contains("reference pose 0 belongs to sample 1"));
        assert!(refuse(&log(&[0.0, 1.0], &[0.0, 1.0], vec![seen(1), seen(0)])).contains("reference pose 1"));
    }
}
