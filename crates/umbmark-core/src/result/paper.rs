//! `paper`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::paper::{BothWays, BumpPlace, Cluster, Masking, TableOne, TableTwo};

/// The paper's experiments; those that were not requested are left out.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Paper {
    /// E_max,sys and sigma of every robot, simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_1: Option<TableOne>,
    /// The extended test with ten bumps of 10 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_2: Option<TableTwo>,
    /// Two errors that cancel in one direction (Figs. 2 to 4).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure_2: Option<Masking>,
    /// Return positions of one test.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure_5: Option<Vec<Cluster>>,
    /// Where the bumps lie.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure_6: Option<Vec<BumpPlace>>,
    /// Section 3.1: what a figure-eight hides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure_eight: Option<Vec<BothWays>>,
    /// Section 4.5: the 7 x 4 m rectangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rectangle: Option<Vec<BothWays>>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Paper {
    /// No experiment yet.
    pub fn new(seed: u64) -> Paper {
        Paper {
            table_1: None,
            table_2: None,
            figure_2: None,
            figure_5: None,
            figure_6: None,
            figure_eight: None,
            rectangle: None,
            seed,
            version: crate::VERSION,
        }
    }
}
