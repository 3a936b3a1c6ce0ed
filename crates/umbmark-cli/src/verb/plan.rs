//! `umbmark plan`: what a test would show before it is driven, and the sheet to drive it by.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{base_model, separating};
use umbmark_core::effect::CATALOGUE;
use umbmark_core::plan::{
    Measured, Options, Order, Planned, Protocol, Setting, Shown, Sought, alternatives, drifts, expected_dataset,
    extended_test, intervals, runs_needed,
};
use umbmark_core::score::score;
use umbmark_core::stats::Interval;

use crate::effect_flags::number;
use crate::files::Pending;
use crate::plan_report::{Answer, Known, Report, Row, Separation};
use crate::protocol_sheet;
use crate::session::Progress;
use crate::setup::{Directions, Setup, SetupFlags};
use crate::{Session, plan_report};

/// Numbers of runs a direction that documents tell of.
const RUNS: std::ops::RangeInclusive<usize> = 3..=30;

/// The order in which runs are driven.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum OrderKind {
    /// Clockwise and counter-clockwise in turn, every other pair the other way round
    Mirrored,
    /// Clockwise and counter-clockwise in turn
    Alternating,
    /// All clockwise runs first: the paper's order
    Blocks,
}

impl From<OrderKind> for Order {
    fn from(kind: OrderKind) -> Order {
        match kind {
            OrderKind::Mirrored => Order::Mirrored,
            OrderKind::Alternating => Order::Alternating,
            OrderKind::Blocks => Order::Blocks,
        }
    }
}

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Measured runs of the robot, whose errors and scatter are planned with, instead of the paper's LabMate
    #[arg(value_name = "DATA")]
    data: Option<PathBuf>,

    /// A size that is to be seen, as the flag of any effect or its name in files, as in eb=1.005 or slope-x=0.002
    #[arg(long, value_name = "SIZE=VALUE", value_parser = assignment)]
    see: Vec<(String, f64)>,

    /// Two effects that are to be told apart: ranks experiments by what they tell per minute
    #[arg(long, num_args = 2, value_names = ["EFFECT", "EFFECT"], value_parser = effect_names(), conflicts_with = "see")]
    separate: Vec<String>,

    /// Scatter of the return positions, one coordinate, as in 50mm [default: that of the robot's noise, or of DATA]
    #[arg(long, value_name = "LENGTH", value_parser = super::mc::length)]
    sigma: Option<f64>,

    /// Probability with which it is to be seen
    #[arg(long, default_value_t = 0.9, value_name = "P", value_parser = super::size)]
    power: f64,

    /// Probability with which a robot without it is accused all the same
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = super::size)]
    size: f64,

    /// Runs in each direction that are planned
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u16).range(3..=1000))]
    runs: u16,

    /// Return headings are not measured
    #[arg(long)]
    no_heading: bool,

    /// Simulated tests behind every figure that has no closed form
    #[arg(long, default_value_t = 999, value_name = "N", value_parser = clap::value_parser!(u32).range(99..=99_999))]
    draws: u32,

    /// Write the sheet to drive by: steps and the empty table, as text (.md) or to print on one page (.html)
    #[arg(short, long, value_name = "protocol.md")]
    output: Vec<PathBuf>,

    /// Order of the runs on the sheet
    #[arg(long, value_enum, default_value_t = OrderKind::Mirrored, value_name = "ORDER")]
    order: OrderKind,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    setup: SetupFlags,
}

/// Numbers of runs to look at, the wish to stop, and how far it is.
struct Looked<'a> {
    numbers: &'a [usize],
    stop: &'a AtomicBool,
    progress: &'a mut Progress,
}

/// "NAME=VALUE".
fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write SIZE=VALUE, as in eb=1.005")?;
    Ok((name.trim().trim_start_matches("--").to_owned(), number(value.trim())?))
}

