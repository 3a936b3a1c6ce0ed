//! What the data cannot see, and the least that it would see.

/// An effect that this data says nothing of.
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
    /// Whatever it does, these parameters of the model do as well.
    Absorbed(Vec<&'static str>),
    /// At its usual size it moves no observation by as much as the noise.
    BelowNoise,
}

/// The least size of an effect that this data would show in four cases of five.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// \[unit of the parameter\]
    pub size: f64,
}
