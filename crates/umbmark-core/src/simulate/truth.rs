//! The true motion of a robot whose odometry believes something else.

use super::Leg;
use super::diffusion::{Diffusion, normals};
use super::pieces::{Noise, Piece, Pieces};
use super::rolls::{Roll, Rolls};
use super::way::Way;
use crate::drive::{Drive, LinkReading, WheelTravel};
use crate::effect::{
    Aside, Bump, Chain, Changes, Context, Filter, Law, Model, RandomLaws, Sight, Stretch, WheelVariance, across,
    course, course_angle,
};
use crate::engine::Instructions;
use crate::geometry::{Displacement2, Pose2, Real};
use crate::path::Direction;
use crate::random::Stream;

/// A filter is followed for so many of its time constants: 6e-6 of it is before.
const FILTERED: f64 = 12.0;
/// Steps of that time.
const STEPS: u32 = 600;
/// Purpose of the stream that wheel noise is drawn from; no hash of a name is this small.
const WHEEL_NOISE: u64 = 2;

/// The effects of a model at work in one trial: deterministic chain, random parts with their streams, true poses.
///
/// Where an effect [varies](Model::varies), stretches are driven in pieces of a centimetre, each with its own [`Context`]; otherwise a
/// stretch is one piece from bump to bump. Wheel noise is the same in both cases, one draw from bump to bump; its rotation is part of the
/// heading of later stretches.
#[derive(Debug)]
pub struct Truth {
    drive: Drive,
    chain: Chain<f64>,
    random: Vec<RandomPart>,
    rotation_per_metre: f64,
    noisy: bool,
    /// Whether effects vary along the way.
    varies: bool,
    /// Whether the robot moves sideways too: what it does depends on the piece then.
    slides: bool,
    way: Way,
    noise: Stream,
    /// Three normal draws for each pending piece of travel.
    draws: Vec<[f64; 3]>,
    /// The context for effects that do not vary along the path.
    anywhere: Context,
    rolls: Rolls,
    pieces: Pieces,
    /// Travel of the present stretch as the robot believes it.
    believed: WheelTravel,
    /// Way to the left of the present stretch as the robot believes it.
    left: f64,
    /// Travel that it was commanded to have, the same in every trial.
    commanded: WheelTravel,
    /// Upcoming bumps of the stretch, the nearest last.
    ahead: Vec<Bump>,
    done: f64,
    /// Number of runs, and way, that two trucks have driven in this session.
    trucks_run: f64,
    trucks_drove: f64,
    whole: Vec<(WheelTravel, Diffusion)>,
}

#[derive(Debug)]
struct RandomPart {
    effect: Law,
    changes: Changes,
    scatter: &'static RandomLaws,
    purpose: u64,
    values: Vec<f64>,
    stream: Stream,
}

/// Variance that the wheels of a robot with these parts accumulate over a true travel.
fn variance(parts: &[RandomPart], travel: &WheelTravel) -> WheelVariance {
    let diffusing = parts.iter().filter(|part| part.changes.include(Changes::DIFFUSION));
    diffusing.fold(WheelVariance::default(), |sum, part| {
        let v = (part.scatter.diffusion)(&part.values, travel);
        WheelVariance { left: sum.left + v.left, right: sum.right + v.right }
    })
}

/// Those of the parts that change this.
#[inline]
fn changing(parts: &mut [RandomPart], change: Changes) -> impl Iterator<Item = &mut RandomPart> {
    parts.iter_mut().filter(move |part| part.changes.include(change))
}

impl Truth {
    /// The effects of `model` with its own values, and no streams yet: [`open`](Truth::open) comes before any driving.
    pub fn new(model: &Model) -> Truth {
        let random = model
            .parts()
            .iter()
            .map(|part| RandomPart {
                effect: part.effect.clone(),
                changes: part.effect.changes(),
                scatter: part.effect.scatter(),
                purpose: part.effect.purpose(),
                values: part.values.clone(),
                stream: Stream::new(0, 0, 0),
            })
            .collect();
        let mut truth = Truth {
            drive: model.robot().drive,
            chain: model.chain(),
            random,
            rotation_per_metre: 0.0,
            noisy: false,
            varies: false,
            slides: model.robot().drive.kind().moves_sideways(),
            way: Way::new(model.robot(), model.reads_place()),
            noise: Stream::new(0, 0, 0),
            draws: Vec::new(),
            anywhere: Context::default(),
            rolls: Rolls::default(),
            pieces: Pieces::new(Instructions::best()),
            believed: WheelTravel::default(),
            left: 0.0,
            commanded: WheelTravel::default(),
            ahead: Vec::new(),
            done: 1.0,
            trucks_run: 0.0,
            trucks_drove: 0.0,
            whole: Vec::new(),
        };
        truth.refresh();
        truth
    }

