//! A robot.toml proposed from logs, with what they do not show left to fill in, and the logs put beside it.

use super::column_names::COLUMNS;
use super::contents::{FoundLog, logs_in};
use super::error::DatasetError;
use super::export::UrdfFile;
use super::file_names::{FILL_IN, ROBOT, RUNS};
use super::known_numbers::KnownNumbers;
use super::layout::csv::{self, REFERENCE};
use super::layout::messages::Topics;
use super::layout::{log_endings, look};
use super::probe::{extension, name_of, names_in};
use super::remedy::{Remedy, Words};
use super::save::{Existing, put_beside_logs, unwritable};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use umbmark_core::action::Action;
use umbmark_core::drive::{DriveKind, Encoder};
use umbmark_core::inspect::{LogContents, WheelUnit, WheelsFound};
use umbmark_core::parameter::Parameter;

/// A line of the proposed `[robot]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedNumber {
    /// The key.
    pub key: &'static str,
    /// The value; `None` for one to be filled in.
    pub value: Option<f64>,
    /// Where it is from, or what it is.
    pub source: String,
}

/// A dataset to begin with.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The text of its robot.toml.
    pub robot: String,
    /// The numbers in it; empty where a log brings its own robot.toml along.
    pub numbers: Vec<ProposedNumber>,
    /// Columns of logs whose tables call them otherwise: what they are called there is to be filled in.
    pub columns: Vec<String>,
    /// What each log holds.
    pub contents: Vec<LogContents>,
    /// What was noticed, a sentence each.
    pub notes: Vec<String>,
    /// Files to be put into the folder, from where to where in it.
    files: Vec<(PathBuf, PathBuf)>,
}

impl Proposal {
    /// Proposes a robot for the logs of a place. `known` are numbers from other sources: the first that has a number is taken.
    /// `folder` is where the dataset will be, and gives it its name.
    ///
    /// # Errors
    ///
    /// Where the place has no log, or none in which the wheels can be read, and where logs are of different drives.
    pub fn of(
        place: &Path,
        folder: &Path,
        topics: &Topics,
        known: &[KnownNumbers],
        words: &Words,
    ) -> Result<Proposal, DatasetError> {
        let logs = logs_in(place)?;
        let (logs, contents, notes) = usable(place, logs, topics, words)?;
        let mut known = known.to_vec();
        if let Some(text) = contents.iter().find_map(|log| log.urdf.clone()) {
            let name = "its robot_description".to_owned();
            // One that cannot be read says nothing, as if it were not there.
            known.extend(UrdfFile { name, text, joints: None }.numbers().ok());
        }
        let files = placed(place, folder, &logs)?;
        let (robot, numbers, columns) = (String::new(), Vec::new(), Vec::new());
        let mut proposal = Proposal { robot, numbers, columns, contents, notes, files };
        match proposal.contents.iter().find_map(|log| log.robot.clone()) {
            Some(text) => proposal.robot = text,
            None => proposal.propose(folder, &known)?,
        }
        Ok(proposal)
    }

    /// The keys that are to be filled in.
    pub fn to_fill_in(&self) -> Vec<&str> {
        let numbers = self.numbers.iter().filter(|number| number.value.is_none()).map(|number| number.key);
        numbers.chain(self.columns.iter().map(String::as_str)).collect()
    }

    /// How many files are put into the folder beside robot.toml.
    pub fn placed(&self) -> usize {
        self.files.len()
    }

    /// Writes robot.toml and puts the logs into `runs`, as links to the same bytes where the file system has them, else as copies.
    /// Logs that stand there already stay. Returns the path of robot.toml.
    ///
    /// # Errors
    ///
    /// Where something of the same name is there and is to be kept, and where the system does not let us write.
    pub fn write(&self, folder: &Path, existing: Existing) -> Result<PathBuf, DatasetError> {
        let there = |file: &PathBuf| file.exists() && existing == Existing::Keep;
        if let Some(file) = self.files.iter().map(|(_, to)| folder.join(to)).find(there) {
            let remedy = Remedy::Replace { another: "folder" };
            return Err(DatasetError::AlreadyThere { file: file.display().to_string(), remedy });
        }
        put_beside_logs(folder, &BTreeMap::from([(PathBuf::from(ROBOT), &self.robot)]), existing)?;
        for (from, to) in &self.files {
            let to = folder.join(to);
            put_in_place(from, &to).map_err(|error| unwritable(&to, &error))?;
        }
        Ok(folder.join(ROBOT))
    }

