//! Comma-separated text, cell by cell.

use std::fmt::{Display, Write};

/// A text in the making.
pub(super) struct CsvText {
    writer: csv::Writer<Vec<u8>>,
    cell: String,
}

impl CsvText {
    /// Begins a text behind some lines of comment.
    pub fn behind(comment: &str) -> CsvText {
        let mut builder = csv::WriterBuilder::new();
        CsvText { writer: builder.flexible(true).from_writer(comment.as_bytes().to_vec()), cell: String::new() }
    }

    /// Adds a cell; numbers in the shortest form that reads back to the last bit. Writing to memory does not fail.
    pub fn cell(&mut self, value: impl Display) {
        self.cell.clear();
        let _ = write!(self.cell, "{value}");
        let _ = self.writer.write_field(&self.cell);
    }

    /// Adds a number in such a form, with a decimal point; an empty cell without a value.
    pub fn decimal(&mut self, value: impl Into<Option<f64>>) {
        match value.into() {
            Some(value) => self.cell(format_args!("{value:?}")),
            None => self.cell(""),
        }
    }

    /// Ends the row.
    pub fn end(&mut self) {
        let _ = self.writer.write_record(None::<&[u8]>);
    }

    /// Adds a row of words.
    pub fn row<'w>(&mut self, cells: impl IntoIterator<Item = &'w str>) {
        let _ = self.writer.write_record(cells);
    }

    /// The whole text.
    pub fn finish(self) -> Vec<u8> {
        self.writer.into_inner().unwrap_or_default()
    }
}
