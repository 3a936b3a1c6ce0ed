//! What is stated of runs, as conditions that can be asked for: which of them differ, which cannot be told from each other.

use super::{Dataset, Stated};
use std::collections::BTreeMap;

/// The name of the condition that several datasets have by themselves.
pub const SESSION: &str = "session";

/// The name of the condition in which sets with paths of their own differ besides.
pub const PATH: &str = "path";

/// Between what values of a condition differ.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// One value a level: their words, in the order in which they first stand.
    Levels(Vec<String>),
    /// A number, on which values depend by a slope: its smallest and its largest.
    Amount([f64; 2]),
}

/// A condition that is not the same in all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its name, and those of others that divide the runs in the same way.
    pub names: Vec<String>,
    /// What it is.
    pub kind: Kind,
    /// Of each run: its level's place, or the number; `None` where it is not stated.
    pub(crate) of_runs: Vec<Option<f64>>,
}

impl Condition {
    /// How many columns it has in a regression.
    pub(crate) fn width(&self) -> usize {
        match &self.kind {
            Kind::Levels(levels) => levels.len() - 1,
            Kind::Amount(_) => 1,
        }
    }

    /// Its column of a run.
    pub(crate) fn column(&self, run: usize, column: usize) -> f64 {
        let value = self.of_runs[run].unwrap_or(0.0);
        match self.kind {
            Kind::Levels(_) => f64::from(u8::from(value == (column + 1) as f64)),
            Kind::Amount(_) => value,
        }
    }

    /// Whether every run of which both are stated tells its value from that of the other.
    pub(crate) fn is_determined_by(&self, other: &Condition) -> bool {
        let mut known: BTreeMap<u64, f64> = BTreeMap::new();
        let mut pairs = self.of_runs.iter().zip(&other.of_runs).filter_map(|(own, other)| Some(((*own)?, (*other)?)));
        pairs.all(|(own, other)| *known.entry(other.to_bits()).or_insert(own) == own)
    }

    /// How many values of another condition each of its own values has, by its value.
    pub(crate) fn values_of(&self, other: &Condition) -> BTreeMap<u64, usize> {
        let mut pairs: Vec<(u64, u64)> = self
            .of_runs
            .iter()
            .zip(&other.of_runs)
            .filter_map(|(own, other)| Some(((*own)?.to_bits(), (*other)?.to_bits())))
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut counts = BTreeMap::new();
        pairs.into_iter().for_each(|(own, _)| *counts.entry(own).or_insert(0) += 1);
        counts
    }

    fn is_stated_alike(&self, other: &Condition) -> bool {
        self.of_runs.iter().zip(&other.of_runs).all(|(own, other)| own.is_some() == other.is_some())
    }

    /// Whether it has the same columns as another one.
    fn is_as(&self, other: &Condition) -> bool {
        let both_levels = matches!((&self.kind, &other.kind), (Kind::Levels(_), Kind::Levels(_)));
        let two = |condition: &Condition| condition.values_of(condition).len() == 2;
        (both_levels || two(self) && two(other))
            && self.is_stated_alike(other)
            && self.is_determined_by(other)
            && other.is_determined_by(self)
    }
}

/// The conditions of some runs, each by the runs' names; and those that are the same in all of them.
pub(crate) fn conditions(data: &Dataset, runs: &[String]) -> (Vec<Condition>, Vec<String>) {
    let stated = |run: &String| data.conditions.iter().find(|stated| stated.run == *run);
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in runs.iter().filter_map(stated).flat_map(|stated| &stated.stated) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let of = |name: &str| -> Vec<Option<Stated>> {
        let find = |run: &String| Some(stated(run)?.stated.iter().find(|(own, _)| own == name)?.1.clone());
        runs.iter().map(find).collect()
    };
    let mut all: Vec<(String, Vec<Option<Stated>>)> =
        names.iter().filter(|name| **name != SESSION).map(|name| ((*name).to_owned(), of(name))).collect();
    let sessions = sessions(data, runs, &of(SESSION));
    if sessions.iter().any(Option::is_some) {
        all.push((SESSION.to_owned(), sessions));
    }
    let (mut found, mut same): (Vec<Condition>, Vec<String>) = (Vec::new(), Vec::new());
    for (name, values) in all {
        let Some(condition) = condition(&name, &values) else {
            same.push(name);
            continue;
        };
        match found.iter_mut().find(|known| known.is_as(&condition)) {
            Some(known) => known.names.push(name),
            None => found.push(condition),
        }
    }
    (found, same)
}