    /// The same, with registers no wider than these: the same bits, maybe slower.
    pub fn limited_to(self, instructions: Instructions) -> Truth {
        Truth { pieces: Pieces::new(instructions), ..self }
    }

    /// Takes new values for all parameters, in the order of [`Model::values`].
    ///
    /// # Panics
    /// Where there are fewer values than parameters.
    pub fn set_values(&mut self, values: &[f64]) {
        self.chain.set_values(values);
        let mut rest = values;
        for part in &mut self.random {
            let own;
            (own, rest) = rest.split_at(part.values.len());
            part.values.copy_from_slice(own);
        }
        self.refresh();
    }

    fn refresh(&mut self) {
        self.whole.clear();
        self.rotation_per_metre =
            self.chain.body(&self.anywhere.as_believed(), &WheelTravel { left: -0.5, right: 0.5 }).rotation;
        let variance = variance(&self.random, &WheelTravel { left: 1.0, right: 1.0 });
        self.noisy = variance != WheelVariance::default();
        self.varies = self.random.iter().any(|part| part.effect.varies(&part.values));
        self.way.whole = !self.varies;
    }

    /// Whether stretches are driven piece by piece, each with its context.
    #[inline]
    fn in_pieces(&self) -> bool {
        self.varies || self.slides
    }

    /// Opens the random streams of a trial; its runs make one session.
    pub fn open(&mut self, seed: u64, trial: u64) {
        self.way.open();
        (self.trucks_run, self.trucks_drove) = (0.0, 0.0);
        self.noise = Stream::new(seed, WHEEL_NOISE, trial);
        for part in &mut self.random {
            part.stream = Stream::new(seed, part.purpose, trial);
        }
    }

    /// Places the robot at START, with the misplacement of the effects, for a run whose ticks are recorded.
    pub fn start(&mut self, direction: Direction) {
        self.forget();
        self.start_another(direction, true);
    }

    /// Forgets all runs.
    pub(super) fn forget(&mut self) {
        self.rolls.clear();
        self.pieces.clear();
    }

    /// The true pose at START of one more run.
    pub(super) fn draw_start(&mut self) -> Pose2 {
        changing(&mut self.random, Changes::START_SCATTER).fold(self.chain.start(), |pose, part| {
            pose.compose(&(part.scatter.start_scatter)(&part.values, &mut part.stream))
        })
    }

    /// The bumps that the front one of two trucks meets in a stretch.
    pub(super) fn bumps_of(&mut self, stretch: Stretch, leg: &Leg) -> Vec<Bump> {
        self.begin(stretch, leg);
        std::mem::take(&mut self.ahead)
    }

    /// True motion of one of two trucks, which is truly there, for a small believed travel, of which one wheel or both lose some at bumps; wheel noise
    /// included.
    #[inline]
    pub(super) fn rolled(
        &mut self,
        at: &Context,
        real: &Pose2,
        believed: &WheelTravel,
        lost: &WheelTravel,
    ) -> Displacement2 {
        let driven;
        let at = &if self.varies {
            let session_distance = self.trucks_drove + at.session_distance;
            driven = Context { run: self.trucks_run, session_distance, ..*at };
            driven.at_pose(real)
        } else {
            self.anywhere.as_believed()
        };
        let mut travel = self.chain.wheel_travel(at, believed);
        if self.noisy {
            let variance = variance(&self.random, &travel);
            travel.left += variance.left.sqrt() * self.noise.normal();
            travel.right += variance.right.sqrt() * self.noise.normal();
        }
        travel.left += lost.left;
        travel.right += lost.right;
        self.chain.body(at, &travel)
    }

    /// The reading of a link's encoders.
    #[inline]
    pub(super) fn link(&self, reading: LinkReading) -> LinkReading {
        self.chain.link(reading)
    }

