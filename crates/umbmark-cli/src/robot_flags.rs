//! Flags for the nominal robot, the path and the speed: the paper's LabMate on its square where nothing is said.

use anyhow::Context;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use umbmark_core::drive::{Drive, Encoder, Kind, Robot};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{Path, SHAPES, SpeedProfile, WAYPOINTS};

use crate::effect_flags::{number_flag, number_of};
use crate::numbers::number;

/// What was said of robot and path on the command line.
#[derive(Clone, Debug, Default)]
pub struct RobotFlags {
    wheelbase: Option<f64>,
    wheel_diameter: Option<f64>,
    ticks_per_revolution: Option<f64>,
    encoder_rate: Option<Option<f64>>,
    shape: Option<String>,
    sizes: Vec<(&'static str, f64)>,
    speed: [Option<f64>; 3],
}

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
        let robot = |flag: &'static str, unit: &'static str, help: &'static str| {
            Arg::new(flag)
                .long(flag)
                .value_name(unit)
                .value_parser(number)
                .allow_negative_numbers(true)
                .help(help)
                .help_heading("Robot")
        };
        let command = command
            .arg(robot("wheelbase", "M", "nominal wheelbase b [default: 0.340, the paper's LabMate]"))
            .arg(robot("wheel-diameter", "M", "nominal diameter of both wheels [default: 0.150, assumed]"))
            .arg(robot("ticks-per-revolution", "N", "encoder ticks per wheel revolution [default: 2000, assumed]"))
            .arg(
                Arg::new("encoder-rate")
                    .long("encoder-rate")
                    .value_name("HZ")
                    .value_parser(encoder_rate)
                    .help("how often the counters are read, or \"every tick\" [default: every tick]")
                    .help_heading("Robot"),
            )
            .arg(
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
        let value = |flag: &str| matches.get_one::<f64>(flag).copied();
        Ok(RobotFlags {
            wheelbase: value("wheelbase"),
            wheel_diameter: value("wheel-diameter"),
            ticks_per_revolution: value("ticks-per-revolution"),
            encoder_rate: matches.get_one::<Option<f64>>("encoder-rate").copied(),
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
        let Robot { name, drive, encoder } = robot;
        Ok(Robot {
            name,
            drive: self.drive(drive)?,
            encoder: Encoder::new(
                self.ticks_per_revolution.unwrap_or(encoder.ticks_per_revolution()),
                self.encoder_rate.unwrap_or(encoder.rate()),
                encoder.counter_bits(),
            )?,
        })
    }

    fn drive(&self, drive: Drive) -> anyhow::Result<Drive> {
        let said = [(self.wheelbase, "--wheelbase"), (self.wheel_diameter, "--wheel-diameter")];
        let (kind, given) = (drive.kind(), said.iter().find(|(value, _)| value.is_some()));
        if let Some((_, flag)) = given.filter(|_| kind != Kind::Differential) {
            anyhow::bail!(
                "{flag} is for robots with drive = \"differential\"; say the {} robot's numbers in a robot.toml",
                kind.name()
            );
        }
        let drive = self.wheelbase.map_or(Ok(drive), |value| drive.with("wheelbase_m", value))?;
        Ok(self.wheel_diameter.map_or(Ok(drive), |value| drive.with("wheel_diameter_m", value))?)
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
        self.wheel_diameter.is_none() || self.ticks_per_revolution.is_none()
    }
}
