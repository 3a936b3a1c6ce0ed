//! What a dataset can say of the robot.
//!
//! To first order, a pose measured after some driving tells a few linear combinations of the departures of E_d, E_b and E_s from
//! one, or of what a robot of another drive has in their place, beside the noise that the driving added. All poses of all runs
//! together, with noise of usual size, give the covariance matrix that a fit of the three would have (a Kalman filter whose state is
//! the pose error and the three departures: Kalman 1960). A quantity is determined where its standard error is small against the
//! size that it usually has. The motion is that of the logs; of runs without a log, that of the path.

use super::Group;
use crate::drive::{Robot, WheelTravel};
use crate::effect::{Aside, Chain, Model, RunContext, TestKind, find};
use crate::engine::{Convoy, Predicted};
use crate::geometry::{Dual, Pose2, seeded};
use crate::likelihood::Noise;
use crate::path::{Direction, Path};
use crate::run::{Run, StartKnown, TickLog};
use crate::setup::Setup;
use nalgebra::{Matrix3, SMatrix, SVector};

/// A quantity, and whether the data can determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct Determined {
    /// The quantity.
    pub quantity: &'static str,
    /// Whether it can be had.
    pub yes: bool,
    /// Standard error that these data promise with noise of usual size, a share of one; `None` where the data say nothing of it, and
    /// of what is no number of the robot.
    pub std_error: Option<f64>,
    /// The size that it usually has in robots, a share of one; `None` of what is no number of the robot.
    pub usual: Option<f64>,
    /// Why, or why not and what would help.
    pub because: &'static str,
}

/// What is asked for of a differential drive; of others, their first effects by name.
const OF_WHEELS: [&str; 3] = ["E_d", "E_b (if E_s = 1)", "E_s"];
const NOTHING: &str = "there is no return error and no absolute pose; measure where the robot stands";
const NO_MOTION: &str = "neither logs nor a path say how the robot drove: write [path] in robot.toml";
/// The motion of a path is taken in so many pieces a move, that of a log in pieces of so much time \[s\], no more than so many a run.
const PIECES: usize = 8;
const STEP: f64 = 0.25;
const MAX_STEPS: f64 = 2400.0;
/// Poses of a run that follow each other sooner share their noise \[s\]; no more than so many of a run are looked at.
const APART: f64 = 0.5;
const MOST_POSES: f64 = 200.0;
/// A quantity is determined where its standard error is less than this share of its usual size: one of usual size then stands out
/// by two standard errors.
const SMALL: f64 = 0.5;
/// Standard deviation of a quantity before anything is measured.
const AT_FIRST: f64 = 1.0;
/// Standard errors beyond this say that the data show nothing.
const NOT_SHOWN: f64 = 0.5;
/// Standard deviation of a gyro's own rate that some rest has shown \[rad/s\].
const OWN_RATE: f64 = 1e-3;
/// Standard deviations of a START that nobody measured \[m, rad\].
const START_UNKNOWN: (f64, f64) = (1.0, 0.5);

/// The answers, and how many combinations of the three quantities are shown.
pub(super) fn determine(
    groups: &[Group],
    runs: &[Run],
    robot: Option<&Robot>,
    path: Option<&Path>,
    setup: Option<&Setup>,
) -> (Vec<Determined>, usize) {
    let robot = robot.cloned().unwrap_or_else(Robot::labmate);
    let first = robot.drive.first_effects();
    let usual =
        first.map(|effect| find(effect).ok().and_then(|e| e.about.parameters.first()).map_or(1.0, |p| p.typical));
    let names = if first == Robot::labmate().drive.first_effects() { OF_WHEELS } else { first };
    let mut seen = Seen::new(&robot, path, setup);
    runs.iter().filter(|run| run.test == TestKind::Systematic).for_each(|run| seen.add(run));
    let answer = |column: usize| {
        let [std_error, alone] = seen.errors(column);
        let yes = seen.poses > 0 && std_error < SMALL * usual[column];
        let because = match (yes, column) {
            _ if seen.measured == 0 => NOTHING,
            _ if seen.poses == 0 => NO_MOTION,
            (true, _) if seen.headings_only => "measured headings show it",
            (false, 2) if seen.headings_only => {
                "headings do not show distances; measure a straight leg by tape, or a pose on the way"
            }
            (true, 2) if seen.stepwise => "measured steps are distances, as far as the sensor's own scale is right",
            (true, _) if seen.stepwise => "measured steps show it",
            (true, 2) if seen.tracked => "absolute poses on the way measure distances",
            (true, 2) => "the path is open: its end measures a distance",
            (true, _) if seen.tracked => "absolute poses on the way show it",
            (true, _) => "the returns show it",
            (false, 2) if seen.tracked => "these poses do not show it; drive longer straights, or measure more often",
            (false, 2) if names[2] == OF_WHEELS[2] => {
                "these returns give E_b/E_s only; measure the pose at a stop on the way, or a straight"
            }
            (false, 2) => {
                "these returns cannot separate it from the others; measure the pose at a stop on the way, or a straight"
            }
            _ if alone >= SMALL * usual[column] => "this path does not show it; drive a square both ways",
            _ if seen.directions.len() < 2 => {
                "one direction gives one combination of both and cannot separate them; drive the other direction as well"
            }
            _ => "these runs give one combination of both and cannot separate them; drive a square both ways",
        };
        let std_error = Some(std_error).filter(|error| seen.poses > 0 && *error < NOT_SHOWN);
        Determined { quantity: names[column], yes, std_error, usual: Some(usual[column]), because }
    };
    let mut answers = vec![answer(0), answer(1), answer(2)];
    answers.extend(other_answers(groups));
    (answers, seen.rank(&usual))
}

