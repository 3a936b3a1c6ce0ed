//! Comma-separated text with line numbers.
//!
//! Tolerated, because they do no harm: Windows and old Mac line ends, a byte order mark, blank lines, lines of nothing
//! but commas, comment lines (#), spaces round cells, quotation marks round cells, empty cells after the last column.

use super::decimal::Decimal;
use super::error::{DatasetError, quoted};

/// A text with a header.
pub(super) struct Sheet<'a> {
    pub file: &'a str,
    /// Names of the columns, in lower case.
    pub header: Vec<String>,
    pub header_line: usize,
    body: Rows<'a>,
}

/// A row of cells.
pub(super) struct Row<'r> {
    pub file: &'r str,
    pub line: usize,
    pub cells: &'r [Cell<'r>],
}

/// What stands between two commas.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<'a> {
    /// Without the spaces and quotation marks round it.
    pub text: &'a str,
    /// Its value where it is a [`Decimal`]; else NaN.
    pub value: f64,
}

/// The lines of a text that hold something, with their numbers.
#[derive(Clone)]
pub(super) struct Rows<'a> {
    rest: &'a str,
    end: char,
    /// How many lines were taken.
    line: usize,
}

impl<'a> Rows<'a> {
    pub fn of(text: &'a str) -> Rows<'a> {
        let end = if text.contains('\n') { '\n' } else { '\r' };
        Rows { rest: text, end, line: 0 }
    }

    /// Takes the next line if every cell is a number or empty, as nearly all are in a log, and there are as many as asked for.
    fn take_plain(&mut self, cells: &mut [Cell<'a>]) -> bool {
        let bytes = self.rest.as_bytes();
        let mut at = 0;
        for (column, cell) in cells.iter_mut().enumerate() {
            if column > 0 {
                if bytes.get(at) != Some(&b',') {
                    return false;
                }
                at += 1;
            }
            let Decimal { value, length } = Decimal::at_start_of(&bytes[at..]);
            *cell = Cell { text: &self.rest[at..at + length], value };
            at += length;
        }
        let nothing_but_commas = at < cells.len();
        let end = match bytes[at..] {
            _ if nothing_but_commas => return false,
            [] => at,
            [b'\n', ..] => at + 1,
            [b'\r', b'\n', ..] => at + 2,
            _ => return false,
        };
        (self.rest, self.line) = (&self.rest[end..], self.line + 1);
        true
    }
}

impl<'a> Iterator for Rows<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<(usize, &'a str)> {
        while !self.rest.is_empty() {
            let (line, rest) = self.rest.split_once(self.end).unwrap_or((self.rest, ""));
            (self.rest, self.line) = (rest, self.line + 1);
            let line = trimmed(line);
            if !line.starts_with('#') && line.bytes().any(|byte| byte != b',' && !byte.is_ascii_whitespace()) {
                return Some((self.line, line));
            }
        }
        None
    }
}

