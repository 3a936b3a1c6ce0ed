//! TOML with positions: tables that know their file and line, and say what they expected.

use super::error::{At, DatasetError, LineProblem, quoted};
use super::file_names::FILL_IN;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use umbmark_core::parameter::{Parameter, nearest};

/// The text of a TOML file.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// The whole file as a table.
    pub fn parse(&self) -> Result<Spanned<DeTable<'a>>, DatasetError> {
        DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let before = self.text.get(..at).unwrap_or(self.text);
            let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            let reason = error.message().lines().collect::<Vec<_>>().join(", ");
            At::new(self.file, self.line(at)).refuse(LineProblem::Syntax { column, reason })
        })
    }

    fn line(&self, at: usize) -> usize {
        self.text.bytes().take(at).filter(|byte| *byte == b'\n').count() + 1
    }
}

/// A table of a file.
pub(super) struct Table<'a> {
    source: &'a Source<'a>,
    /// As it stands in messages: "[robot]".
    name: String,
    /// Where it begins.
    pub line: usize,
    entries: &'a DeTable<'a>,
}

/// A key with its value.
#[derive(Clone, Copy)]
pub(super) struct Entry<'a> {
    source: &'a Source<'a>,
    /// The key.
    pub key: &'a str,
    /// Where it stands in the text.
    at: usize,
    /// What it is given.
    pub value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Table<'a> {
    /// The table at the top of a file.
    pub fn root(source: &'a Source<'a>, entries: &'a Spanned<DeTable<'a>>) -> Table<'a> {
        Table { source, name: "the file".into(), line: 1, entries: entries.get_ref() }
    }

    /// Refuses keys that are not among `allowed`.
    pub fn only(&self, allowed: &[&str]) -> Result<(), DatasetError> {
        let mut unknown: Vec<_> =
            self.entries.keys().filter(|key| !allowed.contains(&key.get_ref().as_ref())).collect();
        unknown.sort_by_key(|key| key.span().start);
        let Some(key) = unknown.first() else { return Ok(()) };
        let remedy = match nearest(key.get_ref(), allowed.iter().copied()) {
            Some(name) => format!("did you mean \"{name}\"?"),
            None => format!("it takes {}", allowed.join(", ")),
        };
        Err(At::new(self.source.file, self.source.line(key.span().start)).refuse(LineProblem::UnknownKey {
            table: self.name.clone(),
            key: quoted(key.get_ref()),
            remedy,
        }))
    }

    /// The entry of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Entry<'a>> {
        let (key, value) = self.entries.get_key_value(key)?;
        Some(Entry { source: self.source, key: key.get_ref(), at: key.span().start, value })
    }

    /// All entries, in the order of the file.
    pub fn entries(&self) -> Vec<Entry<'a>> {
        let entry = |(key, value): (&'a Spanned<std::borrow::Cow<'a, str>>, &'a Spanned<DeValue<'a>>)| Entry {
            source: self.source,
            key: key.get_ref(),
            at: key.span().start,
            value,
        };
        let mut entries: Vec<Entry> = self.entries.iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.at);
        entries
    }

    /// The entry of a key that must be there; `example` says how it may look.
    pub fn need(&self, key: &str, example: &str) -> Result<Entry<'a>, DatasetError> {
        self.get(key).ok_or_else(|| self.missing(key, example))
    }

    /// The error of a key that is not there.
    pub fn missing(&self, key: &str, example: &str) -> DatasetError {
        self.refuse(LineProblem::MissingKey {
            table: self.name.clone(),
            key: key.to_owned(),
            example: example.to_owned(),
        })
    }

    /// What is wrong with the table as a whole.
    pub fn refuse(&self, problem: LineProblem) -> DatasetError {
        At::new(self.source.file, self.line).refuse(problem)
    }

    /// The one entry among keys that mean the same, if any is there.
    pub fn one_of(&self, keys: &[&str]) -> Result<Option<Entry<'a>>, DatasetError> {
        let mut found = keys.iter().filter_map(|key| self.get(key));
        let first = found.next();
        match (&first, found.next()) {
            (Some(first), Some(second)) => Err(first.again(&second)),
            _ => Ok(first),
        }
    }

    /// The number of a described key that must be there.
    pub fn number(&self, parameter: &Parameter) -> Result<f64, DatasetError> {
        let example = format!("e.g. {} = {:?}", parameter.name, parameter.typical);
        self.need(parameter.name, &example)?.number(parameter)
    }
}

