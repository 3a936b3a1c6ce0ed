//! A model: a choice of effects with values.

use super::chain::{Acting, ActingLaws, Chain};
use super::{Entry, Evaluate, Formula, Here, Law, MAX_PARAMETERS, find};
use crate::drive::{DriveKinds, Robot};
use crate::parameter::{Parameter, ParameterError, Role, nearest};
use std::sync::Arc;

/// Why a model is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// An effect that the catalogue does not hold.
    #[error("there is no effect \"{name}\"{}", did_you_mean(*nearest))]
    UnknownEffect {
        /// The name that was given.
        name: String,
        /// The most similar known name.
        nearest: Option<&'static str>,
    },
    /// A parameter that the effect does not have.
    #[error("{effect} has no parameter \"{name}\"{}", did_you_mean(*nearest))]
    UnknownParameter {
        /// The effect.
        effect: &'static str,
        /// The name that was given.
        name: String,
        /// The most similar known name.
        nearest: Option<&'static str>,
    },
    /// A value out of range.
    #[error("{effect}: {problem}")]
    Value {
        /// The effect.
        effect: &'static str,
        /// The parameter, its value and its range.
        problem: ParameterError,
    },
    /// An effect that the robot's drive cannot have.
    #[error("{effect} is an effect of other drives ({drives}), and the robot has drive = \"{drive}\"; leave it out")]
    OtherDrive {
        /// The effect.
        effect: &'static str,
        /// The drives that may have it.
        drives: DriveKinds,
        /// The robot's.
        drive: &'static str,
    },
    /// A model of another nominal robot.
    #[error("the model is of another robot ({own}) than this one ({other}); {why}")]
    OtherRobot {
        /// That of the model.
        own: String,
        /// The other.
        other: String,
        /// Why it is not converted, and what to do.
        why: &'static str,
    },
    /// A second effect of the same name.
    #[error("there is another effect \"{name}\"; give one of them another name")]
    Taken {
        /// The name.
        name: &'static str,
    },
    /// A formula with more or fewer values than parameters.
    #[error("{effect} has {parameters} parameters, got {values} values")]
    Values {
        /// The effect.
        effect: &'static str,
        /// How many parameters it has.
        parameters: usize,
        /// How many values were given.
        values: usize,
    },
    /// A formula that is not finite at some point of the path.
    #[error(
        "{effect}: \"{part}\", or its derivative, is not finite {time:.2} s after START in run {run}, where {values}; change \
         the formula so that it is finite there too, for instance a / max(b, 0.01) instead of a / b"
    )]
    Singular {
        /// The effect.
        effect: &'static str,
        /// The part of its formula.
        part: String,
        /// The values of its variables there.
        values: String,
        /// Time since START \[s\].
        time: f64,
        /// Number of the run in the session, from 0.
        run: f64,
    },
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default()
}

/// One effect of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The effect.
    pub effect: Law,
    /// Its parameters, in the order of its description.
    pub values: Vec<f64>,
    /// Whether a fit may change it.
    pub free: bool,
    /// Names of the parameters that a fit does not change all the same.
    pub fixed: Vec<&'static str>,
}

impl Part {
    /// See [`Effect::is_credible`](super::Effect::is_credible).
    pub(crate) fn is_credible(&self) -> bool {
        self.effect.entry().is_none_or(|entry| (entry.is_credible)(&self.values))
    }

    /// The name of its [share](Role::Share), where it has one.
    pub(crate) fn share(&self) -> Option<&'static str> {
        self.effect.parameters().iter().find(|parameter| parameter.role == Role::Share).map(|parameter| parameter.name)
    }

    /// Whether its share is kept as it is: its shape then is its size.
    fn is_whole(&self) -> bool {
        self.share().is_some_and(|share| self.fixed.contains(&share))
    }
}

/// A chain of effects, in the order of the catalogue; those that are not in it come last.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::Model};
/// let mut model = Model::new(&Robot::labmate());
/// model.set("wheel_diameter_ratio", "e_d", 1.002)?;
/// model.set("wheelbase", "e_b", 1.01)?;
/// assert_eq!(model.get("wheelbase", "e_b"), Some(1.01));
/// assert!(model.set("wheelbase", "e_b", -1.0).is_err());
/// # Ok::<(), umbmark_core::effect::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    robot: Robot,
    parts: Vec<Part>,
}

