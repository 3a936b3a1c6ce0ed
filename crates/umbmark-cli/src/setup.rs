//! What is to be simulated: robot, path and effects, from files and flags.

use std::path::PathBuf;

use umbmark_core::dataset::{read_model, read_robot};
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::Draw;
use umbmark_core::path::Path;
use umbmark_core::replay::check_on_path;

use crate::effect_flags::EffectFlags;
use crate::robot_flags::RobotFlags;

/// The directions of a test.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
pub enum Directions {
    /// Both: UMBmark
    Both,
    /// Clockwise only: a uni-directional test
    Cw,
    /// Counter-clockwise only
    Ccw,
}

impl Directions {
    /// Numbers of runs \[cw, ccw\] of a test with `runs` in each of its directions.
    pub fn runs(self, runs: usize) -> [usize; 2] {
        match self {
            Directions::Both => [runs, runs],
            Directions::Cw => [runs, 0],
            Directions::Ccw => [0, runs],
        }
    }
}

/// The wheel noise \[m^0.5\] where nothing is said of noise: it gives about the paper's scatter.
const ASSUMED_WHEEL_NOISE: f64 = 1e-3;

/// The flags of every verb that simulates. A flag overrides what stands in a file.
#[derive(Debug, clap::Args)]
pub struct SetupFlags {
    /// The robot and its path, instead of the paper's LabMate on a 4 x 4 m square
    #[arg(long, value_name = "robot.toml")]
    robot: Option<PathBuf>,

    /// Effects with their values or distributions
    #[arg(long, value_name = "model.toml")]
    model: Option<PathBuf>,

    /// Directions to drive in; a uni-directional test can hide two errors that cancel
    #[arg(long, value_enum, default_value_t = Directions::Both, value_name = "WHICH")]
    pub direction: Directions,

    #[command(flatten)]
    robot_flags: RobotFlags,

    #[command(flatten)]
    effects: EffectFlags,
}

/// A resolved choice.
#[derive(Debug)]
pub struct Setup {
    /// The path.
    pub path: Path,
    /// The nominal robot and the effects at work.
    pub model: Model,
    /// Parameters that differ from trial to trial.
    pub draws: Vec<Draw>,
    /// What nobody said and was assumed, a phrase each.
    pub assumed: Vec<String>,
}

impl SetupFlags {
    /// The same over a path and a model that are known from measurements; the robot is theirs.
    pub fn over(&self, path: Path, mut model: Model) -> anyhow::Result<Setup> {
        anyhow::ensure!(
            self.robot.is_none()
                && self.model.is_none()
                && self.robot_flags.robot(model.robot().clone())? == *model.robot(),
            "the robot is that of the data; leave --robot, --model and the flags of the robot out"
        );
        let path = self.robot_flags.path(path)?;
        let mut draws = Vec::new();
        self.effects.apply(&mut model, &mut draws)?;
        check_on_path(&model, &path)?;
        Ok(Setup { path, model, draws, assumed: Vec::new() })
    }

    /// Reads the files and lets the flags override them.
    pub fn resolve(&self) -> anyhow::Result<Setup> {
        let (robot, path) = match &self.robot {
            Some(file) => {
                let (robot, path) = read_robot(file)?;
                (robot, path.unwrap_or_else(Path::umbmark))
            }
            None => (Robot::labmate(), Path::umbmark()),
        };
        let robot = self.robot_flags.robot(robot)?;
        let path = self.robot_flags.path(path)?;
        let (mut model, mut draws) = match &self.model {
            Some(file) => read_model(file, &robot)?,
            None => (Model::new(&robot), Vec::new()),
        };
        let mut assumed = Vec::new();
        if self.robot.is_none() && self.robot_flags.leaves_assumptions() {
            assumed.push("wheel diameter 0.150 m and 2000 ticks per revolution where not given".to_owned());
        }
        if self.model.is_none() && self.robot.is_none() && !self.effects.mentions("wheel_noise") {
            model.set("wheel_noise", "k_sqrt_m", ASSUMED_WHEEL_NOISE)?;
            assumed.push(format!("wheel noise k = {ASSUMED_WHEEL_NOISE} m^0.5 (--wheel-noise 0 for none)"));
        }
        self.effects.apply(&mut model, &mut draws)?;
        check_on_path(&model, &path)?;
        if model.get("wheel_noise", "k_sqrt_m").is_none() {
            assumed.push("no wheel noise (--wheel-noise 0.001 gives about the paper's scatter)".to_owned());
        }
        Ok(Setup { path, model, draws, assumed })
    }
}
