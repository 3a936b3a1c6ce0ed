//! `robot.toml` as text.

use super::RobotFile;
use super::column_names::{COLUMNS, ColumnNames};
use super::robot_file::{EXCHANGED, is_waypoints};
use std::fmt::Write;
use umbmark_core::dataset::{Dataset, ReferenceFrame};
use umbmark_core::drive::{Encoder, Robot, Spelling};
use umbmark_core::path::{Path, SpeedProfile};

impl RobotFile {
    /// A robot and its path, whose measured poses are counted as they are meant to be.
    pub fn new(robot: Robot, path: Option<Path>) -> RobotFile {
        RobotFile { robot, path, reference: ReferenceFrame::default(), columns: ColumnNames::default() }
    }

    /// What a `robot.toml` beside the logs of a dataset has to say, with `robot` in the place of the nominal one.
    pub fn beside(data: &Dataset, robot: Robot) -> RobotFile {
        let columns = ColumnNames::of(&data.columns);
        RobotFile { robot, path: data.path.clone(), reference: data.reference_frame, columns }
    }

    /// A commented `robot.toml` that reads back as this, to the last bit.
    ///
    /// ```
    /// use umbmark_core::{drive::Robot, path::Path};
    /// use umbmark_io::RobotFile;
    /// let file = RobotFile::new(Robot::labmate(), Some(Path::umbmark()));
    /// assert_eq!(RobotFile::parse("robot.toml", &file.text())?.robot, Robot::labmate());
    /// # Ok::<(), umbmark_io::DatasetError>(())
    /// ```
    pub fn text(&self) -> String {
        let mut text = robot_text(&self.robot);
        if let Some(path) = &self.path {
            text.push_str("\n[path]\n");
            push_path(&mut text, path);
        }
        let said: Vec<_> = self.reference.keys().into_iter().filter(|(_, is, _)| *is).collect();
        if !said.is_empty() {
            text.push_str("\n[reference]\n");
            said.into_iter().for_each(|(key, _, meaning)| line(&mut text, key, "true", meaning));
        }
        let mut names = self.columns.iter().peekable();
        if names.peek().is_some() {
            text.push_str(&format!("\n[{COLUMNS}]\n"));
        }
        for name in names {
            let header = toml::Value::from(name.header.as_str()).to_string();
            line(&mut text, &name.name, &header, "what stands above this column in the tables");
        }
        text
    }
}

/// The table `[robot]` of a nominal robot, which reads back to the last bit.
pub(super) fn robot_text(robot: &Robot) -> String {
    let mut text = String::from("[robot]\n");
    let name = toml::Value::from(robot.name.as_str()).to_string();
    line(&mut text, "name", &name, "");
    line(&mut text, "drive", &format!("\"{}\"", robot.drive.kind().name()), "");
    push_lengths(&mut text, robot);
    let encoder = &robot.encoder;
    let ticks = number(encoder.ticks_per_revolution());
    line(&mut text, Encoder::TICKS.name, &ticks, Encoder::TICKS.meaning);
    let rate = encoder.rate().map_or("\"every tick\"".to_owned(), number);
    line(&mut text, Encoder::RATE.name, &rate, Encoder::RATE.meaning);
    if let Some(bits) = encoder.counter_bits() {
        line(&mut text, Encoder::BITS.name, &bits.to_string(), Encoder::BITS.meaning);
    }
    let wiring = encoder.wiring();
    for (counter, backward) in robot.drive.kind().counters().iter().zip(wiring.backward) {
        if backward {
            line(
                &mut text,
                &format!("{counter}_counts_backward"),
                "true",
                &format!("the column ticks_{counter} counts down ahead"),
            );
        }
    }
    if wiring.exchanged {
        line(&mut text, EXCHANGED, "true", "the columns of the counters are exchanged");
    }
    text
}

fn push_lengths(text: &mut String, robot: &Robot) {
    let (kind, values) = (robot.drive.kind(), robot.drive.values());
    // One key for several numbers that are alike.
    let alike = |spelling: &&Spelling| {
        let numbers = kind.parameters().iter().zip(&values).filter(|(p, _)| spelling.of.contains(&p.name));
        let values: Vec<f64> = numbers.map(|(_, value)| *value).collect();
        spelling.factor == 1.0 && values.len() > 1 && values.windows(2).all(|pair| pair[0] == pair[1])
    };
    let shared: Vec<&Spelling> = kind.spellings().iter().filter(alike).collect();
    for (parameter, value) in kind.parameters().iter().zip(&values) {
        let key = match shared.iter().find(|spelling| spelling.of.contains(&parameter.name)) {
            Some(spelling) if spelling.of[0] == parameter.name => &spelling.parameter,
            Some(_) => continue,
            None => parameter,
        };
        let word = parameter.word(*value).map(|word| format!("\"{word}\""));
        line(text, key.name, &word.unwrap_or_else(|| number(*value)), key.meaning);
    }
}

fn push_path(text: &mut String, path: &Path) {
    let shape = path.shape();
    line(text, "shape", &format!("\"{}\"", shape.name), "");
    if is_waypoints(shape) {
        let points: Vec<String> =
            path.values().chunks_exact(2).map(|p| format!("[{}, {}]", number(p[0]), number(p[1]))).collect();
        line(text, "points_m", &format!("[{}]", points.join(", ")), "x, y as seen from START");
    }
    for (parameter, value) in shape.parameters.iter().zip(path.values()) {
        line(text, parameter.name, &number(*value), parameter.meaning);
    }
    for (parameter, value) in SpeedProfile::PARAMETERS.iter().zip(path.speed.values()) {
        line(text, parameter.name, &number(value), parameter.meaning);
    }
}

/// The shortest text that reads back as the same number, as TOML wants it.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn line(text: &mut String, key: &str, value: &str, comment: &str) {
    let entry = format!("{key} = {value}");
    // Writing to a string does not fail.
    let _ = match comment {
        "" => writeln!(text, "{entry}"),
        _ => writeln!(text, "{entry:<33} # {comment}"),
    };
}