/// The motion of a piece, and where it ends.
#[derive(Clone, Copy)]
struct Piece {
    /// The believed pose at its end.
    pose: Pose2,
    /// Its derivatives by the three quantities.
    slopes: [Pose2; 3],
    /// Way of the axle's centre \[m\] and rotation \[rad\] of the piece, whatever way.
    way: f64,
    turned: f64,
}

impl Piece {
    /// What is seen of it from a pose before, whose heading turns all that follows: c - c' - c'_θ J (p - p').
    fn since(&self, (from, before): &(Pose2, [Pose2; 3])) -> Piece {
        let (x, y) = (self.pose.x - from.x, self.pose.y - from.y);
        let slope = |k: usize| {
            let (own, before) = (&self.slopes[k], &before[k]);
            let turned = before.heading;
            Pose2::new(own.x - before.x + turned * y, own.y - before.y - turned * x, own.heading - turned)
        };
        Piece { slopes: [0, 1, 2].map(slope), ..*self }
    }
}

/// Everything that was measured so far.
///
/// The state is (q, θ) of the pose error δp = q + θ J p, which stay constant while nothing is added, the departures of the three
/// quantities, and the rate of a gyro by itself.
struct Seen<'a> {
    robot: &'a Robot,
    path: Option<&'a Path>,
    chain: Chain<Dual>,
    noise: Noise,
    covariance: SMatrix<f64, 7, 7>,
    /// Poses and returns that there are, and those of them whose driving is known.
    measured: usize,
    poses: usize,
    /// Whether there are poses on the way, and whether these tell steps only.
    tracked: bool,
    stepwise: bool,
    /// Whether they tell headings only.
    headings_only: bool,
    /// Senses of driving of the runs.
    directions: Vec<Option<Direction>>,
}

