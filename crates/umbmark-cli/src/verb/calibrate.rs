//! `umbmark calibrate`: from measured runs to the true wheel diameters and wheelbase.

pub mod gears;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use umbmark_core::calibrate::{Calibration, Estimate, Method, Options, RadiusWheelbase, Ratio};
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::evidence::Level;
use umbmark_core::likelihood::Noise;
use umbmark_core::result;
use umbmark_core::solve::{Solution, calibrate_beside};
use umbmark_io::RobotFile;
use umbmark_io::export::{Export, Target};

use crate::Session;
use crate::answer::answer_text;
use crate::data_arguments::DataArguments;
use crate::files::Pending;
use crate::level_argument::LevelArgument;
use crate::prose::hanging;
use crate::setup_report::taken_text;
use crate::table::{table, with_precision_of};

/// The estimate that is exported.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum MethodKind {
    ClosedFormX,
    ClosedFormY,
    ClosedFormMean,
    Heading,
    Exact,
    Model,
}

/// The wheelbase in the closed forms' rotation radius.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum WheelbaseKind {
    /// The nominal one, as in the paper's companion
    Nominal,
    /// The corrected one, as in OptiOdom
    Corrected,
}

/// Arguments of `calibrate`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    #[command(flatten)]
    intervals: LevelArgument,

    /// Weight of headings in fits of whole tracks: a radian of heading error counts as so many metres
    /// [default: root mean square distance of the poses from START]
    #[arg(long, value_name = "M", value_parser = crate::numbers::number)]
    heading_arm: Option<f64>,

    /// Wheelbase in the closed forms' formula for E_d
    #[arg(long, value_enum, default_value_t = WheelbaseKind::Nominal, value_name = "WHICH")]
    radius_wheelbase: WheelbaseKind,

    /// Write launch-time parameters for a controller of ros2_control
    #[arg(long, value_name = "FILE", help_heading = "Export")]
    export_ros2: Option<PathBuf>,

    /// Name of the controller in that file [default: that of its type]
    #[arg(long, value_name = "NAME", help_heading = "Export")]
    controller: Option<String>,

    /// Write a robot.toml with the corrected lengths
    #[arg(long, value_name = "FILE", help_heading = "Export")]
    export_toml: Option<PathBuf>,

    /// Write a C header with the corrected lengths
    #[arg(long, value_name = "FILE", help_heading = "Export")]
    export_c: Option<PathBuf>,

    /// Method whose result is exported [default: the learnt model, or the exact fit where the runs are too few for one]
    #[arg(long, value_enum, value_name = "METHOD", help_heading = "Export")]
    method: Option<MethodKind>,

    /// Replace files that exist, and write lengths even if they are in doubt
    #[arg(long)]
    force: bool,
}

impl Arguments {
    fn options(&self) -> Options {
        let radius_wheelbase = match self.radius_wheelbase {
            WheelbaseKind::Corrected => RadiusWheelbase::Corrected,
            WheelbaseKind::Nominal => RadiusWheelbase::Nominal,
        };
        Options { heading_arm: self.heading_arm, radius_wheelbase }
    }

    /// The estimate to export: that of the method that was asked for, or the one to write.
    fn exported<'a>(&self, calibration: &'a Calibration) -> anyhow::Result<&'a Estimate> {
        let Some(method) = self.method.map(|method| Method::ALL[method as usize]) else {
            return calibration.to_write().context("nothing to export: no method gives both E_d and E_b");
        };
        let both = |estimate: &&Estimate| estimate.shown[0] && estimate.shown[1];
        let found = calibration.estimate(method).filter(both);
        found.with_context(|| format!("nothing to export: {} does not give both E_d and E_b", method.name()))
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load_to_test(session)?;
    if !data.nominal_robot()?.drive.kind().has_axle_wheels() {
        return gears::run(&arguments, &data, session);
    }
    let testing = diagnose::Options { seed: session.seed(), ..diagnose::Options::default() };
    let (mut calibration, answer) = session.watched("% of the steps of learning at most", |watch| {
        calibrate_beside(&data, &arguments.options(), &testing, watch)
    })??;
    let robot = data.nominal_robot()?;
    if calibration.estimates.is_empty() {
        anyhow::bail!("nothing can be calibrated from these runs\n{}", calibration.warnings.join("\n"));
    }
    let noticed = calibration.setup.notices().len();
    calibration.warnings.splice(noticed..noticed, data.warnings.iter().cloned());
    let withheld = !calibration.doubts.is_empty() && !arguments.force;
    let written =
        if withheld { Vec::new() } else { export_files(&arguments, &data, robot, &calibration, answer.as_ref())? };
    if session.json() {
        session.print_json(&result::Calibration::new(
            robot,
            &calibration,
            answer.as_ref(),
            arguments.intervals.level,
        ))?;
        return told_what_is_withheld(&arguments, withheld);
    }
    for warning in &calibration.warnings {
        session.message("warning", warning);
    }
    let told = told(robot, &calibration, answer.as_ref(), arguments.intervals.level, testing.size);
    write!(session.out(), "{told}")?;
    for file in written {
        writeln!(session.out(), "wrote {file}")?;
    }
    told_what_is_withheld(&arguments, withheld)
}

