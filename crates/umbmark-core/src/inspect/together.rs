//! Sentences that repeat run after run, as one.

/// So many names are told one by one.
const FEW: usize = 3;

/// Sentences whose numbers differ are one from so many on.
const MANY: usize = 3;

/// Sentences "name: text" with one text as one sentence with all names, in the order in which they came; so many of them also where
/// only numbers differ.
pub(super) fn merged(warnings: &[String]) -> Vec<String> {
    let mut alike: Vec<(String, Vec<(&str, &str)>)> = Vec::new();
    for warning in warnings {
        let (name, text) = warning.split_once(": ").unwrap_or(("", warning));
        let pattern = if name.is_empty() { warning.clone() } else { without_numbers(text) };
        let other = |same: &[(&str, &str)]| name.is_empty() || same.iter().all(|(own, _)| *own != name);
        match alike.iter_mut().find(|(own, same)| *own == pattern && other(same)) {
            Some((_, same)) => same.push((name, text)),
            None => alike.push((pattern, vec![(name, text)])),
        }
    }
    let told = |same: &Vec<(&str, &str)>| {
        let differ = same.iter().any(|(_, text)| *text != same[0].1);
        if differ && same.len() < MANY {
            return same.iter().map(|one| sentence(std::slice::from_ref(one))).collect();
        }
        vec![sentence(same)]
    };
    alike.iter().flat_map(|(_, same)| told(same)).collect()
}

fn sentence(same: &[(&str, &str)]) -> String {
    let mut names: Vec<&str> = Vec::new();
    same.iter().filter(|(name, _)| !name.is_empty()).for_each(|(name, _)| {
        if !names.contains(name) {
            names.push(name);
        }
    });
    let text = same[0].1;
    let differ = same.iter().any(|(_, other)| *other != text);
    let beside = if differ { " (numbers of the first)" } else { "" };
    match names.as_slice() {
        [] => text.to_owned(),
        [name] => format!("{name}: {text}{beside}"),
        few if few.len() <= FEW => format!("{}: {text}{beside}", few.join(", ")),
        [first, .., last] => format!("{first} to {last} ({} files): {text}{beside}", names.len()),
    }
}

/// A text with each number as one sign.
fn without_numbers(text: &str) -> String {
    let mut pattern = String::with_capacity(text.len());
    let number = |c: char| c.is_ascii_digit();
    for c in text.chars() {
        match number(c) {
            true if pattern.ends_with('#') => {}
            true => pattern.push('#'),
            // 3.1 and 3 are both a number.
            false if matches!(c, '.' | '-' | '+') => {}
            false => pattern.push(c),
        }
    }
    pattern
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_repeats_run_after_run_is_one_sentence() {
        let said = |texts: &[&str]| merged(&texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>());
        assert_eq!(
            said(&["a.csv: 3 poses are stale", "b.csv: 3 poses are stale"]),
            ["a.csv, b.csv: 3 poses are stale"]
        );
        let six: Vec<String> = (1..=6).map(|k| format!("run{k}.csv: the track starts {k}.5 m away")).collect();
        let expected = "run1.csv to run6.csv (6 files): the track starts 1.5 m away (numbers of the first)";
        assert_eq!(merged(&six), [expected]);
        let mixed = ["a.csv: is late", "note", "b.csv: is early", "note"];
        assert_eq!(said(&mixed), ["a.csv: is late", "note", "b.csv: is early"]);
        assert_eq!(said(&[]), Vec::<String>::new());
        let of_one = ["a.csv: line 1 is late", "a.csv: line 2 is late", "a.csv: line 3 is late"];
        assert_eq!(said(&of_one), of_one);
        let two = ["a.csv: 1 row is late", "b.csv: 2 row is late"];
        assert_eq!(said(&two), two);
    }
}
