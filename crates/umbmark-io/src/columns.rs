//! Columns by name and unit, and the numbers in their cells.

use super::error::{At, DatasetError, LineProblem, did_you_mean, quoted};
use super::sheet::{Row, Sheet};
use super::source::Source;
use std::collections::BTreeSet;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Length,
    Angle,
    Time,
    TurnRate,
    /// Numbers and words, whose names have no unit.
    Bare,
}

/// A unit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    name: &'static str,
    /// How many of it make the SI unit.
    per_si: f64,
    /// The largest number believed, in this unit.
    largest: f64,
}

const fn unit(name: &'static str, per_si: f64, largest: f64) -> Unit {
    Unit { name, per_si, largest }
}

impl Quantity {
    fn units(self) -> &'static [Unit] {
        const LENGTHS: [Unit; 3] = [unit("m", 1.0, 1e7), unit("mm", 1e3, 1e10), unit("cm", 1e2, 1e9)];
        const ANGLES: [Unit; 2] = [unit("rad", 1.0, 1e6), unit("deg", 180.0 / std::f64::consts::PI, 1e8)];
        const TIMES: [Unit; 4] =
            [unit("s", 1.0, 1e12), unit("ms", 1e3, 1e15), unit("us", 1e6, 1e18), unit("ns", 1e9, 1e21)];
        const TURN_RATES: [Unit; 2] = [unit("rad_s", 1.0, 1e4), unit("deg_s", 180.0 / std::f64::consts::PI, 1e6)];
        match self {
            Quantity::TurnRate => &TURN_RATES,
            Quantity::Length => &LENGTHS,
            Quantity::Angle => &ANGLES,
            Quantity::Time => &TIMES,
            Quantity::Bare => &[],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Quantity::Length => "length",
            Quantity::Angle => "angle",
            Quantity::Time => "time",
            Quantity::TurnRate => "turn rate",
            Quantity::Bare => "number",
        }
    }
}

/// A column that was found.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub name: String,
    index: usize,
    unit: Option<Unit>,
}

/// The columns of a sheet while they are looked up.
pub(super) struct Columns<'s> {
    sheet: &'s Sheet<'s>,
    used: BTreeSet<usize>,
    known: Vec<String>,
    /// The first column of each quantity, whose unit the others must share.
    leaders: Vec<(Quantity, Column)>,
}

