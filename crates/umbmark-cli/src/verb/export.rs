//! `umbmark export`: a model as the file of another program.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::json;
use umbmark_core::geometry::Pose2;
use umbmark_core::parameter::Parameter;
use umbmark_io::ModelFile;
use umbmark_io::export::{Export, TARGETS, Target, UrdfFile, Usual};

use crate::Session;
use crate::files::Pending;
use crate::numbers::pose;
use crate::prose::hanging;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
#[command(after_help = targets())]
pub struct Arguments {
    /// The model, a model.toml with its [robot], as learn and fit write it
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// What to write it for
    #[arg(long, value_name = "TARGET", value_parser = names())]
    to: &'static Target,

    /// File to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Name of the controller in parameters of ros2_control [default: that of its type]
    #[arg(long, value_name = "NAME")]
    controller: Option<String>,

    /// Your own URDF, which is written with other numbers; for --to urdf
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,

    /// Joints of the left and the right wheel in that file, where their names leave that open
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = two, requires = "urdf")]
    joints: Option<[String; 2]>,

    /// Usual speed of the robot, for which a constant covariance is computed
    #[arg(long, value_name = "M_S", value_parser = number(0), default_value_t = Usual::default().speed)]
    speed: f64,

    /// Usual turn rate, for which a constant covariance is computed
    #[arg(long, value_name = "RAD_S", value_parser = number(1), default_value_t = Usual::default().turn_rate)]
    turn_rate: f64,

    /// Rate at which the robot publishes its odometry
    #[arg(long, value_name = "HZ", value_parser = number(2), default_value_t = Usual::default().rate)]
    rate: f64,

    /// Where the robot stands at its first reading, x and y in m, heading in rad; for --to embedded
    #[arg(long, value_name = "X,Y,HEADING", default_value = "0,0,0", value_parser = pose, allow_hyphen_values = true)]
    start: Pose2,

    /// Replace a file that exists, and write a model even if something speaks against it
    #[arg(long)]
    force: bool,
}

fn names() -> impl TypedValueParser<Value = &'static Target> {
    let names = TARGETS.iter().map(|target| target.name);
    PossibleValuesParser::new(names).try_map(|name| Target::named(&name).ok_or("no such target"))
}

fn number(which: usize) -> impl Fn(&str) -> Result<f64, String> + Clone {
    let parameter: &'static Parameter = &Usual::PARAMETERS[which];
    move |text| {
        let value = crate::numbers::number(text)?;
        parameter.check(value).map_err(|_| format!("must be {}", parameter.allowed()))
    }
}

/// The names of two joints.
pub fn two(text: &str) -> Result<[String; 2], String> {
    match text.split_once(',') {
        Some((left, right)) if !left.is_empty() && !right.is_empty() => Ok([left.to_owned(), right.to_owned()]),
        _ => Err("must be the names of two joints with a comma between them".to_owned()),
    }
}

/// The targets, for the end of the help.
fn targets() -> String {
    let lines = TARGETS.iter().map(|target| hanging(&format!("  {}", target.name), 22, target.about));
    format!("Targets:\n{}", lines.collect::<String>())
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let file = ModelFile::read_with_robot(&arguments.model)?;
    for draw in &file.draws {
        let what = format!(
            "{} of {} is drawn from a distribution; its middle is written",
            draw.parameter().name,
            draw.effect()
        );
        session.message("note", &what);
    }
    if let Some(doubt) = file.doubt.as_ref().filter(|doubt| !(doubt.alone && arguments.to.holds_all)) {
        if !arguments.force {
            anyhow::bail!(
                "{}: {} Nothing was written; --force writes it anyway",
                arguments.model.display(),
                doubt.because
            );
        }
        session.message("warning", &doubt.because);
    }
    let usual = Usual { speed: arguments.speed, turn_rate: arguments.turn_rate, rate: arguments.rate };
    let urdf = arguments.urdf.map(|file| UrdfFile::read(file, arguments.joints)).transpose()?;
    let (noise, controller) = (file.noise, arguments.controller);
    let export = Export { noise, controller, urdf, usual, start: arguments.start, ..Export::of(&file.model) };
    let written = arguments.to.write(&export)?;
    Pending::write_whole(&arguments.output, arguments.force, &written.text)?;
    for note in &written.notes {
        session.message("note", note);
    }
    if session.json() {
        session.print_json(&json!({
            "output": arguments.output.display().to_string(),
            "target": arguments.to.name,
            "notes": written.notes,
            "version": umbmark_core::VERSION,
        }))?;
    } else {
        writeln!(session.out(), "wrote {}", arguments.output.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
