//! `umbmark sensitivity`: which parameter drives which metric.

use std::io::Write;
use std::process::ExitCode;

use umbmark_core::monte_carlo::Metric;
use umbmark_core::result::Found;
use umbmark_core::sensitivity::{Inputs, Noise, SobolOptions, Tests, local_derivatives, screen, sobol_indices};

use crate::Session;
use crate::sensitivity_report::SensitivityReport;
use crate::study_flags::StudyFlags;
use crate::vary::VaryFlags;

/// How sensitivities are found.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum Method {
    /// Shares of the variance: Sobol indices, alone and with others
    Sobol,
    /// Which parameters matter at all: Morris screening
    Morris,
    /// What a small change does: derivatives at the medians
    Local,
}

/// Arguments of `sensitivity`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// How: shares of the variance, a first screening, or derivatives
    #[arg(long, value_enum, default_value_t = Method::Sobol, value_name = "HOW")]
    method: Method,

    /// Base points of Sobol indices, a power of two; each costs one test a parameter and three more
    #[arg(short = 'n', long, value_name = "N", default_value_t = 4096, value_parser = crate::numbers::whole)]
    base_points: u64,

    /// Sobol indices of pairs of parameters too, for about twice the tests
    #[arg(long)]
    second_order: bool,

    /// Trajectories of Morris screening; each costs one test a parameter and two more
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = crate::numbers::whole)]
    trajectories: u64,

    /// Tests on each side of the medians for derivatives
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = crate::numbers::whole)]
    trials: u64,

    /// Compute exact kinematics, without noise, bumps and quantisation, instead of whole tests
    #[arg(long)]
    noise_free: bool,

    /// The metric that is shown in full; the document has all of them
    #[arg(long, value_name = "METRIC", default_value = "e_max_sys_m")]
    metric: String,

    #[command(flatten)]
    vary: VaryFlags,

    #[command(flatten)]
    study: StudyFlags,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (study, known) = arguments.study.resolve(arguments.trials, session.seed())?;
    let metric = Metric::named(&arguments.metric)?;
    let varied = arguments.vary.resolve(&study)?;
    let noise = if arguments.noise_free { Noise::Absent } else { Noise::Simulated };
    let tests = Tests::new(&study, &varied.parameters, noise)?;
    anyhow::ensure!(tests.metrics().contains(&metric), "{} is not a metric of these tests", metric.name());
    let inputs = Inputs::new(Tests::inputs(&varied.parameters), &varied.correlations)?;
    let found = find(&arguments, &tests, &inputs, session)?;
    let report = SensitivityReport {
        found: &found,
        parameters: &varied.parameters,
        correlations: &varied.correlations,
        metrics: tests.metrics(),
        metric,
        study: tests.study(),
        noisy: noise == Noise::Simulated,
        assumed: &known.assumed,
        unicode: session.on_terminal(),
    };
    if report.is_partial() {
        session.message("partial", "stopped before all requested tests were done");
    }
    if session.json() {
        session.print_json(&report.result())?;
    } else {
        write!(session.out(), "{}", report.text())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn find(arguments: &Arguments, tests: &Tests, inputs: &Inputs, session: &Session) -> anyhow::Result<Found> {
    let Arguments { method, base_points, second_order, trajectories, trials, .. } = *arguments;
    let seed = session.seed();
    let options = SobolOptions { base_points, second_order, seed };
    Ok(session.watched("%", |watch| match method {
        Method::Sobol => sobol_indices(tests, inputs, &options, watch).map(Found::Sobol),
        Method::Morris => screen(tests, inputs, trajectories, seed, watch).map(Found::Morris),
        Method::Local => local_derivatives(tests, inputs, trials, watch).map(Found::Local),
    })??)
}
