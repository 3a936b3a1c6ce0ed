//! What is to be simulated: robot, path and effects, from files and flags.

use std::path::{Path as FilePath, PathBuf};

use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::Draw;
use umbmark_core::path::Path;
use umbmark_core::preset::{PRESETS, Preset, Published};
use umbmark_core::replay::check_on_path;
use umbmark_io::{ModelFile, RobotFile};

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
    /// The robot and its path, instead of the paper's LabMate on a 4 x 4 m square: a file, or one of the paper's by name,
    /// with its errors and noise
    #[arg(long, value_name = "robot.toml | NAME", long_help = robots())]
    robot: Option<String>,

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

/// The help of `--robot`.
fn robots() -> String {
    let row = |preset: &Preset| format!("\n  {:<24} Table I, row {}", preset.name, preset.published.row);
    let rows: String = PRESETS.iter().map(row).collect();
    format!(
        "The robot and its path, instead of the paper's LabMate on a 4 x 4 m square: a file, or one of the paper's robots with \
         its errors and noise:{rows}"
    )
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
    /// What was taken from the paper, a phrase each.
    pub sources: Vec<String>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// What the paper measured of this robot.
    pub published: Option<Published>,
}

/// Where the robot is from.
enum Origin {
    Default,
    File,
    Preset(&'static Preset),
}

impl SetupFlags {
    /// The same over a path and a model that are known from measurements; the robot is theirs.
    pub fn over(&self, path: Path, mut model: Model) -> anyhow::Result<Setup> {
        anyhow::ensure!(
            self.robot.is_none()
                && self.model.is_none()
                && self.robot_flags.robot(model.robot().clone())? == *model.robot(),
            "the robot is that of the data; remove --robot, --model and the flags of the robot"
        );
        let path = self.robot_flags.path(path)?;
        let mut draws = Vec::new();
        self.effects.apply(&mut model, &mut draws)?;
        check_on_path(&model, &path)?;
        Ok(Setup { path, model, draws, sources: Vec::new(), assumed: Vec::new(), published: None })
    }

    /// Reads the files and lets the flags override them.
    pub fn resolve(&self) -> anyhow::Result<Setup> {
        let (robot, path, origin) = self.robot()?;
        let robot = self.robot_flags.robot(robot)?;
        let path = self.robot_flags.path(path)?;
        let (mut sources, mut assumed) = (Vec::new(), Vec::new());
        let (mut model, mut draws) = match (&self.model, &origin) {
            (Some(file), _) => {
                let read = ModelFile::read(file, Some(&robot))?;
                assumed.extend(read.conversion.map(|conversion| format!("{} {conversion}", file.display())));
                (read.model, read.draws)
            }
            (None, Origin::Preset(preset)) => (preset.model()?.of(&robot), Vec::new()),
            (None, _) => (Model::new(&robot), Vec::new()),
        };
        match origin {
            Origin::Default => {
                if self.robot_flags.leaves_assumptions() {
                    assumed.push("wheel diameter 0.150 m and 2000 ticks per revolution where not given".to_owned());
                }
                if self.model.is_none() && !self.effects.mentions("wheel_noise") {
                    model.set("wheel_noise", "k_sqrt_m", ASSUMED_WHEEL_NOISE)?;
                    assumed.push(format!("wheel noise k = {ASSUMED_WHEEL_NOISE} m^0.5 (--wheel-noise 0 for none)"));
                }
            }
            Origin::Preset(preset) => {
                sources.extend(preset.sources.iter().map(|text| (*text).to_owned()));
                assumed.extend(preset.assumed.iter().map(|text| (*text).to_owned()));
            }
            Origin::File => {}
        }
        self.effects.apply(&mut model, &mut draws)?;
        model.check_drive()?;
        check_on_path(&model, &path)?;
        if model.get("wheel_noise", "k_sqrt_m").is_none() {
            assumed.push("no wheel noise (--wheel-noise 0.001 gives about the paper's scatter)".to_owned());
        }
        let published = if let Origin::Preset(preset) = origin { Some(preset.published) } else { None };
        Ok(Setup { path, model, draws, sources, assumed, published })
    }

    fn robot(&self) -> anyhow::Result<(Robot, Path, Origin)> {
        let Some(name) = &self.robot else {
            let model = self.model.as_ref().map(|file| ModelFile::read(file, None)).transpose()?;
            let robot = model.map_or_else(Robot::labmate, |file| file.model.robot().clone());
            let origin = if robot == Robot::labmate() { Origin::Default } else { Origin::File };
            return Ok((robot, Path::umbmark(), origin));
        };
        let near = match Preset::find(name) {
            Ok(preset) => return Ok((preset.robot(), preset.path(), Origin::Preset(preset))),
            Err(near) => near,
        };
        let file = FilePath::new(name);
        let looks_like_a_file = file.extension().is_some() || file.components().count() > 1;
        if !looks_like_a_file && !file.exists() {
            let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
            let near = near.map(|near| format!("; did you mean \"{near}\"?")).unwrap_or_default();
            anyhow::bail!("there is no robot \"{name}\"{near}\n  give a robot.toml, or one of {}", names.join(", "));
        }
        let RobotFile { robot, path, .. } = RobotFile::read(file)?;
        Ok((robot, path.unwrap_or_else(Path::umbmark), Origin::File))
    }
}