/// The session of each run: what is stated, within the dataset that it comes from.
fn sessions(data: &Dataset, runs: &[String], stated: &[Option<Stated>]) -> Vec<Option<Stated>> {
    let of_set = |name: &String| {
        let place = data.runs.iter().position(|run| run.name == *name)?;
        data.sessions.iter().rev().find(|session| session.first <= place).map(|session| session.name.clone())
    };
    let of = |(run, stated): (&String, &Option<Stated>)| match (of_set(run), stated) {
        (Some(set), Some(own)) => Some(Stated::Word(format!("{set}, {}", own.word()))),
        (Some(set), None) => Some(Stated::Word(set)),
        // Sessions are levels, whatever they are called.
        (None, own) => own.as_ref().map(|own| Stated::Word(own.word())),
    };
    runs.iter().zip(stated).map(of).collect()
}

/// A condition; `None` where it is the same in all runs of which it is stated.
fn condition(name: &str, values: &[Option<Stated>]) -> Option<Condition> {
    let names = vec![name.to_owned()];
    let numbers: Option<Vec<Option<f64>>> = values
        .iter()
        .map(|value| match value {
            None => Some(None),
            Some(Stated::Number(number)) => Some(Some(*number)),
            Some(Stated::Word(_)) => None,
        })
        .collect();
    if let Some(of_runs) = numbers {
        let stated = || of_runs.iter().flatten().copied();
        let (low, high) = (stated().fold(f64::INFINITY, f64::min), stated().fold(f64::NEG_INFINITY, f64::max));
        return (low < high).then_some(Condition { names, kind: Kind::Amount([low, high]), of_runs });
    }
    let mut levels: Vec<String> = Vec::new();
    let of_runs = values
        .iter()
        .map(|value| {
            let word = value.as_ref()?.word();
            let place = levels.iter().position(|level| *level == word).unwrap_or_else(|| {
                levels.push(word);
                levels.len() - 1
            });
            Some(place as f64)
        })
        .collect();
    (levels.len() > 1).then_some(Condition { names, kind: Kind::Levels(levels), of_runs })
}

/// Runs that were driven under several levels of a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// The condition, and others that divide the runs in the same way.
    pub names: Vec<String>,
    /// What the levels are called.
    pub levels: Vec<String>,
    of_runs: BTreeMap<String, usize>,
}

impl Levels {
    /// The conditions of a dataset whose levels stand for more than a run each: a level of one run is left out where runs are.
    pub fn of(data: &Dataset) -> Vec<Levels> {
        let runs: Vec<String> = data.runs.iter().map(|run| run.name.clone()).collect();
        let levels = |condition: Condition| {
            let Kind::Levels(levels) = condition.kind else { return None };
            let own = |(run, level): (&String, &Option<f64>)| Some((run.clone(), (*level)? as usize));
            let of_runs: BTreeMap<String, usize> = runs.iter().zip(&condition.of_runs).filter_map(own).collect();
            let is_path = data.drives_other_paths() && condition.names.iter().any(|name| name == SESSION);
            let names = condition.names.into_iter().chain(is_path.then(|| PATH.to_owned())).collect();
            (of_runs.len() > levels.len()).then_some(Levels { names, levels, of_runs })
        };
        conditions(data, &runs).0.into_iter().filter_map(levels).collect()
    }