    fn propose(&mut self, folder: &Path, known: &[KnownNumbers]) -> Result<(), DatasetError> {
        let wheels: Vec<&WheelsFound> = self.contents.iter().filter_map(|log| log.wheels.as_ref().ok()).collect();
        let drive = wheels.first().map_or_else(DriveKind::default, |first| first.drive);
        if wheels.is_empty() {
            let counters = drive.columns();
            let counters = counters.iter().map(|counter| format!("ticks_{counter}"));
            self.columns = std::iter::once("t_s".to_owned()).chain(counters).collect();
        }
        if let Some(other) = wheels.iter().find(|wheels| wheels.drive != drive) {
            let found = format!("there are logs of a {} and of a {} drive", drive.name(), other.drive.name());
            let remedy = "begin with the logs of one robot".into();
            return Err(DatasetError::NoLogs { file: folder.display().to_string(), found, remedy });
        }
        for (key, of) in keys_of(drive, known) {
            self.numbers.push(number(key, of, known));
        }
        self.numbers.push(ticks(&wheels, known));
        self.numbers.push(rate(&wheels, known));
        self.numbers.extend(bits(&wheels, known));
        let name = known.iter().find_map(|known| known.name.clone()).unwrap_or_else(|| name_of_folder(folder));
        self.robot = self.text(&name, drive);
        Ok(())
    }

    fn text(&self, name: &str, drive: DriveKind) -> String {
        let mut text = String::from(
            "# The robot as its own software believes it to be: nominal values, not measured ones.\n\
             # Lengths in metres. This file was proposed from logs.\n",
        );
        if !self.to_fill_in().is_empty() {
            text += "# The lines marked FILL IN hold what the logs do not show: write it there.\n";
        }
        text += "\n[robot]\n";
        let mut line = |key: &str, value: &str, comment: &str| {
            let entry = format!("{key} = {value}");
            // Writing to a string does not fail.
            let _ = writeln!(text, "{}", format!("{entry:<33} # {comment}").trim_end_matches([' ', '#']));
        };
        line("name", &toml::Value::from(name).to_string(), "");
        let by = if drive == DriveKind::default() { "taken for granted" } else { "by the names of its counters" };
        line("drive", &format!("\"{}\"", drive.name()), by);
        for number in &self.numbers {
            match number.value {
                Some(value) => line(number.key, &format!("{value:?}"), &number.source),
                None => line(number.key, &format!("\"{FILL_IN}\""), &format!("FILL IN: {}", number.source)),
            }
        }
        if !self.columns.is_empty() {
            text += &self.columns_text();
        }
        text += "\n# If it was told to drive one path, say which; the logs are then checked against it.\n\
                 # [path]\n# shape = \"square\"\n# side_m = 4.0\n";
        text
    }

    /// The table that says what the columns of the first log are called.
    fn columns_text(&self) -> String {
        let headers = self.contents.first().map_or(&[][..], |log| &log.parts);
        let headers: Vec<String> =
            headers.iter().map(|part| toml::Value::from(part.name.as_str()).to_string()).collect();
        let mut text = String::from(
            "\n# What stands above these columns in the logs. Its unit is part of a name: t_ms, x_ref_mm and theta_ref_deg are read as well.\n",
        );
        // Writing to a string does not fail.
        let _ = writeln!(text, "# The logs have {}.\n[{COLUMNS}]", headers.join(", "));
        for name in &self.columns {
            let _ = writeln!(text, "{:<33} # FILL IN", format!("{name} = \"{FILL_IN}\""));
        }
        text + "# x_ref_m = \"\"                    # and those of a reference, where there is one\n\
                # y_ref_m = \"\"\n# theta_ref_rad = \"\"\n"
    }
}

/// The logs in which the wheels can be read, what they hold, and what is to be said of the others.
type Usable = (Vec<FoundLog>, Vec<LogContents>, Vec<String>);

