//! Files that are dropped on the page: into which folder they are written, and under which names.

use std::path::{Component, Path, PathBuf};

use umbmark_io::Existing;
use umbmark_io::whole_file::WholeFile;

use crate::bench::Trouble;

/// A name is never longer \[bytes\], and never deeper.
const LONGEST: usize = 200;
const DEEPEST: usize = 4;
/// Folders of one name that are tried.
const TRIED: u32 = 10_000;

/// The parts of a name that leads into a folder and not out of it.
pub fn safe(name: &str) -> Result<PathBuf, Trouble> {
    let wrong =
        |why: &str| Trouble(format!("\"{}\" is no name of a file that can be taken: {why}.", name.escape_default()));
    if name.len() > LONGEST {
        return Err(wrong("it is too long"));
    }
    if name.contains(|c: char| c.is_control() || "\\:*?\"<>|".contains(c)) {
        return Err(wrong("it has a character that names of files do not have everywhere"));
    }
    let parts: Vec<&str> = name.split('/').collect();
    if parts.len() > DEEPEST {
        return Err(wrong("it lies too deep"));
    }
    if parts.iter().any(|part| part.is_empty() || part.starts_with('.') || part.ends_with(['.', ' '])) {
        return Err(wrong("a part of it is empty or begins with a point"));
    }
    let path: PathBuf = parts.iter().collect();
    if path.components().all(|part| matches!(part, Component::Normal(_))) {
        Ok(path)
    } else {
        Err(wrong("it leads elsewhere"))
    }
}

/// Makes a new folder for files that are dropped together, and returns its name.
pub fn begin(drops: &Path, name: &str) -> Result<String, Trouble> {
    let name = safe(name)?;
    if name.components().count() != 1 {
        return Err(Trouble("A folder of dropped files has one name.".into()));
    }
    let name = name.to_string_lossy().into_owned();
    let failed = |error: std::io::Error| Trouble(format!("{}: cannot be written: {error}", drops.display()));
    std::fs::create_dir_all(drops).map_err(failed)?;
    for number in 1..=TRIED {
        let own = if number == 1 { name.clone() } else { format!("{name} {number}") };
        match std::fs::create_dir(drops.join(&own)) {
            Ok(()) => return Ok(own),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(failed(error)),
        }
    }
    Err(Trouble(format!("{}: there are too many folders called {name}", drops.display())))
}

/// The folder of this name, which was made before.
pub fn folder(drops: &Path, name: &str) -> Result<PathBuf, Trouble> {
    let own = safe(name)?;
    let folder = drops.join(&own);
    if own.components().count() == 1 && folder.is_dir() {
        Ok(folder)
    } else {
        Err(Trouble("There is no such drop.".into()))
    }
}

/// Writes a file that was dropped.
pub fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Trouble> {
    let file = folder.join(safe(name)?);
    if let Some(parent) = file.parent() {
        std::fs::create_dir_all(parent)
            .map_err(|error| Trouble(format!("{}: cannot be made: {error}", parent.display())))?;
    }
    WholeFile::write(&file, Existing::Keep, bytes).map_err(Trouble::because)
}

/// What is read of a drop: its only file, else the folder.
pub fn place(folder: &Path) -> Result<PathBuf, Trouble> {
    let failed = |error: std::io::Error| Trouble(format!("{}: cannot be read: {error}", folder.display()));
    let mut inside = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        inside.push(entry.map_err(failed)?.path());
    }
    match &inside[..] {
        [] => Err(Trouble("No file was dropped.".into())),
        [only] if only.is_dir() => place(only),
        [only] => Ok(only.clone()),
        _ => Ok(folder.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_out_of_the_folder_are_refused() {
        for name in [
            "../a.csv",
            "..",
            "a/../../b",
            "/etc/passwd",
            "a//b",
            "",
            ".",
            "./a",
            "a/.",
            ".hidden",
            "a/.b",
            "..\\a",
            "C:\\a",
            "C:a",
            "a\0b",
            "a\nb",
            "a/b/c/d/e",
            "con ",
            "x.",
            "~/../a",
        ] {
            assert!(safe(name).is_err(), "{name:?}");
        }
        assert!(safe(&"a".repeat(201)).is_err());
        for name in ["a.csv", "runs/cw 1.csv", "my_robot/runs/cw_1.mcap", "Läufe/ü.csv"] {
            assert_eq!(safe(name).unwrap(), Path::new(name), "{name}");
        }
    }

    #[test]
    fn files_are_written_into_a_new_folder_each_time_and_nothing_is_replaced() {
        let root = tempfile::tempdir().unwrap();
        let drops = root.path().join("drops");
        assert_eq!([begin(&drops, "a").unwrap(), begin(&drops, "a").unwrap()], ["a", "a 2"]);
        assert!(begin(&drops, "../b").is_err() && begin(&drops, "b/c").is_err() && folder(&drops, "..").is_err());
        let own = folder(&drops, "a 2").unwrap();
        write(&own, "runs/cw_1.csv", b"one").unwrap();
        assert!(write(&own, "runs/cw_1.csv", b"two").is_err());
        assert!(write(&own, "../../out.csv", b"two").is_err());
        assert_eq!(std::fs::read(own.join("runs/cw_1.csv")).unwrap(), b"one");
        assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1);
        assert_eq!(place(&own).unwrap(), own.join("runs/cw_1.csv"));
    }
}
