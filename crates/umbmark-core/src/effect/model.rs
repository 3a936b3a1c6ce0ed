//! A model: a choice of effects with values.

use super::{CATALOGUE, Context, Entry, Evaluate, MAX_PARAMETERS, Mean, Sight, find};
use crate::drive::{DifferentialDrive, Robot, WheelTravel};
use crate::geometry::{Displacement2, Pose2};
use crate::parameter::{DefaultValue, Parameter, ParameterError, nearest};

/// What makes a model impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// An effect that the catalogue does not hold.
    #[error("there is no effect \"{name}\"{}", did_you_mean(*nearest))]
    UnknownEffect {
        /// What was asked for.
        name: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
    },
    /// A parameter that the effect does not have.
    #[error("{effect} has no parameter \"{name}\"{}", did_you_mean(*nearest))]
    UnknownParameter {
        /// The effect.
        effect: &'static str,
        /// What was asked for.
        name: String,
        /// What may have been meant.
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
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default()
}

/// One effect of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The effect.
    pub effect: &'static Entry,
    /// Its parameters, in the order of its description.
    pub values: Vec<f64>,
    /// Whether a fit may change it.
    pub free: bool,
}

/// A chain of effects, in the order of the catalogue.
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
    /// No effects: the robot is as its odometry believes.
    pub fn new(robot: &Robot) -> Model {
        Model { robot: robot.clone(), parts: Vec::new() }
    }

    /// The nominal robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The effects of the model, in the order in which they act.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Adds an effect with its default values, or finds it where it is there already.
    pub fn add(&mut self, effect: &str) -> Result<&mut Part, ModelError> {
        let entry = find(effect)?;
        let order = |e: &Entry| CATALOGUE.iter().position(|c| c == e);
        let place = self.parts.partition_point(|part| order(part.effect) < order(entry));
        if self.parts.get(place).is_none_or(|part| part.effect != entry) {
            let values = entry.about.parameters.iter().map(|p| p.default.resolve(&self.robot)).collect();
            self.parts.insert(place, Part { effect: entry, values, free: false });
        }
        Ok(&mut self.parts[place])
    }

    /// Sets a parameter of an effect, adding the effect where it is not there.
    pub fn set(&mut self, effect: &str, parameter: &str, value: f64) -> Result<(), ModelError> {
        let about = &find(effect)?.about;
        let index = about.parameters.iter().position(|p| p.name == parameter).ok_or_else(|| {
            let nearest = nearest(parameter, about.parameters.iter().map(|p| p.name));
            ModelError::UnknownParameter { effect: about.name, name: parameter.to_owned(), nearest }
        })?;
        let value = about.parameters[index]
            .check(value)
            .map_err(|problem| ModelError::Value { effect: about.name, problem })?;
        self.add(effect)?.values[index] = value;
        Ok(())
    }

    /// The value of a parameter, if its effect is in the model.
    pub fn get(&self, effect: &str, parameter: &str) -> Option<f64> {
        let part = self.parts.iter().find(|part| part.effect.about.name == effect)?;
        let index = part.effect.about.parameters.iter().position(|p| p.name == parameter)?;
        Some(part.values[index])
    }

    /// Whether some effect with its present values changes motion along the way, so that driving has to be cut into small
    /// pieces. A derivative by a size that is 0 needs them all the same.
    pub fn varies(&self) -> bool {
        self.parts.iter().any(|part| (part.effect.varies)(&part.values))
    }

    /// All values of all parts, one after the other: the order of [`Model::chain_with`].
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts.iter().flat_map(|part| part.values.iter().copied())
    }

    /// Which of the [values](Model::values) are shapes: numbers (a length, a threshold) that change nothing where their effect
    /// is at zero.
    pub fn shapes(&self) -> Vec<usize> {
        let all = self.parts.iter().flat_map(|part| part.effect.about.parameters);
        let shape = |p: &Parameter| !matches!(p.default, DefaultValue::Value(value) if value == 0.0 || value == 1.0);
        all.enumerate().filter(|(_, p)| shape(p)).map(|(index, _)| index).collect()
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
            let about = &part.effect.about;
            let checked = about.parameters[index].check(*value);
            part.values[index] = checked.map_err(|problem| ModelError::Value { effect: about.name, problem })?;
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
        let links = self.parts.iter().map(|part| Link {
            mean: *T::mean(part.effect),
            count: part.values.len(),
            values: [T::from(0.0); MAX_PARAMETERS],
        });
        let mut chain = Chain { drive: self.robot.drive, links: links.collect() };
        chain.set_values(values);
        chain
    }
}

