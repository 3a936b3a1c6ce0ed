//! Files as text.

use super::error::DatasetError;
use super::packed::unpacked;
use std::path::Path;

/// The text of a file, without byte order mark.
pub(super) fn read_text(file: &Path) -> Result<String, DatasetError> {
    let bytes = std::fs::read(file).map_err(|error| unreadable(file, &error))?;
    let name = file.display().to_string();
    decode(&name, unpacked(&name, bytes)?)
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
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// The error of a file that the system does not let us read.
pub(super) fn unreadable(file: &Path, error: &std::io::Error) -> DatasetError {
    let reason = match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file or folder".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    };
    DatasetError::Unreadable { file: file.display().to_string(), reason }
}
