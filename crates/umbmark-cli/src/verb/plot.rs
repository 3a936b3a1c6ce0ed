//! `umbmark plot`: one figure as SVG, PNG or PDF.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use serde_json::json;
use umbmark_plot::figure::Figure;
use umbmark_plot::kind::{FigureKind, all, find};
use umbmark_plot::render::file::{Format, UnknownEnding, WIDTHS_MM};

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::files::Pending;
use crate::prose::hanging;
use crate::study_arguments::StudyArguments;

/// A file of a format.
#[derive(Clone, Debug)]
struct Drawing {
    path: PathBuf,
    format: Format,
}

fn drawing(text: &str) -> Result<Drawing, UnknownEnding> {
    let path = PathBuf::from(text);
    Ok(Drawing { format: Format::of(&path)?, path })
}

fn kind(name: &str) -> Result<&'static FigureKind, String> {
    find(name).ok_or_else(|| format!("there is no such kind of figure\n\n{}", kinds()))
}

/// The kinds of figures, a line each.
fn kinds() -> String {
    let lines = all().map(|kind| hanging(&format!("  {}", kind.name), 18, kind.about));
    format!("Kinds:\n{}", lines.collect::<String>())
}

/// Arguments of `plot`.
#[derive(Debug, clap::Args)]
#[command(after_help = kinds())]
pub struct Arguments {
    /// What to draw; the kinds are listed below
    #[arg(value_name = "KIND", value_parser = kind)]
    kind: &'static FigureKind,

    #[command(flatten)]
    data: DataArguments,

    /// The file: NAME.svg, NAME.png, NAME.pdf, or NAME.json for Plotly
    #[arg(short, long, value_name = "FILE", value_parser = drawing)]
    output: Drawing,

    /// A model; its free effects are fitted [default: the model learnt from the data]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    /// Width of the figure: a column of a journal
    #[arg(long, default_value_t = 88.0, value_name = "MM", value_parser = width)]
    width: f64,

    /// Dots per inch of a PNG
    #[arg(long, default_value_t = 300, value_name = "DPI", value_parser = crate::numbers::whole_in::<u32>(30..=1200))]
    dpi: u32,

    /// Replace a file that exists
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    study: StudyArguments,
}

fn width(text: &str) -> Result<f64, String> {
    let width = crate::numbers::number(text)?;
    let (least, most) = (WIDTHS_MM.start(), WIDTHS_MM.end());
    if WIDTHS_MM.contains(&width) { Ok(width) } else { Err(format!("must be from {least} to {most} mm")) }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load(session)?;
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    let name = arguments.data.named();
    let study = arguments.study.study(&name, data, arguments.model.as_deref(), session)?;
    let kind = arguments.kind;
    let figure = session
        .on_threads(|| (kind.build)(&study))?
        .with_context(|| format!("{} cannot be drawn from {name}", kind.name))?;
    let bytes = arguments.output.format.bytes(&figure, arguments.width, arguments.dpi)?;
    let mut file = Pending::create(&arguments.output.path, arguments.force)?;
    file.write_all(&bytes).with_context(|| file.failed())?;
    file.finish()?;
    let output = arguments.output.path.display().to_string();
    if session.json() {
        let told = json!({ "shows": figure.told.shows, "good": figure.told.good, "says": figure.told.says });
        let table = json!({ "header": figure.table.header, "rows": figure.table.rows });
        session.print_json(&json!({
            "kind": kind.name,
            "output": output,
            "told": told,
            "table": table,
            "seed": session.seed(),
            "version": umbmark_core::VERSION,
        }))?;
        return Ok(ExitCode::SUCCESS);
    }
    write!(session.out(), "{}", text(&figure, &output))?;
    Ok(ExitCode::SUCCESS)
}

fn text(figure: &Figure, output: &str) -> String {
    let mut text = hanging("", 0, &figure.told.says);
    text += &hanging("shows", 8, &figure.told.shows);
    text += &hanging("good", 8, &figure.told.good);
    text + &format!("\nwrote {output}\n")
}
