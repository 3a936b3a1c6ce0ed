//! `conditions.csv`: under which conditions runs were driven.

use super::columns::{Columns, Quantity};
use super::error::{At, DatasetError, LineProblem, quoted};
use super::file_names::RUNS;
use super::label;
use super::probe::Probe;
use super::sheet::Sheet;
use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use umbmark_core::dataset::{Dataset, Run, RunConditions, Stated};
use umbmark_core::prose::counted;

/// The name of the file.
pub(super) const CONDITIONS: &str = "conditions.csv";
const RUN: &str = "run";
const EXPECTED: &str = "run,floor,load_kg";
/// So many names of runs are told where one is not found.
const FIRST: usize = 4;
/// The largest number believed.
const LARGEST: f64 = 1e12;

/// The file of a place: in its folder, or above it where that is called runs.
fn file_of(probe: &Probe) -> Option<PathBuf> {
    let in_runs = probe.folder.file_name().is_some_and(|name| name == RUNS);
    let folders = [Some(probe.folder.clone()), in_runs.then(|| probe.folder.join(".."))];
    let names = [CONDITIONS.to_owned(), format!("{CONDITIONS}.gz")];
    let files = folders.into_iter().flatten().flat_map(|folder| names.clone().map(|name| folder.join(name)));
    files.into_iter().find(|file| file.is_file())
}

/// Reads what is stated of the runs of a place, where something is. Rows of runs that are not there are refused in a folder; of one file, they are
/// those of other files.
pub(super) fn read_conditions(probe: &Probe, data: &mut Dataset) -> Result<(), DatasetError> {
    let Some(file) = file_of(probe) else { return Ok(()) };
    let rows = parse_conditions(Source::open(&file)?)?;
    let file = file.display().to_string();
    let mut stated: BTreeMap<usize, (usize, Vec<(String, Stated)>)> = BTreeMap::new();
    for Row { line, run, values } in rows {
        let Some(name) = run else {
            (0..data.runs.len()).for_each(|run| {
                stated.insert(run, (line, values.clone()));
            });
            break;
        };
        let Some(run) = named(&data.runs, &name) else {
            if !probe.is_folder {
                continue;
            }
            let names: Vec<&str> = data.runs.iter().map(|run| run.name.as_str()).collect();
            let near = umbmark_core::parameter::nearest(&name, names.iter().copied());
            let near = near.map_or(String::new(), |near| format!("did you mean {}? ", quoted(near)));
            let more = if names.len() > FIRST { ", ..." } else { "" };
            let first: Vec<String> = names.iter().take(FIRST).map(|name| quoted(name)).collect();
            let remedy = format!("{near}the runs are {}{more}", first.join(", "));
            return Err(wrong_run(&file, line, &name, "the name of a run of this dataset", &remedy));
        };
        if let Some((first, _)) = stated.insert(run, (line, values)) {
            let remedy = format!("line {first} has the same run; keep one of the two rows");
            return Err(wrong_run(&file, line, &name, "each run once", &remedy));
        }
    }
    let missing = data.runs.len() - stated.len();
    if missing > 0 && probe.is_folder {
        let (runs, has) = (counted(missing, "run"), if missing == 1 { "has" } else { "have" });
        data.warnings.push(format!("{file}: {runs} {has} no row; their conditions are not known"));
    }
    data.conditions = stated
        .into_iter()
        .map(|(run, (_, stated))| RunConditions { run: data.runs[run].name.clone(), stated })
        .collect();
    Ok(())
}

fn wrong_run(file: &str, line: usize, name: &str, allowed: &str, remedy: &str) -> DatasetError {
    let (column, value) = (RUN.to_owned(), quoted(name));
    At::new(file, line).refuse(LineProblem::Cell { column, value, allowed: allowed.into(), remedy: remedy.into() })
}

/// The run of a name; or of the test, direction and number in it.
fn named(runs: &[Run], name: &str) -> Option<usize> {
    let by_name = runs.iter().position(|run| run.name == name);
    by_name.or_else(|| {
        let named = label::parse(name);
        let (number, direction) = (named.number?, named.direction?);
        let is_it = |run: &Run| {
            run.number == number && run.direction == direction && named.test.is_none_or(|test| test == run.test)
        };
        runs.iter().position(is_it)
    })
}

