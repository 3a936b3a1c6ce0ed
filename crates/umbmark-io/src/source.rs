//! The bytes of a file, packed or not, a block at a time.

use super::column_names::Renaming;
use super::error::{At, DatasetError, LineProblem};
use super::foreign::Foreign;
use flate2::read::MultiGzDecoder;
use std::io::{self, Cursor, Read};
use std::path::Path;

/// How much is read at a time \[bytes\]. What a file is shows in its first block.
pub(super) const BLOCK: usize = 1 << 16;
/// More than this is not unpacked \[bytes\]: a few kilobytes can stand for gigabytes of nothing.
const LARGEST: u64 = 1 << 30;

/// A text as it is read: without byte order mark, every line, also the last, ended by `\n`.
pub(super) struct Source<'a> {
    /// What messages call it.
    pub file: String,
    packed: bool,
    /// What its columns are called, where it is a table.
    pub columns: Renaming,
    /// The first block.
    head: Vec<u8>,
    rest: Box<dyn Read + 'a>,
    /// How many bytes were given out.
    given: usize,
    /// Lines end in `\r` alone, as those of old Macs.
    old_mac: bool,
    last: u8,
}

/// The text of a file.
pub(super) fn read_text(file: &Path) -> Result<String, DatasetError> {
    Source::open(file)?.text()
}

impl<'a> Source<'a> {
    /// Opens a file.
    pub fn open(file: &Path) -> Result<Source<'a>, DatasetError> {
        let opened = std::fs::File::open(file).map_err(|error| unreadable(file, &error))?;
        Source::of(&file.display().to_string(), opened)
    }

    /// Begins to read some bytes; `file` is what messages call them.
    pub fn of(file: &str, bytes: impl Read + 'a) -> Result<Source<'a>, DatasetError> {
        Source::up_to(LARGEST, file, bytes)
    }

    fn up_to(largest: u64, file: &str, mut bytes: impl Read + 'a) -> Result<Source<'a>, DatasetError> {
        let unreadable = |error| unreadable(Path::new(file), &error);
        let head = block_of(&mut bytes).map_err(|(_, error)| unreadable(error))?;
        let packed = head.starts_with(&[0x1f, 0x8b]);
        let file = file.to_owned();
        let (given, old_mac, last) = (0, false, b'\n');
        let columns = Renaming::default();
        let mut source = Source { file, packed, columns, head, rest: Box::new(bytes), given, old_mac, last };
        if packed {
            let decoder = MultiGzDecoder::new(Cursor::new(source.head).chain(source.rest));
            source.rest = Box::new(Unpacked { decoder, largest, count: 0 });
            source.head = block_of(&mut source.rest).map_err(|(read, error)| damaged(&source.file, read, &error))?;
        }
        if source.head.starts_with(&[0xFF, 0xFE]) || source.head.starts_with(&[0xFE, 0xFF]) {
            return Err(not_utf8(&source.file, 1, "this is UTF-16"));
        }
        if source.head.starts_with("\u{feff}".as_bytes()) {
            source.head.drain(..3);
        }
        if let Some(foreign) = Foreign::of(&source.head) {
            return Err(foreign.refused(&source.file));
        }
        source.old_mac = source.head.contains(&b'\r') && !source.head.contains(&b'\n');
        Ok(source)
    }

    /// The same, its columns called by other names.
    pub fn with(self, columns: &Renaming) -> Source<'a> {
        Source { columns: columns.clone(), ..self }
    }

    /// Whether nothing but blanks is in it.
    pub fn is_empty(&self) -> bool {
        self.head.len() < BLOCK && self.head.trim_ascii().is_empty()
    }

    /// The first line that holds something and is no comment, of those in the first block.
    pub fn first_row(&self) -> String {
        let head = String::from_utf8_lossy(&self.head);
        let row = |line: &&str| !line.starts_with('#') && line.contains(|c: char| c != ',' && !c.is_ascii_whitespace());
        head.split(['\n', '\r']).map(str::trim).find(row).unwrap_or_default().to_owned()
    }

    /// All of it, its lines ended as they are.
    pub fn text(self) -> Result<String, DatasetError> {
        let Source { file, packed, head: mut bytes, mut rest, .. } = self;
        let read = rest.read_to_end(&mut bytes);
        match read {
            Err(error) if packed => return Err(damaged(&file, bytes.len(), &error)),
            Err(error) => return Err(unreadable(Path::new(&file), &error)),
            Ok(_) => {}
        }
        String::from_utf8(bytes).map_err(|error| {
            let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            not_utf8(&file, good.iter().filter(|byte| **byte == b'\n').count() + 1, NOT_UTF8)
        })
    }

    /// The error of a read.
    pub fn failed(&self, error: &io::Error) -> DatasetError {
        if self.packed { damaged(&self.file, self.given, error) } else { unreadable(Path::new(&self.file), error) }
    }
}