impl Model {
    /// No effects: the robot equals its nominal model.
    pub fn new(robot: &Robot) -> Model {
        Model { robot: robot.clone(), parts: Vec::new() }
    }

    /// The nominal robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The same effects of another nominal robot.
    pub fn of(self, robot: &Robot) -> Model {
        Model { robot: robot.clone(), ..self }
    }

    /// The effects of the model, in the order in which they act.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Refuses effects that the robot's drive cannot have.
    pub fn check_drive(&self) -> Result<(), ModelError> {
        let kind = self.robot.drive.kind();
        let entries = self.parts.iter().filter_map(|part| match &part.effect {
            Law::Entry(entry) => Some(*entry),
            Law::Formula(_) => None,
        });
        match entries.into_iter().find(|entry| !entry.drives().contains(kind)) {
            Some(entry) => {
                Err(ModelError::OtherDrive { effect: entry.about.name, drives: entry.drives(), drive: kind.name() })
            }
            None => Ok(()),
        }
    }

    /// Adds an effect of the catalogue with its default values, or finds it if the model already has it.
    pub fn add(&mut self, effect: &str) -> Result<&mut Part, ModelError> {
        let law = self.law(effect)?;
        Ok(self.place(law))
    }

    /// Adds an effect with its default values, in the catalogue or not, or finds it if the model already has it.
    pub fn add_entry(&mut self, entry: &'static Entry) -> Result<&mut Part, ModelError> {
        match self.law(entry.about.name) {
            Ok(Law::Entry(known)) if std::ptr::eq(known, entry) => Ok(self.place(Law::Entry(known))),
            Ok(_) => Err(ModelError::Taken { name: entry.about.name }),
            Err(_) => Ok(self.place(Law::Entry(entry))),
        }
    }

    /// Adds an effect of the user's own with these values of its parameters.
    pub fn add_formula(&mut self, formula: Formula, values: &[f64]) -> Result<&mut Part, ModelError> {
        let effect = formula.name();
        if self.law(effect).is_ok() {
            return Err(ModelError::Taken { name: effect });
        }
        let (parameters, given) = (formula.parameters(), values.len());
        if parameters.len() != given {
            return Err(ModelError::Values { effect, parameters: parameters.len(), values: given });
        }
        for (parameter, value) in parameters.iter().zip(values) {
            parameter.check(*value).map_err(|problem| ModelError::Value { effect, problem })?;
        }
        let part = self.place(Law::Formula(Arc::new(formula)));
        part.values.copy_from_slice(values);
        Ok(part)
    }

    /// The model without an effect.
    pub fn without(&self, effect: &str) -> Model {
        let parts = self.parts.iter().filter(|part| part.effect.name() != effect).cloned().collect();
        Model { robot: self.robot.clone(), parts }
    }

    /// Takes over a part of another model, with its values.
    pub fn adopt(&mut self, part: &Part) {
        let own = self.place(part.effect.clone());
        own.values.clone_from(&part.values);
        own.free = part.free;
        own.fixed.clone_from(&part.fixed);
    }

    /// The law that a name stands for in this model: that of a part, or one of the catalogue.
    fn law(&self, name: &str) -> Result<Law, ModelError> {
        let own = self.parts.iter().find(|part| part.effect.name() == name);
        own.map_or_else(|| find(name).map(Law::Entry), |part| Ok(part.effect.clone()))
    }

    /// The part of a law, added if it is missing.
    fn place(&mut self, law: Law) -> &mut Part {
        let known = self.parts.iter().position(|part| part.effect == law);
        let place = known.unwrap_or_else(|| {
            let place = self.parts.partition_point(|part| part.effect.order() <= law.order());
            let values = law.parameters().iter().map(|p| p.default.resolve(&self.robot)).collect();
            self.parts.insert(place, Part { effect: law, values, free: false, fixed: Vec::new() });
            place
        });
        &mut self.parts[place]
    }

