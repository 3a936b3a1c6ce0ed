//! `umbmark init`: a dataset to begin with, from logs or to be filled in.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches};
use serde_json::json;
use umbmark_core::drive::Robot;
use umbmark_core::parameter::Parameter;
use umbmark_core::prose::counted;
use umbmark_core::result;
use umbmark_io::export::UrdfFile;
use umbmark_io::{Existing, KnownNumbers, Proposal, read_controller, write_template};

use crate::Session;
use crate::data_arguments::TopicArguments;
use crate::effect_flags::{number_flag, number_of};
use crate::prose::hanging;
use crate::verb::export::two;
use crate::words::WORDS;

/// Arguments of `init`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The folder of the dataset; it is created if it does not exist [default: that of the logs if they are in its runs, else the
    /// current folder]
    folder: Option<PathBuf>,

    /// Begin from logs: a log in CSV or MCAP, a bag of ROS 1 or 2, or a folder of these. A robot.toml is proposed from them, and they are
    /// put into runs; without this option, from the logs that are in runs already
    #[arg(long, value_name = "PLACE")]
    logs: Option<PathBuf>,

    /// Take wheelbase and wheel diameters from this URDF
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,

    /// Joints of the left and the right wheel in it, where their names leave that open
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = two, requires = "urdf")]
    joints: Option<[String; 2]>,

    /// Take wheelbase and wheel diameters from the parameters of this ROS 2 controller (YAML with wheel_separation and
    /// wheel_radius)
    #[arg(long, value_name = "FILE")]
    controller_yaml: Option<PathBuf>,

    /// Name of the robot
    #[arg(long, value_name = "TEXT")]
    name: Option<String>,

    #[command(flatten)]
    plate: NamePlate,

    #[command(flatten)]
    topics: TopicArguments,

    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

