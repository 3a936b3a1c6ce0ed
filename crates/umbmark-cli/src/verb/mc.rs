//! `umbmark mc`: Monte Carlo of whole UMBmark tests.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context;
use umbmark_core::monte_carlo::{Ensemble, Metric, Row, Shard, Statistics, Study};
use umbmark_core::result::{self, NoiseFree, Told};
use umbmark_io::checkpoint::{Keeper, Written};

use crate::checkpoint_flags::{CheckpointFlags, with_remedy};
use crate::ensemble_report::Report;
use crate::study_flags::{Known, StudyFlags};
use crate::sweep::{self, SweepFlags};
use crate::{Session, files};

/// Arguments of `mc`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Trials: whole tests, each with all its runs [default: 1000; with --until-std-error as many as needed]
    #[arg(short = 'n', long, value_name = "N", value_parser = crate::numbers::whole)]
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

    #[command(flatten)]
    checkpoint: CheckpointFlags,

    /// Run the I-th of K shards; `umbmark merge` combines them
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
    let checkpoint = arguments.checkpoint.checkpoint(arguments.force)?;
    if arguments.sweep.is_asked_for() {
        let files = sweep::Files { checkpoint: checkpoint.as_ref(), force: arguments.force };
        return sweep::run(&arguments.sweep, &study, &known.assumed, &files, session);
    }
    let told = describe(&study, &known)?;
    let mut keeper = Keeper::of(checkpoint.as_ref())?;
    let mut written = match &checkpoint {
        Some(checkpoint) => checkpoint.begin(&study, arguments.shard, &told).map_err(with_remedy)?,
        None => Written { seed: study.seed, study: told, ensemble: Ensemble::new(&study, arguments.shard) },
    };
    let metrics = study.metrics();
    let mut out =
        arguments.out.as_deref().map(|file| TrialsFile::create(file, &metrics, arguments.force)).transpose()?;
    let (before, all) = (written.ensemble.trials(), arguments.shard.trials(study.trials));
    let mut progress = session.progress(all.end - all.start, "trials");
    let stop = session.catch_interrupt();
    let began = Instant::now();
    let mut precise = false;
    let mut failure = None;
    let Written { seed, study: told, ensemble } = &mut written;
    session.on_threads(|| {
        study.resume(ensemble, &stop, |batch| {
            progress.at(batch.ensemble.trials());
            let kept = out.as_mut().map_or(Ok(()), |file| file.write(batch.first, batch.rows));
            let kept = kept.and_then(|()| Ok(keeper.look(*seed, told, batch.ensemble)?));
            precise = arguments.is_precise(batch.ensemble);
            failure = kept.err();
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
    keeper.keep(*seed, told, ensemble)?;
    let partial = !precise && ensemble.trials() < all.end - all.start;
    if partial {
        session.message("partial", &format!("stopped after {} of {} trials", ensemble.trials(), all.end - all.start));
    } else if arguments.until_std_error.is_some() && !precise {
        session.message("warning", "all trials are done, but the requested standard error is not reached");
    }
    let took = Some((seconds, ensemble.trials() - before));
    let report = Report { study: told, seed: *seed, ensemble, partial, took };
    if session.json() {
        session.print_json(&report.result())?;
    } else {
        let text = report.text(session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The file of `--out`: one row a trial.
struct TrialsFile {
    rows: csv::Writer<files::Pending>,
    columns: Vec<usize>,
}

impl TrialsFile {
    fn create(path: &std::path::Path, metrics: &[Metric], force: bool) -> anyhow::Result<TrialsFile> {
        let mut rows = csv::Writer::from_writer(files::Pending::create(path, force)?);
        let names = ["trial"].into_iter().chain(metrics.iter().map(|metric| metric.name()));
        rows.write_record(names).with_context(|| rows.get_ref().failed())?;
        let columns = (0..Metric::COUNT).filter(|i| metrics.contains(&Metric::ALL[*i])).collect();
        Ok(TrialsFile { rows, columns })
    }

    fn write(&mut self, first: u64, rows: &[Row]) -> anyhow::Result<()> {
        for (trial, row) in (first..).zip(rows) {
            let values = self.columns.iter().map(|column| row[*column].to_string());
            let written = self.rows.write_record([trial.to_string()].into_iter().chain(values));
            written.with_context(|| self.rows.get_ref().failed())?;
        }
        Ok(())
    }

    fn finish(self) -> anyhow::Result<()> {
        self.rows.into_inner()?.finish()
    }
}

/// What the study is.
fn describe(study: &Study, known: &Known) -> anyhow::Result<result::Study> {
    let told = Told { sources: &known.sources, assumed: &known.assumed, published: known.published };
    Ok(result::Study::new(study, &NoiseFree::of(study)?, &told))
}
