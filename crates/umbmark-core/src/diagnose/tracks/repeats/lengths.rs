//! Lengths of a robot and its path: if a period equals one of them, it shows where to look.

use crate::evidence::Estimate;
use crate::likelihood::Observed;
use std::f64::consts::PI;

/// Tolerance of a nominal length, as a share.
const NOMINAL: f64 = 0.01;
/// A length with a larger relative standard error is not compared.
const VAGUE: f64 = 0.03;

/// What a fitted length corresponds to on the robot or its path; `None` if to nothing known.
pub fn meaning(observed: &Observed, length: &Estimate) -> Option<String> {
    let (value, error) = (length.value.abs(), length.standard_error);
    if !(error <= VAGUE * value) {
        return None;
    }
    let near = |known: f64| (value - known).abs() <= 2.0 * error + NOMINAL * known;
    known(observed).into_iter().find(|(known, _)| near(*known)).map(|(_, words)| words)
}

/// Known lengths \[m\], in words.
fn known(observed: &Observed) -> Vec<(f64, String)> {
    let drive = &observed.robot.drive;
    let mut known = Vec::new();
    for (parameter, value) in drive.kind().parameters().iter().zip(drive.values()).filter(|(p, _)| p.unit == "m") {
        let name = parameter.name.trim_end_matches("_m").replace('_', " ");
        if name.contains("diameter") {
            let wheel = name.replace(" diameter", "");
            known.push((PI * value, format!("once a turn of the {}", turned_round(&wheel))));
            known.push((0.5 * PI * value, format!("twice a turn of the {}", turned_round(&wheel))));
        } else {
            known.push((value, format!("the {name}")));
            known.push((PI * value, format!("a circle as wide as the {name}")));
        }
    }
    if let Some(path) = &observed.path {
        for (parameter, value) in path.shape().parameters.iter().zip(path.values()).filter(|(p, _)| p.unit == "m") {
            known
                .push((*value, format!("the {} of the path", parameter.name.trim_end_matches("_m").replace('_', " "))));
        }
    }
    known
}

/// "left wheel" for "wheel left".
fn turned_round(wheel: &str) -> String {
    match wheel.split_once(' ') {
        Some((first, last)) => format!("{last} {first}"),
        None => wheel.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::path::Path;

    #[test]
    fn a_length_means_what_it_is_near_to_and_nothing_where_it_is_vague() {
        let observed = Observed {
            robot: Robot::labmate(),
            runs: Vec::new(),
            path: Some(Path::umbmark()),
            setup: Default::default(),
            conditions: Default::default(),
            knowledge: Default::default(),
        };
        let of = |value: f64, standard_error: f64| {
            let length = Estimate { effect: "own", parameter: "c", value, standard_error, degrees_of_freedom: 9.0 };
            meaning(&observed, &length)
        };
        assert_eq!(of(PI * 0.151, 0.001).as_deref(), Some("once a turn of the left wheel"));
        assert_eq!(of(0.5 * PI * 0.150, 0.001).as_deref(), Some("twice a turn of the left wheel"));
        assert_eq!(of(4.01, 0.02).as_deref(), Some("the side of the path"));
        assert_eq!(of(0.342, 0.001).as_deref(), Some("the wheelbase"));
        assert_eq!(of(0.34, 0.02), None);
        assert_eq!(of(2.5, 0.01), None);
    }
}
