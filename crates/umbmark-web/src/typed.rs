//! Return poses that are typed into a table: mistakes are told at their cells.

use std::path::Path;

use serde::{Deserialize, Serialize};
use umbmark_core::dataset::{Dataset, ReturnError, Run};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::{Direction, Path as Course, SQUARE};
use umbmark_io::Existing;

use crate::bench::Trouble;

/// Rows at most.
const MAX_ROWS: usize = 1000;

/// A robot, its square and its returns, as they are typed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Typed {
    /// Name of the robot.
    pub name: String,
    /// Numbers of the robot by their names in robot.toml, and `side_m` of the square.
    pub plate: Vec<(String, String)>,
    /// A return each: direction, x and y in mm, heading in degrees.
    pub rows: Vec<[String; 4]>,
}

/// A mistake in a cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mistake {
    /// "plate" or "rows".
    pub table: &'static str,
    /// Its row, from 0.
    pub row: usize,
    /// Its column, from 0.
    pub column: usize,
    /// What is wrong and what would be right.
    pub says: String,
}

impl Typed {
    /// The dataset, or every mistake.
    pub fn dataset(&self) -> Result<Dataset, Vec<Mistake>> {
        let mut mistakes = Vec::new();
        let mut wrong = |table, row, column, says: String| mistakes.push(Mistake { table, row, column, says });
        let (mut robot, mut course) = (Robot::labmate(), None);
        robot.name = self.name.chars().filter(|c| !c.is_control()).take(100).collect();
        for (row, (name, text)) in self.plate.iter().enumerate() {
            let value = match number(text) {
                Ok(value) => value,
                Err(says) => {
                    wrong("plate", row, 1, says);
                    continue;
                }
            };
            if name == "side_m" {
                match Course::new(&SQUARE, &[value], Course::umbmark().speed) {
                    Ok(found) => course = Some(found),
                    Err(error) => wrong("plate", row, 1, error.to_string()),
                }
                continue;
            }
            let known = Robot::NUMBERS.iter().find(|parameter| parameter.name == name);
            let Some(parameter) = known else {
                wrong("plate", row, 0, format!("a robot has no {name}"));
                continue;
            };
            match parameter
                .check(value)
                .map_err(|e| e.to_string())
                .and_then(|v| robot.with(parameter.name, v).map_err(|e| e.to_string()))
            {
                Ok(with) => robot = with,
                Err(says) => wrong("plate", row, 1, says),
            }
        }
        if self.rows.len() > MAX_ROWS {
            wrong("rows", MAX_ROWS, 0, format!("more than {MAX_ROWS} rows are not taken"));
        }
        let (mut runs, mut counts) = (Vec::new(), [0, 0]);
        for (row, cells) in self.rows.iter().take(MAX_ROWS).enumerate() {
            if cells[1..].iter().all(|cell| cell.trim().is_empty()) {
                continue;
            }
            let direction = Direction::BOTH.into_iter().find(|direction| direction.name() == cells[0].trim());
            if direction.is_none() {
                wrong("rows", row, 0, "write cw (clockwise) or ccw".into());
            }
            let mut of = |column: usize| match number(&cells[column]) {
                Ok(value) => Some(value),
                Err(says) => {
                    wrong("rows", row, column, says);
                    None
                }
            };
            let (x, y) = (of(1), of(2));
            let heading = if cells[3].trim().is_empty() { None } else { of(3) };
            if let Some(degrees) = heading.filter(|degrees: &f64| degrees.abs() > 180.0) {
                wrong("rows", row, 3, format!("must be between -180 and 180 degrees, got {degrees}"));
            }
            let (Some(direction), Some(x), Some(y)) = (direction, x, y) else { continue };
            counts[direction as usize] += 1;
            let number = counts[direction as usize];
            let returned = Some(ReturnError { x: 1e-3 * x, y: 1e-3 * y, heading: heading.map(f64::to_radians) });
            let name = format!("{}_{number}", direction.name());
            runs.push(Run {
                name,
                number,
                direction: Some(direction),
                test: TestKind::Systematic,
                log: None,
                returned,
            });
        }
        if runs.is_empty() && mistakes.is_empty() {
            mistakes.push(Mistake { table: "rows", row: 0, column: 1, says: "type at least one return".into() });
        }
        let path = Some(course.unwrap_or_else(Course::umbmark));
        if mistakes.is_empty() {
            Ok(Dataset { robot: Some(robot), path, runs, ..Dataset::default() })
        } else {
            Err(mistakes)
        }
    }
}

/// A number as people write it.
fn number(text: &str) -> Result<f64, String> {
    let plain = text.trim().replace(',', ".").replace('\u{2212}', "-");
    if plain.is_empty() {
        return Err("a number is missing".into());
    }
    let value: Option<f64> = plain.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| format!("\"{}\" is no number", text.trim()))
}

/// Writes the dataset into a folder.
pub fn save(data: &Dataset, folder: &Path) -> Result<(), Trouble> {
    umbmark_io::save(data, folder, Existing::Keep).map_err(Trouble::because)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(rows: &[[&str; 4]]) -> Typed {
        let plate =
            [("wheelbase_m", "0.34"), ("wheel_diameter_m", "0,15"), ("ticks_per_revolution", "2000"), ("side_m", "4")];
        Typed {
            name: "mine".into(),
            plate: plate.map(|(name, value)| (name.to_owned(), value.to_owned())).into(),
            rows: rows.iter().map(|row| row.map(str::to_owned)).collect(),
        }
    }

    #[test]
    fn a_table_becomes_the_dataset_that_its_files_read_back_as() {
        let data = typed(&[["cw", "-12", "34,5", "0.5"], ["", "", "", ""], ["ccw", "\u{2212}3", "1e1", ""]])
            .dataset()
            .unwrap();
        assert_eq!(data.runs.len(), 2);
        assert_eq!(data.runs[0].returned.unwrap().y, 0.0345);
        let folder = tempfile::tempdir().unwrap();
        save(&data, folder.path()).unwrap();
        let read = umbmark_io::load(folder.path()).unwrap();
        assert_eq!((read.robot, read.path), (data.robot, data.path));
        let returns = |runs: &[Run]| runs.iter().map(|run| run.returned).collect::<Vec<_>>();
        assert_eq!(returns(&read.runs), returns(&data.runs));
    }

    #[test]
    fn every_mistake_is_told_at_its_cell() {
        let mut table = typed(&[["cw", "12", "x", ""], ["left", "1", "2", "3"], ["ccw", "", "2", "270"]]);
        table.plate[0].1 = "-1".into();
        table.plate[2].1 = String::new();
        let mistakes = table.dataset().unwrap_err();
        let cells: Vec<_> = mistakes.iter().map(|m| (m.table, m.row, m.column)).collect();
        assert_eq!(
            cells,
            [("plate", 0, 1), ("plate", 2, 1), ("rows", 0, 2), ("rows", 1, 0), ("rows", 2, 1), ("rows", 2, 3)]
        );
        assert!(mistakes[0].says.contains("must be"), "{}", mistakes[0].says);
        assert_eq!(typed(&[]).dataset().unwrap_err()[0].says, "type at least one return");
    }
}
