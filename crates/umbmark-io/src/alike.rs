//! Warnings that many files share, told once.

/// So many warnings that differ in their numbers only are told one by one.
const FEW: usize = 3;

/// Warnings, each of a file ("FILE: ..."): of more than [`FEW`] that differ in their files and numbers only, the first, and how many more
/// there are.
pub(super) fn told_once(warnings: Vec<String>) -> Vec<String> {
    let kinds: Vec<Option<String>> = warnings.iter().map(|warning| kind(warning)).collect();
    let alike = |place: usize| kinds.iter().filter(|kind| kind.is_some() && **kind == kinds[place]).count();
    let is_first = |place: usize| !kinds[..place].contains(&kinds[place]);
    let of = |(place, warning): (usize, String)| match alike(place) {
        count if count <= FEW => Some(warning),
        count if is_first(place) => Some(format!("{warning} (and {} more files alike)", count - 1)),
        _ => None,
    };
    warnings.into_iter().enumerate().filter_map(of).collect()
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
        let first = "runs/1.csv: the track starts -1.5 m away (and 3 more files alike)".to_owned();
        assert_eq!(told, [vec![first, other], vec![without_file; 5]].concat());
    }
}
