//! Tables for people.

use comfy_table::{CellAlignment, Table, presets};
use umbmark_core::prose::unsigned_zeros;

use crate::prose::WIDTH;

/// A borderless table: the first column to the left, numbers to the right. One that is wider than a page has its header in several lines,
/// and less room between columns.
pub fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let rows: Vec<Vec<String>> =
        rows.into_iter().map(|row| row.iter().map(|cell| unsigned_zeros(cell)).collect()).collect();
    let header: Vec<String> = header.iter().map(|&cell| cell.to_owned()).collect();
    let widest = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let width_of =
        |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| widest(cell)).max().unwrap_or(0);
    let fold = |(column, cell): (usize, &String)| folded(cell, width_of(column).max(LEAST_HEADER));
    let folded: Vec<String> = header.iter().enumerate().map(fold).collect();
    let close = || rows.iter().map(|row| row.iter().map(|cell| cell.replace(" ± ", "±")).collect()).collect::<Vec<_>>();
    let steps: [&dyn Fn() -> String; 4] = [
        &|| drawn(&header, &rows, Room::Wide),
        &|| drawn(&header, &rows, Room::FromTheEdge),
        &|| drawn(&folded, &rows, Room::FromTheEdge),
        &|| drawn(&folded, &rows, Room::Narrow),
    ];
    let fitting = steps.iter().map(|draw| draw()).find(|text| widest(text) <= WIDTH);
    fitting.unwrap_or_else(|| drawn(&folded, &close(), Room::Narrow))
}

/// No header is folded to less than this.
const LEAST_HEADER: usize = 6;

/// How much room there is before columns.
#[derive(Clone, Copy, PartialEq)]
enum Room {
    Wide,
    /// None before the first.
    FromTheEdge,
    /// One place, and none before the first.
    Narrow,
}

/// Words in as many lines as it takes to be no wider than this, where they can be.
fn folded(words: &str, width: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split(' ') {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= width) {
            Some(line) => *line = format!("{line} {word}"),
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

fn drawn(header: &[String], rows: &[Vec<String>], room: Room) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.to_vec());
    for row in rows {
        table.add_row(row.clone());
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index == 0 { CellAlignment::Left } else { CellAlignment::Right });
        let after = u16::from(room != Room::Narrow);
        if room != Room::Wide {
            column.set_padding((u16::from(index > 0), after));
        }
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
