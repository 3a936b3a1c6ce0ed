//! Flags for every number of every effect, made from the catalogue.

use anyhow::Context;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use umbmark_core::effect::{ActsOn, CATALOGUE, Entry, Model};
use umbmark_core::monte_carlo::{Distribution, Draw};
use umbmark_core::parameter::{DefaultValue, Parameter, Role};

use crate::numbers::number;

/// The heading that the flags of an effect stand under in the help.
fn heading(entry: &Entry) -> &'static str {
    match entry.about.acts_on {
        ActsOn::Odometry => "Effects on the odometry",
        ActsOn::Wheels => "Effects on the wheels",
        ActsOn::Body => "Effects on the body",
        ActsOn::Start => "Effects at START",
        ActsOn::Reference => "Effects on the absolute measurement",
    }
}

/// What was said of the effects' parameters on the command line.
#[derive(Clone, Debug, Default)]
pub struct EffectFlags {
    given: Vec<Given>,
}

#[derive(Clone, Debug)]
struct Given {
    effect: &'static str,
    parameter: &'static Parameter,
    value: Option<f64>,
    deviation: Option<f64>,
}

fn every() -> impl Iterator<Item = (&'static Entry, &'static Parameter)> {
    let by_kind =
        ActsOn::ALL.into_iter().flat_map(|kind| CATALOGUE.iter().copied().filter(move |e| e.about.acts_on == kind));
    by_kind.flat_map(|entry| entry.about.parameters.iter().map(move |p| (entry, p)))
}

fn deviation_flag(parameter: &Parameter) -> String {
    format!("{}-sd", parameter.flag)
}

/// Whether its scatter from robot to robot makes sense: choices and scatters have none.
fn has_deviation(parameter: &Parameter) -> bool {
    !matches!(parameter.role, Role::Choice(_) | Role::Scatter)
}

/// A flag for a number, with its unit and range in the help.
pub fn number_flag(parameter: &'static Parameter) -> Arg {
    let name = if parameter.unit.is_empty() { "X".to_owned() } else { parameter.unit.to_uppercase() };
    let default = match parameter.default {
        DefaultValue::Value(value) => match parameter.word(value) {
            Some(word) => format!(" [default: {word}]"),
            None => format!(" [default: {value}]"),
        },
        DefaultValue::OfRobot(_) => " [default: the robot's]".to_owned(),
    };
    let arg = Arg::new(parameter.flag)
        .long(parameter.flag)
        .help(format!("{}{default}", parameter.meaning))
        .allow_negative_numbers(true);
    if parameter.choices().is_empty() {
        arg.value_name(name).value_parser(number)
    } else {
        arg.value_parser(clap::builder::PossibleValuesParser::new(parameter.choices()))
    }
}

/// The value of a number's flag, choices as their index.
pub fn number_of(matches: &ArgMatches, parameter: &Parameter) -> Option<f64> {
    if matches.value_source(parameter.flag) != Some(ValueSource::CommandLine) {
        return None;
    }
    if parameter.choices().is_empty() {
        return matches.get_one::<f64>(parameter.flag).copied();
    }
    let word = matches.get_one::<String>(parameter.flag)?;
    parameter.choices().iter().position(|choice| choice == word).map(|index| index as f64)
}

impl Args for EffectFlags {
    fn augment_args(command: Command) -> Command {
        every().fold(command, |command, (entry, parameter)| {
            let command = command.arg(number_flag(parameter).help_heading(heading(entry)));
            if !has_deviation(parameter) {
                return command;
            }
            let flag = deviation_flag(parameter);
            command.arg(
                Arg::new(flag.clone())
                    .long(flag)
                    .value_name("SD")
                    .value_parser(number)
                    .allow_negative_numbers(true)
                    .help(format!("standard deviation of --{} from trial to trial", parameter.flag))
                    .help_heading(heading(entry))
                    .hide_short_help(true),
            )
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for EffectFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let given = every().filter_map(|(entry, parameter)| {
            let value = number_of(matches, parameter);
            let deviation =
                has_deviation(parameter).then(|| matches.get_one::<f64>(&deviation_flag(parameter)).copied()).flatten();
            (value.is_some() || deviation.is_some()).then_some(Given {
                effect: entry.about.name,
                parameter,
                value,
                deviation,
            })
        });
        Ok(EffectFlags { given: given.collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl EffectFlags {
    /// Puts what was said into the model and the list of drawn parameters; it overrides what stands there.
    pub fn apply(&self, model: &mut Model, draws: &mut Vec<Draw>) -> anyhow::Result<()> {
        for given in &self.given {
            let (effect, name) = (given.effect, given.parameter.name);
            if let Some(value) = given.value {
                model.set(effect, name, value).with_context(|| format!("--{}", given.parameter.flag))?;
                draws.retain(|draw| draw.effect() != effect || draw.parameter().name != name);
            }
            if let Some(sd) = given.deviation {
                model.add(effect)?;
                let mean = model.get(effect, name).unwrap_or(0.0);
                draws.retain(|draw| draw.effect() != effect || draw.parameter().name != name);
                let draw = Draw::new(effect, name, Distribution::Normal { mean, sd })
                    .with_context(|| format!("--{}", deviation_flag(given.parameter)))?;
                draws.push(draw);
            }
        }
        Ok(())
    }

    /// Whether something was said of this parameter.
    pub fn mentions(&self, effect: &str) -> bool {
        self.given.iter().any(|given| given.effect == effect)
    }
}
