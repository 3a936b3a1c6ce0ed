//! `umbmark report`: everything on one page.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use serde_json::json;
use umbmark_core::result::Said;
use umbmark_plot::kind::KINDS;
use umbmark_plot::page::{Origin, Provenance, change, page, said};
use umbmark_plot::study::Study;

use crate::Session;
use crate::data_arguments::TopicArguments;
use crate::files::Pending;
use crate::prose::hanging;
use crate::study_arguments::StudyArguments;
use crate::words::ACTIONS;

/// Measured poses that take minutes to learn from: some 0.1 ms each on one thread.
const MANY: usize = 200_000;

/// No more stand side by side.
const MAX_SIDE_BY_SIDE: usize = 2;

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A dataset folder or file; two are shown side by side, for example before and after a calibration
    #[arg(value_name = "DATA", required = true, num_args = 1..=MAX_SIDE_BY_SIDE)]
    data: Vec<PathBuf>,

    /// A model; its free effects are fitted; two are shown side by side
    /// [default: the model learnt from the data]
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,

    /// The page
    #[arg(short, long, default_value = "report.html", value_name = "FILE", value_parser = html)]
    output: PathBuf,

    /// Replace a file that exists
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    topics: TopicArguments,

    #[command(flatten)]
    study: StudyArguments,
}

fn html(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("html" | "htm") => Ok(path),
        _ => Err("a report is written as NAME.html".into()),
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let stop = session.catch_interrupt();
    let studies: Vec<Study> = arguments.studies(session)?.into_iter().map(|study| study.stopped_by(&stop)).collect();
    let provenance = arguments.provenance(session)?;
    // Refused before the long work, not after it.
    let mut file = Pending::create(&arguments.output, arguments.force)?;
    for study in studies.iter().filter(|study| study.given.is_none()) {
        let poses: usize = study.data.runs.iter().flat_map(|run| &run.log).map(|log| log.reference.len()).sum();
        if poses > MANY && !study.options.diagnose.ends_only {
            let cost =
                "takes minutes; with --model FILE nothing is learnt, --return-poses learns from return poses alone";
            session.message("note", &format!("learning from {poses} measured poses {cost}"));
        }
        // Why nothing could be learnt, the page says.
        let _ = session.told("% of the steps of learning at most", |tell| study.learn(tell).is_ok())?;
    }
    let mut progress = session.progress(KINDS.len() as u64, "figures");
    let made = session.on_threads(|| page(&studies, &provenance, ACTIONS, |done| progress.at(done as u64)))?;
    drop(progress);
    let text = made.context("cannot make the page")?;
    file.write_all(text.as_bytes()).with_context(|| file.failed())?;
    file.finish()?;
    let output = arguments.output.display().to_string();
    let partial = studies.iter().any(Study::is_partial);
    if partial {
        session.message("partial", "stopped before all parts were finished; the page says what is missing");
    }
    let verdicts: Vec<Said> = studies.iter().map(said).collect();
    if session.json() {
        session.print_json(&json!({
            "output": output,
            "bytes": text.len(),
            "studies": verdicts,
            "change": change(&studies),
            "partial": partial,
            "seed": session.seed(),
            "version": umbmark_core::VERSION,
        }))?;
        return Ok(ExitCode::SUCCESS);
    }
    for said in &verdicts {
        let name = if verdicts.len() > 1 { format!("{}: ", said.name) } else { String::new() };
        for notice in &said.notices {
            write!(session.out(), "{}", hanging("LOOK", 6, &format!("{name}{notice}")))?;
        }
        write!(session.out(), "{}", hanging("", 0, &format!("{name}{}", said.verdict)))?;
    }
    if let Some(outcome) = change(&studies) {
        writeln!(session.out(), "\nfrom {} to {}: {outcome}", studies[0].name, studies[1].name)?;
    }
    writeln!(session.out(), "\nwrote {output} ({:.1} MB)", text.len() as f64 / 1e6)?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// One study for each dataset or model.
    fn studies(&self, session: &Session) -> anyhow::Result<Vec<Study>> {
        let of = |place: &Path, model: Option<&Path>, name: &str| {
            let data = self.topics.load_to_test(place, session)?;
            for warning in data.warnings.iter().filter(|_| !session.json()) {
                session.message("warning", warning);
            }
            self.study.study(name, data, model, session)
        };
        match (&self.data[..], &self.model[..]) {
            ([place], []) => Ok(vec![of(place, None, &short(place))?]),
            ([place], [model]) => Ok(vec![of(place, Some(model), &short(place))?]),
            ([place], models) if models.len() <= MAX_SIDE_BY_SIDE => {
                models.iter().map(|model| of(place, Some(model), &short(model))).collect()
            }
            (places, []) => places.iter().map(|place| of(place, None, &short(place))).collect(),
            (places, models) if places.len() == models.len() => {
                places.iter().zip(models).map(|(place, model)| of(place, Some(model), &short(place))).collect()
            }
            (places, [model]) => places.iter().map(|place| of(place, Some(model), &short(place))).collect(),
            (_, models) => {
                anyhow::bail!(
                    "{} models are too many: {MAX_SIDE_BY_SIDE} studies at most are shown side by side",
                    models.len()
                )
            }
        }
    }

    fn provenance(&self, session: &Session) -> anyhow::Result<Provenance> {
        let mut files = Vec::new();
        for place in &self.data {
            let read = Origin::of_dataset(place);
            files.extend(read.with_context(|| format!("cannot read the files of {}", place.display()))?);
        }
        for model in &self.model {
            files.push(Origin::of(model).with_context(|| format!("cannot read {}", model.display()))?);
        }
        let (version, seed) = (umbmark_core::VERSION.to_owned(), session.seed());
        Ok(Provenance { version, seed, command: command(), files })
    }
}

/// A place by the last part of its name.
fn short(place: &Path) -> String {
    place.file_name().unwrap_or(place.as_os_str()).to_string_lossy().into_owned()
}

/// The command as it was given, fit for a shell.
fn command() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%".contains(c);
    let word = |word: String| match !word.is_empty() && word.chars().all(plain) {
        true => word,
        false => format!("'{}'", word.replace('\'', r"'\''")),
    };
    let words = std::env::args_os().skip(1).map(|argument| word(argument.to_string_lossy().into_owned()));
    std::iter::once("umbmark".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
