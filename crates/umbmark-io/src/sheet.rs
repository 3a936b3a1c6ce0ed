//! Delimited text: rows of cells with the lines they stand on.
//!
//! Tolerated, because they do no harm: Windows and old Mac line ends, a byte order mark, blank lines, lines of nothing
//! but commas, comment lines (#), spaces round cells, quotation marks round cells, empty cells after the last column.

use super::error::{At, DatasetError, LineProblem, quoted};
use super::source::{BLOCK, Source};
use csv::{ErrorKind, ReaderBuilder, StringRecord, Terminator};

/// The rows of a text that hold something.
pub(super) struct Rows<'a> {
    reader: csv::Reader<Source<'a>>,
    cells: StringRecord,
}

/// A row of cells.
pub(super) struct Row<'r> {
    pub file: &'r str,
    pub line: usize,
    cells: &'r StringRecord,
}

/// Rows below a header.
pub(super) struct Sheet<'a> {
    /// Names of the columns, in lower case.
    pub header: Vec<String>,
    pub header_line: usize,
    rows: Rows<'a>,
}

impl<'a> Rows<'a> {
    /// Rows whose cells are separated by commas.
    pub fn of(source: Source<'a>) -> Rows<'a> {
        Rows::separated_by(b',', source)
    }

    pub fn separated_by(delimiter: u8, source: Source<'a>) -> Rows<'a> {
        let mut builder = ReaderBuilder::new();
        builder.delimiter(delimiter).comment(Some(b'#')).terminator(Terminator::Any(b'\n'));
        let reader = builder.has_headers(false).flexible(true).buffer_capacity(BLOCK).from_reader(source);
        Rows { reader, cells: StringRecord::new() }
    }

    pub fn file(&self) -> &str {
        &self.reader.get_ref().file
    }

    /// The next row; nothing at the end.
    pub fn next(&mut self) -> Result<Option<Row<'_>>, DatasetError> {
        loop {
            let before = self.reader.position().line();
            match self.reader.read_record(&mut self.cells) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(error) => return Err(self.failed(error)),
            }
            if !self.holds_something() {
                continue;
            }
            // The reader stands on the line after the row; comments and blank lines may have come before it.
            let mut line = self.reader.position().line() - 1;
            if line > before {
                line -= self.cells.as_slice().bytes().filter(|byte| *byte == b'\n').count() as u64;
            }
            return Ok(Some(Row { file: &self.reader.get_ref().file, line: line as usize, cells: &self.cells }));
        }
    }

    fn holds_something(&self) -> bool {
        let text = self.cells.as_slice();
        match text.as_bytes().first() {
            Some(first) if first.is_ascii_graphic() && *first != b'#' => true,
            _ => !text.trim().is_empty() && !self.cells[0].trim_start().starts_with('#'),
        }
    }

    fn failed(&self, error: csv::Error) -> DatasetError {
        let source = self.reader.get_ref();
        match error.into_kind() {
            ErrorKind::Io(error) => source.failed(&error),
            _ => source.not_utf8(self.reader.position().line() as usize - 1),
        }
    }
}

impl<'r> Row<'r> {
    /// A cell; nothing where the row has ended before.
    #[inline]
    pub fn cell(&self, place: usize) -> &'r str {
        self.cells.get(place).map_or("", tidy)
    }

    pub fn cells(&self) -> impl Iterator<Item = &'r str> + use<'r> {
        self.cells.iter().map(tidy)
    }

    /// Refuses a row with more or fewer cells than there are columns; empty ones after the last do no harm.
    #[inline]
    fn check_width(&self, expected: usize) -> Result<(), DatasetError> {
        let got = self.cells.len();
        if got == expected || got > expected && self.cells().skip(expected).all(str::is_empty) {
            return Ok(());
        }
        if got == 1 {
            self.check_separator()?;
        }
        let remedy = if got > expected {
            "write decimals with a point (0.123, not 0,123), and quote text that has commas"
        } else {
            "leave a cell empty (,,) where nothing was measured"
        };
        Err(At::new(self.file, self.line).refuse(LineProblem::Ragged { got, expected, remedy }))
    }

    fn check_separator(&self) -> Result<(), DatasetError> {
        let has = |separator: char| self.cells.as_slice().contains(separator);
        let found = match self.cells.len() {
            _ if has(';') => "semicolons",
            2.. => return Ok(()),
            _ if has('\t') => "tabs",
            _ if has(' ') => "spaces",
            _ => return Ok(()),
        };
        Err(At::new(self.file, self.line).refuse(LineProblem::Separator { found }))
    }
}

impl<'a> Sheet<'a> {
    /// Takes the first row as the header; `expected` names its columns in messages.
    pub fn open(source: Source<'a>, expected: &str) -> Result<Sheet<'a>, DatasetError> {
        let is_empty = source.is_empty();
        let mut rows = Rows::of(source);
        let Some(row) = rows.next()? else {
            let found = if is_empty { "the file is empty" } else { "there are only comments" };
            let remedy = format!("it needs a header line ({expected}) and rows");
            return Err(DatasetError::NoRows { file: rows.file().to_owned(), found, remedy });
        };
        row.check_separator()?;
        let first = row.cell(0);
        if first.parse::<f64>().is_ok() {
            return Err(At::new(row.file, row.line).refuse(LineProblem::NoHeader { value: quoted(first) }));
        }
        let (mut header, line): (Vec<String>, _) = (row.cells().map(str::to_lowercase).collect(), row.line);
        header.truncate(header.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1));
        rows.reader.get_ref().columns.rename(&mut header);
        Ok(Sheet { header, header_line: line, rows })
    }

    /// Takes every row as data, of a number of columns.
    pub fn headless(source: Source<'a>, columns: usize) -> Sheet<'a> {
        Sheet { header: vec![String::new(); columns], header_line: 0, rows: Rows::of(source) }
    }

    pub fn file(&self) -> &str {
        self.rows.file()
    }

    /// Visits every row; there must be one.
    pub fn for_each(mut self, mut visit: impl FnMut(&Row) -> Result<(), DatasetError>) -> Result<(), DatasetError> {
        let mut any = false;
        while let Some(row) = self.rows.next()? {
            row.check_width(self.header.len())?;
            visit(&row)?;
            any = true;
        }
        if any {
            return Ok(());
        }
        let (file, found) = (self.file().to_owned(), "there are no rows");
        Err(DatasetError::NoRows { file, found, remedy: "add the measurements, one a line".into() })
    }
}

/// A cell without the spaces and quotation marks round it; most have none.
#[inline]
fn tidy(cell: &str) -> &str {
    let plain = |byte: Option<&u8>| byte.is_none_or(|byte| byte.is_ascii_graphic() && *byte != b'"');
    if plain(cell.as_bytes().first()) && plain(cell.as_bytes().last()) {
        return cell;
    }
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).map_or(cell, str::trim)
}
