//! Flags for the nominal robot, the path and the speed: the paper's LabMate on its square where nothing is said.

use anyhow::Context;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use umbmark_core::drive::{DifferentialDrive, Encoder, Robot};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{Path, SHAPES, SpeedProfile, WAYPOINTS};

use crate::effect_flags::{number_flag, number_of};
use crate::numbers::number;

/// What was said of robot and path on the command line.
#[derive(Clone, Debug, Default)]
pub struct RobotFlags {
    /// Numbers of the robot, with their descriptions; `None` for an encoder that is looked at at every tick.
    numbers: Vec<(&'static Parameter, Option<f64>)>,
    shape: Option<String>,
    sizes: Vec<(&'static str, f64)>,
    speed: [Option<f64>; 3],
}

/// Numbers of the LabMate that the paper does not give.
const ASSUMED: [Parameter; 2] = [DifferentialDrive::WHEEL_DIAMETER, Encoder::TICKS];

/// The numbers of all shapes, those that share a flag only once.
fn sizes() -> Vec<&'static Parameter> {
    let mut sizes: Vec<&'static Parameter> = Vec::new();
    for parameter in SHAPES.iter().flat_map(|shape| shape.parameters) {
        if sizes.iter().all(|known| known.flag != parameter.flag) {
            sizes.push(parameter);
        }
    }
    sizes
}

fn size_flag(parameter: &'static Parameter) -> Arg {
    let users: Vec<&str> = SHAPES
        .iter()
        .filter(|shape| shape.parameters.iter().any(|p| p.flag == parameter.flag))
        .map(|shape| shape.name)
        .collect();
    let meaning = if users.len() == 1 { parameter.meaning } else { "size" };
    number_flag(parameter).help(format!("{meaning}, of {}", users.join(", "))).help_heading("Path")
}

fn encoder_rate(text: &str) -> Result<Option<f64>, String> {
    if text == "every tick" || text == "every-tick" {
        return Ok(None);
    }
    number(text).map(Some).map_err(|why| format!("{why}; give a rate in Hz or \"every tick\""))
}

impl Args for RobotFlags {
    fn augment_args(command: Command) -> Command {
        let robot = |command: Command, p: &'static Parameter| {
            let arg = number_flag(p).help_heading("Robot");
            if p.name == Encoder::RATE.name {
                let help = format!("{}, or \"every tick\" [default: every tick]", p.meaning);
                return command.arg(arg.value_parser(encoder_rate).help(help));
            }
            let assumed = ASSUMED.iter().any(|assumed| assumed.name == p.name);
            let source = if assumed { "assumed" } else { "the paper's LabMate" };
            command.arg(arg.help(format!("{} [default: {}, {source}]", p.meaning, p.typical)))
        };
        let command = Robot::NUMBERS.iter().fold(command, robot).arg(
            Arg::new("shape")
                .long("shape")
                .value_parser(clap::builder::PossibleValuesParser::new(
                    SHAPES.iter().filter(|s| !std::ptr::eq(**s, &WAYPOINTS)).map(|s| s.name),
                ))
                .help("shape of the path [default: square]")
                .help_heading("Path"),
        );
        let command = sizes().into_iter().fold(command, |command, p| command.arg(size_flag(p)));
        SpeedProfile::PARAMETERS.iter().fold(command, |command, p| command.arg(number_flag(p).help_heading("Path")))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for RobotFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let number = |p: &'static Parameter| {
            let given = if p.name == Encoder::RATE.name {
                matches.get_one::<Option<f64>>(p.flag).copied()?
            } else {
                Some(number_of(matches, p)?)
            };
            Some((p, given))
        };
        Ok(RobotFlags {
            numbers: Robot::NUMBERS.iter().filter_map(number).collect(),
            shape: matches.get_one::<String>("shape").cloned(),
            sizes: sizes().into_iter().filter_map(|p| Some((p.flag, number_of(matches, p)?))).collect(),
            speed: std::array::from_fn(|i| number_of(matches, &SpeedProfile::PARAMETERS[i])),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl RobotFlags {
    /// `robot` with what was said changed.
    pub fn robot(&self, robot: Robot) -> anyhow::Result<Robot> {
        self.numbers.iter().try_fold(robot, |robot, (parameter, value)| {
            let changed = match value {
                Some(value) => robot.with(parameter.name, *value),
                None => robot.encoder.with_rate(None).map(|encoder| Robot { encoder, ..robot }),
            };
            changed.with_context(|| format!("--{}", parameter.flag))
        })
    }

    /// `path` with what was said changed.
    pub fn path(&self, path: Path) -> anyhow::Result<Path> {
        let shape = match &self.shape {
            Some(name) => SHAPES.iter().find(|shape| shape.name == name).context("there is no such shape")?,
            None => path.shape(),
        };
        let same = std::ptr::eq(shape, path.shape());
        let mut unused: Vec<&str> = self.sizes.iter().map(|(flag, _)| *flag).collect();
        let mut values: Vec<f64> = if same { path.values().to_vec() } else { Vec::new() };
        for (index, parameter) in shape.parameters.iter().enumerate() {
            let given = self.sizes.iter().find(|(flag, _)| *flag == parameter.flag);
            unused.retain(|flag| *flag != parameter.flag);
            match given {
                Some((_, value)) if index < values.len() => values[index] = *value,
                Some((_, value)) => values.push(*value),
                None if index < values.len() => {}
                None => values.push(parameter.default.resolve(&Robot::labmate())),
            }
        }
        if let Some(flag) = unused.first() {
            anyhow::bail!("--{flag} is not a size of a {}", shape.name);
        }
        let mut speed = path.speed.values();
        for (slot, given) in speed.iter_mut().zip(self.speed) {
            *slot = given.unwrap_or(*slot);
        }
        let [speed, acceleration, pause] = speed;
        Ok(Path::new(shape, &values, SpeedProfile::new(speed, acceleration, pause)?)?)
    }

    /// Whether the wheel diameter and ticks are still the assumed ones.
    pub fn leaves_assumptions(&self) -> bool {
        let said = |assumed: &Parameter| self.numbers.iter().any(|(parameter, _)| parameter.name == assumed.name);
        !ASSUMED.iter().all(said)
    }
}