/// Numbers of the robot that its maker or its software tells.
#[derive(Clone, Debug, Default)]
struct NamePlate(Vec<(&'static Parameter, f64)>);

impl Args for NamePlate {
    fn augment_args(command: Command) -> Command {
        let flag = |command: Command, parameter: &'static Parameter| {
            command.arg(number_flag(parameter).help(parameter.meaning).help_heading("Robot"))
        };
        Robot::NUMBERS.iter().fold(command, flag)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for NamePlate {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let given = |parameter: &'static Parameter| Some((parameter, number_of(matches, parameter)?));
        Ok(NamePlate(Robot::NUMBERS.iter().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let existing = if arguments.force { Existing::Replace } else { Existing::Keep };
    let folder = arguments.folder();
    let known = arguments.known()?;
    let place = arguments.logs.clone().or_else(|| umbmark_io::has_logs(&folder).then(|| folder.clone()));
    let Some(place) = place else {
        anyhow::ensure!(
            known.is_empty(),
            "{}: there are no logs to begin from in runs; name them with --logs PLACE",
            folder.display()
        );
        return template(&folder, existing, session);
    };
    let proposal = Proposal::of(&place, &folder, &arguments.topics.topics(), &known, &WORDS)?;
    let robot = proposal.write(&folder, existing)?;
    if session.json() {
        session.print_json(&document(&proposal, &robot))?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = proposed_text(&proposal, &robot, &folder, &arguments.topics.said())?;
    write!(session.out(), "{text}")?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// Where the dataset goes: where it was said, else where logs in runs belong to, else here.
    fn folder(&self) -> PathBuf {
        let in_place = |logs: &PathBuf| {
            let parent = logs.parent().filter(|_| logs.file_name().is_some_and(|name| name == "runs"));
            parent
                .map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent })
                .map(PathBuf::from)
                .or_else(|| logs.join("runs").is_dir().then(|| logs.clone()))
        };
        let from_logs = || self.logs.as_ref().and_then(in_place);
        self.folder.clone().or_else(from_logs).unwrap_or_else(|| PathBuf::from("."))
    }

    /// Numbers of the robot from other sources than logs: what was said comes first, then what its odometry uses.
    fn known(&self) -> anyhow::Result<Vec<KnownNumbers>> {
        let mut said = KnownNumbers::default();
        said.name.clone_from(&self.name);
        for (parameter, value) in &self.plate.0 {
            let value = parameter.check(*value).with_context(|| format!("--{}", parameter.flag))?;
            said.push(parameter.name, value, &format!("as said with --{}", parameter.flag));
        }
        let mut known = Vec::new();
        if said != KnownNumbers::default() {
            known.push(said);
        }
        known.extend(self.controller_yaml.as_ref().map(read_controller).transpose()?);
        if let Some(urdf) = &self.urdf {
            known.push(UrdfFile::read(urdf, self.joints.clone())?.numbers()?);
        }
        Ok(known)
    }
}

/// Files to fill in.
fn template(folder: &Path, existing: Existing, session: &mut Session) -> anyhow::Result<ExitCode> {
    let [robot, returns] = write_template(folder, existing)?.map(|file| file.display().to_string());
    if session.json() {
        session.print_json(&json!({ "written": [robot, returns] }))?;
        return Ok(ExitCode::SUCCESS);
    }
    let folder = folder.to_string_lossy();
    let folder = shlex::try_quote(&folder)?;
    write!(
        session.out(),
        "wrote {robot}\n  enter the values of your robot's software: wheelbase, wheels, encoders, path\n\
         wrote {returns}\n  add one row for each drive round the path; the file says how to measure\n\n\
         then\n  umbmark inspect {folder}      is the data good?\n  \
         umbmark score {folder}        how large are the errors?\n  \
         umbmark calibrate {folder}    what corrects them?\n\n\
         If you have logs of its wheels:\n  umbmark init {folder} --force --logs PLACE\n"
    )?;
    Ok(ExitCode::SUCCESS)
}

fn proposed_text(proposal: &Proposal, robot: &Path, folder: &Path, topics: &str) -> anyhow::Result<String> {
    let mut text = format!("wrote {}\n", robot.display());
    let open = proposal.to_fill_in().len();
    let rows = proposal.numbers.iter().map(|number| {
        let value = number.value.map_or("FILL IN".to_owned(), |value| value.to_string());
        (format!("  {:<24}{value}", number.key), number.source.clone())
    });
    for (head, source) in rows {
        text += &hanging(&head, 38, &source);
    }
    if proposal.numbers.is_empty() {
        text += "  the robot.toml that the logs bring along\n";
    }
    let logs = counted(proposal.contents.len(), "log");
    match proposal.placed() {
        0 => text += &format!("found {logs} in {}\n", folder.join("runs").display()),
        _ => text += &format!("put {logs} into {}\n", folder.join("runs").display()),
    }
    let are_read = proposal.columns.is_empty();
    if are_read && proposal.contents.iter().all(|log| matches!(log.reference, Ok(None))) {
        text += &hanging(
            "",
            2,
            "none has columns of absolute poses: measure where the robot ends by tape (returns.csv), record its poses, or give the rates of a gyro \
             (gyro_deg_s) or a TUM file of poses beside each log",
        );
    }
    for note in &proposal.notes {
        text += &hanging("  note", 8, note);
    }
    let name = folder.to_string_lossy();
    let name = shlex::try_quote(&name)?;
    text += "\nthen\n";
    if open > 0 {
        let lines = counted(open, "line");
        text += &hanging("", 2, &format!("fill in what is marked FILL IN in {}: {lines}", robot.display()));
    }
    let commands = [
        (format!("umbmark inspect {name}{topics}"), "is the data good?"),
        (format!("umbmark solve {name}{topics} -o model.toml"), "what is wrong, and what to write into the robot"),
        ("umbmark export model.toml --to ros2_control -o robot.yaml".to_owned(), "the numbers as a file of ROS 2"),
    ];
    for (command, answers) in commands {
        text += &format!("  {command}\n      {answers}\n");
    }
    Ok(text)
}

fn document(proposal: &Proposal, robot: &Path) -> serde_json::Value {
    let number = |number: &umbmark_io::ProposedNumber| json!({ "key": number.key, "value": number.value, "source": number.source });
    json!({
        "written": [robot.display().to_string()],
        "numbers": proposal.numbers.iter().map(number).collect::<Vec<_>>(),
        "to_fill_in": proposal.to_fill_in(),
        "logs": proposal.contents.iter().map(result::LogContents::from).collect::<Vec<_>>(),
        "notes": proposal.notes,
    })
}
