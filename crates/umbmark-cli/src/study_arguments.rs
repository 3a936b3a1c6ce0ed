//! The arguments of the verbs that draw: what a study is made of.

use std::path::Path;

use umbmark_core::dataset::Dataset;
use umbmark_plot::study::{Options, Study};

use crate::Session;
use crate::model_report::read_model;
use crate::test_arguments::TestArguments;

/// How a study is made.
#[derive(Debug, clap::Args)]
pub struct StudyArguments {
    #[command(flatten)]
    test: TestArguments,

    /// Simulated tests of the model
    #[arg(short = 'n', long, default_value_t = 1000, value_name = "N", value_parser = crate::numbers::whole_in::<u64>(100..=1_000_000_000))]
    trials: u64,
}

impl StudyArguments {
    /// A study of a dataset and a model from a file, or the one that is learnt from it.
    pub fn study(&self, name: &str, data: Dataset, model: Option<&Path>, session: &Session) -> anyhow::Result<Study> {
        let given = match model {
            None => None,
            Some(file) => Some((file.display().to_string(), read_model(file, &data, session)?)),
        };
        let options = Options { diagnose: self.test.options(session), trials: self.trials };
        Ok(Study::new(name, data, given, options))
    }
}
