//! What the data cannot show, and the minimum detectable sizes.

/// An effect that this data cannot show.
#[derive(Clone, Debug, PartialEq)]
pub struct Unseen {
    /// The effect.
    pub effect: &'static str,
    /// Why.
    pub why: Why,
}

/// Why an effect cannot be seen.
#[derive(Clone, Debug, PartialEq)]
pub enum Why {
    /// It is indistinguishable from these parameters of the model with this path.
    Absorbed(Vec<&'static str>),
    /// At its usual size it moves every observation by less than the noise.
    BelowNoise,
}

/// Minimum detectable size of an effect: this data would show it with 80 % power.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// \[unit of the parameter\]
    pub size: f64,
}