    /// Sets a parameter of an effect, and adds the effect if it is missing.
    pub fn set(&mut self, effect: &str, parameter: &str, value: f64) -> Result<(), ModelError> {
        let law = self.law(effect)?;
        let known = parameter_of(&law, parameter)?;
        let value = known.check(value).map_err(|problem| ModelError::Value { effect: law.name(), problem })?;
        let index = law.parameters().iter().position(|p| p.name == parameter);
        let part = self.place(law);
        index.into_iter().for_each(|index| part.values[index] = value);
        Ok(())
    }

    /// Keeps a parameter of an effect as it is in fits, though its effect is free.
    pub fn fix(&mut self, effect: &str, parameter: &str) -> Result<(), ModelError> {
        let law = self.law(effect)?;
        let name = parameter_of(&law, parameter)?.name;
        let part = self.place(law);
        if !part.fixed.contains(&name) {
            part.fixed.push(name);
        }
        Ok(())
    }

    /// Lets fits change a parameter of a free effect again.
    pub(crate) fn release(&mut self, effect: &str, parameter: &str) {
        let own = self.parts.iter_mut().filter(|part| part.effect.name() == effect);
        own.for_each(|part| part.fixed.retain(|name| *name != parameter));
    }

    /// Whether a fit may change some of its values.
    pub fn is_free(&self) -> bool {
        !self.free_places().is_empty()
    }

