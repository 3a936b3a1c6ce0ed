//! `umbmark plan`: what a test would show before it is driven, and the sheet to drive it by.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{first_model, separating};
use umbmark_core::effect::CATALOGUE;
use umbmark_core::plan::{Measured, Options, Order, Protocol, Request, Setting, Sought, expected_dataset};
use umbmark_core::result;
use umbmark_core::stats::Interval;

use crate::files::Pending;
use crate::numbers::number;
use crate::plan_report::{Known, Report, Separation};
use crate::setup::{Directions, Setup, SetupFlags};
use crate::words::ACTIONS;
use crate::{Session, plan_report};

/// Numbers of runs a direction that results tell of.
const RUNS: std::ops::RangeInclusive<usize> = 3..=30;

/// The order in which runs are driven.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum OrderKind {
    /// Clockwise and counter-clockwise in turn, every second pair in reverse order
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
    /// Measured runs of the robot: plan with its errors and scatter instead of those of the paper's LabMate
    #[arg(value_name = "DATA")]
    data: Option<PathBuf>,

    /// A size to detect, by the flag of any effect or its name in files: eb=1.005 or slope-x=0.002
    #[arg(long, value_name = "SIZE=VALUE", value_parser = assignment)]
    see: Vec<(String, f64)>,

    /// Two effects to separate: ranks experiments by their information per minute
    #[arg(long, num_args = 2, value_names = ["EFFECT", "EFFECT"], value_parser = effect_names(),
          conflicts_with = "see")]
    separate: Vec<String>,

    /// Scatter of the return positions, one coordinate, as in 50mm [default: that of the robot's noise, or of DATA]
    #[arg(long, value_name = "LENGTH", value_parser = super::mc::length)]
    sigma: Option<f64>,

    /// Probability with which the size is detected
    #[arg(long, default_value_t = 0.9, value_name = "P", value_parser = crate::numbers::probability)]
    power: f64,

    /// False-alarm rate: probability of detecting an effect that the robot does not have
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = crate::numbers::probability)]
    size: f64,

    /// Planned runs in each direction
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = crate::numbers::whole_in::<u16>(3..=1000))]
    runs: u16,

    /// Return headings are not measured
    #[arg(long)]
    no_heading: bool,

    /// Simulated tests for each figure that has no closed form
    #[arg(long, default_value_t = 999, value_name = "N", value_parser = crate::numbers::whole_in::<u32>(99..=99_999))]
    draws: u32,

    /// Write the protocol: steps and an empty table, as text (.md) or to print on one page (.html)
    #[arg(short, long, value_name = "protocol.md")]
    output: Vec<PathBuf>,

    /// Order of the runs in the protocol
    #[arg(long, value_enum, default_value_t = OrderKind::Mirrored, value_name = "ORDER")]
    order: OrderKind,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    setup: SetupFlags,
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
        "runs in one direction have no E_max,sys and cannot separate E_d from E_b; remove --direction"
    );
    anyhow::ensure!(arguments.power > arguments.size, "--power must be greater than --size, {}", arguments.size);
    let options =
        Options { size: arguments.size, draws: arguments.draws as usize, seed: session.seed(), ..Options::default() };
    let data = arguments.data.as_ref().map(umbmark_io::load).transpose()?;
    if !arguments.separate.is_empty() {
        if !arguments.output.is_empty() {
            let (setting, ..) = session.on_threads(|| arguments.setting(data.as_ref(), session.seed()))??;
            arguments.write(&arguments.sheet(&setting), session)?;
        }
        let separation = session.on_threads(|| arguments.separation(data.as_ref(), session.seed()))??;
        let [a, b] = &separation.pair;
        let found = result::Separation::new([a, b], &separation.after, &separation.experiments, &options);
        return answer(session, separation.text(), &found);
    }
    let (setting, known, sigma_interval) =
        session.on_threads(|| arguments.setting(data.as_ref(), session.seed()))??;
    let sheet = arguments.sheet(&setting);
    arguments.write(&sheet, session)?;
    let see = arguments.sought(&setting)?;
    let numbers: Vec<usize> = if session.json() { RUNS.collect() } else { plan_report::PRINTED.to_vec() };
    let (runs, power) = (usize::from(arguments.runs), arguments.power);
    let request = Request { runs, see: &see, power, numbers: &numbers, sigma_interval, options };
    let findings = session.watched("%", |watch| request.findings(&setting, watch))??;
    if findings.partial {
        session.message("partial", "stopped before all results were computed");
    }
    let report =
        Report { summary: &sheet.summary, setting: &setting, known: &known, request: &request, findings: &findings };
    let found = result::Plan::new(&setting, &request, &findings, &known.assumed);
    answer(session, plan_report::text(&report), &found)
}

