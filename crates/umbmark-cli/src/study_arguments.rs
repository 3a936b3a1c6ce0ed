//! The arguments of the verbs that draw: what a study is made of.

use std::path::Path;

use umbmark_core::dataset::{Dataset, read_model};
use umbmark_core::diagnose;
use umbmark_plot::study::{Options, Study};

use crate::Session;

/// How a study is made.
#[derive(Clone, Debug, clap::Args)]
pub struct StudyArguments {
    /// Use return poses alone, even where the runs were observed on the way
    #[arg(long)]
    return_poses: bool,

    /// Simulated tests of the model
    #[arg(short = 'n', long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(100..))]
    trials: u64,

    /// Simulated tests for p-values that have no closed form
    #[arg(long, default_value_t = 999, value_name = "N", value_parser = clap::value_parser!(u32).range(99..=99_999))]
    draws: u32,

    /// Probability with which a complete model is accused all the same; intervals hold with the rest
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = crate::verb::size)]
    size: f64,
}

impl StudyArguments {
    /// A study of a dataset and a model from a file, or the one that it teaches.
    pub fn study(&self, name: &str, data: Dataset, model: Option<&Path>, session: &Session) -> anyhow::Result<Study> {
        let given = match model {
            None => None,
            Some(file) => Some((file.display().to_string(), read_model(file, data.nominal_robot()?)?.0)),
        };
        let options = Options {
            diagnose: diagnose::Options {
                size: self.size,
                draws: self.draws as usize,
                seed: session.seed(),
                ends_only: self.return_poses,
            },
            trials: self.trials,
        };
        Ok(Study::new(name, data, given, options))
    }
}