    /// Two trucks have driven a run of this length.
    pub(super) fn end_of_trucks(&mut self, length: f64) {
        self.trucks_run += 1.0;
        self.trucks_drove += length;
    }

    /// A true pose as an absolute measurement at this moment shows it.
    pub(super) fn measured_of_trucks(&mut self, at: &Sight, pose: &Pose2) -> Pose2 {
        measured(&self.chain, &mut self.random, at, pose)
    }

    /// Begins one more run at START; the ends of earlier runs remain available.
    pub(super) fn start_another(&mut self, direction: Direction, recorded: bool) {
        let start = self.draw_start();
        if self.in_pieces() {
            // Room for the pieces of one run, not of all.
            self.pieces.settle(self.rotation_per_metre);
            self.way.start(direction, recorded, start);
        }
        self.make_pieces();
        self.pieces.start(start);
        self.done = 1.0;
    }

    /// Stands still \[s\], by its counts.
    pub fn rest(&mut self, duration: f64) {
        let at = self.way.rest(duration);
        self.move_on_at_rest(&at);
    }

    /// Stands still after a move until some time after START, by its counts.
    pub(super) fn rest_until(&mut self, clock: f64) {
        if let Some(at) = self.way.rest_until(clock).filter(|_| self.varies) {
            self.move_on_at_rest(&at);
        }
    }

    /// What moves the robot while its counters stand.
    fn move_on_at_rest(&mut self, at: &Context) {
        let motion = self.chain.displacement(&self.way.here(at), &WheelTravel::default());
        if self.varies && motion != Displacement2::NONE {
            self.way.advance(&motion);
            self.pieces.push(&Piece { motion, noise: Noise::None });
        }
    }

    /// Begins a stretch, commanded by a move of the course; its bumps are drawn now.
    pub fn begin(&mut self, stretch: Stretch, leg: &Leg) {
        if self.in_pieces() {
            self.rest_until(leg.begins);
            self.way.begin(leg, &stretch);
        }
        self.left = stretch.left;
        self.commanded = leg.travel;
        self.ahead.clear();
        for part in changing(&mut self.random, Changes::BUMPS) {
            (part.scatter.bumps)(&part.values, &stretch, &mut part.stream, &mut self.ahead);
        }
        self.ahead.sort_unstable_by(|a, b| b.at.total_cmp(&a.at));
        self.believed = stretch.travel;
        self.done = 0.0;
    }

    /// Adds an upcoming bump to the present stretch.
    pub fn place(&mut self, bump: Bump) {
        let behind = self.ahead.partition_point(|other| other.at >= bump.at);
        self.ahead.insert(behind, bump);
    }

    /// The direction in which the robot moves in the present stretch, from its heading \[rad\].
    pub(super) fn course(&self) -> f64 {
        course_angle(&self.believed, self.left)
    }

    /// Upcoming bumps of the stretch, the nearest last.
    pub(super) fn ahead(&self) -> &[Bump] {
        &self.ahead
    }

    /// Drives on until `share` of the stretch is done.
    pub fn advance(&mut self, share: f64) {
        while let Some(bump) = self.ahead.pop_if(|bump| bump.at < share) {
            self.roll(bump.at);
            self.meet(&bump);
        }
        self.roll(share);
    }

    fn roll(&mut self, share: f64) {
        let piece = share - self.done;
        if piece <= 0.0 {
            return;
        }
        self.done = share;
        if self.in_pieces() {
            return self.roll_in_pieces(share);
        }
        let whole = self.noisy && piece == 1.0;
        let kind = if whole { Roll::Whole(self.find_whole_diffusion()) } else { Roll::Part };
        self.rolls.push(self.believed.scaled(piece), kind);
    }

    /// Turns all pending travel into pieces of motion.
    fn make_pieces(&mut self) {
        self.rolls.work_out(&self.chain, &self.anywhere.as_believed());
        self.draws.resize(if self.noisy { self.rolls.stretches() } else { 0 }, [0.0; 3]);
        self.noise.normals(self.draws.as_flattened_mut());
        let mut draws = self.draws.iter();
        for (kind, travel, motion) in self.rolls.all() {
            let draws = if matches!(kind, Roll::Bump(_)) { None } else { draws.next() };
            let noise = match (kind, draws) {
                (Roll::Whole(known), Some(normals)) => Noise::Moves(self.whole[known].1.scatter(*normals)),
                (Roll::Part, Some(normals)) => {
                    Noise::Draws { variance: variance(&self.random, travel), normals: *normals }
                }
                _ => Noise::None,
            };
            self.pieces.push(&Piece { motion, noise });
        }
        self.rolls.clear();
    }