fn answer(session: &mut Session, text: String, found: &impl serde::Serialize) -> anyhow::Result<ExitCode> {
    if session.json() {
        session.print_json(found)?;
    } else {
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// The robot on its path, and what is known of it.
    fn setting(&self, data: Option<&Dataset>, seed: u64) -> anyhow::Result<(Setting, Known, Option<Interval>)> {
        let (setup, with_heading, sigma_interval) = match data {
            None => (self.setup.resolve()?, true, None),
            Some(data) => {
                let Measured { path, truth, with_heading, sigma_interval } = Measured::new(data)?;
                let expected = sigma_interval.filter(|_| self.sigma.is_none());
                (self.setup.over(path, truth)?, with_heading, expected)
            }
        };
        let Setup { path, model, draws, mut assumed, .. } = setup;
        anyhow::ensure!(draws.is_empty(), "a plan is for one robot; remove --{}-sd", draws[0].parameter().flag);
        let (setting, more) = Setting::expecting(&path, &model, self.sigma, seed)?;
        assumed.extend(more.map(str::to_owned));
        let setting = setting.with_heading(with_heading && !self.no_heading);
        Ok((setting, Known { assumed, from_data: data.is_some() }, sigma_interval))
    }

    /// The sheet of the planned test.
    fn sheet(&self, setting: &Setting) -> Protocol {
        Protocol::new(setting, usize::from(self.runs), self.order.into(), setting.bumps(), ACTIONS)
    }

    /// Writes the sheets that were asked for.
    fn write(&self, sheet: &Protocol, session: &Session) -> anyhow::Result<()> {
        for file in &self.output {
            let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
            let text = match ending.as_str() {
                "html" | "htm" => sheet.html(),
                "md" | "txt" => sheet.markdown(),
                _ => anyhow::bail!("{}: the name of a protocol ends in .md, .txt or .html", file.display()),
            };
            Pending::write_whole(file, self.force, &text).context("the protocol was not written")?;
            session.message("wrote", &file.display().to_string());
        }
        Ok(())
    }

    /// Experiments that tell two effects apart, together with the data or a planned test.
    fn separation(&self, data: Option<&Dataset>, seed: u64) -> anyhow::Result<Separation> {
        let pair = [self.separate[0].as_str(), self.separate[1].as_str()];
        anyhow::ensure!(pair[0] != pair[1], "--separate needs two effects, got {} twice", pair[0]);
        let (of, after) = match data {
            Some(data) => (data.clone(), "the data".to_owned()),
            None => {
                let (setting, ..) = self.setting(None, seed)?;
                let planned = expected_dataset(&setting, usize::from(self.runs));
                (planned, format!("a test of {0} + {0} runs", self.runs))
            }
        };
        let experiments = separating(&of, &first_model(&of)?, pair)?;
        Ok(Separation { pair: pair.map(str::to_owned), after, experiments })
    }

    /// What is to be seen.
    fn sought(&self, setting: &Setting) -> anyhow::Result<Vec<(Sought, f64)>> {
        let one = |(name, value): &(String, f64)| -> anyhow::Result<(Sought, f64)> {
            let sought = Sought::named(name, *value, setting.robot()).with_context(|| format!("--see {name}"))?;
            Ok((sought, *value))
        };
        self.see.iter().map(one).collect()
    }
}
