//! `umbmark apply`: corrected odometry from wheel counts and a model.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::builder::PossibleValuesParser;
use serde_json::json;
use umbmark_core::apply::{Corrected, apply_to_all};
use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::geometry::Pose2;
use umbmark_core::result::Applied;
use umbmark_core::stats::normal_quantile;
use umbmark_io::whole_file::{FileError, WholeFile, is_standard_output};
use umbmark_io::{CorrectedFormat, DatasetError, ModelFile};

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::files::{begin, with_remedy};
use crate::numbers::pose;
use crate::prose::hanging;
use crate::table::table;

/// Arguments of `apply`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// The model, as `learn` or `fit` has written it
    #[arg(long, value_name = "FILE")]
    model: PathBuf,

    /// File to write, NAME.csv, NAME.mcap or NAME.tum; for several runs a folder
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Format of the files in a folder [default: csv]
    #[arg(long, value_name = "FORMAT", value_parser = names())]
    to: Option<String>,

    /// Where each run begins: x and y in m, heading in rad. Effects that depend on heading or place need it where a run does
    /// not begin where those began that the model was learnt from
    #[arg(long, value_name = "X,Y,HEADING", default_value = "0,0,0", value_parser = pose, allow_hyphen_values = true)]
    start: Pose2,

    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(CorrectedFormat::ALL.map(CorrectedFormat::name))
}

