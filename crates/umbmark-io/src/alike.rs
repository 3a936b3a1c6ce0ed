//! Warnings that many files share, told once.

use std::collections::HashMap;

/// So many warnings that differ in their numbers only are told one by one.
const FEW: usize = 3;

/// Warnings, each of a file ("FILE: ..."): of more than [`FEW`] that differ in their files and numbers only, the first, and how many more
/// there are.
pub(super) fn told_once(warnings: Vec<String>) -> Vec<String> {
    let mut places_of: HashMap<String, Vec<usize>> = HashMap::new();
    for (place, warning) in warnings.iter().enumerate() {
        if let Some(kind) = kind(warning) {
            places_of.entry(kind).or_default().push(place);
        }
    }
    let mut told: Vec<Option<String>> = warnings.into_iter().map(Some).collect();
    for places in places_of.values().filter(|places| places.len() > FEW) {
        let first = told[places[0]].take();
        for place in places {
            told[*place] = None;
        }
        told[places[0]] = first.map(|warning| format!("{warning} (and {} more like it)", places.len() - 1));
    }
    told.into_iter().flatten().collect()
}

/// What a warning says of its file, without the numbers in it; `None` where it is of no file.
fn kind(warning: &str) -> Option<String> {
    let (_, said) = warning.split_once(": ")?;
    Some(said.chars().filter(|letter| !letter.is_ascii_digit() && *letter != '-').collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_that_differ_in_files_and_numbers_are_told_once_where_they_are_many() {
        let starts =
            |count: usize| (1..=count).map(|k| format!("runs/{k}.csv: the track starts -{k}.5 m away")).collect();
        let few: Vec<String> = starts(3);
        assert_eq!(told_once(few.clone()), few);
        let other = "runs/2.csv: row 3 is empty".to_owned();
        let without_file = "robot.toml has the numbers of an example".to_owned();
        let mut many: Vec<String> = starts(4);
        many.splice(2..2, [other.clone()]);
        many.extend(vec![without_file.clone(); 5]);
        let told = told_once(many);
        let first = "runs/1.csv: the track starts -1.5 m away (and 3 more like it)".to_owned();
        assert_eq!(told, [vec![first, other], vec![without_file; 5]].concat());
    }
}