    /// Moves all runs to the end of their computed pieces.
    fn settle(&mut self) {
        self.make_pieces();
        self.pieces.settle(self.rotation_per_metre);
    }

    #[inline(never)]
    fn roll_in_pieces(&mut self, share: f64) {
        let (mut rolled, mut moved) = (WheelTravel { left: 0.0, right: 0.0 }, Displacement2::NONE);
        while let Some((at, believed)) = self.way.until(share) {
            let at = self.way.here(&at);
            let travel = self.chain.wheel_travel(&at, &believed);
            let motion = self.chain.body(&at, &travel);
            self.way.advance(&motion);
            self.pieces.push(&Piece { motion, noise: Noise::None });
            rolled = WheelTravel { left: rolled.left + travel.left, right: rolled.right + travel.right };
            moved = Displacement2 {
                forward: moved.forward + motion.forward,
                sideways: moved.sideways + motion.sideways,
                rotation: moved.rotation + motion.rotation,
            };
        }
        if self.noisy {
            // It is drawn in the frame of the beginning of the stretch, and applied in the frame of its end.
            let [x, y, turned] = if self.slides {
                self.scatter_across(&moved)
            } else {
                self.diffusion(&rolled, &moved).scatter(normals(&mut self.noise))
            };
            let (sine, cosine) = moved.rotation.sine_cosine();
            let moves = [cosine * x + sine * y, cosine * y - sine * x, turned];
            self.way.put(moves);
            self.pieces.push(&Piece { motion: Displacement2::NONE, noise: Noise::Moves(moves) });
        }
    }

    /// The noise of a stretch in which the robot may move sideways: that of an axle that stands across its course.
    fn scatter_across(&mut self, moved: &Displacement2) -> [f64; 3] {
        let along = self.drive.wheel_travel(moved.forward, moved.rotation);
        let travel = across(&along, moved.sideways);
        let way = 0.5 * (travel.left + travel.right);
        let motion = Displacement2 { forward: way, sideways: 0.0, rotation: moved.rotation };
        let [x, y, turned] = self.diffusion(&travel, &motion).scatter(normals(&mut self.noise));
        let [cosine, sine] = course(&along, moved.sideways).unwrap_or([1.0, 0.0]);
        [cosine * x - sine * y, sine * x + cosine * y, turned]
    }

    fn diffusion(&self, travel: &WheelTravel, motion: &Displacement2) -> Diffusion {
        Diffusion::new(motion, &variance(&self.random, travel), self.rotation_per_metre)
    }

    /// The noise of a whole stretch, computed for its commanded travel, which all stretches of a kind share; the driven travel differs by
    /// less than a tick or two.
    fn find_whole_diffusion(&mut self) -> usize {
        let commanded = self.commanded;
        self.whole.iter().position(|(travel, _)| *travel == commanded).unwrap_or_else(|| {
            let travel = self.chain.wheel_travel(&self.anywhere.as_believed(), &commanded);
            self.whole
                .push((commanded, self.diffusion(&travel, &self.chain.body(&self.anywhere.as_believed(), &travel))));
            self.whole.len() - 1
        })
    }

    fn meet(&mut self, bump: &Bump) {
        let travel = self.drive.bumped(bump.wheel, bump.lost);
        if !self.in_pieces() {
            return self.rolls.push(WheelTravel::default(), Roll::Bump(travel));
        }
        let motion = if self.slides {
            self.bump_across(&travel)
        } else {
            self.chain.body(&self.way.here(&self.way.moment()), &travel)
        };
        self.way.advance(&motion);
        self.pieces.push(&Piece { motion, noise: Noise::None });
    }

