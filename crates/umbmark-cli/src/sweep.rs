//! `mc --sweep`: ensembles over a grid of values, as a tidy table and a map.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use umbmark_core::monte_carlo::{Axis, Metric, MetricSummary, Quantity, Study, Sweep, SweepPoint};
use umbmark_core::prose::counted;
use umbmark_core::result;
use umbmark_io::checkpoint::{Checkpoint, Keeper};

use crate::Session;
use crate::checkpoint_flags::with_remedy;
use crate::ensemble_report::{title, unit};
use crate::files::Pending;
use crate::heat_map::HeatMap;
use crate::numbers::number;
use crate::table::{table, with_precision_of};

/// The flags of a sweep.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Sweeps")]
pub struct SweepFlags {
    /// Repeat the study for equally spaced values of a parameter, by the name of its flag: ed=1.000:1.004:41; with more than
    /// one, on a grid. Trial i has the same noise at every point
    #[arg(long, value_name = "NAME=FIRST:LAST:COUNT", value_parser = given,
          conflicts_with_all = ["out", "until_std_error", "shard"])]
    sweep: Vec<Given>,

    /// Write the table of a sweep to a CSV file, one row a point
    #[arg(short = 'o', long, value_name = "sweep.csv", requires = "sweep")]
    output: Option<PathBuf>,

    /// The metric that a sweep's table and map show
    #[arg(long, value_name = "METRIC", requires = "sweep", default_value = "e_max_sys_m")]
    metric: String,
}

#[derive(Clone, Debug)]
struct Given {
    name: String,
    first: f64,
    last: f64,
    count: u64,
}

fn given(text: &str) -> Result<Given, String> {
    let wrong = || "write NAME=FIRST:LAST:COUNT, as in ed=1.000:1.004:41".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(wrong)?;
    let words: Vec<&str> = rest.split(':').collect();
    let [first, last, count] = words.as_slice() else { return Err(wrong()) };
    let (first, last) = (number(first)?, number(last)?);
    Ok(Given { name: name.to_owned(), first, last, count: count.parse().map_err(|_| wrong())? })
}

/// Where a sweep is saved, and what may be replaced.
#[derive(Debug)]
pub struct Files<'a> {
    /// What `--checkpoint` says.
    pub checkpoint: Option<&'a Checkpoint>,
    /// Whether files may be replaced.
    pub force: bool,
}

impl SweepFlags {
    /// Whether a sweep is asked for.
    pub fn is_asked_for(&self) -> bool {
        !self.sweep.is_empty()
    }

    fn resolve(&self, study: &Study) -> anyhow::Result<Sweep> {
        let axis = |given: &Given| -> anyhow::Result<Axis> {
            let quantity = Quantity::find(&given.name, study).context("--sweep")?;
            Ok(Axis { quantity, first: given.first, last: given.last, count: given.count })
        };
        let axes: Vec<Axis> = self.sweep.iter().map(axis).collect::<Result<_, _>>()?;
        Sweep::new(study, &axes).context("--sweep")
    }

    fn metric(&self) -> anyhow::Result<Metric> {
        Ok(Metric::named(&self.metric)?)
    }
}

