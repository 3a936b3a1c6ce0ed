//! Files as text.

use super::error::DatasetError;
use super::packed::unpacked;
use std::io::{self, Read};
use std::path::Path;

/// The text of a file, without byte order mark.
pub(super) fn read_text(file: &Path) -> Result<String, DatasetError> {
    let bytes = std::fs::read(file).map_err(|error| unreadable(file, &error))?;
    let name = file.display().to_string();
    decode(&name, unpacked(&name, bytes)?)
}

/// The text of a source in pieces of whole lines, so that a long one is never in memory as a whole.
pub(super) struct Pieces<R> {
    source: R,
    /// How much is read at a time \[bytes\].
    size: usize,
    bytes: Vec<u8>,
    /// How many of the bytes the last piece had.
    taken: usize,
}

impl<R: Read> Pieces<R> {
    pub fn of(source: R, size: usize) -> Pieces<R> {
        Pieces { source, size, bytes: Vec::new(), taken: 0 }
    }

    /// The next lines; nothing at the end.
    pub fn next(&mut self) -> io::Result<&str> {
        self.bytes.drain(..self.taken);
        self.taken = loop {
            let kept = self.bytes.len();
            self.bytes.resize(kept + self.size, 0);
            let read = self.source.read(&mut self.bytes[kept..])?;
            self.bytes.truncate(kept + read);
            match self.bytes[kept..].iter().rposition(|byte| *byte == b'\n') {
                Some(last) => break kept + last + 1,
                None if read == 0 => break kept,
                None => {}
            }
        };
        str::from_utf8(&self.bytes[..self.taken]).map_err(io::Error::other)
    }
}

/// Bytes as text, without byte order mark.
pub(super) fn decode(file: &str, bytes: Vec<u8>) -> Result<String, DatasetError> {
    let utf16 = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..good].iter().filter(|byte| **byte == b'\n').count() + 1;
        let found = if utf16 { "this is UTF-16" } else { "there are bytes that are not UTF-8" };
        DatasetError::NotUtf8 { file: file.to_owned(), line, found }
    })?;
    let rest = without_mark(&text);
    Ok(if rest.len() < text.len() { rest.to_owned() } else { text })
}

/// A text without byte order mark.
pub(super) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The error of a file that the system does not let us read.
pub(super) fn unreadable(file: &Path, error: &io::Error) -> DatasetError {
    let reason = match error.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    };
    DatasetError::Unreadable { file: file.display().to_string(), reason }
}
