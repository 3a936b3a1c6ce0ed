//! The true motion of a robot whose odometry believes something else.

use super::diffusion::Diffusion;
use crate::drive::{Wheel, WheelTravel};
use crate::effect::{Bump, Chain, Context, Entry, Model, Stretch, WheelVariance};
use crate::engine::Motion;
use crate::geometry::{Displacement2, Pose2};
use crate::random::Stream;

/// Purpose of the stream that wheel noise is drawn from; no hash of a name gives so small a number.
const WHEEL_NOISE: u64 = 2;

/// The effects of a model at work in one trial: deterministic chain, random parts with their streams, true pose.
#[derive(Debug)]
pub struct Truth {
    chain: Chain<f64>,
    random: Vec<RandomPart>,
    rotation_per_metre: f64,
    noisy: bool,
    noise: Stream,
    pose: Motion,
    stretch: Option<Stretch>,
    /// Travel that the stretch was commanded to have, the same in every trial.
    commanded: WheelTravel,
    /// Bumps of the stretch that lie ahead, the nearest last.
    ahead: Vec<Bump>,
    done: f64,
    whole: Vec<(WheelTravel, Diffusion)>,
}

#[derive(Debug)]
struct RandomPart {
    effect: &'static Entry,
    values: Vec<f64>,
    stream: Stream,
}

impl Truth {
    /// The effects of `model` with its own values, and no streams yet: [`open`](Truth::open) comes before any driving.
    pub fn new(model: &Model) -> Truth {
        let random = model
            .parts()
            .iter()
            .map(|part| RandomPart { effect: part.effect, values: part.values.clone(), stream: Stream::new(0, 0, 0) })
            .collect();
        let mut truth = Truth {
            chain: model.chain(),
            random,
            rotation_per_metre: 0.0,
            noisy: false,
            noise: Stream::new(0, 0, 0),
            pose: Motion::IDENTITY,
            stretch: None,
            commanded: WheelTravel::default(),
            ahead: Vec::new(),
            done: 0.0,
            whole: Vec::new(),
        };
        truth.refresh();
        truth
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
            self.chain.body(&Context::default(), &WheelTravel { left: -0.5, right: 0.5 }).rotation;
        let variance = self.variance(&WheelTravel { left: 1.0, right: 1.0 });
        self.noisy = variance != WheelVariance::default();
    }

    fn variance(&self, travel: &WheelTravel) -> WheelVariance {
        self.random.iter().fold(WheelVariance::default(), |sum, part| {
            let v = (part.effect.scatter.diffusion)(&part.values, travel);
            WheelVariance { left: sum.left + v.left, right: sum.right + v.right }
        })
    }

    /// Opens the random streams of a trial.
    pub fn open(&mut self, seed: u64, trial: u64) {
        self.noise = Stream::new(seed, WHEEL_NOISE, trial);
        for part in &mut self.random {
            part.stream = Stream::new(seed, part.effect.purpose(), trial);
        }
    }

    /// Puts the robot at START, as far as the effects let it stand there.
    pub fn start(&mut self) {
        let start = self.random.iter_mut().fold(self.chain.start(), |pose, part| {
            pose.compose(&(part.effect.scatter.start_scatter)(&part.values, &mut part.stream))
        });
        self.pose = Motion::from(start);
        self.stretch = None;
    }

    /// Begins a stretch that was commanded to have a certain travel; what it meets on the way is drawn now.
    pub fn begin(&mut self, stretch: Stretch, commanded: WheelTravel) {
        self.commanded = commanded;
        self.ahead.clear();
        for part in &mut self.random {
            (part.effect.scatter.bumps)(&part.values, &stretch, &mut part.stream, &mut self.ahead);
        }
        self.ahead.sort_unstable_by(|a, b| b.at.total_cmp(&a.at));
        self.stretch = Some(stretch);
        self.done = 0.0;
    }

    /// Puts one more bump ahead of the robot in the present stretch.
    pub fn place(&mut self, bump: Bump) {
        let behind = self.ahead.partition_point(|other| other.at >= bump.at);
        self.ahead.insert(behind, bump);
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
        let Some(stretch) = self.stretch else { return };
        let piece = share - self.done;
        if piece <= 0.0 {
            return;
        }
        let whole = piece == 1.0;
        let travel = self.chain.wheel_travel(&Context::default(), &stretch.travel.scaled(piece));
        let motion = self.chain.body(&Context::default(), &travel);
        let from = self.pose;
        self.pose = from.then(&Motion::exp(&motion));
        if self.noisy {
            let diffusion = if whole { self.whole_diffusion() } else { self.diffusion(&travel, &motion) };
            let [dx, dy, turned] = diffusion.draw(&mut self.noise);
            // Moved in the frame of the start, turned about the end.
            self.pose.pose.x += from.cosine * dx - from.sine * dy;
            self.pose.pose.y += from.sine * dx + from.cosine * dy;
            self.pose = self.pose.then(&Motion::from(Pose2::new(0.0, 0.0, turned)));
        }
        self.done = share;
    }

    fn diffusion(&self, travel: &WheelTravel, motion: &Displacement2) -> Diffusion {
        Diffusion::new(motion, &self.variance(travel), self.rotation_per_metre)
    }

    /// The noise of a whole stretch, taken for its commanded travel: the driven one differs by less than a tick or two,
    /// and all stretches of one kind share it.
    fn whole_diffusion(&mut self) -> Diffusion {
        let commanded = self.commanded;
        if let Some((_, known)) = self.whole.iter().find(|(travel, _)| *travel == commanded) {
            return *known;
        }
        let travel = self.chain.wheel_travel(&Context::default(), &commanded);
        let diffusion = self.diffusion(&travel, &self.chain.body(&Context::default(), &travel));
        self.whole.push((commanded, diffusion));
        diffusion
    }

    fn meet(&mut self, bump: &Bump) {
        let travel = match bump.wheel {
            Wheel::Left => WheelTravel { left: -bump.lost, right: 0.0 },
            Wheel::Right => WheelTravel { left: 0.0, right: -bump.lost },
        };
        self.pose = self.pose.then(&Motion::exp(&self.chain.body(&Context::default(), &travel)));
    }

    /// The true pose.
    pub fn pose(&self) -> Pose2 {
        self.pose.pose
    }

    /// The true pose as the absolute measurement shows it.
    pub fn measure(&mut self) -> Pose2 {
        let mut pose = self.pose.pose;
        for part in &mut self.random {
            (part.effect.scatter.measured)(&part.values, &mut part.stream, &mut pose);
        }
        pose
    }
}