impl<'s> Columns<'s> {
    pub fn of(sheet: &'s Sheet<'s>) -> Columns<'s> {
        Columns { sheet, used: BTreeSet::new(), known: Vec::new(), leaders: Vec::new() }
    }

    /// The column `base` with any unit of its quantity, if it is there.
    pub fn find(&mut self, base: &str, quantity: Quantity) -> Result<Option<Column>, DatasetError> {
        let names: Vec<(String, Option<Unit>)> = match quantity {
            Quantity::Bare => vec![(base.to_owned(), None)],
            _ => quantity.units().iter().map(|unit| (format!("{base}_{}", unit.name), Some(*unit))).collect(),
        };
        let mut found: Option<Column> = None;
        for (index, header) in self.sheet.header.iter().enumerate() {
            let Some((name, unit)) = names.iter().find(|(name, _)| name == header) else { continue };
            if let Some(first) = found {
                let (first, second) = (first.name, name.clone());
                return Err(self.refuse(LineProblem::ColumnTwice { first, second }));
            }
            found = Some(Column { name: name.clone(), index, unit: *unit });
        }
        self.known.extend(names.into_iter().map(|(name, _)| name));
        match &found {
            Some(column) => self.take(column, quantity)?,
            None => self.check_unit(base, quantity)?,
        }
        Ok(found)
    }

    /// Whether any of these columns is there, with whatever unit.
    pub fn given(&self, bases: &[&str]) -> bool {
        let stands = |base: &&str| {
            self.sheet.header.iter().any(|header| header.strip_prefix(*base).is_some_and(|rest| rest.starts_with('_')))
        };
        bases.iter().any(stands)
    }

    /// The column `base`, which must be there; `remedy` says why.
    pub fn need(&mut self, base: &str, quantity: Quantity, remedy: &str) -> Result<Column, DatasetError> {
        match self.find(base, quantity)? {
            Some(column) => Ok(column),
            None => Err(self.missing(base, quantity, remedy)),
        }
    }

    /// The error of a column that is not there.
    pub fn missing(&self, base: &str, quantity: Quantity, remedy: &str) -> DatasetError {
        let column = quantity.units().first().map_or(base.to_owned(), |unit| format!("{base}_{}", unit.name));
        let unused = (0..self.sheet.header.len()).filter(|i| !self.used.contains(i)).map(|i| &*self.sheet.header[i]);
        let remedy = match umbmark_core::parameter::nearest(&column, unused) {
            Some(near) => format!("is it {}? {remedy}", quoted(near)),
            None => remedy.to_owned(),
        };
        self.refuse(LineProblem::MissingColumn { column, remedy })
    }

    /// The error of a header that cannot be.
    fn refuse(&self, problem: LineProblem) -> DatasetError {
        At::new(self.file(), self.sheet.header_line).refuse(problem)
    }

    /// Ends the search: columns that nobody asked for are refused where they resemble one that could have been meant,
    /// else named in a warning.
    pub fn finish(self, warnings: &mut Vec<String>) -> Result<(), DatasetError> {
        let given: BTreeSet<&String> = self.sheet.header.iter().collect();
        let free: Vec<&str> = self.known.iter().filter(|name| !given.contains(name)).map(String::as_str).collect();
        for (index, header) in self.sheet.header.iter().enumerate() {
            if self.used.contains(&index) || header.is_empty() {
                continue;
            }
            if let Some(nearest) = umbmark_core::parameter::nearest(header, free.iter().copied()) {
                let (column, nearest) = (quoted(header), nearest.to_owned());
                return Err(self.refuse(LineProblem::UnknownColumn { column, nearest }));
            }
            warnings.push(format!("{}: column {} is not used", self.sheet.file(), quoted(header)));
        }
        Ok(())
    }

    fn file(&self) -> String {
        self.sheet.file().to_owned()
    }

    fn take(&mut self, column: &Column, quantity: Quantity) -> Result<(), DatasetError> {
        self.used.insert(column.index);
        match self.leaders.iter().find(|(q, _)| *q == quantity) {
            Some((_, leader)) if leader.unit != column.unit => Err(self.refuse(LineProblem::MixedUnits {
                first: leader.name.clone(),
                second: column.name.clone(),
                quantity: quantity.name(),
            })),
            Some(_) => Ok(()),
            None => {
                self.leaders.push((quantity, column.clone()));
                Ok(())
            }
        }
    }

    /// Refuses `base` without a unit, or with an unknown one.
    fn check_unit(&self, base: &str, quantity: Quantity) -> Result<(), DatasetError> {
        if quantity == Quantity::Bare {
            return Ok(());
        }
        for header in &self.sheet.header {
            let Some(rest) = header.strip_prefix(base) else { continue };
            let found = match rest.strip_prefix(['_', ' ', '[', '(']) {
                _ if rest.is_empty() => "the unit is missing".to_owned(),
                Some(unit) if !unit.contains('_') => {
                    format!("{} is no unit of {}", quoted(unit.trim_end_matches([']', ')'])), quantity.name())
                }
                _ => continue,
            };
            let allowed =
                quantity.units().iter().map(|unit| format!("_{}", unit.name)).collect::<Vec<_>>().join(" or ");
            return Err(self.refuse(LineProblem::Unit { column: quoted(header), found, allowed }));
        }
        Ok(())
    }
}

