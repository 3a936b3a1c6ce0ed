//! Models as files of other programs: what a robot needs in order to be right, one target a file.
//!
//! A target writes what it can hold. What it cannot hold, for example the slope of a floor, is said in the file and beside it, so
//! that nobody believes that it is corrected.

mod covariance;
mod text;

pub use urdf::UrdfFile;

use super::{Remedy, RobotFile, Words};
use std::fmt;
use umbmark_core::apply::CompileError;
use umbmark_core::drive::{Drive, DriveError, Robot};
use umbmark_core::effect::{Changes, Model, ModelError, Part};
use umbmark_core::geometry::Pose2;
use umbmark_core::likelihood::Noise;
use umbmark_core::parameter::Parameter;
use umbmark_core::{register, remedy};

register! {
    /// Every target there is.
    pub TARGETS: Target = TARGET in
    ros2_control,
    amcl,
    robot_localization,
    toml,
    c,
    urdf,
    gazebo,
    mujoco,
    embedded,
    embedded_rust,
}

/// A program, or a kind of file, for which numbers of a model are written.
#[derive(Debug)]
pub struct Target {
    /// What it is called.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Whether it holds every effect of a model, and not the numbers of the robot alone.
    pub holds_all: bool,
    write: fn(&Export) -> Result<Written, ExportError>,
}

impl Target {
    /// The target of a name.
    pub fn named(name: &str) -> Option<&'static Target> {
        TARGETS.iter().find(|target| target.name == name).copied()
    }

    /// Writes a model as a file of this target.
    ///
    /// ```
    /// use umbmark_core::{drive::Robot, effect::Model};
    /// use umbmark_io::export::{Export, Target};
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheelbase", "e_b", 0.99)?;
    /// let yaml = Target::named("ros2_control").unwrap().write(&Export::of(&model))?.text;
    /// assert!(yaml.contains("    wheel_separation_multiplier: 0.99\n    left_wheel_radius_multiplier: 1.0\n"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Where the target cannot have such a robot, or needs something that is missing.
    pub fn write(&self, export: &Export) -> Result<Written, ExportError> {
        export.model.check_drive()?;
        (self.write)(export)
    }
}

/// A file as text, and what has to be said of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// What the file does not hold, a sentence each; it stands in the file too, where comments may be added.
    pub notes: Vec<String>,
}

/// What keeps a file from being written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A drive that the target cannot have.
    #[error("{target} has no {drive} drive; {remedy}")]
    Drive {
        /// Name of the target.
        target: &'static str,
        /// Kind of the drive.
        drive: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// Something that the target cannot do without.
    #[error("{target}: {what}")]
    Missing {
        /// Name of the target.
        target: &'static str,
        /// What is missing, and what to do.
        what: &'static str,
    },
    /// A file to be edited that cannot be read.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// A file to be edited that is not as it should be.
    #[error("{file}:{line}: {problem}{}", after(remedy.as_ref(), &Words::PLAIN))]
    File {
        /// The file.
        file: String,
        /// Its line.
        line: u32,
        /// What is wrong.
        problem: String,
        /// What to do, where the problem does not say it.
        remedy: Option<Remedy>,
    },
    /// No file to be edited.
    #[error("{target}: the file to edit is missing{}", after(Some(remedy), &Words::PLAIN))]
    NoFile {
        /// Name of the target.
        target: &'static str,
        /// What to do.
        remedy: Remedy,
    },
    /// A correction that leaves no possible robot.
    #[error("the model belongs to no possible robot ({0}); are signs, units and directions right?")]
    Impossible(#[from] DriveError),
    /// An effect that the drive cannot have.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model that the library on the robot cannot hold.
    #[error("embedded: {0}")]
    Compile(#[from] CompileError),
}

impl ExportError {
    /// In the words of an edge.
    pub fn worded(&self, words: &Words) -> String {
        match self {
            ExportError::File { file, line, problem, remedy } => {
                format!("{file}:{line}: {problem}{}", after(remedy.as_ref(), words))
            }
            ExportError::NoFile { target, remedy } => {
                format!("{target}: the file to edit is missing{}", after(Some(remedy), words))
            }
            ExportError::Model(error) => format!("{self}{}", words.behind(remedy::of(error))),
            ExportError::Compile(error) => format!("{self}{}", words.behind(remedy::of(error))),
            other => other.to_string(),
        }
    }
}

/// A remedy behind what is wrong.
fn after(remedy: Option<&Remedy>, words: &Words) -> String {
    remedy.map_or_else(String::new, |remedy| format!("; {}", remedy.worded(words)))
}

/// A model to be written, and how.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// The model with its nominal robot.
    pub model: &'a Model,
    /// Sizes of what is random, where they were fitted.
    pub noise: Option<Noise>,
    /// Name of the controller in parameters of ros2_control; that of its type where none is given.
    pub controller: Option<String>,
    /// What a robot.toml says besides the robot.
    pub beside: Option<RobotFile>,
    /// The user's own description of the robot, to be edited.
    pub urdf: Option<UrdfFile>,
    /// Where the robot stands at its first reading, for a table that computes poses.
    pub start: Pose2,
    /// How the robot is usually driven: constant covariances are those of this motion.
    pub usual: Usual,
}

/// The motion for which a covariance that has to be constant is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usual {
    /// Speed of the axle's centre \[m/s\].
    pub speed: f64,
    /// Turn rate, either way \[rad/s\].
    pub turn_rate: f64,
    /// How often odometry is published \[Hz\].
    pub rate: f64,
}

