//! Which class of effects a model is missing, how sure that is, and what this data cannot see.
//!
//! Two kinds of evidence, one answer: return poses alone (`ends`), where a square driven both ways shows six numbers and
//! exact small-sample tests exist; and tick logs with absolute poses on the way (`tracks`), where almost every effect leaves
//! a trace of its own. Effects that the data cannot tell apart are named together, as a class.

mod candidates;

use crate::effect::Model;

pub use candidates::{Candidate, Size, candidates, columns};

/// What was observed of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Return poses only.
    Ends,
    /// Absolute poses on the way: at stops, or all along.
    Tracks,
}

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Probability with which a complete model is accused all the same: the family-wise size of all tests together.
    pub size: f64,
    /// Simulated tests that p-values without a closed form are taken from.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
}

impl Default for Options {
    /// 5 %, 999 draws, seed 1.
    fn default() -> Self {
        Options { size: 0.05, draws: 999, seed: 1 }
    }
}

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No sign of a further effect, as far as this data can see.
    Explained,
    /// One class of effects is missing.
    MissingEffect,
    /// More than one class is missing.
    SeveralMissing,
    /// Something is missing that no effect of the catalogue explains.
    UnlistedEffect,
    /// Too few runs, or of one direction only.
    NotEnoughData,
}

impl Verdict {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Explained => "explained",
            Verdict::MissingEffect => "missing_effect",
            Verdict::SeveralMissing => "several_missing",
            Verdict::UnlistedEffect => "unlisted_effect",
            Verdict::NotEnoughData => "not_enough_data",
        }
    }
}

/// A number of an effect with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The effect.
    pub effect: &'static str,
    /// The parameter, as in files: its unit stands in the name.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// ν of Student's t for its interval.
    pub degrees_of_freedom: f64,
}

/// A test of the whole model against what it leaves unexplained.
#[derive(Clone, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Which test.
    pub name: &'static str,
    /// Its statistic.
    pub statistic: f64,
    /// Degrees of freedom, where it is an F; none where p comes from simulation.
    pub degrees_of_freedom: Option<[f64; 2]>,
    /// Probability of so large a statistic where the model is complete.
    pub p: f64,
}

/// A class of effects that may be missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// All effects that this data cannot tell apart from the best, the best included.
    pub class: Vec<&'static str>,
    /// The effect of the class that fits best.
    pub best: &'static str,
    /// Its F (t² for one size).
    pub f: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// p of this class alone.
    pub p: f64,
    /// p of the greatest among all classes that were asked.
    pub p_adjusted: f64,
    /// p of the greatest when the signs of the runs' scores are flipped, where there are runs enough: it trusts no
    /// noise model.
    pub p_flips: Option<f64>,
    /// Sizes of the best effect after one step from zero.
    pub estimate: Vec<Estimate>,
    /// By how much the misfit would fall, in units of the noise variance.
    pub expected_drop: f64,
}

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

/// A further experiment that tells two effects apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The two.
    pub separates: [&'static str; 2],
    /// What to do, in words.
    pub experiment: String,
    /// How long it takes.
    pub minutes: f64,
    /// How far apart the two would then be, in standard deviations; 3.3 is seen in nine cases of ten.
    pub sd: f64,
}

/// What a diagnosis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// What was observed.
    pub level: Level,
    /// In one word.
    pub verdict: Verdict,
    /// The model, its free parameters fitted to this data.
    pub model: Model,
    /// Those parameters.
    pub fitted: Vec<Estimate>,
    /// Tests of the model as a whole.
    pub goodness_of_fit: Vec<GoodnessOfFit>,
    /// All classes that were asked, the likeliest first.
    pub ranking: Vec<Suspect>,
    /// How many of the first of the ranking are certified as missing.
    pub certified: usize,
    /// What this data cannot see.
    pub invisible: Vec<Unseen>,
    /// What it would have seen.
    pub minimum_detectable: Vec<Detectable>,
    /// What to measure next, the most telling per minute first.
    pub next_experiments: Vec<Experiment>,
    /// What else should be said, a sentence each.
    pub remarks: Vec<String>,
}