impl<'a> Seen<'a> {
    fn new(robot: &'a Robot, path: Option<&'a Path>, setup: Option<&Setup>) -> Seen<'a> {
        let mut model = Model::new(robot);
        let first = robot.drive.first_effects();
        // Every drive's first effects stand in the catalogue.
        first.iter().for_each(|effect| drop(model.add(effect)));
        let place = |effect: &str| -> usize {
            model.parts().iter().take_while(|part| part.effect.name() != effect).map(|part| part.values.len()).sum()
        };
        let chain = model.chain_with(&seeded(model.values(), &first.map(place)));
        let mut noise = Noise::default();
        if let Some(own) = setup.filter(|setup| setup.mounting.is_some()).map(|setup| setup.noise) {
            noise.reference_position = noise.reference_position.max(own.position);
            noise.reference_heading = noise.reference_heading.max(own.heading);
        }
        let mut covariance = SMatrix::zeros();
        (3..6).for_each(|k| covariance[(k, k)] = AT_FIRST * AT_FIRST);
        let (measured, poses, directions) = (0, 0, Vec::new());
        let (tracked, stepwise, headings_only) = (false, false, false);
        Seen { robot, path, chain, noise, covariance, measured, poses, tracked, stepwise, headings_only, directions }
    }

    /// What a run adds.
    fn add(&mut self, run: &Run) {
        let log = run.log.as_ref().filter(|log| log.time.len() > 1);
        let with_poses = log.filter(|log| log.reference.len() > 1);
        if with_poses.is_none() && run.returned.is_none() {
            return;
        }
        self.measured += 1;
        if !self.directions.contains(&run.direction) {
            self.directions.push(run.direction);
        }
        match (log, with_poses, run.returned) {
            (_, Some(log), _) => self.add_log(log, run.direction),
            (Some(log), None, Some(returned)) => {
                let ends = steps(log, &[]);
                let pieces = self.along(&self.of_log(log, &ends), run.direction, true);
                self.add_return(&pieces, returned.heading.is_some());
            }
            (None, _, Some(returned)) => {
                let Some(path) = self.path else { return };
                let direction = run.direction.unwrap_or(Direction::Ccw);
                let pieces = match Convoy::new(self.robot, path, direction) {
                    Some(convoy) => along_with_trucks(&convoy, &self.chain),
                    None => self.along(&self.of_path(path, direction), run.direction, false),
                };
                self.add_return(&pieces, returned.heading.is_some());
            }
            _ => {}
        }
    }

    /// The end of a run, measured by hand as START was.
    fn add_return(&mut self, pieces: &[Piece], heading: bool) {
        let marked = (self.noise.start_position, self.noise.start_heading);
        self.begin(marked);
        let mut from = Pose2::IDENTITY;
        for piece in pieces {
            self.roll(&from, piece);
            from = piece.pose;
        }
        if let Some(end) = pieces.last() {
            self.see(end, heading, marked);
        }
    }

    /// A log and its poses.
    fn add_log(&mut self, log: &TickLog, direction: Option<Direction>) {
        let mut poses: Vec<(usize, bool)> = Vec::new();
        let last = log.reference[log.reference.len() - 1].sample;
        let span = log.time[last] - log.time[log.reference[0].sample];
        let apart = APART.max(span / MOST_POSES);
        for pose in &log.reference {
            let near = poses.last().is_some_and(|(before, _)| log.time[pose.sample] - log.time[*before] < apart);
            if !near || (pose.sample == last && poses.last().is_some_and(|(before, _)| *before < last)) {
                poses.push((pose.sample, pose.heading.is_some()));
            }
        }
        let ends = steps(log, &poses.iter().map(|(sample, _)| *sample).collect::<Vec<usize>>());
        let pieces = self.along(&self.of_log(log, &ends), direction, true);
        let reference = (self.noise.reference_position, self.noise.reference_heading);
        self.begin(match log.start.known {
            StartKnown::Given => (self.noise.start_position, self.noise.start_heading),
            StartKnown::AtRest => reference,
            StartKnown::OnTheWay => START_UNKNOWN,
        });
        self.headings_only |= log.headings_only;
        self.drift_anew();
        let mut before = log.time[log.reference[0].sample];
        let mut seen = poses.iter().peekable();
        let (mut from, mut moved) = (Pose2::IDENTITY, 0);
        let mut last: Option<(Pose2, [Pose2; 3])> = None;
        let way: f64 = pieces.iter().map(|piece| piece.way).sum();
        let mut gone = 0.0;
        for (end, piece) in ends[1..].iter().zip(&pieces) {
            self.roll(&from, piece);
            (from, gone) = (piece.pose, gone + piece.way);
            while let Some((sample, heading)) = seen.next_if(|(sample, _)| sample <= end) {
                let seconds = log.time[*sample] - std::mem::replace(&mut before, log.time[*sample]);
                if log.headings_only {
                    let before = last.replace((piece.pose, piece.slopes));
                    match before.filter(|_| log.relative) {
                        Some(before) => self.see_heading(&piece.since(&before), reference.1, seconds),
                        None if log.relative => {}
                        None => self.see_heading(piece, reference.1, 0.0),
                    }
                    if log.relative {
                        self.begin((0.0, 0.0));
                    }
                } else if log.relative {
                    let step = last.replace((piece.pose, piece.slopes)).map(|before| piece.since(&before));
                    if let Some(step) = step {
                        self.see(&step, *heading, reference);
                    }
                    self.begin((0.0, 0.0));
                } else {
                    self.see(piece, *heading, reference);
                }
                moved += usize::from(gone > 0.05 * way && gone < 0.95 * way);
            }
        }
        self.tracked |= moved > 0;
        self.stepwise |= log.relative;
    }

    /// Travel and time of each step of a log.
    fn of_log(&self, log: &TickLog, ends: &[usize]) -> Vec<(WheelTravel, Aside, f64)> {
        let asides = log.asides(self.robot);
        let per_tick = self.robot.metres_per_tick();
        let step = |pair: &[usize]| {
            let (a, b) = (pair[0], pair[1]);
            let (left, right) = (log.left[b] - log.left[a], log.right[b] - log.right[a]);
            let travel = WheelTravel { left: left * per_tick.left, right: right * per_tick.right };
            let seconds = (log.time[b] - log.time[a]).max(1e-6);
            let [way, disagreement] = asides.get(b).map_or([0.0; 2], |to| [to[0] - asides[a][0], to[1] - asides[a][1]]);
            (travel, Aside { way, disagreement, speed: way / seconds }, seconds)
        };
        ends.windows(2).map(step).collect()
    }

    /// Travel and time of each piece of a path.
    fn of_path(&self, path: &Path, direction: Direction) -> Vec<(WheelTravel, Aside, f64)> {
        let pieces = |m: crate::path::Move| {
            let share = 1.0 / PIECES as f64;
            let (travel, way) = (m.wheel_travel(&self.robot.drive).scaled(share), share * m.displacement().sideways);
            std::iter::repeat_n((travel, Aside { way, speed: way, ..Aside::NONE }, 1.0), PIECES)
        };
        path.moves(direction).into_iter().flat_map(pieces).collect()
    }

    /// The believed poses along some travel, with their derivatives.
    fn along(&self, travels: &[(WheelTravel, Aside, f64)], direction: Option<Direction>, recorded: bool) -> Vec<Piece> {
        let mut progress = RunContext { direction, ..RunContext::default() }.progress(self.robot, recorded);
        let mut pose: Pose2<Dual> = Pose2::IDENTITY.lift();
        let one = |(travel, aside, seconds): &(WheelTravel, Aside, f64)| {
            let speeds = [travel.left / seconds, travel.right / seconds];
            let at = progress.piece_aside(travel, *aside, *seconds, speeds, speeds);
            pose = pose.moved(&self.chain.displacement(&at.at_pose(&pose), travel));
            let ahead = 0.5 * (travel.left + travel.right).abs();
            let way = if aside.way == 0.0 { ahead } else { libm::hypot(ahead, aside.way) };
            let turned = (travel.right - travel.left).abs() / self.robot.drive.wheelbase();
            Piece { pose: pose.value(), slopes: [0, 1, 2].map(|lane| pose.slope(lane)), way, turned }
        };
        travels.iter().map(one).collect()
    }

    /// A run begins: its pose error is that of START.
    fn begin(&mut self, (position, heading): (f64, f64)) {
        for k in 0..3 {
            self.covariance.fill_row(k, 0.0);
            self.covariance.fill_column(k, 0.0);
            let sd = if k < 2 { position } else { heading };
            self.covariance[(k, k)] = sd * sd;
        }
    }

    /// The robot drives: wheels and floor add noise.
    fn roll(&mut self, from: &Pose2, piece: &Piece) {
        let Noise { heading_per_metre, heading_per_radian, forward_per_metre, sideways_per_metre, .. } = self.noise;
        let (x, y) = (0.5 * (from.x + piece.pose.x), 0.5 * (from.y + piece.pose.y));
        let (sine, cosine) = libm::sincos(0.5 * (from.heading + piece.pose.heading));
        let turned = piece.way * heading_per_metre.powi(2) + piece.turned * heading_per_radian.powi(2);
        let (along, across) = (piece.way * forward_per_metre.powi(2), piece.way * sideways_per_metre.powi(2));
        for (direction, variance) in
            [([y, -x, 1.0], turned), ([cosine, sine, 0.0], along), ([-sine, cosine, 0.0], across)]
        {
            for (i, a) in direction.iter().enumerate() {
                for (j, b) in direction.iter().enumerate() {
                    self.covariance[(i, j)] += variance * a * b;
                }
            }
        }
    }

    /// A pose is measured at the end of a piece.
    fn see(&mut self, at: &Piece, heading: bool, (position, angle): (f64, f64)) {
        self.poses += 1;
        let [a, b, c] = &at.slopes;
        self.update([1.0, 0.0, -at.pose.y, a.x, b.x, c.x, 0.0], position);
        self.update([0.0, 1.0, at.pose.x, a.y, b.y, c.y, 0.0], position);
        if heading {
            self.update([0.0, 0.0, 1.0, a.heading, b.heading, c.heading, 0.0], angle);
        }
    }

    /// A heading is measured at the end of a piece, by a gyro so many seconds after the one before.
    fn see_heading(&mut self, at: &Piece, angle: f64, seconds: f64) {
        self.poses += 1;
        let [a, b, c] = at.slopes.each_ref().map(|slope| slope.heading);
        self.update([0.0, 0.0, 1.0, a, b, c, seconds], angle);
    }

    /// A gyro's own rate is unknown when a run begins.
    fn drift_anew(&mut self) {
        self.covariance.fill_row(6, 0.0);
        self.covariance.fill_column(6, 0.0);
        self.covariance[(6, 6)] = OWN_RATE * OWN_RATE;
    }

    fn update(&mut self, row: [f64; 7], std_dev: f64) {
        let row = SVector::<f64, 7>::from(row);
        let gain = self.covariance * row;
        let variance = row.dot(&gain) + std_dev * std_dev;
        if variance.is_finite() && variance > 0.0 {
            self.covariance -= gain * gain.transpose() / variance;
        }
    }

    /// Covariance of the three quantities.
    fn of_quantities(&self) -> Matrix3<f64> {
        let own: Matrix3<f64> = self.covariance.fixed_view::<3, 3>(3, 3).into_owned();
        0.5 * (own + own.transpose())
    }

    /// Standard error of a quantity: of the first two, the other being free and the third being one; of the third, both others being
    /// free. And the one that it would have if all others were known.
    fn errors(&self, column: usize) -> [f64; 2] {
        let own = self.of_quantities();
        let Some(information) = own.try_inverse() else { return [AT_FIRST; 2] };
        let error = |variance: f64| if variance > 0.0 { variance.sqrt() } else { AT_FIRST };
        let alone = error(1.0 / information[(column, column)]);
        if column == 2 {
            return [error(own[(2, 2)]), alone];
        }
        let pair = information.fixed_view::<2, 2>(0, 0).into_owned().try_inverse();
        [pair.map_or(AT_FIRST, |pair| error(pair[(column, column)])), alone]
    }

    /// How many combinations of the three, each in its usual size, are determined.
    fn rank(&self, usual: &[f64; 3]) -> usize {
        let own = self.of_quantities();
        let scaled = Matrix3::from_fn(|i, j| own[(i, j)] / (usual[i] * usual[j]));
        scaled.symmetric_eigenvalues().iter().filter(|variance| **variance < SMALL * SMALL).count()
    }
}

