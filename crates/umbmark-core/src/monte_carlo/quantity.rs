//! The numbers of a study that can be varied, by the names of their flags.

use super::{Study, StudyError};
use crate::drive::{DriveError, Encoder, Robot};
use crate::effect::CATALOGUE;
use crate::engine::Update;
use crate::parameter::{Parameter, ParameterError, Role, nearest};
use crate::path::{Path, PathError, SHAPES, SpeedProfile};
use crate::simulate::Odometry;

/// A number that decides what a test does: of an effect, the nominal robot, its encoders, the path, its speed, or the number
/// of runs.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::Model, monte_carlo::{Quantity, Study}};
/// let mut study = Study::new(Model::new(&Robot::labmate()), 100, 1);
/// let side = Quantity::find("side", &study)?;
/// side.set(&mut study, 5.0)?;
/// assert_eq!((side.get(&study), side.key().as_str()), (Some(5.0), "path.side_m"));
/// assert!(Quantity::find("sdie", &study).unwrap_err().to_string().contains("did you mean \"side\"?"));
/// # Ok::<(), umbmark_core::monte_carlo::StudyError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    owner: Owner,
    parameter: Parameter,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    Effect(&'static str),
    Robot,
    Path,
    Speed(usize),
    Test,
}

/// A quantity that is not there, or cannot be what it is asked to be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// No quantity of this name.
    #[error("there is no parameter \"{name}\"{}", nearest.as_ref().map_or(String::new(), |n| format!("; did you mean \"{n}\"?")))]
    Unknown {
        /// The name that was given.
        name: String,
        /// The most similar known name.
        nearest: Option<String>,
    },
    /// A choice among words.
    #[error("{name} is {allowed}: it cannot be varied")]
    Choice {
        /// The parameter.
        name: &'static str,
        /// What it may be.
        allowed: String,
    },
    /// A size that the path does not have.
    #[error("{name} is not a size of a {shape}")]
    Shape {
        /// The parameter.
        name: &'static str,
        /// The shape of the path.
        shape: &'static str,
    },
    /// A value out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A robot that cannot be.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A path that cannot be.
    #[error(transparent)]
    Path(#[from] PathError),
}

/// Runs in each direction of a test; sigma needs two.
const RUNS: Parameter = Parameter::count("runs", "runs", 5.0, (2.0, 10_000.0), "runs in each direction, whole numbers");

impl Quantity {
    /// A quantity by its flag ("ed") or by its key ("wheel_diameter_ratio.e_d"); formulas are found in the study's model.
    pub fn find(name: &str, study: &Study) -> Result<Quantity, QuantityError> {
        let all = Quantity::all(study);
        let Some(found) = all.iter().find(|q| q.parameter.flag == name || q.key() == name) else {
            let names: Vec<String> = all.iter().flat_map(|q| [q.parameter.flag.to_owned(), q.key()]).collect();
            let nearest = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
            return Err(QuantityError::Unknown { name: name.to_owned(), nearest });
        };
        if !found.parameter.choices().is_empty() {
            let parameter = found.parameter;
            return Err(QuantityError::Choice { name: parameter.name, allowed: parameter.allowed() });
        }
        Ok(*found)
    }

    /// All that there are, those of the catalogue first.
    fn all(study: &Study) -> Vec<Quantity> {
        let known = CATALOGUE.iter().map(|entry| (entry.about.name, entry.about.parameters));
        let own = study.model.parts().iter().filter(|part| part.effect.entry().is_none_or(|e| !CATALOGUE.contains(&e)));
        let effects = known.chain(own.map(|part| (part.effect.name(), part.effect.parameters())));
        let effects = effects.flat_map(|(effect, all)| all.iter().map(move |p| (Owner::Effect(effect), *p)));
        // The shape that is driven comes first: shapes share names.
        let sizes = std::iter::once(study.path.shape()).chain(SHAPES.iter().copied()).flat_map(|s| s.parameters);
        let speeds = SpeedProfile::PARAMETERS.into_iter().enumerate().map(|(i, p)| (Owner::Speed(i), p));
        effects
            .chain(Robot::NUMBERS.map(|p| (Owner::Robot, p)))
            .chain(sizes.map(|p| (Owner::Path, *p)))
            .chain(speeds)
            .chain([(Owner::Test, RUNS)])
            .map(|(owner, parameter)| Quantity { owner, parameter })
            .collect()
    }

    /// What it is: name, unit, bounds and meaning.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// Its name in documents, with its unit: "wheel_diameter_ratio.e_d", "path.side_m".
    pub fn key(&self) -> String {
        let owner = match self.owner {
            Owner::Effect(effect) => effect,
            Owner::Robot => "robot",
            Owner::Path | Owner::Speed(_) => "path",
            Owner::Test => "test",
        };
        format!("{owner}.{}", self.parameter.name)
    }

    /// Whether a test rounds it to a whole number.
    pub fn is_whole(&self) -> bool {
        self.parameter.role == Role::Count
    }