impl Arguments {
    /// The file of each of some runs, and its format.
    fn files(&self, runs: &[&Run]) -> anyhow::Result<(CorrectedFormat, Vec<PathBuf>)> {
        let wish = self.to.as_deref().and_then(|name| CorrectedFormat::ALL.into_iter().find(|f| f.name() == name));
        let place = self.output.display();
        match (CorrectedFormat::of_file(&self.output), runs) {
            (Some(format), _) if wish.is_some_and(|wish| wish != format) => {
                anyhow::bail!("--to says another format than {place} ends with; remove one of them")
            }
            (Some(format), [_]) => Ok((format, vec![self.output.clone()])),
            (Some(_), runs) => {
                anyhow::bail!(
                    "there are {} runs, and {place} holds one; name a folder, and the format with --to",
                    runs.len()
                )
            }
            (None, [_]) if is_standard_output(&self.output) => {
                Ok((wish.unwrap_or(CorrectedFormat::Csv), vec![self.output.clone()]))
            }
            (None, runs) if is_standard_output(&self.output) => {
                anyhow::bail!("there are {} runs, and standard output holds one; name a folder", runs.len())
            }
            (None, _) => {
                let format = wish.unwrap_or(CorrectedFormat::Csv);
                let file = |run: &&Run| self.output.join(format!("{}.{}", run.name, format.name()));
                Ok((format, runs.iter().map(file).collect()))
            }
        }
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let name = arguments.model.display();
    let own = ModelFile::read(&arguments.model, None)?.model;
    arguments.data.say_needs(session)?;
    let alone = arguments.data.read();
    // Positions of joints and odometry become counts by the numbers of a robot, counts do without.
    let (data, is_own) = match alone {
        Err(DatasetError::NoRobot(_)) => (arguments.data.load_of(own.robot())?, true),
        data => data.map(|data| (data, false))?,
    };
    let ModelFile { model, draws, conversion, noise, doubt } = ModelFile::read(&arguments.model, data.robot.as_ref())?;
    if let Some(drawn) = draws.first() {
        anyhow::bail!("{name}: {} of {} is drawn; give it a value", drawn.parameter().name, drawn.effect());
    }
    for warning in &data.warnings {
        session.message("warning", warning);
    }
    if let Some(conversion) = conversion {
        session.message("note", &format!("{name} {conversion}"));
    }
    if is_own || data.robot.is_none() {
        session.message("note", &format!("no robot.toml beside the log: the robot of {name} is taken"));
    }
    if let Some(doubt) = doubt.filter(|doubt| !doubt.alone) {
        session.message("warning", &doubt.because);
    }
    if noise.is_none() {
        session
            .message("note", &format!("{name} has no [noise]: no covariance is given (`learn` on tracks writes it)"));
    }
    let corrected = apply_to_all(&data, &model, noise.as_ref(), arguments.start)?;
    if corrected.is_empty() {
        anyhow::bail!("{}: no run has wheel counts, and odometry is made of them", arguments.data.named());
    }
    let runs: Vec<&Run> = corrected.iter().map(|(run, _)| *run).collect();
    let (format, files) = arguments.files(&runs)?;
    write_all(&arguments, format, &corrected, &files)?;
    let applied: Vec<Applied> = corrected
        .iter()
        .zip(&files)
        .filter_map(|((run, corrected), file)| Applied::new(&run.name, &file.display().to_string(), corrected))
        .collect();
    if session.json() {
        session.print_json(&json!({ "runs": applied, "version": umbmark_core::VERSION }))?;
    } else {
        let text = text(&data, &applied, format, &arguments);
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes all files beside first, so that none stands there if one cannot.
fn write_all(
    arguments: &Arguments,
    format: CorrectedFormat,
    corrected: &[(&Run, Corrected)],
    files: &[PathBuf],
) -> anyhow::Result<()> {
    // Runs of several datasets are called DATASET/RUN.
    for folder in files.iter().filter(|file| **file != arguments.output).filter_map(|file| file.parent()) {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    let write = |file: &Path, corrected: &Corrected| {
        let failed = |error| FileError::Write { file: file.to_owned(), error };
        let bytes = format.bytes(corrected).map_err(failed)?;
        let mut whole = begin(file, arguments.force)?;
        whole.write_all(&bytes).map_err(failed)?;
        whole.secure()?;
        Ok::<_, FileError>(whole)
    };
    let whole = corrected.iter().zip(files).map(|((_, corrected), file)| write(file, corrected));
    let whole: Vec<WholeFile> = whole.collect::<Result<_, _>>().map_err(with_remedy)?;
    whole.into_iter().try_for_each(WholeFile::finish).map_err(with_remedy)
}

fn text(data: &Dataset, applied: &[Applied], format: CorrectedFormat, arguments: &Arguments) -> String {
    let robot = data.robot.as_ref().map_or(String::new(), |robot| format!(" of {}", robot.name));
    let mut text = format!("Odometry{robot}, corrected by {}\n\n", arguments.model.display());
    let half = normal_quantile(0.975);
    let row = |a: &Applied| {
        let cell = |value: f64, sd: Option<f64>, scale: f64, digits: usize| {
            let half = sd.map(|sd| format!(" ± {:.digits$}", half * scale * sd)).unwrap_or_default();
            format!("{:.digits$}{half}", scale * value)
        };
        let sd = a.end_standard_deviation;
        vec![
            a.run.clone(),
            a.samples.to_string(),
            format!("{:.2}", a.way_m),
            cell(a.end[0], sd.map(|sd| sd[0]), 1e3, 1),
            cell(a.end[1], sd.map(|sd| sd[1]), 1e3, 1),
            cell(a.end[2], sd.map(|sd| sd[2]), 1f64.to_degrees(), 2),
        ]
    };
    text +=
        &table(&["run; ± 95 %", "poses", "way [m]", "end x [mm]", "y [mm]", "heading [deg]"], applied.iter().map(row));
    text += "\n\n";
    if format == CorrectedFormat::Tum && applied.iter().any(|a| a.end_standard_deviation.is_some()) {
        text += &hanging("lost", 10, "the covariances: a trajectory holds poses alone; csv and mcap have them");
    }
    let wrote = match applied {
        [one] => one.output.clone(),
        _ => format!("{} files to {}", applied.len(), arguments.output.display()),
    };
    text + &format!("wrote {wrote}\n")
}