fn effect_names() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(CATALOGUE.iter().map(|entry| entry.about.name))
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    anyhow::ensure!(
        arguments.setup.direction == Directions::Both,
        "runs in one direction have no E_max,sys and do not tell E_d from E_b; leave --direction out"
    );
    anyhow::ensure!(arguments.power > arguments.size, "--power must be greater than --size, {}", arguments.size);
    let options =
        Options { size: arguments.size, draws: arguments.draws as usize, seed: session.seed(), ..Options::default() };
    let data = arguments.data.as_ref().map(Dataset::load).transpose()?;
    let (setting, known) = session.on_threads(|| arguments.setting(data.as_ref(), session.seed()))??;
    let sheet = Protocol::new(&setting, usize::from(arguments.runs), arguments.order.into(), bumps(&setting));
    let written = arguments.write(&sheet)?;
    for file in &written {
        session.message("wrote", file);
    }
    if !arguments.separate.is_empty() {
        let separation = session.on_threads(|| arguments.separation(&setting, data.as_ref()))??;
        let (text, document) = (separation.text(), separation.json(&options));
        return answer(session, text, &document);
    }
    let stop = session.catch_interrupt()?;
    let numbers: Vec<usize> = if session.json() { RUNS.collect() } else { plan_report::PRINTED.to_vec() };
    let mut progress = session.progress(numbers.len() as u64 + 1, "numbers of runs");
    let mut looked = Looked { numbers: &numbers, stop: &stop, progress: &mut progress };
    let report = session.on_threads(|| arguments.report(&setting, known, &sheet, &options, &mut looked))??;
    drop(progress);
    if report.partial {
        session.message("partial", "stopped before all numbers of runs were looked at");
    }
    answer(session, plan_report::text(&report), &plan_report::document(&report))
}

