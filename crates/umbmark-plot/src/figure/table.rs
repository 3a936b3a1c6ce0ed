//! The numbers behind a figure.

use serde::{Deserialize, Serialize};

/// Rows of words and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Above the columns.
    pub header: Vec<String>,
    /// Below one another.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table.
    pub fn new<const N: usize>(header: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> Table {
        Table { header: header.map(str::to_owned).into(), rows: rows.into_iter().map(Vec::from).collect() }
    }
}
