//! What is compared: the robot's own numbers where both tests show them all, else what they do show.

use super::Value;
use super::model::is_of_test;
use crate::evidence::{Estimate, Fit};
use crate::solve::{Own, deviation};
use nalgebra::DVector;

/// What a number belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The robot: its geometry.
    Robot,
    /// An effect on its motion.
    Effect,
    /// What the model leaves of the runs' errors.
    Scatter,
    /// The reference.
    Reference,
}

impl Of {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Of::Robot => "robot",
            Of::Effect => "effect",
            Of::Scatter => "scatter",
            Of::Reference => "reference",
        }
    }
}

/// A number that is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// What it belongs to.
    pub of: Of,
    /// Its key: of robot.toml, with its unit, or EFFECT.PARAMETER.
    pub key: String,
    /// What it is, in words.
    pub meaning: String,
}

/// Right over left wheel diameter, and wheelbase over their mean: what return poses show of two wheels on an axle.
const RATIOS: [(&str, &str); 2] = [
    ("wheel_diameter_ratio", "wheel diameter ratio, right over left,"),
    ("wheelbase_over_diameter", "wheelbase over the mean wheel diameter"),
];

/// All that both fits determine, before and after.
pub(super) fn of(fits: &[Fit; 2]) -> Vec<(Quantity, [Value; 2])> {
    let own = fits[0].model.robot().drive.own_effects();
    let mut found = geometry(fits);
    for before in &fits[0].estimates {
        let Some(part) = fits[0].model.parts().iter().find(|part| part.effect.name() == before.effect) else {
            continue;
        };
        let Some(after) = fits[1].estimates.iter().find(|after| same(before, after)) else { continue };
        if own.contains(&before.effect) {
            continue;
        }
        let title = part.effect.entry().map_or(before.effect, |entry| entry.about.title);
        let several = part.effect.parameters().len() > 1;
        let meaning = if several { format!("{title}, {}", before.parameter) } else { title.to_owned() };
        let of = if is_of_test(part) { Of::Reference } else { Of::Effect };
        let key = format!("{}.{}", before.effect, before.parameter);
        found.push((Quantity { of, key, meaning }, [value(before), value(after)]));
    }
    found
}

/// A key of the robot as it stands in tables, without its unit.
fn in_words(key: &str) -> String {
    key.strip_suffix("_m").unwrap_or(key).replace('_', " ")
}

fn same(a: &Estimate, b: &Estimate) -> bool {
    a.effect == b.effect && a.parameter == b.parameter
}

fn value(estimate: &Estimate) -> Value {
    let &Estimate { value, standard_error, degrees_of_freedom, .. } = estimate;
    Value { value, standard_error, degrees_of_freedom }
}

/// The own effects of a fit.
pub(super) fn own(fit: &Fit) -> Own<'_> {
    Own::of(&fit.model, &fit.estimates, &fit.correlations)
}

/// The robot's own numbers.
fn geometry(fits: &[Fit; 2]) -> Vec<(Quantity, [Value; 2])> {
    let drive = &fits[0].model.robot().drive;
    let [before, after] = [0, 1].map(|test| own(&fits[test]).shown.iter().map(|(which, _)| *which).collect::<Vec<_>>());
    let shows_all = |shown: &[usize]| (0..drive.first_effects().len()).all(|which| shown.contains(&which));
    if shows_all(&before) && shows_all(&after) {
        let parameters = drive.kind().parameters();
        let [before, after] = [numbers(&fits[0]), numbers(&fits[1])];
        let (Some(before), Some(after)) = (before, after) else { return Vec::new() };
        let of = |(parameter, (before, after)): (&crate::parameter::Parameter, (Value, Value))| {
            let (key, meaning) = (parameter.name.to_owned(), in_words(parameter.name));
            (Quantity { of: Of::Robot, key, meaning }, [before, after])
        };
        return parameters.iter().zip(before.into_iter().zip(after)).map(of).collect();
    }
    if drive.kind().has_axle_wheels() {
        let both = RATIOS.iter().enumerate().filter(|(which, _)| before.contains(which) && after.contains(which));
        let of = |(which, (key, meaning)): (usize, &(&str, &str))| {
            let quantity = Quantity { of: Of::Robot, key: (*key).to_owned(), meaning: (*meaning).to_owned() };
            Some((quantity, [ratio(&fits[0], which)?, ratio(&fits[1], which)?]))
        };
        return both.filter_map(of).collect();
    }
    let own = drive.own_effects();
    let of = |before: &Estimate| {
        let after = fits[1].estimates.iter().find(|after| same(before, after))?;
        let (key, meaning) = (format!("{}.{}", before.effect, before.parameter), in_words(before.effect));
        Some((Quantity { of: Of::Robot, key, meaning }, [value(before), value(after)]))
    };
    fits[0].estimates.iter().filter(|before| own.contains(&before.effect)).filter_map(of).collect()
}

/// The numbers of the drive with the fitted effects in them.
fn numbers(fit: &Fit) -> Option<Vec<Value>> {
    let corrected = fit.model.corrected_robot().ok()?.drive.values();
    let own = own(fit);
    let freedom = own.freedom().unwrap_or(1.0);
    let of = |(value, slope): (&f64, DVector<f64>)| {
        let standard_error = deviation(&own.covariance, &slope);
        Value { value: *value, standard_error, degrees_of_freedom: freedom }
    };
    Some(corrected.iter().zip(own.slopes(&fit.model)).map(of).collect())
}

/// One of the [RATIOS]: E_d and E_b times what is nominal.
pub(super) fn ratio(fit: &Fit, which: usize) -> Option<Value> {
    let robot = fit.model.robot();
    let [left, right] = robot.nominal().wheel_radius;
    let nominal = [right / left, robot.drive.wheelbase() / (left + right)][which];
    let effect = robot.drive.first_effects()[which];
    let estimate = fit.estimates.iter().find(|own| own.effect == effect)?;
    Some(Value {
        value: nominal * estimate.value,
        standard_error: nominal * estimate.standard_error,
        degrees_of_freedom: estimate.degrees_of_freedom,
    })
}
