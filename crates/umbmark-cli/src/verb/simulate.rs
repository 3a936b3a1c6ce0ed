//! `umbmark simulate`: one test, written as a dataset.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};
use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::drive::{Encoder, Robot};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::engine::Update;
use umbmark_core::monte_carlo::draw_parameters;
use umbmark_core::path::{Direction, Path};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

use crate::Session;
use crate::output_arguments::{OutputArguments, layouts};
use crate::setup::{Directions, Setup, SetupFlags};
use crate::table::table;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
#[command(after_help = layouts())]
pub struct Arguments {
    #[command(flatten)]
    output: OutputArguments,

    /// Runs in each direction [default: 5, and 1 for NAME.mcap]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: Option<u32>,

    /// How often the absolute pose is measured on the way; 0 for the end pose alone
    #[arg(long, default_value_t = 20.0, value_name = "HZ", value_parser = crate::effect_flags::number)]
    reference_rate: f64,

    #[command(flatten)]
    setup: SetupFlags,
}

impl Arguments {
    /// Whether one log is to be written, and no folder.
    fn is_log(&self) -> bool {
        self.output.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
    }

    /// Numbers of runs \[cw, ccw\]; a log holds one, counter-clockwise where nothing else is said.
    fn numbers(&self) -> anyhow::Result<[usize; 2]> {
        let direction = self.setup.direction;
        if !self.is_log() {
            return Ok(direction.runs(self.runs.unwrap_or(5) as usize));
        }
        if let Some(runs @ 2..) = self.runs {
            anyhow::bail!("an MCAP log holds one run, got --runs {runs}; leave it out, or name a folder");
        }
        let direction = if direction == Directions::Both { Directions::Ccw } else { direction };
        Ok(direction.runs(1))
    }
}

/// How often the counters are written down where the robot file does not say \[Hz\].
const LOG_RATE: f64 = 100.0;

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let Setup { path, model, draws, assumed, .. } = arguments.setup.resolve()?;
    let model = draw_parameters(&model, &draws, session.seed(), 0)?;
    let robot = with_rate(model.robot())?;
    let dataset = record(&arguments, &robot, &path, &model, session.seed())?;
    let lost = arguments.output.write(&dataset)?;
    for text in &assumed {
        session.message("assumed", text);
    }
    for text in &lost {
        session.message("lost", text);
    }
    if session.json() {
        let runs: Vec<Value> = dataset.runs.iter().map(run_json).collect();
        session.print_json(&json!({
            "output": arguments.output.output.display().to_string(),
            "layout": arguments.output.layout().name,
            "lost": lost,
            "seed": session.seed(),
            "runs": runs,
            "version": umbmark_core::VERSION,
        }))?;
        return Ok(ExitCode::SUCCESS);
    }
    let rows = dataset.runs.iter().filter_map(|run| {
        let error = run.returned?;
        let heading = error.heading.map_or("-".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        Some(vec![run.name.clone(), format!("{:.1}", error.x * 1e3), format!("{:.1}", error.y * 1e3), heading])
    });
    let text = table(&["run", "ex [mm]", "ey [mm]", "etheta [deg]"], rows);
    let count = dataset.runs.len();
    let place = arguments.output.output.display();
    writeln!(session.out(), "{text}\n")?;
    let seed = session.seed();
    writeln!(session.out(), "{count} runs of {} in {place}, seed {seed}", robot.name)?;
    Ok(ExitCode::SUCCESS)
}

/// The robot with a sampling rate, which a log needs.
fn with_rate(robot: &Robot) -> anyhow::Result<Robot> {
    let encoder = &robot.encoder;
    let rate = encoder.rate().unwrap_or(LOG_RATE);
    let encoder = Encoder::new(encoder.ticks_per_revolution(), Some(rate), encoder.counter_bits())?;
    Ok(Robot { encoder, ..robot.clone() })
}

fn record(arguments: &Arguments, robot: &Robot, path: &Path, model: &Model, seed: u64) -> anyhow::Result<Dataset> {
    let rate = robot.encoder.rate().unwrap_or(LOG_RATE);
    let odometry = Odometry::Sampled { rate, update: Update::Arc };
    let mut simulator = Simulator::new(robot, path, odometry, Phase::Random)?;
    let mut truth = Truth::new(model);
    simulator.open(&mut truth, seed, 0);
    let extended = model.get("placed_bumps", "count").is_some_and(|count| count > 0.0);
    let tests = match (extended, arguments.is_log()) {
        (true, false) => &[TestKind::Systematic, TestKind::Bumps][..],
        (true, true) => &[TestKind::Bumps],
        (false, _) => &[TestKind::Systematic],
    };
    let mut runs = Vec::new();
    let numbers = arguments.numbers()?;
    for &test in tests {
        for (direction, count) in Direction::BOTH.into_iter().zip(numbers) {
            for number in 1..=count as u32 {
                let reference = if arguments.reference_rate > 0.0 { arguments.reference_rate } else { rate };
                let mut recording = simulator.record(&mut truth, direction, test, [rate, reference])?;
                if arguments.reference_rate <= 0.0 {
                    let last = recording.log.reference.len() - 1;
                    recording.log.reference.drain(..last);
                }
                let prefix = if test == TestKind::Bumps { "bumps_" } else { "" };
                runs.push(Run {
                    name: format!("{prefix}{}_{number:02}", direction.name()),
                    number,
                    direction: Some(direction),
                    test,
                    log: Some(recording.log),
                    returned: Some(recording.returned),
                });
            }
        }
    }
    Ok(Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() })
}

fn run_json(run: &Run) -> Value {
    let error = run.returned.unwrap_or_default();
    json!({
        "run": run.name, "direction": run.direction.map(Direction::name), "test": run.test.name(),
        "ex_m": error.x, "ey_m": error.y, "etheta_rad": error.heading,
    })
}
