//! The verbs, one file each.

use std::process::ExitCode;

use crate::Session;

/// Each verb by its help, its name and its file, which has `Arguments` and `run`.
macro_rules! verbs {
    ($($(#[$help:meta])* $verb:ident($file:ident),)*) => {
        $(mod $file;)*

        /// What the command can do.
        #[derive(Debug, clap::Subcommand)]
        pub enum Verb {
            $($(#[$help])* $verb(Box<$file::Arguments>),)*
        }

        impl Verb {
            pub(crate) fn run(self, session: &mut Session) -> anyhow::Result<ExitCode> {
                match self {
                    $(Verb::$verb(arguments) => $file::run(*arguments, session),)*
                }
            }
        }
    };
}

verbs! {
    /// Monte Carlo: simulate whole UMBmark tests by the thousand
    Mc(mc),
    /// Merge shards or checkpoints of mc into one result
    Merge(merge),
    /// Simulate one test and write it as a dataset
    Simulate(simulate),
    /// Repeat the paper's experiments, beside its numbers
    Paper(paper),
    /// Score a measured test: E_max,sys, centroids, sigma, extended test
    Score(score),
    /// Calibrate a measured robot: E_d, E_b, E_s, and files to put them to use
    Calibrate(calibrate),
    /// Hold models against a measured robot: what is explained, what not, in which direction
    Compare(compare),
    /// Find which class of effects a model is missing, and what to measure next
    Diagnose(diagnose),
    /// Plan a test: how many runs, what they would show, and the sheet to drive by
    Plan(plan),
    /// Fit the free effects of a model
    Fit(fit),
    /// Learn a model: fit, diagnose, add, until nothing is missing
    Learn(learn),
    /// Which parameter drives which metric: Sobol indices, Morris screening, derivatives
    Sensitivity(sensitivity),
    /// How many robots are good enough, and the cheapest tolerances that make it enough
    Tolerance(tolerance),
    /// Put everything on one page: a report to send
    Report(report),
    /// Draw one figure as SVG, PNG or PDF
    Plot(plot),
    /// Look at a dataset: what it holds, whether it is any good, what it can determine
    Inspect(inspect),
    /// Write a dataset in another layout; sets clocks that disagree by the motion
    Convert(convert),
    /// Write a robot.toml and a returns.csv to fill in
    Init(init),
    /// List the effects that make a robot err, or explain one
    Effects(effects),
    /// Print shell completions or the manual page
    Completions(completions),
}
