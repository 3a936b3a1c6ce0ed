//! Several places that are read as one dataset.

use crate::{DatasetError, Topics};
use std::collections::HashSet;
use std::path::{Component, Path};
use umbmark_core::dataset::Dataset;
use umbmark_core::drive::Robot;

/// Reads datasets of one robot as one, as [`Dataset::joined`] has it. Each is called by the last part of its path, or by as many parts as make the
/// names differ.
pub fn load_together<P: AsRef<Path>>(places: &[P], topics: &Topics) -> Result<Dataset, DatasetError> {
    together(places, |place| crate::load_with(place, topics))
}

/// The same of logs beside which no robot stands: they are of `robot`, where another does not stand there.
pub fn load_together_of<P: AsRef<Path>>(places: &[P], topics: &Topics, robot: &Robot) -> Result<Dataset, DatasetError> {
    together(places, |place| crate::load_of(place, topics, robot))
}

fn together<P: AsRef<Path>>(
    places: &[P],
    load: impl Fn(&Path) -> Result<Dataset, DatasetError>,
) -> Result<Dataset, DatasetError> {
    let places: Vec<&Path> = places.iter().map(AsRef::as_ref).collect();
    if let [place] = places[..] {
        return load(place);
    }
    let names = names(&places)?;
    let sets = names.into_iter().zip(places).map(|(name, place)| Ok((name, load(place)?)));
    Ok(Dataset::joined(sets.collect::<Result<_, DatasetError>>()?)?)
}

/// A name for each place, of which there must be one.
pub(super) fn names(places: &[&Path]) -> Result<Vec<String>, DatasetError> {
    if places.is_empty() {
        return Err(DatasetError::NoPlace);
    }
    let parts: Vec<Vec<String>> = places.iter().map(|place| parts(place)).collect();
    let longest = parts.iter().map(Vec::len).max().unwrap_or(0);
    let by = |count: usize| parts.iter().map(move |parts| parts[parts.len().saturating_sub(count)..].join("/"));
    let differ = |count: &usize| by(*count).collect::<HashSet<_>>().len() == places.len();
    let count = (1..=longest).find(differ);
    let twice = || {
        let mut seen = HashSet::new();
        let again = places.iter().find(|place| !seen.insert(**place)).unwrap_or(&places[0]);
        DatasetError::Twice { file: again.display().to_string() }
    };
    count.map(|count| by(count).collect()).ok_or_else(twice)
}

/// The parts of a path that name it, without the ending of a file.
fn parts(place: &Path) -> Vec<String> {
    let whole = place.canonicalize().unwrap_or_else(|_| place.to_owned());
    let named = if whole.is_dir() { whole } else { whole.with_extension("") };
    let normal = |part: Component| match part {
        Component::Normal(part) => Some(part.to_string_lossy().into_owned()),
        _ => None,
    };
    named.components().filter_map(normal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn no_place_is_an_error_and_no_panic() {
        let said = load_together::<&Path>(&[], &Topics::default()).unwrap_err().to_string();
        assert_eq!(said, "no dataset is named; give at least one folder or file");
    }

    #[test]
    fn each_place_is_called_by_as_much_of_its_path_as_makes_it_differ() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        for made in ["monday/square", "monday/circle", "tuesday/square"] {
            fs::create_dir_all(at(made)).unwrap();
        }
        fs::write(at("monday/log.csv"), "").unwrap();
        let named = |paths: &[&str]| {
            let places: Vec<_> = paths.iter().map(|path| at(path)).collect();
            names(&places.iter().map(|place| place.as_path()).collect::<Vec<_>>())
        };
        assert_eq!(named(&["monday/square", "monday/circle"]).unwrap(), ["square", "circle"]);
        assert_eq!(named(&["monday/square/", "tuesday/square"]).unwrap(), ["monday/square", "tuesday/square"]);
        assert_eq!(named(&["monday/log.csv", "monday/square"]).unwrap(), ["log", "square"]);
        let refused = named(&["monday/square", "monday/../monday/square"]).unwrap_err();
        assert!(matches!(refused, DatasetError::Twice { .. }), "{refused}");
    }
}