/// A row of the file.
pub(super) struct Row {
    line: usize,
    /// `None` where the row is of all runs.
    run: Option<String>,
    pub values: Vec<(String, Stated)>,
}

pub(super) fn parse_conditions(source: Source) -> Result<Vec<Row>, DatasetError> {
    let sheet = Sheet::open(source, EXPECTED)?;
    let (file, header_line) = (sheet.file().to_owned(), sheet.header_line);
    let refuse = |line: usize, problem: LineProblem| At::new(file.clone(), line).refuse(problem);
    let mut columns = Columns::of(&sheet);
    let run = columns.find(RUN, Quantity::Bare)?;
    let mut names: BTreeSet<&str> = BTreeSet::new();
    let mut conditions = Vec::new();
    for name in sheet.header.iter().filter(|name| *name != RUN && !name.is_empty()) {
        if !names.insert(name) {
            let (first, second) = (name.clone(), name.clone());
            return Err(refuse(header_line, LineProblem::ColumnTwice { first, second }));
        }
        conditions.extend(columns.find(name, Quantity::Bare)?);
    }
    if conditions.is_empty() {
        let remedy = format!("add one for each condition, as in {EXPECTED}");
        return Err(refuse(header_line, LineProblem::MissingColumn { column: "of a condition".into(), remedy }));
    }
    let mut rows: Vec<Row> = Vec::new();
    sheet.for_each(|row| {
        let name = run.as_ref().map(|column| row.text(column).to_owned());
        if let (Some(column), Some("")) = (&run, name.as_deref()) {
            return Err(row.wrong(
                column,
                "the name of a run, as cw_01",
                "leave out the column to state the same of all runs",
            ));
        }
        if run.is_none() && !rows.is_empty() {
            let remedy = "a file without the column run has one row, which is of all runs; add the column".to_owned();
            return Err(
                At::new(file.clone(), row.line).refuse(LineProblem::MissingColumn { column: RUN.into(), remedy })
            );
        }
        let mut values = Vec::new();
        for column in &conditions {
            let text = row.text(column);
            let value = match text.parse::<f64>() {
                _ if text.is_empty() => continue,
                Ok(number) if number.abs() <= LARGEST => Stated::Number(number),
                Ok(_) => {
                    let allowed = format!("a word, or a number of at most {LARGEST:e} either way");
                    return Err(row.wrong(column, &allowed, "leave the cell empty where it is not known"));
                }
                Err(_) => Stated::Word(text.replace(char::is_control, "?")),
            };
            values.push((column.name.replace(char::is_control, "?"), value));
        }
        rows.push(Row { line: row.line, run: name, values });
        Ok(())
    })?;
    Ok(rows)
}

/// The file of what is stated, with runs as they are called in written datasets; `None` where nothing is.
pub(super) fn conditions_text(data: &Dataset) -> Option<Vec<u8>> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in data.conditions.iter().flat_map(|stated| &stated.stated) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return None;
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = [RUN].into_iter().chain(names.iter().copied());
    writer.write_record(header).ok()?;
    for (run, stated) in of_runs(data) {
        let of =
            |name: &&str| stated.iter().find(|(own, _)| own == name).map_or(String::new(), |(_, value)| value.word());
        let label = label::label(run.test, run.direction, run.number);
        writer.write_record([label].into_iter().chain(names.iter().map(of))).ok()?;
    }
    writer.into_inner().ok()
}

/// What is stated of each run of which something is, in the order of their tests, directions and numbers.
pub(super) fn of_runs(data: &Dataset) -> Vec<(&Run, &Vec<(String, Stated)>)> {
    let stated = |run: &Run| data.conditions.iter().find(|stated| stated.run == run.name && !stated.stated.is_empty());
    let mut found: Vec<_> = data.runs.iter().filter_map(|run| Some((run, &stated(run)?.stated))).collect();
    found.sort_by_key(|(run, _)| (run.test, run.direction, run.number));
    found
}