fn usable(place: &Path, logs: Vec<FoundLog>, topics: &Topics, words: &Words) -> Result<Usable, DatasetError> {
    let file = place.display().to_string();
    let (mut kept, mut contents, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut tables = (Vec::new(), Vec::new());
    for log in logs {
        let found = look(&log.path, topics, words).transpose()?;
        let Some(found) = found else { continue };
        match &found.wheels {
            Ok(_) => {
                kept.push(log);
                contents.push(found);
            }
            Err(problem) => {
                notes.push(format!("{}: not taken: {problem}", log.path.display()));
                let has_counts = found.parts.iter().any(|part| part.name.starts_with("ticks_"));
                if found.layout == csv::LAYOUT.name && !has_counts && found.parts.len() > 2 {
                    tables.0.push(log);
                    tables.1.push(found);
                }
            }
        }
    }
    if kept.is_empty() && !tables.0.is_empty() {
        let said = "the columns go by other names than t_s and ticks_...: write in robot.toml which is which";
        return Ok((tables.0, tables.1, vec![said.to_owned()]));
    }
    match (&kept[..], &notes[..]) {
        ([], []) => {
            let found = format!("there is no log (.{}) in it", log_endings().join(", ."));
            Err(DatasetError::NoLogs { file, found, remedy: "give a log, or a folder of logs".into() })
        }
        ([], [first, ..]) => {
            let found = format!("the wheels can be read in none of its logs; {first}");
            let remedy = Remedy::Then { words: "look at one", action: Action::CheckLog };
            Err(DatasetError::NoLogs { file, found, remedy })
        }
        _ => {
            let noticed = contents.iter().flat_map(|log| log.notes.iter().map(|note| format!("{}: {note}", log.file)));
            notes.extend(noticed.collect::<Vec<_>>());
            let poses =
                contents.iter().flat_map(|log| Some(format!("{}: {}", log.file, log.reference.as_ref().err()?)));
            notes.extend(poses.collect::<Vec<_>>());
            Ok((kept, contents, notes))
        }
    }
}

/// Where logs, and the tracks beside them, go in the folder of a dataset; nothing for those that are there.
fn placed(place: &Path, folder: &Path, logs: &[FoundLog]) -> Result<Vec<(PathBuf, PathBuf)>, DatasetError> {
    let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    let mut files = Vec::new();
    let mut taken = BTreeSet::new();
    let runs = folder.join(RUNS);
    for log in logs {
        if log.path.parent().is_some_and(|parent| same(parent, &runs)) {
            continue;
        }
        let packed = name_of(&log.path).to_lowercase().ends_with(".gz");
        let is_folder = log.path.is_dir();
        let ending = format!("{}{}", extension(&log.path), if packed { ".gz" } else { "" });
        let mut name = log.name.clone();
        for again in 2.. {
            if taken.insert(name.clone()) {
                break;
            }
            name = format!("{}_{again}", log.name);
        }
        if is_folder {
            let own = Path::new(RUNS).join(name);
            let names = names_in(&log.path)?.into_iter().filter(|name| log.path.join(name).is_file());
            files.extend(names.map(|name| (log.path.join(&name), own.join(name))));
        } else {
            files.push((log.path.clone(), Path::new(RUNS).join(format!("{name}.{ending}"))));
        }
    }
    let tracks = place.join(REFERENCE);
    if tracks.is_dir() && !same(place, folder) {
        for name in names_in(&tracks)? {
            files.push((tracks.join(&name), Path::new(REFERENCE).join(name)));
        }
    }
    Ok(files)
}

fn put_in_place(from: &Path, to: &Path) -> std::io::Result<()> {
    to.parent().map_or(Ok(()), std::fs::create_dir_all)?;
    if to.exists() {
        std::fs::remove_file(to)?;
    }
    let from = from.canonicalize()?;
    std::fs::hard_link(&from, to).or_else(|_| std::fs::copy(&from, to).map(|_| ()))
}

fn name_of_folder(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    match name_of(&whole) {
        name if name.is_empty() => "my robot".to_owned(),
        name => name.replace('_', " "),
    }
}

/// The keys of a drive's numbers: one for several that are alike, unless a source has different values for these.
fn keys_of(drive: DriveKind, known: &[KnownNumbers]) -> Vec<(&'static Parameter, Vec<&'static str>)> {
    let of = |key: &str| known.iter().find_map(|known| known.get(&[key])).map(|number| number.value);
    let shared = |name: &str| {
        let spelling = drive.spellings().iter().find(|s| s.factor == 1.0 && s.of.len() > 1 && s.of.contains(&name))?;
        let values: Vec<Option<f64>> = spelling.of.iter().map(|name| of(name)).collect();
        values.windows(2).all(|pair| pair[0] == pair[1]).then_some(spelling)
    };
    let mut keys: Vec<(&'static Parameter, Vec<&'static str>)> = Vec::new();
    for parameter in drive.parameters().iter().filter(|parameter| parameter.nothing().is_none()) {
        match shared(parameter.name) {
            Some(spelling) if spelling.of[0] == parameter.name => {
                let names = std::iter::once(spelling.parameter.name).chain(spelling.of.iter().copied());
                keys.push((&spelling.parameter, names.collect()));
            }
            Some(_) => {}
            None => {
                let same = drive.spellings().iter().filter(|s| s.factor == 1.0 && s.of.contains(&parameter.name));
                let names = std::iter::once(parameter.name).chain(same.map(|spelling| spelling.parameter.name));
                keys.push((parameter, names.collect()));
            }
        }
    }
    keys
}

fn number(parameter: &'static Parameter, names: Vec<&'static str>, known: &[KnownNumbers]) -> ProposedNumber {
    let key = parameter.name;
    match known.iter().find_map(|known| known.get(&names)) {
        Some(number) => ProposedNumber { key, value: Some(number.value), source: number.source.clone() },
        None => ProposedNumber { key, value: None, source: parameter.meaning.to_owned() },
    }
}

/// A unit as fine as any encoder, for logs that have no counts.
const FINE_TICKS: f64 = 65536.0;

fn ticks(wheels: &[&WheelsFound], known: &[KnownNumbers]) -> ProposedNumber {
    let given = number(&Encoder::TICKS, vec![Encoder::TICKS.name], known);
    let counts = wheels.is_empty() || wheels.iter().any(|wheels| wheels.unit == WheelUnit::Counts);
    if given.value.is_some() || counts {
        return given;
    }
    let steps: Vec<f64> = wheels.iter().filter_map(|wheels| wheels.ticks_per_revolution).collect();
    let key = Encoder::TICKS.name;
    match steps.first() {
        Some(first) if steps.iter().all(|steps| steps == first) => {
            ProposedNumber { key, value: Some(*first), source: "the joint positions come in such steps".to_owned() }
        }
        _ => {
            let source = "a unit only: the logs have no counts, and any number does".to_owned();
            ProposedNumber { key, value: Some(FINE_TICKS), source }
        }
    }
}

fn rate(wheels: &[&WheelsFound], known: &[KnownNumbers]) -> ProposedNumber {
    let given = number(&Encoder::RATE, vec![Encoder::RATE.name], known);
    if given.value.is_some() || wheels.is_empty() {
        return given;
    }
    let mut rates: Vec<f64> = wheels.iter().map(|wheels| wheels.rate).collect();
    rates.sort_by(f64::total_cmp);
    let source = "how often the logs have a reading".to_owned();
    ProposedNumber { key: Encoder::RATE.name, value: Some(plain(rates[rates.len() / 2])), source }
}

/// A rate to three digits, whole where it is nearly so: the times of messages scatter.
fn plain(rate: f64) -> f64 {
    let whole = rate.round();
    if whole > 0.0 && (rate - whole).abs() < 0.01 * rate {
        return whole;
    }
    let unit = libm::exp10(libm::floor(libm::log10(rate)) - 2.0);
    let digits = (rate / unit).round();
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit }
}

fn bits(wheels: &[&WheelsFound], known: &[KnownNumbers]) -> Option<ProposedNumber> {
    let given = number(&Encoder::BITS, vec![Encoder::BITS.name], known);
    if given.value.is_some() {
        return Some(given);
    }
    let bits = wheels.iter().filter_map(|wheels| wheels.counter_bits).max()?;
    let source = "the counts jump as those of such a counter do when it rolls over".to_owned();
    Some(ProposedNumber { key: Encoder::BITS.name, value: Some(f64::from(bits)), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_told_as_people_set_them() {
        for (measured, told) in [(49.97, 50.0), (12.5, 12.5), (0.2512, 0.251), (1999.0, 1999.0), (33.34, 33.3)] {
            assert!((plain(measured) - told).abs() < 1e-12, "{measured}: {}", plain(measured));
        }
    }
}