impl<'a> Entry<'a> {
    /// The line that it stands on.
    pub fn line(&self) -> usize {
        self.source.line(self.at)
    }

    /// The error of a second key that means the same.
    pub fn again(&self, second: &Entry) -> DatasetError {
        let (first, second) = if self.at <= second.at { (self, second) } else { (second, self) };
        At::new(self.source.file, second.line()).refuse(LineProblem::KeyTwice {
            second: second.key.to_owned(),
            first: first.key.to_owned(),
            first_line: first.line(),
        })
    }

    /// The value as a table, called `name` in messages.
    pub fn table(&self, name: String) -> Result<Table<'a>, DatasetError> {
        match self.value.get_ref() {
            DeValue::Table(entries) => Ok(Table { source: self.source, name, line: self.line(), entries }),
            _ => Err(self.wrong(&format!("a table, {name}"), "")),
        }
    }

    /// Whether the value is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Table(_))
    }

    /// The value as a list of entries under the same key.
    pub fn list(&self, allowed: &str) -> Result<Vec<Entry<'a>>, DatasetError> {
        let DeValue::Array(items) = self.value.get_ref() else { return Err(self.wrong(allowed, "")) };
        let entry = |value: &'a Spanned<DeValue<'a>>| Entry { value, at: value.span().start, ..*self };
        Ok(items.iter().map(entry).collect())
    }

    /// The value as text.
    pub fn word(&self, allowed: &str) -> Result<&'a str, DatasetError> {
        match self.value.get_ref() {
            // They would move the cursor of a terminal, or end a line of a file that is written.
            DeValue::String(text) if text.chars().any(|c| c.is_control() && !matches!(c, '\t' | '\n')) => {
                Err(self.wrong("text without control characters", "remove them"))
            }
            DeValue::String(text) => Ok(text),
            _ => Err(self.wrong(allowed, "put it in quotation marks")),
        }
    }

    /// The value as yes or no.
    pub fn flag(&self) -> Result<bool, DatasetError> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.wrong("true or false", "")),
        }
    }

    /// The value as a number within the bounds of its description; a word where the description offers words.
    pub fn number(&self, parameter: &Parameter) -> Result<f64, DatasetError> {
        if let (DeValue::String(word), false) = (self.value.get_ref(), parameter.choices().is_empty()) {
            let place = parameter.choices().iter().position(|choice| *choice == word.as_ref());
            let remedy = super::error::did_you_mean(word, parameter.choices().iter().copied());
            return place.map(|p| p as f64).ok_or_else(|| self.wrong(&parameter.allowed(), &remedy));
        }
        let value = self.any_number().ok_or_else(|| self.wrong(&parameter.allowed(), self.unquote()))?;
        parameter.check(value).map_err(|error| self.wrong(&error.allowed, ""))
    }

    /// The value as a number, whatever its size.
    pub fn any_number(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        }
    }

    fn unquote(&self) -> &'static str {
        match self.value.get_ref() {
            DeValue::String(text) if text == FILL_IN => "no log shows it: put the number of your robot there",
            DeValue::String(text) if text.trim().parse::<f64>().is_ok() => "write the number without quotation marks",
            DeValue::String(text) if text.contains(',') => "write decimals with a point, without quotation marks",
            _ => "",
        }
    }

    /// The error of a value that is not what is allowed.
    pub fn wrong(&self, allowed: &str, remedy: &str) -> DatasetError {
        self.wrong_value(self.key.to_owned(), allowed, remedy)
    }

    /// The same for a value that goes by another name than its key.
    pub fn wrong_value(&self, key: String, allowed: &str, remedy: &str) -> DatasetError {
        let (allowed, remedy) = (allowed.into(), remedy.into());
        self.refuse(LineProblem::Value { key, value: self.shown(), allowed, remedy })
    }

    /// What is wrong with the entry.
    pub fn refuse(&self, problem: LineProblem) -> DatasetError {
        At::new(self.source.file, self.line()).refuse(problem)
    }

    /// The value as it stands in the file, shortened.
    pub fn shown(&self) -> String {
        let raw = self.source.text.get(self.value.span()).unwrap_or("").trim();
        let plain = raw.len() <= 40 && !raw.is_empty() && raw.chars().all(|c| !c.is_control());
        if plain { raw.to_owned() } else { quoted(raw) }
    }
}
