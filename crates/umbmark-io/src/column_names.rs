//! `[columns]` of a robot.toml: names that columns have in the tables of a dataset, in place of the usual ones.

use super::document::Table;
use super::error::{At, DatasetError, LineProblem, quoted};
use super::file_names::FILL_IN;
use std::cell::Cell;
use std::rc::Rc;
use umbmark_core::dataset::ColumnName;

/// The table in robot.toml.
pub(super) const COLUMNS: &str = "columns";

/// Names of columns, and where each is said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnNames {
    file: String,
    names: Vec<(ColumnName, usize)>,
}

impl ColumnNames {
    /// Reads the table of a file.
    pub(super) fn read(file: &str, table: &Table) -> Result<ColumnNames, DatasetError> {
        let mut names: Vec<(ColumnName, usize)> = Vec::new();
        for entry in table.entries() {
            let allowed = "what stands above this column in the tables, e.g. \"left_count\"";
            let header = entry.word(allowed)?.trim();
            if header.is_empty() || header == FILL_IN {
                return Err(entry.wrong(allowed, "look at the header of a log"));
            }
            if names.iter().any(|(other, _)| other.header.to_lowercase() == header.to_lowercase()) {
                return Err(entry.wrong("a column that no other line names", ""));
            }
            names.push((ColumnName { name: entry.key.to_lowercase(), header: header.to_owned() }, entry.line()));
        }
        Ok(ColumnNames { file: file.to_owned(), names })
    }

    /// Those of a dataset that was read.
    pub(super) fn of(names: &[ColumnName]) -> ColumnNames {
        ColumnNames { file: String::new(), names: names.iter().map(|name| (name.clone(), 0)).collect() }
    }

    /// Each name.
    pub(super) fn iter(&self) -> impl Iterator<Item = &ColumnName> {
        self.names.iter().map(|(name, _)| name)
    }
}

/// Names of columns that are given their usual ones, table by table, and which of them were met.
#[derive(Clone, Debug, Default)]
pub(super) struct Renaming(Rc<(ColumnNames, Vec<Cell<bool>>)>);

impl Renaming {
    pub fn by(names: ColumnNames) -> Renaming {
        let met = names.names.iter().map(|_| Cell::new(false)).collect();
        Renaming(Rc::new((names, met)))
    }

    /// Gives the columns of a header, which is in lower case, their usual names.
    pub fn rename(&self, header: &mut [String]) {
        let (names, met) = &*self.0;
        for column in header {
            if let Some(place) = names.iter().position(|name| name.header.to_lowercase() == *column) {
                column.clone_from(&names.names[place].0.name);
                met[place].set(true);
            }
        }
    }

    /// Each name.
    pub fn names(&self) -> Vec<ColumnName> {
        self.0.0.iter().cloned().collect()
    }

    /// Refuses a name that no table has: what it stands for would be missing without a word.
    pub fn check(&self) -> Result<(), DatasetError> {
        let (names, met) = &*self.0;
        match names.names.iter().zip(met).find(|(_, met)| !met.get()) {
            None => Ok(()),
            Some(((name, line), _)) => Err(At::new(names.file.clone(), *line).refuse(LineProblem::Value {
                key: name.name.clone(),
                value: quoted(&name.header),
                allowed: "what stands above a column".into(),
                remedy: "no table of this dataset has it".into(),
            })),
        }
    }
}
