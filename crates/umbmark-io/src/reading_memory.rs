//! How much memory reading needs, told before anything is read.

use std::path::{Path, PathBuf};

/// Memory for each byte of a log in CSV \[bytes\]: measured on logs of 160 and 500 MB with counts in every row and a pose in every second.
const PER_BYTE: u64 = 5;
/// Folders in a dataset.
const DEEPEST: usize = 2;

/// About how much memory reading a dataset needs \[bytes\]: by the sizes of its files of CSV. Logs of messages are read in pieces.
pub fn memory_to_read(place: impl AsRef<Path>) -> u64 {
    PER_BYTE * csv_files(place.as_ref().to_owned(), DEEPEST)
}

/// The sizes of all files of CSV at a place.
fn csv_files(place: PathBuf, depth: usize) -> u64 {
    let is_csv = || place.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    match std::fs::metadata(&place) {
        Ok(found) if found.is_file() && is_csv() => found.len(),
        Ok(found) if found.is_dir() && depth > 0 => {
            let entries = std::fs::read_dir(&place).into_iter().flatten().flatten();
            entries.map(|entry| csv_files(entry.path(), depth - 1)).sum()
        }
        // What is not there is said by reading it.
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_csv_count_in_the_folder_and_in_its_runs_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let runs = folder.path().join("runs");
        std::fs::create_dir_all(runs.join("deeper")).unwrap();
        for (name, length) in [
            ("returns.csv", 100),
            ("robot.toml", 1000),
            ("runs/a.CSV", 10),
            ("runs/b.mcap", 1000),
            ("runs/deeper/c.csv", 1000),
        ] {
            std::fs::write(folder.path().join(name), vec![b' '; length]).unwrap();
        }
        assert_eq!(memory_to_read(folder.path()), 5 * 110);
        assert_eq!(memory_to_read(runs.join("a.CSV")), 50);
        assert_eq!(memory_to_read(folder.path().join("nothing")), 0);
    }
}
