//! Delimited text: rows of cells with the lines they stand on.
//!
//! Tolerated, because they do no harm: Windows and old Mac line ends, a byte order mark, blank lines, lines of nothing
//! but commas, comment lines (#), spaces round cells, quotation marks round cells, empty cells after the last column.

use super::error::{At, DatasetError, LineProblem, quoted};
use super::source::{BLOCK, Source};
use csv::{ByteRecord, ErrorKind, ReaderBuilder, Terminator};
use std::str::from_utf8;

/// The rows of a text that hold something.
pub(super) struct Rows<'a> {
    reader: csv::Reader<Source<'a>>,
    cells: ByteRecord,
}

/// A row of cells.
pub(super) struct Row<'r> {
    pub file: &'r str,
    pub line: usize,
    /// All cells, one behind the other.
    text: &'r str,
    cells: &'r ByteRecord,
}

/// Rows below a header.
pub(super) struct Sheet<'a> {
    /// Names of the columns, in lower case.
    pub header: Vec<String>,
    /// Cells of the line with the names, those without a name among them.
    width: usize,
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
        Rows { reader, cells: ByteRecord::new() }
    }

    pub fn file(&self) -> &str {
        &self.reader.get_ref().file
    }

    /// The next row; nothing at the end.
    pub fn next(&mut self) -> Result<Option<Row<'_>>, DatasetError> {
        self.next_below(&[])
    }

    /// The next row below a header, whose names messages use; nothing at the end.
    fn next_below(&mut self, header: &[String]) -> Result<Option<Row<'_>>, DatasetError> {
        loop {
            let before = self.reader.position().line();
            match self.reader.read_byte_record(&mut self.cells) {
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
                line -= self.cells.as_slice().iter().filter(|byte| **byte == b'\n').count() as u64;
            }
            let (file, line) = (&self.reader.get_ref().file[..], line as usize);
            return match text_of(&self.cells) {
                Some(text) => Ok(Some(Row { file, line, text, cells: &self.cells })),
                None => Err(At::new(file, line).refuse(not_utf8(&self.cells, header))),
            };
        }
    }

    fn holds_something(&self) -> bool {
        let bytes = self.cells.as_slice();
        match bytes.first() {
            Some(first) if first.is_ascii_graphic() && *first != b'#' => true,
            _ => {
                let first = String::from_utf8_lossy(&self.cells[0]);
                !String::from_utf8_lossy(bytes).trim().is_empty() && !first.trim_start().starts_with('#')
            }
        }
    }

    fn failed(&self, error: csv::Error) -> DatasetError {
        let source = self.reader.get_ref();
        match error.into_kind() {
            ErrorKind::Io(error) => source.failed(&error),
            // Of bytes and rows of any length, nothing else can fail.
            other => source.failed(&std::io::Error::other(format!("{other:?}"))),
        }
    }
}

impl<'r> Row<'r> {
    /// A cell; nothing where the row has ended before.
    #[inline]
    pub fn cell(&self, place: usize) -> &'r str {
        self.cells.range(place).map_or("", |range| tidy(&self.text[range]))
    }

    pub fn cells(&self) -> impl Iterator<Item = &'r str> + use<'r> {
        let (cells, text) = (self.cells, self.text);
        (0..cells.len()).filter_map(|place| cells.range(place)).map(|range| tidy(&text[range]))
    }

    /// Refuses a row with more or fewer cells than there are columns. Empty ones after the last do no harm, up to so many cells; more of them,
    /// where no cell has a decimal point, are what decimal commas leave of rows whose last cells are empty.
    #[inline]
    fn check_width(&self, expected: usize, most: usize) -> Result<(), DatasetError> {
        let got = self.cells.len();
        let has_points = || self.cells().any(|cell| cell.contains('.'));
        let is_surplus_empty = || self.cells().skip(expected).all(str::is_empty) && (got <= most || has_points());
        if got == expected || got > expected && is_surplus_empty() {
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
        let has = |separator: char| self.text.contains(separator);
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
        let width = header.len();
        header.truncate(header.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1));
        rows.reader.get_ref().columns.rename(&mut header);
        Ok(Sheet { header, width, header_line: line, rows })
    }

    /// Takes every row as data, of a number of columns.
    pub fn headless(source: Source<'a>, columns: usize) -> Sheet<'a> {
        Sheet { header: vec![String::new(); columns], width: columns, header_line: 0, rows: Rows::of(source) }
    }

    pub fn file(&self) -> &str {
        self.rows.file()
    }

    /// Visits every row; there must be one.
    pub fn for_each(mut self, mut visit: impl FnMut(&Row) -> Result<(), DatasetError>) -> Result<(), DatasetError> {
        let columns = self.header.len();
        let mut most = None;
        while let Some(row) = self.rows.next_below(&self.header)? {
            // A comma at the end of a row stands at the end of every row.
            let most = *most.get_or_insert(self.width + usize::from(row.cells.len() == self.width + 1));
            row.check_width(columns, most)?;
            visit(&row)?;
        }
        if most.is_some() {
            return Ok(());
        }
        let (file, found) = (self.file().to_owned(), "there are no rows");
        Err(DatasetError::NoRows { file, found, remedy: "add the measurements, one a line".into() })
    }
}

/// All cells of a row, one behind the other, where each is UTF-8: two broken ones may make a character together.
fn text_of(cells: &ByteRecord) -> Option<&str> {
    let text = from_utf8(cells.as_slice()).ok()?;
    let is_whole = text.is_ascii() || cells.iter().all(|cell| from_utf8(cell).is_ok());
    is_whole.then_some(text)
}

/// What is said of the first cell that is not UTF-8.
fn not_utf8(cells: &ByteRecord, header: &[String]) -> LineProblem {
    let broken = cells.iter().enumerate().find(|(_, cell)| from_utf8(cell).is_err());
    let (place, cell) = broken.unwrap_or((0, cells.as_slice()));
    let column = match header.get(place).filter(|name| !name.is_empty()) {
        Some(name) => format!("\"{name}\""),
        None => (place + 1).to_string(),
    };
    LineProblem::CellNotUtf8 { column, value: quoted(&String::from_utf8_lossy(cell)) }
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