impl<'r> Row<'r> {
    /// The text of a cell.
    #[inline]
    pub fn text(&self, column: &Column) -> &'r str {
        self.cell(column.index)
    }

    /// The number in a cell, in SI units.
    #[inline]
    pub fn number(&self, column: &Column) -> Result<f64, DatasetError> {
        let text = self.text(column);
        number(text, column.unit).ok_or_else(|| self.refused(&column.name, text, column.unit))
    }

    /// The number in a cell, in SI units, where it is not empty.
    #[inline]
    pub fn number_or(&self, column: &Column) -> Result<Option<f64>, DatasetError> {
        if self.text(column).is_empty() { Ok(None) } else { self.number(column).map(Some) }
    }

    /// A number of a layout that has its own names, in the units of the layout.
    pub fn own_number(&self, name: &str, text: &str) -> Result<f64, DatasetError> {
        number(text, None).ok_or_else(|| self.refused(name, text, None))
    }

    /// The error of a cell that holds no number that is believed.
    #[cold]
    fn refused(&self, name: &str, text: &str, unit: Option<Unit>) -> DatasetError {
        let number = unit
            .map_or("a finite number".to_owned(), |unit| format!("a finite number in {}", unit.name.replace('_', "/")));
        let wrong = |remedy| self.wrong_cell(name, text, &number, remedy);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                let allowed = format!("{number} of at most {:e} either way", largest(unit));
                self.wrong_cell(name, text, &allowed, "")
            }
            Ok(_) => wrong("measure again, or leave out the row"),
            Err(_) if text.is_empty() => wrong("fill it in, or leave out the row"),
            Err(_) if text.replace(',', ".").parse::<f64>().is_ok() => {
                wrong("write decimals with a point (0.123, not 0,123)")
            }
            Err(_) => wrong(""),
        }
    }

    /// One of a few words, in upper or lower case.
    pub fn word<T: Copy>(&self, column: &Column, words: &[(&str, T)]) -> Result<T, DatasetError> {
        let text = self.text(column).to_lowercase();
        if let Some((_, meaning)) = words.iter().find(|(word, _)| *word == text) {
            return Ok(*meaning);
        }
        let (last, others) = words.split_last().map_or(("", &words[..0]), |(last, others)| (last.0, others));
        let others = others.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
        let allowed = format!("{others} or {last}");
        let remedy = did_you_mean(&text, words.iter().map(|(word, _)| *word));
        Err(self.wrong(column, &allowed, &remedy))
    }

    /// The error of a cell that is not what is allowed.
    pub fn wrong(&self, column: &Column, allowed: &str, remedy: &str) -> DatasetError {
        self.wrong_cell(&column.name, self.text(column), allowed, remedy)
    }

    fn wrong_cell(&self, name: &str, text: &str, allowed: &str, remedy: &str) -> DatasetError {
        At::new(self.file, self.line).refuse(LineProblem::Cell {
            column: name.to_owned(),
            value: if text.is_empty() { "nothing".into() } else { quoted(text) },
            allowed: allowed.into(),
            remedy: remedy.into(),
        })
    }
}

/// The number that a text is, in SI units, where it is believed.
#[inline]
fn number(text: &str, unit: Option<Unit>) -> Option<f64> {
    let value = text.parse::<f64>().ok().filter(|value| value.abs() <= largest(unit))?;
    Some(unit.map_or(value, |unit| value / unit.per_si))
}

/// The largest number believed, as it is written.
fn largest(unit: Option<Unit>) -> f64 {
    /// Not far above this, counts are no longer distinct in `f64`.
    const COUNT: f64 = 9e15;
    unit.map_or(COUNT, |unit| unit.largest)
}

/// Visits the rows of a text without header, all of whose cells are numbers in SI units.
pub(super) fn headless<const N: usize>(
    source: Source,
    names: &[&str; N],
    mut visit: impl FnMut(usize, &[f64; N]),
) -> Result<(), DatasetError> {
    let columns = std::array::from_fn::<Column, N, _>(|i| Column { name: names[i].to_owned(), index: i, unit: None });
    let mut numbers = [0.0; N];
    Sheet::headless(source, N).for_each(|row| {
        for (number, column) in numbers.iter_mut().zip(&columns) {
            *number = row.number(column)?;
        }
        visit(row.line, &numbers);
        Ok(())
    })
}
