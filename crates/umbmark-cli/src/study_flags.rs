//! The flags of every verb that simulates whole tests by the thousand.

use umbmark_core::engine::Update;
use umbmark_core::monte_carlo::Study;
use umbmark_core::preset::Published;
use umbmark_core::simulate::{Odometry, Phase};

use crate::setup::{Setup, SetupFlags};

/// How the robot computes its pose.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum OdometryKind {
    /// At the encoder rate if there is one, else at every tick
    Robot,
    /// At every tick
    Ticks,
    /// At every tick, one by one: the slow reference
    TickByTick,
    /// From the wheel angles themselves, without quantisation
    Continuous,
}

/// The update of sampled odometry.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum UpdateKind {
    /// Exact circular arc
    Arc,
    /// Straight step at the mean heading
    Midpoint,
    /// Straight step at the old heading
    Euler,
}

/// Where the wheels rest within a tick.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum PhaseKind {
    /// Anywhere
    Random,
    /// On the edge of a tick
    Edge,
}

/// What a report says of a study beside its numbers.
#[derive(Debug)]
pub struct Known {
    /// Where its numbers come from.
    pub sources: Vec<String>,
    /// What was assumed.
    pub assumed: Vec<String>,
    /// What was published of such a robot.
    pub published: Option<Published>,
}

/// What was said of the tests.
#[derive(Debug, clap::Args)]
pub struct StudyFlags {
    /// Runs in each direction
    #[arg(long, default_value_t = 5, value_name = "N")]
    runs: usize,

    /// How the robot computes its pose
    #[arg(long, value_enum, default_value_t = OdometryKind::Robot, value_name = "KIND")]
    odometry: OdometryKind,

    /// How sampled odometry follows the counts
    #[arg(long, value_enum, default_value_t = UpdateKind::Arc, value_name = "RULE")]
    update: UpdateKind,

    /// Where within a tick the wheels come to rest
    #[arg(long, value_enum, default_value_t = PhaseKind::Random, value_name = "WHERE")]
    phase: PhaseKind,

    #[command(flatten)]
    setup: SetupFlags,
}

impl StudyFlags {
    /// The study of so many trials, and what is to be said of it beside its numbers.
    pub fn resolve(&self, trials: u64, seed: u64) -> anyhow::Result<(Study, Known)> {
        let Setup { path, model, draws, sources, assumed, published } = self.setup.resolve()?;
        let robot = model.robot();
        let update = match self.update {
            UpdateKind::Arc => Update::Arc,
            UpdateKind::Midpoint => Update::Midpoint,
            UpdateKind::Euler => Update::Euler,
        };
        let odometry = match (self.odometry, robot.encoder.rate()) {
            (OdometryKind::Robot, Some(rate)) => Odometry::Sampled { rate, update },
            (OdometryKind::Robot, None) | (OdometryKind::Ticks, _) => Odometry::EveryTick,
            (OdometryKind::TickByTick, _) => Odometry::EveryTickOneByOne,
            (OdometryKind::Continuous, _) => Odometry::Continuous,
        };
        let phase = match self.phase {
            PhaseKind::Random => Phase::Random,
            PhaseKind::Edge => Phase::Edge,
        };
        let runs = self.setup.direction.runs(self.runs);
        let study = Study { draws, odometry, path, phase, runs, ..Study::new(model, trials, seed) };
        Ok((study, Known { sources, assumed, published }))
    }
}