    /// Places, among the [values](Model::values), of those that a fit may change.
    pub fn free_places(&self) -> Vec<usize> {
        let of_part = |part: &'_ Part| {
            let names =
                part.effect.parameters().iter().map(|parameter| part.free && !part.fixed.contains(&parameter.name));
            names.collect::<Vec<bool>>()
        };
        let flags = self.parts.iter().flat_map(of_part);
        flags.enumerate().filter_map(|(place, free)| free.then_some(place)).collect()
    }

    /// The model with only one of its effects.
    pub(crate) fn only(&self, effect: &str) -> Model {
        let parts = self.parts.iter().filter(|part| part.effect.name() == effect).cloned().collect();
        Model { parts, ..self.clone() }
    }

    /// The value of a parameter, if its effect is in the model.
    pub fn get(&self, effect: &str, parameter: &str) -> Option<f64> {
        let part = self.parts.iter().find(|part| part.effect.name() == effect)?;
        let index = part.effect.parameters().iter().position(|p| p.name == parameter)?;
        Some(part.values[index])
    }

    /// The same effects at their defaults, where most have no influence; a formula has no defaults and is kept.
    pub fn at_rest(&self) -> Model {
        let mut rest = self.clone();
        for part in rest.parts.iter_mut().filter(|part| part.effect.formula().is_none()) {
            part.values = part.effect.parameters().iter().map(|p| p.default.resolve(&self.robot)).collect();
        }
        rest
    }

    /// Meaning of an effect of the model for the robot, in a sentence; `None` if the model does not have it or it has none, as most
    /// formulas.
    pub fn meaning(&self, effect: &str) -> Option<String> {
        let part = self.parts.iter().find(|part| part.effect.name() == effect)?;
        if let Some(formula) = part.effect.formula() {
            return formula.meaning(&part.values);
        }
        let said = (part.effect.entry()?.means)(&part.values, &self.robot);
        (!said.is_empty()).then_some(said)
    }

    /// Whether some effect is a formula.
    pub fn has_formulas(&self) -> bool {
        self.parts.iter().any(|part| part.effect.formula().is_some())
    }

    /// Whether some effect may depend on where the robot is in the room, [`Here::x`](super::Here::x) and [`Here::y`](super::Here::y): a formula that has
    /// them, or an effect of a program's own.
    pub(crate) fn reads_place(&self) -> bool {
        self.parts.iter().any(|part| part.effect.reads_place())
    }

    /// Refuses formulas that are not finite at some of these places.
    pub fn check_along<'a>(&self, places: impl IntoIterator<Item = Here<'a>>) -> Result<(), ModelError> {
        let formulas: Vec<_> =
            self.parts.iter().filter_map(|part| Some((part.effect.formula()?, &part.values))).collect();
        if formulas.is_empty() {
            return Ok(());
        }
        for at in places {
            for (formula, values) in &formulas {
                formula.finite_at(values, &at).map_err(|singular| ModelError::Singular {
                    effect: formula.name(),
                    part: singular.part,
                    values: singular.values,
                    time: at.time,
                    run: at.run,
                })?;
            }
        }
        Ok(())
    }

    /// Whether some effect with its present values varies along the path, so that the path must be cut into small pieces. For derivatives
    /// see [`Model::may_vary`].
    pub fn varies(&self) -> bool {
        self.parts.iter().any(|part| part.effect.varies(&part.values))
    }

    /// Whether it would vary with some values. Derivatives depend on this, because a size of 0 has a derivative too.
    pub fn may_vary(&self) -> bool {
        self.parts.iter().any(|part| {
            let usual: Vec<f64> = part.effect.parameters().iter().map(|p| p.usual(&self.robot)).collect();
            part.effect.varies(&usual)
        })
    }

    /// All values of all parts, one after the other: the order of [`Model::chain_with`].
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts.iter().flat_map(|part| part.values.iter().copied())
    }

    /// The place of a parameter among the [values](Model::values), if its effect is in the model.
    pub fn place_of(&self, effect: &str, parameter: &str) -> Option<usize> {
        let part = self.parts.iter().position(|part| part.effect.name() == effect)?;
        let before: usize = self.parts[..part].iter().map(|part| part.values.len()).sum();
        let own = self.parts[part].effect.parameters().iter().position(|p| p.name == parameter)?;
        Some(before + own)
    }

    /// Which of the [values](Model::values) are shapes: numbers (a length, a threshold) without influence while their effect is zero.
    pub fn shapes(&self) -> Vec<usize> {
        let shapes = self.parameters().enumerate().filter(|(_, (_, parameter))| parameter.role == Role::Shape);
        shapes.filter(|(_, (part, _))| !part.is_whole()).map(|(value, _)| value).collect()
    }

    /// The value of one of the [values](Model::values), given by its index, at which its effect has no influence; `None` for a shape. A
    /// time constant is the size of an effect whose share is kept.
    pub(crate) fn nothing(&self, place: usize) -> Option<f64> {
        let (part, parameter) = self.parameters().nth(place)?;
        parameter.nothing().or_else(|| part.is_whole().then_some(0.0))
    }

    /// The usual size of one of the [values](Model::values), given by its index, where it is a shape of an effect of the catalogue.
    pub(crate) fn usual_shape(&self, place: usize) -> Option<f64> {
        let mut all = self.parts.iter().flat_map(|part| {
            let is_listed = part.effect.entry().is_some();
            part.effect.parameters().iter().map(move |parameter| (is_listed, parameter))
        });
        let (is_listed, parameter) = all.nth(place)?;
        (is_listed && parameter.role == Role::Shape).then_some(parameter.typical)
    }

    /// What the [values](Model::values) are values of.
    fn parameters(&self) -> impl Iterator<Item = (&Part, &Parameter)> {
        self.parts.iter().flat_map(|part| part.effect.parameters().iter().map(move |parameter| (part, parameter)))
    }

    /// The same effects with some of the [values](Model::values), named by their place, replaced.
    pub fn with_values(&self, places: &[usize], values: &[f64]) -> Result<Model, ModelError> {
        let mut model = self.clone();
        for (place, value) in places.iter().zip(values) {
            let mut index = *place;
            let holds = |part: &&mut Part| {
                let inside = index < part.values.len();
                index -= if inside { 0 } else { part.values.len() };
                inside
            };
            let Some(part) = model.parts.iter_mut().find(holds) else { continue };
            let checked = part.effect.parameters()[index].check(*value);
            part.values[index] =
                checked.map_err(|problem| ModelError::Value { effect: part.effect.name(), problem })?;
        }
        Ok(model)
    }

    /// The model's deterministic chain with its own values.
    pub fn chain(&self) -> Chain<f64> {
        let values: Vec<f64> = self.values().collect();
        self.chain_with(&values)
    }

    /// The model's deterministic chain with `values` (numbers or duals) in the order of [`Model::values`].
    pub fn chain_with<T: Evaluate>(&self, values: &[T]) -> Chain<T> {
        let effects = self.parts.iter().map(|part| Acting {
            laws: match &part.effect {
                Law::Entry(entry) => ActingLaws::Entry(*T::mean(entry)),
                Law::Formula(formula) => ActingLaws::Formula(Arc::clone(formula)),
            },
            changes: part.effect.changes(),
            count: part.values.len(),
            values: [T::from(0.0); MAX_PARAMETERS],
        });
        let mut chain = Chain { drive: *self.robot.drive, effects: effects.collect(), reads_place: self.reads_place() };
        chain.set_values(values);
        chain
    }
}

