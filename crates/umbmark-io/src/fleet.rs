//! Where the robots of a fleet are.

use super::error::DatasetError;
use super::file_names::ROBOT;
use super::probe::{Probe, names_in};
use super::together::names;
use std::path::{Path, PathBuf};

/// The places of robots, each with a name: as they are given, or the folders in one folder that is no dataset itself.
///
/// # Errors
/// Where a place cannot be read, where two are the same, and where a folder holds no robots.
pub fn fleet_in<P: AsRef<Path>>(places: &[P]) -> Result<Vec<(String, PathBuf)>, DatasetError> {
    let places: Vec<PathBuf> = places.iter().map(|place| place.as_ref().to_owned()).collect();
    let places = match &places[..] {
        [one] => folders_of(one)?.unwrap_or(places),
        _ => places,
    };
    let all: Vec<&Path> = places.iter().map(PathBuf::as_path).collect();
    Ok(names(&all)?.into_iter().zip(places.iter().cloned()).collect())
}

/// The folders of a folder, where it is no dataset and they have a robot.toml each.
fn folders_of(place: &Path) -> Result<Option<Vec<PathBuf>>, DatasetError> {
    let probe = Probe::of(place)?;
    if !probe.is_folder || probe.has(ROBOT) {
        return Ok(None);
    }
    let folders: Vec<PathBuf> = names_in(place)?.into_iter().map(|name| place.join(name)).collect();
    let robots: Vec<PathBuf> = folders.into_iter().filter(|folder| folder.join(ROBOT).is_file()).collect();
    Ok((!robots.is_empty()).then_some(robots))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_are_the_folders_of_a_folder_or_the_places_that_are_given() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        for name in ["b", "a", "notes"] {
            std::fs::create_dir_all(at(name)).unwrap();
        }
        for name in ["a", "b"] {
            std::fs::write(at(name).join(ROBOT), "").unwrap();
        }
        let found =
            |places: &[PathBuf]| fleet_in(places).unwrap().into_iter().map(|(name, _)| name).collect::<Vec<_>>();
        assert_eq!(found(&[folder.path().to_owned()]), ["a", "b"]);
        assert_eq!(found(&[at("a")]), ["a"]);
        assert_eq!(found(&[at("b"), at("a")]), ["b", "a"]);
        assert!(fleet_in(&[at("nowhere")]).is_err());
    }
}