impl Usual {
    /// Its numbers: flags, keys, bounds and defaults.
    pub const PARAMETERS: [Parameter; 3] = [
        Parameter::shape(
            "speed_m_s",
            "speed",
            "m/s",
            0.2,
            (1e-3, 100.0),
            "usual speed, for which a constant covariance is computed",
        ),
        Parameter::shape(
            "turn_rate_rad_s",
            "turn-rate",
            "rad/s",
            0.5,
            (0.0, 100.0),
            "usual turn rate, for which a constant covariance is computed",
        ),
        Parameter::shape("rate_hz", "rate", "Hz", 50.0, (0.1, 1e5), "rate at which the robot publishes its odometry"),
    ];
}

impl Default for Usual {
    fn default() -> Usual {
        let [speed, turn_rate, rate] = Usual::PARAMETERS.map(|parameter| parameter.typical);
        Usual { speed, turn_rate, rate }
    }
}

impl<'a> Export<'a> {
    /// A model without noise, as it is usually written.
    pub fn of(model: &'a Model) -> Export<'a> {
        Export {
            model,
            noise: None,
            controller: None,
            beside: None,
            urdf: None,
            start: Pose2::IDENTITY,
            usual: Usual::default(),
        }
    }

    /// The nominal robot.
    fn robot(&self) -> &'a Robot {
        self.model.robot()
    }

    /// The robot with the numbers that its odometry should have.
    fn corrected(&self) -> Result<Robot, ExportError> {
        Ok(self.model.corrected_robot()?)
    }

    /// The error of a drive that a target cannot have.
    fn no_drive(&self, target: &'static str) -> ExportError {
        let remedy = "toml and c hold the numbers of every drive";
        ExportError::Drive { target, drive: self.robot().drive.kind().name(), remedy }
    }

    /// Effects of the model that its corrected numbers do not undo, a sentence each.
    fn uncorrected(&self) -> Vec<String> {
        let drive: &Drive = &self.robot().drive;
        let corrected = |name: &str| drive.own_effects().contains(&name);
        let said = |part: &&Part| moves(part, self.robot()) && !corrected(part.effect.name());
        self.model.parts().iter().filter(said).map(not_corrected).collect()
    }

    /// What every file says first: what wrote it, and which errors are corrected in it.
    fn heading(&self) -> String {
        let kind = self.robot().drive.kind();
        let names = self.robot().drive.own_effects();
        let values = self.model.own_values();
        let ratio = |name: &str| if kind.has_axle_wheels() { letters(name) } else { name.to_owned() };
        let values: Vec<String> =
            names.iter().zip(values).map(|(name, value)| format!("{} {}", ratio(name), text::number(value))).collect();
        format!("umbmark {}: {}", umbmark_core::VERSION, values.join(", "))
    }
}

/// The letters of the paper.
fn letters(effect: &str) -> String {
    match effect {
        "wheel_diameter_ratio" => "E_d",
        "wheelbase" => "E_b",
        "scale" => "E_s",
        other => other,
    }
    .to_owned()
}

/// Whether a part makes the robot move otherwise than its odometry believes, at its present values.
fn moves(part: &Part, robot: &Robot) -> bool {
    let Some(entry) = part.effect.entry() else { return true };
    let at_rest = part.effect.parameters().iter().map(|parameter| parameter.default.resolve(robot));
    entry.changes.include(Changes::WHEELS.and(Changes::BODY).and(Changes::LINK))
        && !at_rest.eq(part.values.iter().copied())
}

fn not_corrected(part: &Part) -> String {
    let name = part.effect.name();
    let what = part.effect.entry().map_or("a law that is in no catalogue", |entry| entry.about.title);
    format!("not corrected by this file: {name} ({what})")
}

/// How a language marks a comment.
#[derive(Clone, Copy, Debug)]
enum Comment {
    Hash,
    C,
    Xml,
}

impl Comment {
    /// Sentences as comments, a line each.
    fn lines<S: fmt::Display>(self, said: impl IntoIterator<Item = S>) -> String {
        said.into_iter().map(|sentence| self.line(&sentence.to_string())).collect()
    }

    fn line(self, said: &str) -> String {
        match self {
            Comment::Hash => format!("# {said}\n"),
            Comment::C => format!("/* {} */\n", said.replace("*/", "* /")),
            Comment::Xml => format!("<!-- {} -->\n", said.replace("--", "- -")),
        }
    }
}

#[cfg(test)]
mod tests;