    /// The effect that it is a number of, if it is.
    pub fn effect(&self) -> Option<&'static str> {
        match self.owner {
            Owner::Effect(effect) => Some(effect),
            _ => None,
        }
    }

    /// Its value in a study; none where an effect, a rate or a size is not there.
    pub fn get(&self, study: &Study) -> Option<f64> {
        let name = self.parameter.name;
        match self.owner {
            Owner::Effect(effect) => study.model.get(effect, name),
            Owner::Robot => study.robot().number(name),
            Owner::Path => {
                let place = study.path.shape().parameters.iter().position(|p| p.name == name)?;
                study.path.values().get(place).copied()
            }
            Owner::Speed(place) => Some(study.path.speed.values()[place]),
            Owner::Test => Some(study.runs[0].max(study.runs[1]) as f64),
        }
    }

    /// Gives it a value, the same in every trial.
    ///
    /// A new robot keeps the values of all effects. An encoder rate makes the odometry a sampled one. A number of runs is
    /// rounded, and is that of each direction that has runs.
    pub fn set(&self, study: &mut Study, value: f64) -> Result<(), StudyError> {
        let name = self.parameter.name;
        if let Owner::Effect(effect) = self.owner {
            study.draws.retain(|draw| draw.effect() != effect || draw.parameter().name != name);
            return Ok(study.model.set(effect, name, value)?);
        }
        let value = self.parameter.check(value).map_err(QuantityError::from)?;
        match self.owner {
            Owner::Effect(_) => {}
            Owner::Robot => self.set_robot(study, value)?,
            Owner::Path => self.set_size(study, value)?,
            Owner::Speed(place) => {
                let mut values = study.path.speed.values();
                values[place] = value;
                let [speed, acceleration, pause] = values;
                study.path.speed = SpeedProfile::new(speed, acceleration, pause).map_err(QuantityError::from)?;
            }
            Owner::Test => {
                study.runs = study.runs.map(|runs| if runs > 0 { value.round() as usize } else { 0 });
            }
        }
        Ok(())
    }

    fn set_robot(&self, study: &mut Study, value: f64) -> Result<(), QuantityError> {
        let robot = study.robot().with(self.parameter.name, value)?;
        if self.parameter.name == Encoder::RATE.name {
            let update = match study.odometry {
                Odometry::Sampled { update, .. } => update,
                _ => Update::Arc,
            };
            study.odometry = Odometry::Sampled { rate: value, update };
        }
        study.model = study.model.clone().of(&robot);
        Ok(())
    }

    fn set_size(&self, study: &mut Study, value: f64) -> Result<(), QuantityError> {
        let (shape, name) = (study.path.shape(), self.parameter.name);
        let place = shape.parameters.iter().position(|p| p.name == name);
        let place = place.ok_or(QuantityError::Shape { name, shape: shape.name })?;
        let mut values = study.path.values().to_vec();
        values[place] = value;
        study.path = Path::new(shape, &values, study.path.speed)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Model;
    use crate::monte_carlo::{Distribution, Draw};

    fn study() -> Study {
        Study::new(Model::new(&Robot::labmate()), 10, 1)
    }

    #[test]
    fn every_quantity_that_a_square_has_can_be_set_and_read_back() {
        let study = study();
        for quantity in Quantity::all(&study).iter().filter(|q| q.parameter.choices().is_empty()) {
            let (low, high) = quantity.parameter.bounds;
            let value = (quantity.parameter.usual(study.robot()) * 1.25).clamp(low, high).round().max(low);
            let mut changed = study.clone();
            if quantity.owner == Owner::Path && quantity.get(&study).is_none() {
                assert!(quantity.set(&mut changed, value).unwrap_err().to_string().ends_with("not a size of a square"));
                continue;
            }
            quantity.set(&mut changed, value).unwrap();
            assert_eq!(quantity.get(&changed), Some(value), "{}", quantity.key());
            assert_eq!(Quantity::find(&quantity.key(), &study).unwrap().key(), quantity.key());
            assert_eq!(Quantity::find(quantity.parameter.flag, &study).unwrap().key(), quantity.key());
        }
    }

    #[test]
    fn a_value_that_is_set_is_drawn_no_more_and_a_rate_makes_odometry_sampled() {
        let mut study = study();
        study.draws.push(Draw::new("wheelbase", "e_b", Distribution::Normal { mean: 1.0, sd: 0.1 }).unwrap());
        Quantity::find("eb", &study).unwrap().set(&mut study, 1.01).unwrap();
        assert!(study.draws.is_empty() && study.model.get("wheelbase", "e_b") == Some(1.01));
        Quantity::find("encoder-rate", &study).unwrap().set(&mut study, 50.0).unwrap();
        assert_eq!(study.odometry, Odometry::Sampled { rate: 50.0, update: Update::Arc });
        assert_eq!(study.model.get("wheelbase", "e_b"), Some(1.01));
    }

    #[test]
    fn what_is_no_quantity_or_no_value_is_refused() {
        let mut study = study();
        let find = |name: &str| Quantity::find(name, &study).unwrap_err().to_string();
        assert_eq!(find("wheel-nose"), "there is no parameter \"wheel-nose\"; did you mean \"wheel-noise\"?");
        assert!(find("bump-profile").ends_with("it cannot be varied"), "{}", find("bump-profile"));
        let runs = Quantity::find("runs", &study).unwrap();
        let refused = runs.set(&mut study, 1.0).unwrap_err().to_string();
        assert_eq!(refused, "runs must be between 2 and 10000, got 1");
    }
}
