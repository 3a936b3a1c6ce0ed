//! The argument of every verb that states intervals.

/// How sure an interval is.
#[derive(Debug, clap::Args)]
pub struct LevelArgument {
    /// Probability with which the intervals hold
    #[arg(long, default_value_t = 0.95, value_name = "P", value_parser = crate::numbers::probability)]
    pub level: f64,
}