    /// The place of the level of a run; `None` where it is not stated.
    pub fn of_run(&self, run: &str) -> Option<usize> {
        self.of_runs.get(run).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::RunConditions;

    fn data(rows: &[(&str, &[(&str, Stated)])]) -> (Dataset, Vec<String>) {
        let of = |(run, stated): &(&str, &[(&str, Stated)])| RunConditions {
            run: (*run).to_owned(),
            stated: stated.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect(),
        };
        let names = rows.iter().map(|(run, _)| (*run).to_owned()).collect();
        (Dataset { conditions: rows.iter().map(of).collect(), ..Dataset::default() }, names)
    }

    fn word(word: &str) -> Stated {
        Stated::Word(word.into())
    }

    #[test]
    fn words_are_levels_numbers_are_amounts_and_what_never_differs_is_not_asked() {
        let row = |floor: &str, load: f64, battery: &str| {
            vec![("floor", word(floor)), ("load_kg", Stated::Number(load)), ("battery", word(battery))]
        };
        let rows = [row("tile", 0.0, "a"), row("felt", 2.0, "a"), row("tile", 5.0, "a")];
        let names = ["1", "2", "3"];
        let rows: Vec<(&str, &[(&str, Stated)])> = names.iter().copied().zip(rows.iter().map(Vec::as_slice)).collect();
        let (data, names) = data(&rows);
        let (found, same) = conditions(&data, &names);
        assert_eq!(same, ["battery"]);
        assert_eq!(found[0].kind, Kind::Levels(vec!["tile".into(), "felt".into()]));
        assert_eq!(found[1].kind, Kind::Amount([0.0, 5.0]));
        assert_eq!((found[0].column(1, 0), found[0].column(2, 0), found[1].column(2, 0)), (1.0, 0.0, 5.0));
        assert!(found[0].is_determined_by(&found[1]) && !found[1].is_determined_by(&found[0]));
    }

    #[test]
    fn conditions_that_divide_the_runs_alike_are_one_with_two_names() {
        let row = |floor: &'static str, load: f64| [("floor", word(floor)), ("load_kg", Stated::Number(load))];
        let rows = [row("tile", 0.0), row("felt", 2.0), row("felt", 2.0)];
        let named: Vec<(&str, &[(&str, Stated)])> =
            ["1", "2", "3"].iter().copied().zip(rows.iter().map(|row| &row[..])).collect();
        let (data, names) = data(&named);
        let (found, _) = conditions(&data, &names);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].names, ["floor", "load_kg"]);
    }

    #[test]
    fn sessions_are_levels_even_where_they_are_called_by_numbers() {
        let row = |session: f64| [(SESSION, Stated::Number(session))];
        let rows = [row(1.0), row(2.0), row(3.0)];
        let named: Vec<(&str, &[(&str, Stated)])> =
            ["1", "2", "3"].iter().copied().zip(rows.iter().map(|row| &row[..])).collect();
        let (data, names) = data(&named);
        let (found, _) = conditions(&data, &names);
        assert_eq!(found[0].kind, Kind::Levels(vec!["1".into(), "2".into(), "3".into()]));
    }

    #[test]
    fn levels_of_a_run_each_and_amounts_are_not_left_out_and_sets_of_other_paths_differ_in_path_too() {
        let run = |name: &str| crate::dataset::Run {
            name: name.into(),
            number: 1,
            direction: None,
            test: crate::effect::TestKind::Systematic,
            log: None,
            returned: None,
        };
        let row = |floor: &'static str, load: f64, own: &'static str| {
            [("floor", word(floor)), ("load_kg", Stated::Number(load)), ("own", word(own))]
        };
        let rows = [row("tile", 0.0, "a"), row("felt", 2.0, "b"), row("felt", 5.0, "c")];
        let names = ["1", "2", "3"];
        let named: Vec<(&str, &[(&str, Stated)])> =
            names.iter().copied().zip(rows.iter().map(|row| &row[..])).collect();
        let (mut data, _) = data(&named);
        data.runs = names.map(run).to_vec();
        let found = Levels::of(&data);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (&found[0].names[..], &found[0].levels[..]),
            (&["floor".to_owned()][..], &["tile".to_owned(), "felt".to_owned()][..])
        );
        assert_eq!([found[0].of_run("1"), found[0].of_run("3"), found[0].of_run("4")], [Some(0), Some(1), None]);
        let session = |name: &str, first, other_path| crate::dataset::Session { name: name.into(), first, other_path };
        data.sessions = vec![session("squares", 0, false), session("circles", 2, true)];
        let found = Levels::of(&data);
        assert_eq!(found[1].names, ["session", "path"]);
    }
}