    /// What an axle that stands across the course loses at a bump.
    fn bump_across(&self, lost: &WheelTravel) -> Displacement2 {
        let [cosine, sine] = course(&self.believed, self.left).unwrap_or([1.0, 0.0]);
        let Displacement2 { forward, rotation, .. } = self.drive.displacement(lost);
        let aside = Aside { way: sine * forward, ..Aside::NONE };
        let travel = self.drive.wheel_travel(cosine * forward, rotation);
        self.chain.body(&self.way.here(&Context { aside, ..self.way.moment() }), &travel)
    }

    /// The true pose.
    pub fn pose(&mut self) -> Pose2 {
        self.settle();
        self.pieces.reached().last().unwrap_or_default()
    }

    /// Absolute measurements of the true poses, each given by the time since the run began \[s\].
    pub fn measure(&mut self, at: &Sight, shown: impl Fn(f64) -> Pose2) -> Pose2 {
        let late = self.chain.late(at.time);
        let pose = filtered(self.chain.filter(), &shown, at.time - late);
        measured(&self.chain, &mut self.random, &Sight { late, ..*at }, &pose)
    }

    /// The ends of all runs as absolute measurements at this moment of each show them, in the order in which they were begun.
    pub(super) fn measure_all(&mut self, at: Sight) -> impl Iterator<Item = Pose2> + '_ {
        self.settle();
        let Truth { pieces, random, chain, .. } = self;
        pieces.reached().map(move |pose| measured(chain, random, &at, &pose))
    }
}

/// The true pose at a time as it leaves a filter: the mean of all poses before, by the midpoints of steps.
fn filtered(filter: Option<Filter>, shown: impl Fn(f64) -> Pose2, time: f64) -> Pose2 {
    let now = shown(time);
    let Some(Filter { share, time_constant }) = filter.filter(|filter| filter.share != 0.0) else { return now };
    let step = FILTERED / f64::from(STEPS);
    let (mut lag, mut weights) = ([0.0; 3], 0.0);
    for k in 0..STEPS {
        let age = (f64::from(k) + 0.5) * step;
        let (weight, then) = (libm::exp(-age), shown(time - age * time_constant));
        weights += weight;
        for (lag, way) in lag.iter_mut().zip([now.x - then.x, now.y - then.y, now.heading - then.heading]) {
            *lag += weight * way;
        }
    }
    let [x, y, heading] = lag.map(|lag| share * lag / weights);
    Pose2 { x: now.x - x, y: now.y - y, heading: now.heading - heading }
}

/// A true pose as an absolute measurement at this moment shows it.
fn measured(chain: &Chain<f64>, random: &mut [RandomPart], at: &Sight, pose: &Pose2) -> Pose2 {
    let mut seen = chain.seen(at, pose);
    for part in changing(random, Changes::MEASURED) {
        (part.scatter.measured)(&part.values, &mut part.stream, &mut seen);
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::{Formula, Target, TestKind};
    use crate::path::Path;
    use crate::simulate::{Odometry, Phase, Simulator};

    #[test]
    fn the_place_that_formulas_see_is_the_true_one_through_bumps_and_noise_in_every_run_of_a_session() {
        let mut model = Model::new(&Robot::labmate());
        let formula = Formula::new("own", Target::HeadingPerMetre, "k * x + q * y", &["k", "q"]).unwrap();
        model.add_formula(formula, &[1e-2, -2e-2]).unwrap();
        for (effect, parameter, value) in [
            ("crab", "angle_rad", 0.01),
            ("wheel_noise", "k_sqrt_m", 2e-3),
            ("placed_bumps", "count", 10.0),
            ("start_pose", "position_sd_m", 0.3),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        let path = Path::umbmark();
        let mut simulator = Simulator::new(&Robot::labmate(), &path, Odometry::Continuous, Phase::Random).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, 7, 0);
        for direction in [Direction::Ccw, Direction::Ccw, Direction::Cw] {
            simulator.run(&mut truth, direction, TestKind::Bumps);
            let moment = truth.way.moment();
            let (seen, real) = (truth.way.here(&moment).pose(), truth.pose());
            assert!(libm::hypot(real.x, real.y) > 0.01, "it errs: {real:?}");
            for (seen, real) in [(seen.x, real.x), (seen.y, real.y), (seen.heading, real.heading)] {
                assert!((seen - real).abs() < 1e-11, "{seen} {real}");
            }
        }
    }
}