/// Refuses the files that were asked for where they were not written.
fn told_what_is_withheld(arguments: &Arguments, withheld: bool) -> anyhow::Result<ExitCode> {
    let asked = [&arguments.export_ros2, &arguments.export_toml, &arguments.export_c];
    let files: Vec<String> = asked.into_iter().flatten().map(|file| file.display().to_string()).collect();
    if withheld && !files.is_empty() {
        let verb = if files.len() > 1 { "were" } else { "was" };
        anyhow::bail!(
            "{}: {verb} not written, because the lengths are in doubt (see the warnings); --force writes them anyway",
            files.join(", ")
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes what was asked for; gives the names of the files.
fn export_files(
    arguments: &Arguments,
    data: &Dataset,
    robot: &Robot,
    calibration: &Calibration,
    answer: Option<&Solution>,
) -> anyhow::Result<Vec<String>> {
    let asked = [&arguments.export_ros2, &arguments.export_toml, &arguments.export_c];
    if asked.iter().all(|file| file.is_none()) {
        return Ok(Vec::new());
    }
    let estimate = arguments.exported(calibration)?;
    match answer.map(|answer| &answer.learnt).filter(|_| estimate.method == Method::Model) {
        Some(learnt) => write_targets(arguments, data, &learnt.model, learnt.noise),
        None => write_targets(arguments, data, &estimate.correction.model(robot)?, None),
    }
}

/// Writes a model to the files that were asked for; gives their names.
fn write_targets(
    arguments: &Arguments,
    data: &Dataset,
    model: &Model,
    noise: Option<Noise>,
) -> anyhow::Result<Vec<String>> {
    let asked =
        [("ros2_control", &arguments.export_ros2), ("toml", &arguments.export_toml), ("c", &arguments.export_c)];
    let export = Export {
        noise,
        controller: arguments.controller.clone(),
        beside: Some(RobotFile::beside(data, model.robot().clone())),
        ..Export::of(model)
    };
    let mut written = Vec::new();
    for (name, file) in asked {
        let Some(file) = file else { continue };
        let target = Target::named(name).with_context(|| format!("no target {name}"))?;
        Pending::write_whole(file, arguments.force, &target.write(&export)?.text)?;
        written.push(file.display().to_string());
    }
    Ok(written)
}

/// What people call a method.
fn title(method: Method) -> &'static str {
    match method.name() {
        "closed_form_x" => "closed form, x",
        "closed_form_y" => "closed form, y",
        "closed_form_mean" => "closed form, mean",
        "heading" => "heading form",
        "model" => "learnt model",
        _ => "exact fit",
    }
}

/// The calibration, and the answer beside it.
pub fn told(robot: &Robot, calibration: &Calibration, answer: Option<&Solution>, level: f64, size: f64) -> String {
    let answer = answer.map(|answer| format!("\n{}", answer_text(answer, 1.0 - size)));
    text(robot, calibration, level) + &answer.unwrap_or_default()
}

fn text(robot: &Robot, calibration: &Calibration, level: f64) -> String {
    let observed = match calibration.level {
        Level::Ends => "end poses",
        Level::Tracks => "whole tracks; the closed forms use their ends",
    };
    let drive = &robot.drive;
    let taken = taken_text(&calibration.taken);
    let mut text = format!(
        "Calibration of {}\nobserved: {observed}\nnominal: b {:.3} mm, D_left {:.4} mm, D_right {:.4} mm\n{taken}\n",
        robot.name,
        1e3 * drive.wheelbase(),
        1e3 * drive.wheel_diameter_left(),
        1e3 * drive.wheel_diameter_right(),
    );
    let estimates = &calibration.estimates;
    text += &table(&["", "E_d", "E_b", "E_s"], estimates.iter().map(|e| ratio_row(e, level)));
    text += &format!("\n\n±: half of the {} % interval.", 100.0 * level);
    if let Some(before) = estimates.iter().find_map(|e| e.e_max_sys_before) {
        text += &format!("\nE_max,sys as driven: {:.1} mm; with the correction:", 1e3 * before);
    }
    text += "\n\n";
    let header = ["", "b [mm]", "D_left [mm]", "D_right [mm]", "predicted", "replayed [mm]"];
    text += &table(&header, estimates.iter().map(|e| length_row(robot, e)));
    text += "\n\npredicted: E_max,sys of the same test with the correction\nreplayed: E_max,sys of the recorded ticks with the correction\n";
    if let Some(estimate) = calibration.to_write() {
        let head = if calibration.doubts.is_empty() { "exported:" } else { "exported, but only with --force:" };
        text += &hanging(head, 10, why(estimate));
    }
    text
}

/// Why an estimate is the one that is exported.
fn why(estimate: &Estimate) -> &'static str {
    match estimate.method {
        Method::Model => "the learnt model, which also has every other effect that the runs show",
        _ => "the exact fit, because the runs are too few to learn a model",
    }
}

fn ratio_row(estimate: &Estimate, level: f64) -> Vec<String> {
    let cell = |ratio: Ratio| {
        let Some(value) = estimate.ratio(ratio) else { return "-".to_owned() };
        match estimate.interval(ratio, level) {
            Some(interval) if interval.high > interval.low => {
                let half = 0.5 * (interval.high - interval.low);
                format!("{} ± {}", with_precision_of(value, half), with_precision_of(half, half))
            }
            _ => format!("{value:.6}"),
        }
    };
    std::iter::once(title(estimate.method).to_owned()).chain(Ratio::ALL.map(cell)).collect()
}

fn length_row(robot: &Robot, estimate: &Estimate) -> Vec<String> {
    let lengths = estimate.lengths(robot);
    let mm = |value: Option<f64>, decimals: usize| value.map_or("-".to_owned(), |v| format!("{:.decimals$}", 1e3 * v));
    vec![
        title(estimate.method).to_owned(),
        mm(lengths.wheelbase, 3),
        mm(lengths.left, 4),
        mm(lengths.right, 4),
        mm(estimate.e_max_sys_after, 1),
        mm(estimate.replayed_after.and_then(|r| r.e_max_sys), 1),
    ]
}
