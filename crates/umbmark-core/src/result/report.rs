//! `report`.

use schemars::JsonSchema;
use serde::Serialize;

/// The result of a study.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Said {
    /// Its name.
    pub name: String,
    /// Warnings about its data, a sentence each.
    pub notices: Vec<String>,
    /// In a word: "explained", "partly" (effects were found, but something remains or is unsure), "not_explained", "fault" or
    /// "not_enough_data".
    pub outcome: &'static str,
    /// Its result, in one sentence.
    pub verdict: String,
}

/// A page with all results.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Report {
    /// Its length.
    pub bytes: usize,
    /// The verdict of each study on it, and the warnings about its data.
    pub studies: Vec<Said>,
    /// Of two studies: "better", "worse" or "the same"; null where they cannot be compared.
    pub change: Option<&'static str>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}
