//! The verbs, one file each.

mod calibrate;
mod compare;
mod completions;
mod convert;
mod diagnose;
mod effects;
mod fit;
mod init;
mod inspect;
mod learn;
mod mc;
mod merge;
mod paper;
mod plan;
mod plot;
mod report;
mod score;
mod sensitivity;
mod simulate;
mod tolerance;

use std::process::ExitCode;

use crate::Session;

/// What the command can do.
#[derive(Debug, clap::Subcommand)]
pub enum Verb {
    /// Monte Carlo: simulate whole UMBmark tests by the thousand
    Mc(Box<mc::Arguments>),
    /// Merge shards or checkpoints of mc into one result
    Merge(merge::Arguments),
    /// Simulate one test and write it as a dataset
    Simulate(Box<simulate::Arguments>),
    /// Repeat the paper's experiments, beside its numbers
    Paper(paper::Arguments),
    /// Score a measured test: E_max,sys, centroids, sigma, extended test
    Score(score::Arguments),
    /// Calibrate a measured robot: E_d, E_b, E_s, and files to put them to use
    Calibrate(calibrate::Arguments),
    /// Hold models against a measured robot: what is explained, what not, in which direction
    Compare(compare::Arguments),
    /// Find which class of effects a model is missing, and what to measure next
    Diagnose(diagnose::Arguments),
    /// Plan a test: how many runs, what they would show, and the sheet to drive by
    Plan(Box<plan::Arguments>),
    /// Fit the free effects of a model
    Fit(fit::Arguments),
    /// Learn a model: fit, diagnose, add, until nothing is missing
    Learn(learn::Arguments),
    /// Which parameter drives which metric: Sobol indices, Morris screening, derivatives
    Sensitivity(Box<sensitivity::Arguments>),
    /// How many robots are good enough, and the cheapest tolerances that make it enough
    Tolerance(Box<tolerance::Arguments>),
    /// Put everything on one page: a report to send
    Report(report::Arguments),
    /// Draw one figure as SVG, PNG or PDF
    Plot(plot::Arguments),
    /// Look at a dataset: what it holds, whether it is any good, what it can determine
    Inspect(inspect::Arguments),
    /// Write a dataset in another layout; sets clocks that disagree by the motion
    Convert(convert::Arguments),
    /// Write a robot.toml and a returns.csv to fill in
    Init(init::Arguments),
    /// List the effects that make a robot err, or explain one
    Effects(effects::Arguments),
    /// Print shell completions or the manual page
    Completions(completions::Arguments),
}

impl Verb {
    pub(crate) fn run(self, session: &mut Session) -> anyhow::Result<ExitCode> {
        match self {
            Verb::Mc(arguments) => mc::run(*arguments, session),
            Verb::Merge(arguments) => merge::run(arguments, session),
            Verb::Simulate(arguments) => simulate::run(*arguments, session),
            Verb::Paper(arguments) => paper::run(arguments, session),
            Verb::Score(arguments) => score::run(arguments, session),
            Verb::Calibrate(arguments) => calibrate::run(arguments, session),
            Verb::Compare(arguments) => compare::run(arguments, session),
            Verb::Diagnose(arguments) => diagnose::run(arguments, session),
            Verb::Plan(arguments) => plan::run(*arguments, session),
            Verb::Fit(arguments) => fit::run(arguments, session),
            Verb::Learn(arguments) => learn::run(arguments, session),
            Verb::Sensitivity(arguments) => sensitivity::run(*arguments, session),
            Verb::Tolerance(arguments) => tolerance::run(*arguments, session),
            Verb::Report(arguments) => report::run(arguments, session),
            Verb::Plot(arguments) => plot::run(arguments, session),
            Verb::Inspect(arguments) => inspect::run(arguments, session),
            Verb::Convert(arguments) => convert::run(arguments, session),
            Verb::Init(arguments) => init::run(arguments, session),
            Verb::Effects(arguments) => effects::run(arguments, session),
            Verb::Completions(arguments) => completions::run(arguments, session),
        }
    }
}