/// Runs a sweep and tells of it.
pub fn run(
    flags: &SweepFlags,
    study: &Study,
    assumed: &[String],
    files: &Files,
    session: &mut Session,
) -> anyhow::Result<ExitCode> {
    let (sweep, metric) = (flags.resolve(study)?, flags.metric()?);
    let output = flags.output.as_deref().map(|file| Pending::create(file, files.force)).transpose()?;
    let mut keeper = Keeper::of(files.checkpoint)?;
    let begin = |checkpoint: &Checkpoint| checkpoint.begin_sweep(&sweep).map_err(with_remedy);
    let mut points = files.checkpoint.map(begin).transpose()?.unwrap_or_default();
    let mut progress = session.progress(sweep.points(), "points");
    let stop = session.catch_interrupt();
    let mut failure = None;
    session.on_threads(|| {
        sweep.run(points.len() as u64, &stop, |more| {
            points.extend(more);
            progress.at(points.len() as u64);
            failure = keeper.look_at(&sweep, &points).err();
            if failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })??;
    drop(progress);
    if let Some(error) = failure {
        return Err(error.into());
    }
    keeper.keep_points(&sweep, &points)?;
    if let Some(mut file) = output {
        file.write_all(&csv(&sweep, &points)?).with_context(|| file.failed())?;
        file.finish()?;
    }
    let count = points.len() as u64;
    if count < sweep.points() {
        session.message("partial", &format!("stopped after {count} of {} points", sweep.points()));
    }
    let report = SweepReport { sweep: &sweep, points: &points, metric, assumed };
    if session.json() {
        session.print_json(&result::Sweep::new(&sweep, &points, assumed))?;
    } else {
        let terminal = session.on_terminal();
        write!(session.out(), "{}", report.text(terminal))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// One row a point: the values of the axes, then of every metric its mean, standard deviation, standard error and quantiles.
fn csv(sweep: &Sweep, points: &[SweepPoint]) -> anyhow::Result<Vec<u8>> {
    let mut header: Vec<String> = sweep.axes().iter().map(|axis| axis.quantity.key()).collect();
    header.push("trials".to_owned());
    for summary in points.first().map_or(&[][..], |point| &point.metrics) {
        let of = |what: &str| format!("{}.{what}", summary.metric);
        header.extend(["mean", "std_dev", "std_error"].map(of));
        header.extend(SweepPoint::QUANTILES.map(|q| of(&format!("q{q}"))));
    }
    let cell = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for point in points {
        let mut cells: Vec<String> = point.values.iter().map(f64::to_string).collect();
        cells.push(sweep.study().trials.to_string());
        for s in &point.metrics {
            cells.extend([s.mean, s.std_dev, s.std_error].into_iter().chain(s.quantiles).map(cell));
        }
        writer.write_record(cells)?;
    }
    Ok(writer.into_inner()?)
}

/// What was asked and found.
#[derive(Debug)]
pub struct SweepReport<'a> {
    /// The grid.
    pub sweep: &'a Sweep,
    /// Its points that are done.
    pub points: &'a [SweepPoint],
    /// The metric that people see.
    pub metric: Metric,
    /// What was assumed.
    pub assumed: &'a [String],
}

/// The most rows of a table for people.
const ROWS: usize = 60;

impl SweepReport<'_> {
    /// A table of few points, a map over two axes.
    pub fn text(&self, terminal: bool) -> String {
        let (axes, study) = (self.sweep.axes(), self.sweep.study());
        let count = self.points.len();
        let mut text = format!(
            "Sweep of UMBmark: {} of {} trials, {}, {}\n",
            counted(count, "point"),
            study.trials,
            study.robot().name,
            study.path.shape().name.replace('_', "-")
        );
        self.assumed.iter().for_each(|assumption| text += &format!("  assumed: {assumption}\n"));
        text.push('\n');
        if axes.len() == 2 {
            text += &self.map(terminal);
        }
        if axes.len() != 2 || count <= ROWS {
            text += &self.table();
        }
        if count > ROWS && axes.len() != 2 {
            text += &format!("... {}; -o sweep.csv writes all of them\n", counted(count - ROWS, "more point"));
        }
        let partial = if (count as u64) < self.sweep.points() { ", PARTIAL: not all points were done" } else { "" };
        text + &format!("\nseed {}, umbmark {}{partial}\n", study.seed, umbmark_core::VERSION)
    }

    fn summary<'a>(&self, point: &'a SweepPoint) -> Option<&'a MetricSummary> {
        point.metric(self.metric.name())
    }

    fn table(&self) -> String {
        let (unit, factor) = unit(self.metric);
        let mut header: Vec<&str> = self.sweep.axes().iter().map(|axis| axis.quantity.parameter().flag).collect();
        let name = format!("{} [{unit}]", title(self.metric));
        header.extend([name.as_str(), "std error", "std dev", "5 %", "95 %"]);
        let rows = self.points.iter().take(ROWS).map(|point| {
            let mut row: Vec<String> = point.values.iter().map(|value| rounded(*value)).collect();
            let summary = self.summary(point);
            let error = summary.and_then(|s| s.std_error).unwrap_or(f64::NAN) * factor;
            let cell = |value: Option<f64>| with_precision_of(value.unwrap_or(f64::NAN) * factor, error);
            let of = |pick: fn(&MetricSummary) -> Option<f64>| cell(summary.and_then(pick));
            row.extend([of(|s| s.mean), of(|s| s.std_error), of(|s| s.std_dev)]);
            row.extend([of(|s| s.quantiles[0]), of(|s| s.quantiles[4])]);
            row
        });
        table(&header, rows) + "\n"
    }

    /// The mean over both axes: the first one upwards, the second to the right.
    fn map(&self, terminal: bool) -> String {
        let [up, right] = self.sweep.axes() else { return String::new() };
        let (unit, factor) = unit(self.metric);
        let mean = |point: &SweepPoint| self.summary(point).and_then(|s| s.mean).map(|mean| mean * factor);
        let values: Vec<Option<f64>> = self.points.iter().map(mean).collect();
        let row = |i: u64| {
            let place = |j: u64| values.get((i * right.count + j) as usize).copied().flatten();
            (0..right.count).map(place).collect::<Vec<Option<f64>>>()
        };
        let rows: Vec<Vec<Option<f64>>> = (0..up.count).rev().map(row).collect();
        let label = |axis: &Axis, value: f64| format!("{} {}", axis.quantity.parameter().flag, rounded(value));
        let map = HeatMap {
            rows: &rows,
            columns: [label(right, right.first), rounded(right.last)],
            sides: [label(up, up.last), label(up, up.first)],
            terminal,
        };
        let known = || values.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?)));
        let (Some(least), Some(most)) = (known().min_by(by_value), known().max_by(by_value)) else {
            return format!("{} is not a metric of this test\n", title(self.metric));
        };
        let place = |(index, value): (usize, f64)| {
            let at = self.points[index].values.iter().map(|v| rounded(*v)).collect::<Vec<_>>().join(", ");
            format!("{value:.1} {unit} at ({at})")
        };
        format!("mean {}, from {} to {}\n\n{}\n", title(self.metric), place(least), place(most), map.text())
    }
}

fn by_value(a: &(usize, f64), b: &(usize, f64)) -> std::cmp::Ordering {
    a.1.total_cmp(&b.1)
}

/// A value of an axis without the noise of its last digits.
fn rounded(value: f64) -> String {
    let text = format!("{value:.9}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
