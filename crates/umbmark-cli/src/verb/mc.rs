//! `umbmark mc`: Monte Carlo of whole UMBmark tests.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context;
use umbmark_core::document::{self, Theory};
use umbmark_core::monte_carlo::{Draw, Ensemble, Metric, Row, Shard, Statistics, Study};
use umbmark_core::parameter::Parameter;

use crate::checkpoint::Checkpoint;
use crate::distribution_text::distribution_words;
use crate::ensemble_report::{Description, Report};
use crate::numbers::number;
use crate::study_flags::{Known, StudyFlags};
use crate::sweep::{self, SweepFlags};
use crate::{Session, files};

/// Arguments of `mc`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Trials: whole tests, each with all its runs [default: 1000; as many as it takes with --until-std-error]
    #[arg(short = 'n', long, value_name = "N")]
    trials: Option<u64>,

    /// Stop as soon as the standard error of the mean E_max,sys is this small, as in 0.1mm
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    until_std_error: Option<f64>,

    /// Write the metrics of every trial to a CSV file
    #[arg(long, value_name = "trials.csv")]
    out: Option<PathBuf>,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    /// Write what is done to this file now and then, for --resume and `umbmark merge`
    #[arg(long, value_name = "FILE", help_heading = "Long studies")]
    checkpoint: Option<PathBuf>,

    /// Time between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = number, requires = "checkpoint",
          help_heading = "Long studies")]
    checkpoint_every: f64,

    /// Go on with the study of the checkpoint file, if it is there
    #[arg(long, requires = "checkpoint", conflicts_with = "out", help_heading = "Long studies")]
    resume: bool,

    /// Run the I-th of K shards, for `umbmark merge` to put together
    #[arg(long, value_name = "I/K", default_value_t = Shard::WHOLE, conflicts_with = "until_std_error",
          requires = "checkpoint", help_heading = "Long studies")]
    shard: Shard,

    #[command(flatten)]
    sweep: SweepFlags,

    #[command(flatten)]
    study: StudyFlags,
}

impl Arguments {
    fn trials(&self) -> u64 {
        self.trials.unwrap_or(if self.until_std_error.is_some() { MOST_UNTIL } else { 1000 })
    }

    /// What is done already, where a study is taken up again.
    fn checkpoint(&self, study: &Study, description: &Description) -> anyhow::Result<Checkpoint> {
        let new = || Checkpoint { description: description.clone(), ensemble: Ensemble::new(study, self.shard) };
        let Some(file) = self.checkpoint.as_deref().filter(|file| file.exists()) else { return Ok(new()) };
        if !self.resume {
            anyhow::ensure!(
                self.force,
                "{} exists already; --resume goes on with it, --force begins anew",
                file.display()
            );
            return Ok(new());
        }
        let known = Checkpoint::load(file)?;
        anyhow::ensure!(
            known.ensemble.is_of(study, self.shard),
            "{} is of another study or shard; say the same flags, seed and number of trials as before",
            file.display()
        );
        Ok(known)
    }

    fn save(&self, description: &Description, ensemble: &Ensemble) -> anyhow::Result<()> {
        self.checkpoint.as_deref().map_or(Ok(()), |file| Checkpoint::save(file, description, ensemble))
    }

    fn is_precise(&self, ensemble: &Ensemble) -> bool {
        let reached = ensemble.get(Metric::EMaxSys).map(Statistics::std_error);
        self.until_std_error.zip(reached).is_some_and(|(wanted, reached)| reached <= wanted)
    }
}

/// The most trials of a study that stops by precision.
const MOST_UNTIL: u64 = 1_000_000_000;

