//! `report`.

use schemars::JsonSchema;
use serde::Serialize;

/// What a study comes to.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Said {
    /// Its name.
    pub name: String,
    /// What to know of its data first, a sentence each.
    pub notices: Vec<String>,
    /// What it comes to, in one sentence.
    pub verdict: String,
}

/// A page of everything.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Report {
    /// Its length.
    pub bytes: usize,
    /// The verdict of each study on it, and what to know of its data first.
    pub studies: Vec<Said>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}