impl<'a> Sheet<'a> {
    /// Takes the first row as the header; `expected` names its columns in messages.
    pub fn open(file: &'a str, text: &'a str, expected: &str) -> Result<Sheet<'a>, DatasetError> {
        let mut body = Rows::of(text);
        let Some((header_line, header)) = body.next() else {
            let found = if text.trim().is_empty() { "the file is empty" } else { "there are only comments" };
            let remedy = format!("it needs a header line ({expected}) and rows");
            return Err(DatasetError::NoRows { file: file.to_owned(), found, remedy });
        };
        check_separator(file, header_line, header)?;
        let mut cells = Vec::new();
        split(header, &mut cells);
        let first = cells[0].text;
        if first.parse::<f64>().is_ok() {
            return Err(DatasetError::NoHeader { file: file.to_owned(), line: header_line, value: quoted(first) });
        }
        let used = cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |last| last + 1);
        let header = cells[..used].iter().map(|cell| cell.text.to_lowercase()).collect();
        Ok(Sheet { file, header, header_line, body })
    }

    /// Takes every row as data, of a number of columns.
    pub fn headless(file: &'a str, text: &'a str, columns: usize) -> Sheet<'a> {
        Sheet { file, header: vec![String::new(); columns], header_line: 0, body: Rows::of(text) }
    }

    /// Visits every row; there must be one.
    pub fn for_each(&self, mut visit: impl FnMut(&Row) -> Result<(), DatasetError>) -> Result<(), DatasetError> {
        let mut any = false;
        self.for_each_of(self.body(), |row| {
            any = true;
            visit(row)
        })?;
        if any {
            return Ok(());
        }
        let (file, found) = (self.file.to_owned(), "there are no rows");
        Err(DatasetError::NoRows { file, found, remedy: "add the measurements, one a line".into() })
    }

    /// The rows below the header.
    pub fn body(&self) -> Rows<'a> {
        self.body.clone()
    }

    /// The rows of another text that goes on after so many lines.
    pub fn body_after<'b>(&self, line: usize, text: &'b str) -> Rows<'b> {
        Rows { rest: text, end: self.body.end, line }
    }

    /// Visits some rows, and says how many lines there were by then.
    pub fn for_each_of(
        &self,
        mut rows: Rows,
        mut visit: impl FnMut(&Row) -> Result<(), DatasetError>,
    ) -> Result<usize, DatasetError> {
        let mut cells = Vec::new();
        loop {
            cells.resize(self.header.len(), Cell { text: "", value: f64::NAN });
            if !rows.take_plain(&mut cells) {
                let Some((line, text)) = rows.next() else { return Ok(rows.line) };
                split(text, &mut cells);
                self.check_width(line, text, &cells)?;
            }
            visit(&Row { file: self.file, line: rows.line, cells: &cells })?;
        }
    }

    fn check_width(&self, line: usize, text: &str, cells: &[Cell]) -> Result<(), DatasetError> {
        let expected = self.header.len();
        if cells.len() >= expected && cells[expected..].iter().all(|cell| cell.text.is_empty()) {
            return Ok(());
        }
        if cells.len() == 1 {
            check_separator(self.file, line, text)?;
        }
        let remedy = if cells.len() > expected {
            "write decimals with a point (0.123, not 0,123), and quote text that has commas"
        } else {
            "leave a cell empty (,,) where nothing was measured"
        };
        Err(DatasetError::Ragged { file: self.file.to_owned(), line, got: cells.len(), expected, remedy })
    }
}

fn check_separator(file: &str, line: usize, text: &str) -> Result<(), DatasetError> {
    let found = match text {
        _ if text.contains(';') => "semicolons",
        _ if text.contains(',') => return Ok(()),
        _ if text.contains('\t') => "tabs",
        _ if text.contains(' ') => "spaces",
        _ => return Ok(()),
    };
    Err(DatasetError::Separator { file: file.to_owned(), line, found })
}

/// Cuts a line at its commas, but not at those in quotation marks.
pub(super) fn split<'a>(line: &'a str, cells: &mut Vec<Cell<'a>>) {
    cells.clear();
    let bytes = line.as_bytes();
    let mut start = 0;
    loop {
        let Decimal { value, length } = Decimal::at_start_of(&bytes[start..]);
        let mut end = start + length;
        if bytes.get(end).is_none_or(|byte| *byte == b',') {
            cells.push(Cell { text: &line[start..end], value });
        } else {
            end += text_length(&bytes[end..]);
            cells.push(Cell { text: tidy(&line[start..end]), value: f64::NAN });
        }
        if end == bytes.len() {
            return;
        }
        start = end + 1;
    }
}

/// How many bytes there are before a comma that is not in quotation marks.
fn text_length(bytes: &[u8]) -> usize {
    let mut inside = false;
    let ends = |byte: &u8| {
        inside ^= *byte == b'"';
        *byte == b',' && !inside
    };
    bytes.iter().position(ends).unwrap_or(bytes.len())
}

/// A cell without the spaces and quotation marks round it; most have none.
fn tidy(cell: &str) -> &str {
    let cell = trimmed(cell);
    cell.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).map_or(cell, str::trim)
}

/// A text without the spaces round it; most have none.
fn trimmed(text: &str) -> &str {
    let plain = |byte: Option<&u8>| byte.is_none_or(u8::is_ascii_graphic);
    if plain(text.as_bytes().first()) && plain(text.as_bytes().last()) { text } else { text.trim() }
}
