//! The verbs, one file each.

use std::process::ExitCode;

use crate::Session;

/// Each verb by its help, its name and its file, which has `Arguments` and `run`.
macro_rules! verbs {
    ($($(#[$help:meta])* $verb:ident($file:ident),)*) => {
        $(pub(crate) mod $file;)*

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
    /// Repeat the paper's experiments and compare with its numbers
    Paper(paper),
    /// Answer for a measured robot: what to write into it, what that is worth, what remains
    Solve(solve),
    /// Score a measured test: E_max,sys, centroids, sigma, extended test
    Score(score),
    /// Calibrate a measured robot: E_d, E_b, E_s, and files for ROS 2, TOML or C
    Calibrate(calibrate),
    /// Compare the predictions of models with a measured robot: where is the error made?
    Compare(compare),
    /// Find what changed of a robot between two tests
    Changed(changed),
    /// Find which numbers of a robot depend on session, floor, load or temperature
    Conditions(conditions),
    /// Fit and diagnose many robots: a row each, how far they are apart, which stand out
    Survey(survey),
    /// Watch a robot that is tested again and again: did it change, since when, and what of it
    Watch(watch),
    /// Correct the odometry of a log by a model, with its covariance; no reference is needed
    Apply(apply),
    /// Find which class of effects a model is missing, and what to measure next
    Diagnose(diagnose),
    /// Plan a test: how many runs, what they would show, and a protocol to print
    Plan(plan),
    /// Fit the free effects of a model
    Fit(fit),
    /// Learn a model: fit, diagnose and add effects until nothing is missing
    Learn(learn),
    /// Write a model's numbers for a robot: ROS 2, Nav2, URDF, C, robot.toml, Gazebo, MuJoCo
    Export(export),
    /// Show which parameter changes which metric: Sobol indices, Morris screening, derivatives
    Sensitivity(sensitivity),
    /// Find the cheapest tolerances with which enough robots keep a target
    Tolerance(tolerance),
    /// Open the workbench in the browser: compare a model with measurements, change it, fit it, see the error fall
    Open(open),
    /// Write everything on one HTML page
    Report(report),
    /// Draw one figure as SVG, PNG or PDF
    Plot(plot),
    /// Check a dataset: what it contains, how good it is, what it can determine
    Inspect(inspect),
    /// Write a dataset in another layout; aligns separate clocks from the motion
    Convert(convert),
    /// Write a robot.toml and a returns.csv to fill in
    Init(init),
    /// List the known error sources, or explain one
    Effects(effects),
    /// Print shell completions or the manual page
    Completions(completions),
}