/// The deterministic effects of a model, ready to turn believed into true motion.
#[derive(Clone, Debug)]
pub struct Chain<T: Evaluate> {
    drive: DifferentialDrive,
    links: Vec<Link<T>>,
}

#[derive(Clone, Debug)]
struct Link<T: Evaluate> {
    mean: Mean<T>,
    count: usize,
    values: [T; MAX_PARAMETERS],
}

impl<T: Evaluate> Chain<T> {
    /// Replaces all values, in the order of [`Model::values`].
    ///
    /// # Panics
    /// Where there are fewer values than parameters.
    pub fn set_values(&mut self, values: &[T]) {
        let mut rest = values;
        for link in &mut self.links {
            let own;
            (own, rest) = rest.split_at(link.count);
            link.values[..link.count].copy_from_slice(own);
        }
    }

    /// Where the robot truly stands at START on average, seen from where it is believed to stand.
    pub fn start(&self) -> Pose2<T> {
        let start = Pose2::IDENTITY.lift();
        self.links.iter().fold(start, |pose, link| pose.compose(&(link.mean.start)(&link.values)))
    }

    /// True wheel travel for a believed one.
    #[inline]
    pub fn wheel_travel(&self, at: &Context<T>, believed: &WheelTravel) -> WheelTravel<T> {
        let mut travel = WheelTravel { left: T::from(believed.left), right: T::from(believed.right) };
        for link in &self.links {
            (link.mean.wheels)(&link.values, at, &mut travel);
        }
        travel
    }

    /// Body motion that a true wheel travel makes.
    #[inline]
    pub fn body(&self, at: &Context<T>, travel: &WheelTravel<T>) -> Displacement2<T> {
        let mut motion = self.drive.displacement(travel);
        for link in &self.links {
            (link.mean.body)(&link.values, at, &mut motion);
        }
        motion
    }

    /// Body motion for a believed wheel travel at constant ratio of the wheel speeds.
    #[inline]
    pub fn displacement(&self, at: &Context<T>, believed: &WheelTravel) -> Displacement2<T> {
        self.body(at, &self.wheel_travel(at, believed))
    }

    /// What a measurement without noise shows of a true pose.
    #[inline]
    pub fn seen(&self, at: &Sight, pose: &Pose2<T>) -> Pose2<T> {
        let mut seen = *pose;
        for link in &self.links {
            (link.mean.seen)(&link.values, at, &mut seen);
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Dual;

    #[test]
    fn effects_stand_in_the_order_of_the_catalogue_however_they_were_added() {
        let mut model = Model::new(&Robot::labmate());
        for name in ["scale", "wheel_diameter_ratio", "wheelbase", "scale"] {
            model.add(name).unwrap();
        }
        let names: Vec<_> = model.parts().iter().map(|p| p.effect.about.name).collect();
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
        assert_eq!(model.chain().displacement(&Context::default(), &believed), robot.drive.displacement(&believed));
    }

    #[test]
    fn wheels_and_wheelbase_are_as_the_paper_defines_them() {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_diameter_ratio", "e_d", 1.02).unwrap();
        model.set("wheelbase", "e_b", 1.05).unwrap();
        model.set("scale", "e_s", 0.99).unwrap();
        let chain = model.chain();
        let travel = chain.wheel_travel(&Context::default(), &WheelTravel { left: 1.0, right: 1.0 });
        assert!((travel.right / travel.left - 1.02).abs() < 1e-15);
        assert!((travel.right + travel.left - 2.0 * 0.99).abs() < 1e-15);
        let motion = chain.body(&Context::default(), &travel);
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
            let duals: Vec<Dual> =
                values.iter().enumerate().map(|(j, v)| Dual::new(*v, f64::from(u8::from(i == j)))).collect();
            let exact = model.chain_with(&duals).displacement(&Context::default().headed(duals[0]), &believed);
            let at = |step: f64| {
                let mut v = values.clone();
                v[i] += step;
                model.chain_with(&v).displacement(&Context::default(), &believed)
            };
            let (h, l) = (at(1e-6), at(-1e-6));
            assert!((exact.forward.eps - (h.forward - l.forward) / 2e-6).abs() < 1e-8);
            assert!((exact.rotation.eps - (h.rotation - l.rotation) / 2e-6).abs() < 1e-8);
        }
    }
}
