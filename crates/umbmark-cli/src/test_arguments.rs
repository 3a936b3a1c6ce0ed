//! The arguments of every verb that tests models against measurements.

use umbmark_core::diagnose::Options;

use crate::Session;

/// How to test.
#[derive(Debug, clap::Args)]
pub struct TestArguments {
    /// Use return poses alone, even if the runs were tracked
    #[arg(long)]
    return_poses: bool,

    /// Simulated tests for p-values that have no closed form
    #[arg(long, default_value_t = 999, value_name = "N", value_parser = crate::numbers::whole_in::<u32>(99..=99_999))]
    draws: u32,

    /// False-alarm rate: probability that a complete model is rejected
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = crate::numbers::probability)]
    size: f64,
}

impl TestArguments {
    /// The same for the core.
    pub fn options(&self, session: &Session) -> Options {
        let (size, draws, seed) = (self.size, self.draws as usize, session.seed());
        Options { size, draws, seed, ends_only: self.return_poses, ..Options::default() }
    }
}