impl Read for Source<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = match self.head.get(self.given..).filter(|left| !left.is_empty()) {
            Some(mut left) => left.read(buffer)?,
            None => self.rest.read(buffer)?,
        };
        self.given += read;
        if self.old_mac {
            buffer[..read].iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
        }
        match (read, buffer) {
            (0, [first, ..]) if self.last != b'\n' => {
                (*first, self.last) = (b'\n', b'\n');
                Ok(1)
            }
            (read, buffer) => {
                self.last = buffer[..read].last().copied().unwrap_or(self.last);
                Ok(read)
            }
        }
    }
}

/// What a packed file stands for.
struct Unpacked<R> {
    decoder: MultiGzDecoder<R>,
    largest: u64,
    count: u64,
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.decoder.read(buffer)?;
        self.count += read as u64;
        if self.count > self.largest { Err(io::Error::other(TooLarge(self.largest))) } else { Ok(read) }
    }
}

#[derive(Debug, thiserror::Error)]
#[error("unpacks to more than {0} bytes; unpack it yourself if that is meant")]
struct TooLarge(u64);

/// The first block of some bytes; where it cannot be read, how much could and why.
fn block_of(bytes: &mut impl Read) -> Result<Vec<u8>, (usize, io::Error)> {
    let mut block = Vec::new();
    match bytes.take(BLOCK as u64).read_to_end(&mut block) {
        Ok(_) => Ok(block),
        Err(error) => Err((block.len(), error)),
    }
}

const NOT_UTF8: &str = "there are bytes that are not UTF-8";

fn not_utf8(file: &str, line: usize, found: &'static str) -> DatasetError {
    At::new(file, line).refuse(LineProblem::NotUtf8 { found })
}

fn damaged(file: &str, read: usize, error: &io::Error) -> DatasetError {
    let too_large = error.get_ref().and_then(|error| error.downcast_ref::<TooLarge>());
    let reason = too_large.map_or_else(
        || format!("is damaged after {read} bytes of its text ({error}); pack it again"),
        |too_large| too_large.to_string(),
    );
    DatasetError::Packed { file: file.to_owned(), reason }
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

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    fn packed(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    fn text(bytes: &[u8]) -> Result<String, String> {
        Source::of("f", bytes).and_then(Source::text).map_err(|error| error.to_string())
    }

    #[test]
    fn packed_text_is_unpacked_and_other_text_is_not_touched() {
        assert_eq!(text(&packed(b"a,b\n1,2\n")).unwrap(), "a,b\n1,2\n");
        assert_eq!(text(b"a,b").unwrap(), "a,b");
        assert_eq!(text(&[packed(b"a,b\n"), packed(b"1,2\n")].concat()).unwrap(), "a,b\n1,2\n");
    }

    #[test]
    fn a_bomb_is_refused_before_it_fills_the_memory() {
        let bomb = packed(&vec![0; 1 << 20]);
        assert!(bomb.len() < 2000);
        for largest in [1000, 500_000] {
            let said = Source::up_to(largest, "f", &bomb[..]).and_then(Source::text).unwrap_err().to_string();
            assert_eq!(said, format!("f: unpacks to more than {largest} bytes; unpack it yourself if that is meant"));
        }
    }

    #[test]
    fn a_cut_file_is_refused() {
        let whole = packed(b"0123456789");
        let said = text(&whole[..whole.len() - 9]).unwrap_err();
        assert!(said.starts_with("f: is damaged after "), "{said}");
    }

    #[test]
    fn lines_end_alike_whatever_ended_them() {
        for (given, read) in [("a\rb", "a\nb\n"), ("a\nb\n", "a\nb\n"), ("\u{feff}a\r\nb", "a\r\nb\n"), ("", "")] {
            let mut bytes = Vec::new();
            Source::of("f", given.as_bytes()).unwrap().read_to_end(&mut bytes).unwrap();
            assert_eq!(bytes, read.as_bytes(), "{given:?}");
        }
    }
}