/// A parameter of a law, by its name.
fn parameter_of<'a>(law: &'a Law, name: &str) -> Result<&'a Parameter, ModelError> {
    let parameters = law.parameters();
    parameters.iter().find(|parameter| parameter.name == name).ok_or_else(|| ModelError::UnknownParameter {
        effect: law.name(),
        name: name.to_owned(),
        nearest: nearest(name, parameters.iter().map(|p| p.name)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::WheelTravel;
    use crate::effect::{CATALOGUE, Context};
    use crate::geometry::{Pose2, seeded};

    #[test]
    fn effects_stand_in_the_order_of_the_catalogue_however_they_were_added() {
        let mut model = Model::new(&Robot::labmate());
        for name in ["scale", "wheel_diameter_ratio", "wheelbase", "scale"] {
            model.add(name).unwrap();
        }
        let names: Vec<_> = model.parts().iter().map(|p| p.effect.name()).collect();
        assert_eq!(names, ["wheel_diameter_ratio", "wheelbase", "scale"]);
    }

    #[test]
    fn a_model_with_default_values_changes_nothing() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for entry in CATALOGUE {
            model.add(entry.about.name).unwrap();
        }
        let believed = WheelTravel { left: 0.7, right: -0.2 };
        assert_eq!(
            model.chain().displacement(&Context::default().as_believed(), &believed),
            robot.drive.displacement(&believed)
        );
    }

    #[test]
    fn wheels_and_wheelbase_are_as_the_paper_defines_them() {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_diameter_ratio", "e_d", 1.02).unwrap();
        model.set("wheelbase", "e_b", 1.05).unwrap();
        model.set("scale", "e_s", 0.99).unwrap();
        let chain = model.chain();
        let travel = chain.wheel_travel(&Context::default().as_believed(), &WheelTravel { left: 1.0, right: 1.0 });
        assert!((travel.right / travel.left - 1.02).abs() < 1e-15);
        assert!((travel.right + travel.left - 2.0 * 0.99).abs() < 1e-15);
        let motion = chain.body(&Context::default().as_believed(), &travel);
        assert!((motion.rotation - (travel.right - travel.left) / (0.340 * 1.05)).abs() < 1e-15);
    }

    #[test]
    fn the_derivative_of_the_chain_is_that_of_finite_differences() {
        let mut model = Model::new(&Robot::labmate());
        for (effect, parameter) in [("wheel_diameter_ratio", "e_d"), ("wheelbase", "e_b"), ("scale", "e_s")] {
            model.set(effect, parameter, 1.01).unwrap();
        }
        let believed = WheelTravel { left: 0.9, right: 1.1 };
        let values: Vec<f64> = model.values().collect();
        for i in 0..3 {
            let duals = seeded(values.iter().copied(), &[0, 1, 2]);
            let exact = model
                .chain_with(&duals)
                .displacement(&Context::default().at_pose(&Pose2::new(duals[0], duals[0], duals[0])), &believed);
            let at = |step: f64| {
                let mut v = values.clone();
                v[i] += step;
                model.chain_with(&v).displacement(&Context::default().as_believed(), &believed)
            };
            let (h, l) = (at(1e-6), at(-1e-6));
            assert!((exact.forward.eps[i] - (h.forward - l.forward) / 2e-6).abs() < 1e-8);
            assert!((exact.rotation.eps[i] - (h.rotation - l.rotation) / 2e-6).abs() < 1e-8);
        }
    }
}
