//! A number a user can set: its name, unit, role, bounds, usual value and meaning.
//!
//! Robots, effects, path shapes and speed profiles describe their numbers with the same type, so that files, flags, sweeps, help
//! and error messages are all made from one description.

/// The description of one number.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name in files: the unit stands in the name unless it is a ratio or a count.
    pub name: &'static str,
    /// Its command-line flag, without the dashes; empty where it has none.
    pub flag: &'static str,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// What it does.
    pub role: Role,
    /// The value where none is given.
    pub default: DefaultValue,
    /// A usual size: of the departure from the value that does nothing, where there is one.
    pub typical: f64,
    /// Smallest and largest value allowed.
    pub bounds: (f64, f64),
    /// What it is, in a short sentence.
    pub meaning: &'static str,
}

/// What a number does in what it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It does nothing at 0.
    Size,
    /// It does nothing at 0, and usually it is 1: all.
    Share,
    /// It does nothing at 1.
    Ratio,
    /// A length, rate or threshold. It changes nothing by itself, and no value of it does nothing.
    Shape,
    /// A standard deviation of what differs from run to run: nothing varies at 0.
    Scatter,
    /// How many there are: a whole number.
    Count,
    /// It stands for one of these words, in order from 0.
    Choice(&'static [&'static str]),
}

/// The value of a parameter that nobody set.
#[derive(Clone, Copy, Debug)]
pub enum DefaultValue {
    /// A number.
    Value(f64),
    /// A number that the robot has.
    OfRobot(fn(&dyn Sizes) -> f64),
}

/// The sizes of a robot that numbers nobody set may be taken from.
pub trait Sizes {
    /// \[m\]
    fn wheelbase(&self) -> f64;

    /// Mean radius of its wheels \[m\].
    fn wheel_radius(&self) -> f64;
}

impl DefaultValue {
    /// The number itself.
    pub fn resolve(&self, robot: &dyn Sizes) -> f64 {
        match self {
            DefaultValue::Value(value) => *value,
            DefaultValue::OfRobot(of) => of(robot),
        }
    }
}

/// A parameter that cannot have the value it was given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} must be {allowed}, got {value}")]
pub struct ParameterError {
    /// The parameter.
    pub name: &'static str,
    /// What it was given.
    pub value: f64,
    /// What it may be, in words.
    pub allowed: String,
}

impl Parameter {
    const fn new(
        role: Role,
        [name, flag, unit]: [&'static str; 3],
        [default, typical]: [f64; 2],
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter { name, flag, unit, role, default: DefaultValue::Value(default), typical, bounds, meaning }
    }

    /// A number that does nothing where it is 0, its value where none is given.
    pub const fn size(
        name: &'static str,
        flag: &'static str,
        unit: &'static str,
        typical: f64,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter::new(Role::Size, [name, flag, unit], [0.0, typical], bounds, meaning)
    }

    /// A share that does nothing where it is 0, its value where none is given, and that is 1 where it is all, as it usually is.
    pub const fn share(name: &'static str, flag: &'static str, bounds: (f64, f64), meaning: &'static str) -> Parameter {
        Parameter::new(Role::Share, [name, flag, ""], [0.0, 1.0], bounds, meaning)
    }

    /// A pure number that does nothing where it is 1, its value where none is given; `typical` is a usual departure from 1.
    pub const fn ratio(
        name: &'static str,
        flag: &'static str,
        typical: f64,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter::new(Role::Ratio, [name, flag, ""], [1.0, typical], bounds, meaning)
    }

    /// A length, rate or threshold, with a usual value.
    pub const fn shape(
        name: &'static str,
        flag: &'static str,
        unit: &'static str,
        usual: f64,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter::new(Role::Shape, [name, flag, unit], [usual, usual], bounds, meaning)
    }

    /// A standard deviation of what differs from run to run, 0 where none is given.
    pub const fn scatter(
        name: &'static str,
        flag: &'static str,
        unit: &'static str,
        typical: f64,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter::new(Role::Scatter, [name, flag, unit], [0.0, typical], bounds, meaning)
    }

    /// How many there are; none where nothing is said.
    pub const fn count(
        name: &'static str,
        flag: &'static str,
        typical: f64,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Parameter {
        Parameter::new(Role::Count, [name, flag, ""], [0.0, typical], bounds, meaning)
    }

    /// One of a few words; the one of this index where none is given.
    pub const fn choice(
        name: &'static str,
        flag: &'static str,
        words: &'static [&'static str],
        default: usize,
        meaning: &'static str,
    ) -> Parameter {
        let bounds = (0.0, words.len() as f64 - 1.0);
        Parameter::new(Role::Choice(words), [name, flag, ""], [default as f64; 2], bounds, meaning)
    }

    /// The words that it stands for; none for a number.
    pub fn choices(&self) -> &'static [&'static str] {
        match self.role {
            Role::Choice(words) => words,
            _ => &[],
        }
    }

