//! The geometry in the parameters of a ROS 2 controller.

use super::error::DatasetError;
use super::known_numbers::KnownNumbers;
use super::source::read_text;
use serde_json::{Map, Value};
use std::path::Path;

/// A key of a controller and the number of the robot that it is, times a factor and times multipliers that stand beside it.
struct Key {
    name: &'static str,
    factor: f64,
    /// The keys of the robot, each with the multipliers that belong to it.
    makes: &'static [(&'static str, &'static [&'static str])],
}

/// `diff_drive_controller` of `ros2_controllers`: its odometry uses each length times its multiplier.
const DIFF_DRIVE: [Key; 2] = [
    Key { name: "wheel_separation", factor: 1.0, makes: &[("wheelbase_m", &["wheel_separation_multiplier"])] },
    Key {
        name: "wheel_radius",
        factor: 2.0,
        makes: &[
            ("wheel_diameter_left_m", &["left_wheel_radius_multiplier", "wheel_radius_multiplier"]),
            ("wheel_diameter_right_m", &["right_wheel_radius_multiplier", "wheel_radius_multiplier"]),
        ],
    },
];

/// The table `wheels` of the node of a TurtleBot3.
const TURTLEBOT: [Key; 2] = [
    Key { name: "separation", factor: 1.0, makes: &[("wheelbase_m", &[])] },
    Key { name: "radius", factor: 2.0, makes: &[("wheel_diameter_left_m", &[]), ("wheel_diameter_right_m", &[])] },
];

const REMEDY: &str = "give the file that has wheel_separation and wheel_radius of the robot's diff_drive_controller";

/// The wheelbase and the wheel diameters in the YAML file of a robot's controller: `wheel_separation` and `wheel_radius` of a
/// `diff_drive_controller`, each times its multiplier, or `separation` and `radius` of a TurtleBot3.
///
/// # Errors
///
/// Where the file cannot be read, is not YAML, or describes no such controller, or more than one.
pub fn read_controller(file: impl AsRef<Path>) -> Result<KnownNumbers, DatasetError> {
    let file = file.as_ref();
    let name = file.display().to_string();
    parse(&name, &read_text(file)?)
}

fn parse(file: &str, text: &str) -> Result<KnownNumbers, DatasetError> {
    let refuse = |problem: String| DatasetError::Controller { file: file.to_owned(), problem, remedy: REMEDY };
    let document: Value = serde_saphyr::from_str(text).map_err(|error| {
        let said = error.to_string();
        refuse(format!("is not YAML: {}", said.lines().next().unwrap_or_default()))
    })?;
    let mut found = Vec::new();
    look(&document, &mut Vec::new(), &mut found);
    match &found[..] {
        [(path, table, keys)] => read(file, path, table, keys).map_err(refuse),
        [] => Err(refuse("has no wheel_separation of a controller".to_owned())),
        several => {
            let paths: Vec<&str> = several.iter().map(|(path, ..)| path.as_str()).collect();
            Err(refuse(format!("describes more than one robot ({})", paths.join(", "))))
        }
    }
}

type Table<'v> = (String, &'v Map<String, Value>, &'static [Key]);

/// The tables that hold the geometry of a robot, with their places.
fn look<'v>(value: &'v Value, path: &mut Vec<&'v str>, found: &mut Vec<Table<'v>>) {
    let Value::Object(table) = value else { return };
    if table.contains_key(DIFF_DRIVE[0].name) {
        found.push((path.join("."), table, &DIFF_DRIVE));
    } else if path.last() == Some(&"wheels") && table.contains_key(TURTLEBOT[0].name) {
        found.push((path.join("."), table, &TURTLEBOT));
    }
    for (key, value) in table {
        path.push(key);
        look(value, path, found);
        path.pop();
    }
}

fn read(file: &str, path: &str, table: &Map<String, Value>, keys: &[Key]) -> Result<KnownNumbers, String> {
    let number = |key: &str| match table.get(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => match value.as_f64().filter(|value| value.is_finite() && *value >= 0.0) {
            Some(value) => Ok(Some(value)),
            None => Err(format!("{key} of {path} must be a number of 0 or more, got {value}")),
        },
    };
    let mut known = KnownNumbers::of(file);
    for key in keys {
        // Zero stands for "not set" in this controller.
        let Some(value) = number(key.name)?.filter(|value| *value > 0.0) else { continue };
        for (name, multipliers) in key.makes {
            let mut product = key.factor * value;
            let mut source = key.name.to_owned();
            for multiplier in *multipliers {
                if let Some(factor) = number(multiplier)?.filter(|factor| *factor > 0.0 && *factor != 1.0) {
                    product *= factor;
                    source += &format!(" times {multiplier}");
                }
            }
            known.push(name, (product * 1e9).round() / 1e9, &source);
        }
    }
    Ok(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_WHEELS: &str = "\
controller_manager:
  ros__parameters:
    update_rate: 100
    diff_cont:
      type: diff_drive_controller/DiffDriveController
diff_cont:
  ros__parameters:
    left_wheel_names: ['left_wheel_joint']
    right_wheel_names: ['right_wheel_joint']
    wheel_separation: 0.4
    wheel_radius: 0.05
    left_wheel_radius_multiplier: 1.001
    wheel_separation_multiplier: 1.02
";

    fn numbers(text: &str) -> Vec<(String, f64)> {
        let known = parse("c.yaml", text).unwrap();
        known.numbers.iter().map(|number| (number.key.to_owned(), number.value)).collect()
    }

    fn said(text: &str) -> String {
        parse("c.yaml", text).unwrap_err().to_string()
    }

    #[test]
    fn lengths_are_those_that_the_odometry_of_the_controller_uses() {
        let expected = [("wheelbase_m", 0.408), ("wheel_diameter_left_m", 0.1001), ("wheel_diameter_right_m", 0.1)];
        assert_eq!(numbers(TWO_WHEELS), expected.map(|(key, value)| (key.to_owned(), value)));
        let known = parse("c.yaml", TWO_WHEELS).unwrap();
        assert_eq!(known.numbers[0].source, "wheel_separation times wheel_separation_multiplier in c.yaml");
        let burger =
            "turtlebot3_node:\n  ros__parameters:\n    wheels:\n      separation: 0.160\n      radius: 0.033\n";
        assert_eq!(numbers(burger)[..2], [("wheelbase_m".into(), 0.16), ("wheel_diameter_left_m".into(), 0.066)]);
        assert_eq!(numbers(&TWO_WHEELS.replace("0.05", "0.0")).len(), 1, "a radius of 0 is not set");
    }

    #[test]
    fn what_describes_no_robot_is_refused_with_what_to_give() {
        assert_eq!(said("a: 1\n"), format!("c.yaml: has no wheel_separation of a controller; {REMEDY}"));
        assert!(said("a: [1\nb").starts_with("c.yaml: is not YAML: "), "{}", said("a: [1\nb"));
        let two = format!("{TWO_WHEELS}other:\n  wheel_separation: 0.3\n");
        assert!(said(&two).contains("more than one robot (diff_cont.ros__parameters, other)"), "{}", said(&two));
        let word = TWO_WHEELS.replace("wheel_radius: 0.05", "wheel_radius: wide");
        assert!(
            said(&word)
                .contains("wheel_radius of diff_cont.ros__parameters must be a number of 0 or more, got \"wide\"")
        );
    }
}