/// The samples at which the steps of a log end, the first one included, and those of all poses.
fn steps(log: &TickLog, poses: &[usize]) -> Vec<usize> {
    let (first, last) = (log.time[0], log.time[log.time.len() - 1]);
    let step = STEP.max((last - first) / MAX_STEPS);
    let mut poses = poses.iter().copied().peekable();
    let mut ends = vec![0];
    let mut before = first;
    for (sample, time) in log.time.iter().enumerate().skip(1) {
        let mut seen = false;
        while poses.next_if(|pose| *pose <= sample).is_some() {
            seen = true;
        }
        if seen || *time - before >= step || sample + 1 == log.time.len() {
            ends.push(sample);
            before = *time;
        }
    }
    ends
}

/// The derivative of the front truck's return error after each move.
fn along_with_trucks(convoy: &Convoy, chain: &Chain<Dual>) -> Vec<Piece> {
    let mut floor = Predicted::by(chain);
    let mut trucks = convoy.at_start(chain.start(), &mut floor);
    let (mut made, mut poses) = (0, Vec::new());
    for stop in convoy.stops() {
        convoy.steps()[made..*stop].iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
        made = *stop;
        let slopes = [0, 1, 2].map(|lane| {
            let [real, believed] = [&trucks.real[0], &trucks.believed[0]].map(|pose| pose.slope(lane));
            Pose2::new(real.x - believed.x, real.y - believed.y, real.heading - believed.heading)
        });
        // The correction takes what wheels and floor add.
        poses.push(Piece { pose: trucks.real[0].value(), slopes, way: 0.0, turned: 0.0 });
    }
    poses
}

fn other_answers(groups: &[Group]) -> [Determined; 3] {
    let each = |enough: &dyn Fn(&Group) -> bool| {
        Direction::BOTH.into_iter().all(|d| groups.iter().any(|g| g.direction == Some(d) && enough(g)))
    };
    let bumps = groups.iter().any(|g| g.test == TestKind::Bumps && g.headings > 0);
    let answer = |quantity, yes, because: [&'static str; 2]| Determined {
        quantity,
        yes,
        std_error: None,
        usual: None,
        because: because[usize::from(!yes)],
    };
    [
        answer(
            "heading form",
            each(&|g| g.headings > 0),
            ["return headings were measured in both directions", "it needs return headings in both directions"],
        ),
        answer(
            "scatter sigma",
            each(&|g| g.returns >= 3),
            ["there are 3 or more returns in each direction", "it needs 3 or more returns in each direction"],
        ),
        answer(
            "extended test",
            bumps,
            [
                "there are runs over bumps with return headings",
                "it needs runs over bumps with return headings (column test = bumps)",
            ],
        ),
    ]
}