fn answer(session: &mut Session, text: String, document: &serde_json::Value) -> anyhow::Result<ExitCode> {
    if session.json() {
        session.print_json(document)?;
    } else {
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Bumps of the planned test, where there are any.
fn bumps(setting: &Setting) -> f64 {
    setting.truth.get("placed_bumps", "count").unwrap_or(0.0)
}

impl Arguments {
    /// The robot on its path, and what is known of it.
    fn setting(&self, data: Option<&Dataset>, seed: u64) -> anyhow::Result<(Setting, Known)> {
        let mut sigma_interval = None;
        let (setup, with_heading) = match data {
            None => (self.setup.resolve()?, true),
            Some(data) => {
                let Measured { path, truth, with_heading } = Measured::new(data)?;
                let intervals = score(&data.runs, 0.95)?.intervals;
                sigma_interval = intervals.map(|i| i.sigma_axis).filter(|_| self.sigma.is_none());
                (self.setup.over(path, truth)?, with_heading)
            }
        };
        let Setup { path, mut model, draws, mut assumed, .. } = setup;
        anyhow::ensure!(draws.is_empty(), "one robot is planned for; leave --{}-sd out", draws[0].parameter().flag);
        if self.sigma.is_some() && model.get("wheel_noise", "k_sqrt_m").is_none_or(|k| k == 0.0) {
            model.set("wheel_noise", "k_sqrt_m", 1e-3)?;
            assumed.push("the runs scatter as those of evenly noisy wheels".to_owned());
        }
        let mut setting = Setting::new(&path, &model, seed)?.with_heading(with_heading && !self.no_heading);
        if let Some(sigma) = self.sigma {
            setting = setting.with_sigma(sigma);
        }
        Ok((setting, Known { assumed, from_data: data.is_some(), sigma_interval }))
    }

    /// Writes the sheets that were asked for.
    fn write(&self, sheet: &Protocol) -> anyhow::Result<Vec<String>> {
        let mut written = Vec::new();
        for file in &self.output {
            let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
            let text = match ending.as_str() {
                "html" | "htm" => protocol_sheet::html(sheet),
                "md" | "txt" => protocol_sheet::markdown(sheet),
                _ => anyhow::bail!("{}: a sheet ends in .md, .txt or .html", file.display()),
            };
            Pending::write_whole(file, self.force, &text).context("the sheet was not written")?;
            written.push(file.display().to_string());
        }
        Ok(written)
    }

    fn separation(&self, setting: &Setting, data: Option<&Dataset>) -> anyhow::Result<Separation> {
        let planned = expected_dataset(setting, usize::from(self.runs));
        let pair = [self.separate[0].as_str(), self.separate[1].as_str()];
        anyhow::ensure!(pair[0] != pair[1], "--separate needs two effects, got {} twice", pair[0]);
        let of = data.unwrap_or(&planned);
        let experiments = separating(of, &base_model(setting.robot())?, pair)?;
        let after = match data {
            Some(_) => "the data".to_owned(),
            None => format!("a test of {0} + {0} runs", self.runs),
        };
        Ok(Separation { pair: pair.map(str::to_owned), after, experiments })
    }

    fn report(
        &self,
        setting: &Setting,
        known: Known,
        sheet: &Protocol,
        options: &Options,
        looked: &mut Looked,
    ) -> anyhow::Result<Report> {
        let n = usize::from(self.runs);
        let planned = Planned::new(setting, n, options)?;
        let mut sought = Vec::new();
        for (name, value) in &self.see {
            sought.push(Sought::named(name, *value, setting.robot()).with_context(|| format!("--see {name}"))?);
        }
        let answers = sought
            .iter()
            .zip(&self.see)
            .map(|(sought, (_, value))| self.seen(setting, &planned, sought, *value, known.sigma_interval, options))
            .collect::<anyhow::Result<_>>()?;
        let sizes = planned.sizes();
        let rows = self.rows(setting, &sizes, options, looked)?;
        let partial = rows.len() < looked.numbers.len();
        let mut watched: Vec<Sought> = sizes.iter().take(2).copied().collect();
        let is_new = |s: &&Sought| watched.iter().all(|known| known.parameter.name != s.parameter.name);
        let others = sought.iter().filter(|s| matches!(planned.shown(s), Shown::Fitted(_) | Shown::Asked));
        let others: Vec<Sought> = others.filter(is_new).copied().collect();
        watched.extend(others);
        let bumps = Some(bumps(setting)).filter(|bumps| *bumps > 0.0).unwrap_or(10.0);
        let report = Report {
            summary: sheet.summary.clone(),
            alternatives: alternatives(setting, n, &watched, self.power, options)?,
            extended: if setting.with_heading { Some(extended_test(setting, n, bumps, options)?) } else { None },
            drifts: drifts(setting, n, &sizes[..sizes.len().min(2)])?,
            setting: setting.clone(),
            known,
            runs: n,
            power: self.power,
            options: *options,
            answers,
            unseen: planned.unseen().to_vec(),
            sizes,
            watched,
            rows,
            partial,
        };
        looked.progress.at(looked.numbers.len() as u64 + 1);
        Ok(report)
    }

    /// One size that is to be seen.
    fn seen(
        &self,
        setting: &Setting,
        planned: &Planned,
        sought: &Sought,
        value: f64,
        sigma: Option<Interval>,
        options: &Options,
    ) -> anyhow::Result<Answer> {
        let needed = |setting: &Setting| runs_needed(setting, sought, self.power, options);
        let runs = needed(setting)?;
        let at = |sigma: f64| needed(&setting.clone().with_sigma(sigma));
        let runs_at_sigma = match sigma {
            Some(sigma) => Some([at(sigma.low)?, at(sigma.high)?]),
            None => None,
        };
        let shown = planned.shown(sought);
        let separable = match &shown {
            Shown::Absorbed(by) => {
                let data = expected_dataset(setting, planned.runs);
                separating(&data, &base_model(setting.robot())?, [by[0], sought.effect.about.name])?
            }
            _ => Vec::new(),
        };
        Ok(Answer { sought: *sought, value, runs, runs_at_sigma, power: planned.power(sought), shown, separable })
    }

    /// What each number of runs shows; fewer where it was stopped.
    fn rows(
        &self,
        setting: &Setting,
        sizes: &[Sought],
        options: &Options,
        looked: &mut Looked,
    ) -> anyhow::Result<Vec<Row>> {
        let mut rows = Vec::new();
        for n in looked.numbers.iter().copied().take_while(|_| !looked.stop.load(Ordering::Relaxed)) {
            let planned = Planned::new(setting, n, options)?;
            let least = planned.least_of(sizes, self.power);
            let expected = intervals(setting, &[n], 1.0 - self.size, 2 * self.draws, options.seed);
            rows.extend(expected.first().map(|interval| Row { interval: *interval, least }));
            looked.progress.at(rows.len() as u64);
        }
        Ok(rows)
    }
}
