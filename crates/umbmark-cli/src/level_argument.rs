//! The argument of every verb that states intervals.

/// The confidence level of intervals.
#[derive(Debug, clap::Args)]
pub struct LevelArgument {
    /// Probability with which an interval contains the true value
    #[arg(long, default_value_t = 0.95, value_name = "P", value_parser = crate::numbers::probability)]
    pub level: f64,
}