    /// The word that a value of it stands for.
    pub fn word(&self, value: f64) -> Option<&'static str> {
        self.choices().get(value as usize).copied()
    }

    /// The value at which it does nothing, where there is one.
    pub fn nothing(&self) -> Option<f64> {
        match self.role {
            Role::Size | Role::Share | Role::Scatter | Role::Count => Some(0.0),
            Role::Ratio => Some(1.0),
            Role::Shape | Role::Choice(_) => None,
        }
    }

    /// A value at which it does something: the typical departure from the one that does nothing, else the default.
    pub fn usual(&self, robot: &dyn Sizes) -> f64 {
        self.nothing().map_or_else(|| self.default.resolve(robot), |nothing| nothing + self.typical)
    }

    /// `value`, if it is finite and within the bounds.
    pub fn check(&self, value: f64) -> Result<f64, ParameterError> {
        let (lowest, highest) = self.bounds;
        let whole = self.choices().is_empty() || value.fract() == 0.0;
        if value.is_finite() && value >= lowest && value <= highest && whole {
            return Ok(value);
        }
        Err(ParameterError { name: self.name, value, allowed: self.allowed() })
    }

    /// The allowed values in words: "between 0.5 and 2", "0 or more, in m".
    pub fn allowed(&self) -> String {
        if let Role::Choice(words) = self.role {
            return format!("one of {}", words.join(", "));
        }
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        match self.bounds {
            (f64::NEG_INFINITY, f64::INFINITY) => format!("a finite number{unit}"),
            (lowest, f64::INFINITY) => format!("{lowest}{unit} or more"),
            (f64::NEG_INFINITY, highest) => format!("{highest}{unit} or less"),
            (lowest, highest) => format!("between {lowest} and {highest}{unit}"),
        }
    }
}

/// The member of `names` that `word` was probably meant to be, if one is near or begins with it.
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    names
        .into_iter()
        .map(|name| {
            let lower = name.to_lowercase();
            let begun = word.len() >= 3 && lower.starts_with(&word);
            (if begun { 1 } else { strsim::levenshtein(&word, &lower) }, name)
        })
        .filter(|(distance, name)| *distance <= 2.max(name.len() / 3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATIO: Parameter = Parameter::ratio("e_d", "ed", 1e-3, (0.5, 2.0), "");

    #[test]
    fn values_out_of_bounds_and_not_finite_are_refused_with_the_range() {
        assert_eq!(RATIO.check(1.01), Ok(1.01));
        assert_eq!(RATIO.check(3.0).unwrap_err().to_string(), "e_d must be between 0.5 and 2, got 3");
        assert!(RATIO.check(f64::NAN).is_err());
    }

    #[test]
    fn a_slip_of_the_keyboard_finds_its_word_and_nonsense_finds_none() {
        let names = ["wheelbase", "wheel_noise", "scale"];
        assert_eq!(nearest("wheelbsae", names), Some("wheelbase"));
        assert_eq!(nearest("Wheel_nose", names), Some("wheel_noise"));
        assert_eq!(nearest("whe", names), Some("wheelbase"));
        assert_eq!(nearest("zzz", names), None);
    }
}
