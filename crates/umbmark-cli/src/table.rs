//! Tables for people.

use comfy_table::{CellAlignment, Table, presets};
use umbmark_core::prose::unsigned_zeros;

/// A borderless table: the first column to the left, numbers to the right.
pub fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.to_vec());
    for row in rows {
        table.add_row(row.iter().map(|cell| unsigned_zeros(cell)).collect::<Vec<_>>());
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index == 0 { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.trim_fmt()
}

/// `value` with enough digits that its uncertainty is told to two of them; a dash for what is not known.
pub fn with_precision_of(value: f64, uncertainty: f64) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    let decimals = if uncertainty > 0.0 && uncertainty.is_finite() {
        (1 - uncertainty.log10().floor() as i32).clamp(0, 9) as usize
    } else {
        3
    };
    format!("{value:.decimals$}")
}