/// A length with its unit: m, mm or um.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let wrong = || "write a length with its unit, as in 0.1mm, 100um or 1e-4m".to_owned();
    let units = [("mm", 1e-3), ("um", 1e-6), ("m", 1.0)];
    let (number, factor) =
        units.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor))).ok_or_else(wrong)?;
    let value: f64 = number.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 && value.is_finite() { Ok(value * factor) } else { Err("must be positive and finite".to_owned()) }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (study, known) = arguments.study.resolve(arguments.trials(), session.seed())?;
    if arguments.sweep.is_asked_for() {
        let files = sweep::Files {
            checkpoint: arguments.checkpoint.as_deref(),
            every: arguments.checkpoint_every,
            resume: arguments.resume,
            force: arguments.force,
        };
        return sweep::run(&arguments.sweep, &study, &known.assumed, &files, session);
    }
    let description = describe(&study, &known)?;
    let mut checkpoint = arguments.checkpoint(&study, &description)?;
    let metrics = study.metrics();
    let mut out =
        arguments.out.as_deref().map(|file| TrialsFile::create(file, &metrics, arguments.force)).transpose()?;
    let (before, all) = (checkpoint.ensemble.trials(), arguments.shard.trials(study.trials));
    let mut progress = session.progress(all.end - all.start, "trials");
    let stop = session.catch_interrupt()?;
    let began = Instant::now();
    let mut precise = false;
    let mut failure = None;
    let Checkpoint { ensemble, .. } = &mut checkpoint;
    session.on_threads(|| {
        let mut saved = Instant::now();
        study.resume(ensemble, &stop, |batch| {
            progress.at(batch.ensemble.trials());
            let mut written = out.as_mut().map_or(Ok(()), |file| file.write(batch.first, batch.rows));
            if written.is_ok() && saved.elapsed().as_secs_f64() >= arguments.checkpoint_every {
                written = arguments.save(&description, batch.ensemble);
                saved = Instant::now();
            }
            precise = arguments.is_precise(batch.ensemble);
            failure = written.err();
            if failure.is_some() || precise { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })??;
    let seconds = began.elapsed().as_secs_f64();
    drop(progress);
    if let Some(error) = failure {
        return Err(error);
    }
    if let Some(file) = out {
        file.finish()?;
    }
    let ensemble = &checkpoint.ensemble;
    arguments.save(&description, ensemble)?;
    let partial = !precise && ensemble.trials() < all.end - all.start;
    if partial {
        session.message("partial", &format!("stopped after {} of {} trials", ensemble.trials(), all.end - all.start));
    } else if arguments.until_std_error.is_some() && !precise {
        session.message("warning", "all trials are done, and the standard error that was asked for is not reached");
    }
    let took = Some((seconds, ensemble.trials() - before));
    let report = Report { description: &description, ensemble, partial, took };
    if session.json() {
        session.print_json(&report.json())?;
    } else {
        let text = report.text(session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The file of `--out`: one row a trial.
struct TrialsFile {
    file: files::Pending,
    columns: Vec<usize>,
}

impl TrialsFile {
    fn create(path: &std::path::Path, metrics: &[Metric], force: bool) -> anyhow::Result<TrialsFile> {
        let mut file = files::Pending::create(path, force)?;
        let names: Vec<&str> = metrics.iter().map(|metric| metric.name()).collect();
        writeln!(file, "trial,{}", names.join(",")).with_context(|| file.failed())?;
        let columns = (0..Metric::COUNT).filter(|i| metrics.contains(&Metric::ALL[*i])).collect();
        Ok(TrialsFile { file, columns })
    }

    fn write(&mut self, first: u64, rows: &[Row]) -> anyhow::Result<()> {
        let mut text = String::new();
        for (trial, row) in (first..).zip(rows) {
            text.push_str(&trial.to_string());
            for column in &self.columns {
                text.push(',');
                text.push_str(&row[*column].to_string());
            }
            text.push('\n');
        }
        self.file.write_all(text.as_bytes()).with_context(|| self.file.failed())
    }

    fn finish(self) -> anyhow::Result<()> {
        self.file.finish()
    }
}

/// The study in words and numbers.
fn describe(study: &Study, known: &Known) -> anyhow::Result<Description> {
    let theory = Theory::of(study)?;
    let path = &study.path;
    let sizes = path.shape().parameters.iter().zip(path.values());
    let written: Vec<String> = sizes.map(|(p, v)| format!("{} {v}", p.name)).collect();
    let drawn = |effect: &str, parameter: &Parameter| {
        study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter.name)
    };
    let mut heading = vec![
        match study.runs {
            [cw, 0] => format!("{cw} cw runs, uni-directional"),
            [0, ccw] => format!("{ccw} ccw runs, uni-directional"),
            [cw, ccw] => format!("{cw} cw + {ccw} ccw runs"),
        },
        format!("{}, {} ({})", study.robot().name, path.shape().name.replace('_', "-"), written.join(", ")),
    ];
    for part in study.model.parts() {
        let name = part.effect.name();
        let mut words = Vec::new();
        for (parameter, value) in part.effect.parameters().iter().zip(&part.values) {
            let draw = drawn(name, parameter);
            words.push(format!("{} {}", parameter.name, value_text(parameter, *value, draw)));
        }
        heading.push(format!("  {name}: {}", words.join(", ")));
    }
    heading.extend(known.sources.iter().map(|source| format!("  from the paper: {source}")));
    heading.extend(known.assumed.iter().map(|assumption| format!("  assumed: {assumption}")));
    let told = document::Told { sources: &known.sources, assumed: &known.assumed, published: known.published };
    let document = document::study(study, &theory, &told);
    let published = known.published.map(|p| (p.row.to_owned(), p.e_max_sys, p.sigma));
    Ok(Description { heading, theory: in_words(&theory, study.runs), seed: study.seed, document, published })
}

/// What the test gives without noise.
fn in_words(theory: &Theory, runs: [usize; 2]) -> String {
    let subject = if runs.contains(&0) { "Driven both ways, E_max,sys" } else { "E_max,sys" };
    let mm = |value: Option<f64>| value.map(|v| format!("{:.1} mm", v * 1e3));
    match (mm(theory.exact), mm(theory.first_order)) {
        (Some(exact), Some(first)) => {
            format!("{subject} without noise: {exact} by exact kinematics, {first} to first order\n\n")
        }
        (Some(exact), None) => format!("{subject} without noise: {exact} by exact kinematics\n\n"),
        _ => String::new(),
    }
}

fn value_text(parameter: &Parameter, value: f64, draw: Option<&Draw>) -> String {
    match (parameter.choices.get(value as usize), draw.map(Draw::distribution)) {
        (Some(word), _) => (*word).to_owned(),
        (None, Some(distribution)) => distribution_words(&distribution),
        (None, None) => value.to_string(),
    }
}
