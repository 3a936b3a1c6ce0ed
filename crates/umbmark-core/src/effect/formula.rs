//! An effect of the user's own: a formula, compiled once.
//!
//! ```text
//! heading_per_metre     Δθ ← Δθ + f · length                   f [rad/m]
//! sideways_per_metre    sideways ← sideways + f · length       f [m/m], to the left
//! forward_per_radian    forward ← forward + f · |rotation|     f [m/rad]
//! sideways_per_radian   sideways ← sideways + f · |rotation|   f [m/rad], to the left
//! heading_per_second    Δθ ← Δθ + f · duration                 f [rad/s]
//! forward_per_second    forward ← forward + f · duration       f [m/s]
//! sideways_per_second   sideways ← sideways + f · duration     f [m/s], to the left
//! forward_scale         forward ← (1 + f) · forward            f [-]
//! turn_scale            Δθ ← (1 + f) · Δθ                      f [-]
//! left_wheel_scale      s_L ← (1 + f) · s_L                    f [-]
//! right_wheel_scale     s_R ← (1 + f) · s_R                    f [-]
//! ```
//!
//! *length* is the path length of a piece, always positive, *rotation* how far it turns and *duration* how long it takes; where these are
//! 0, laws per metre, per radian or per second have no influence. f is evaluated in the middle of the piece: from the predicted beginning
//! of the piece, after half of the motion that the preceding effects give. A formula with the value 0 changes nothing.

mod error;
mod meaning;
mod parser;
mod program;
mod tokens;
mod units;
mod variable;

use super::name::lasting;
use super::{CATALOGUE, Here, MAX_PARAMETERS};
use crate::drive::{DifferentialDrive, WheelTravel};
use crate::geometry::{Displacement2, Dual, LANES, Pose2, Real};
use crate::parameter::{DefaultValue, Parameter, Role};
use program::{Op, Program};
use std::fmt;
use units::Unit;
use variable::{Middle, VARIABLES, Variable};

pub use error::FormulaError;
pub use variable::FormulaVariable;

/// What a formula acts on, by the laws of [`Formula`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Rotation per path length \[rad/m\], counter-clockwise positive.
    HeadingPerMetre,
    /// Share by which motion ahead grows.
    ForwardScale,
    /// Share by which rotation grows.
    TurnScale,
    /// Sideways motion per path length, to the left positive.
    SidewaysPerMetre,
    /// Motion ahead per radian turned either way \[m/rad\].
    ForwardPerRadian,
    /// Sideways motion per radian turned either way \[m/rad\], to the left positive.
    SidewaysPerRadian,
    /// Rotation per second \[rad/s\], counter-clockwise positive.
    HeadingPerSecond,
    /// Motion ahead per second \[m/s\].
    ForwardPerSecond,
    /// Sideways motion per second \[m/s\], to the left positive.
    SidewaysPerSecond,
    /// Share by which the left wheel's travel grows.
    LeftWheelScale,
    /// Share by which the right wheel's travel grows.
    RightWheelScale,
}

impl Target {
    /// All of them.
    pub const ALL: [Target; 11] = [
        Target::HeadingPerMetre,
        Target::ForwardScale,
        Target::TurnScale,
        Target::SidewaysPerMetre,
        Target::ForwardPerRadian,
        Target::SidewaysPerRadian,
        Target::HeadingPerSecond,
        Target::ForwardPerSecond,
        Target::SidewaysPerSecond,
        Target::LeftWheelScale,
        Target::RightWheelScale,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Target::HeadingPerMetre => "heading_per_metre",
            Target::ForwardScale => "forward_scale",
            Target::TurnScale => "turn_scale",
            Target::SidewaysPerMetre => "sideways_per_metre",
            Target::ForwardPerRadian => "forward_per_radian",
            Target::SidewaysPerRadian => "sideways_per_radian",
            Target::HeadingPerSecond => "heading_per_second",
            Target::ForwardPerSecond => "forward_per_second",
            Target::SidewaysPerSecond => "sideways_per_second",
            Target::LeftWheelScale => "left_wheel_scale",
            Target::RightWheelScale => "right_wheel_scale",
        }
    }

    fn unit(self) -> Unit {
        match self {
            Target::HeadingPerMetre => Unit { metres: -1.0, seconds: 0.0 },
            Target::ForwardPerRadian | Target::SidewaysPerRadian => Unit { metres: 1.0, seconds: 0.0 },
            Target::HeadingPerSecond => Unit { metres: 0.0, seconds: -1.0 },
            Target::ForwardPerSecond | Target::SidewaysPerSecond => Unit { metres: 1.0, seconds: -1.0 },
            _ => Unit::PLAIN,
        }
    }

    /// Factor of the formula for a piece: its length, its unsigned rotation, its duration (0 where the wheels stand), or 1 for
    /// a share.
    #[inline]
    fn exposure<T>(self, at: &Here<T>) -> f64 {
        match self {
            Target::HeadingPerMetre | Target::SidewaysPerMetre => at.length,
            Target::ForwardPerRadian | Target::SidewaysPerRadian => (at.turn_rate * at.duration).abs(),
            Target::HeadingPerSecond | Target::ForwardPerSecond | Target::SidewaysPerSecond if at.stands() => 0.0,
            Target::HeadingPerSecond | Target::ForwardPerSecond | Target::SidewaysPerSecond => at.duration,
            Target::ForwardScale | Target::TurnScale | Target::LeftWheelScale | Target::RightWheelScale => 1.0,
        }
    }
}

/// A law of the user's own. Its numbers have their values in the [`Part`](super::Part) of a model.
///
/// It is made of `+ - * /`, `^` with a whole number, parentheses, numbers, `pi`, the functions `sin`, `cos`, `tan`, `exp`, `log`
/// (natural), `sqrt`, `abs`, `sign`, `min`, `max` and `tanh`, its parameters, and what the robot's own odometry knows in the
/// middle of a piece ([`Formula::variables`]): `speed` \[m/s\], `turn_rate` \[rad/s\], `acceleration` \[m/s²\], `turn_acceleration` \[rad/s²\],
/// `heading` \[rad\] in the room from the heading at START, `wheel_angle_left`, `wheel_angle_right` \[rad\] since START, `x`, `y` \[m\] in
/// the room from START, along the heading there and to its left, `distance`, `session_distance`, `since_turn` \[m\], `time` \[s\] since
/// START, `last_turn` and `direction` (+1 to the left, -1 to the right, 0 for neither).
///
/// `heading`, `x` and `y` are those that the model predicts, not those that are measured. Where runs of one session start in different
/// places, START is that of the first one.
///
/// Units must agree: an angle is a plain number, and parameters and written numbers have whatever unit makes it so.
/// Derivatives are exact; those of `abs`, `sign`, `min` and `max` at a corner are those of one side, or 0.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::{Formula, Model, Target}};
/// let nap = Formula::new("nap", Target::HeadingPerMetre, "k * sin(heading - h0)", &["k", "h0"])?;
/// let mut model = Model::new(&Robot::labmate());
/// model.add_formula(nap, &[0.001, 0.5])?.free = true;
/// assert_eq!(model.get("nap", "h0"), Some(0.5));
/// let error = Formula::new("nap", Target::HeadingPerMetre, "sin(speed)", &[]).unwrap_err();
/// assert!(error.to_string().starts_with("column 5: sin takes a plain number or an angle, and \"speed\" is in m/s"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Formula {
    name: &'static str,
    target: Target,
    text: String,
    parameters: Vec<Parameter>,
    reads_place: bool,
    program: Program,
}

/// A place where a formula is not finite.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Singular {
    /// The part of the formula.
    pub part: String,
    /// The variables and parameters in it, with their values.
    pub values: String,
}

impl Formula {
    /// Compiles a formula whose parameters have these names.
    pub fn new(name: &str, target: Target, text: &str, parameters: &[&str]) -> Result<Formula, FormulaError> {
        if CATALOGUE.iter().any(|entry| entry.about.name == name) {
            let why = "the catalogue has an effect of this name";
            return Err(FormulaError::Naming { name: name.to_owned(), what: "an effect", why });
        }
        check_name(name, "an effect")?;
        check_parameters(parameters)?;
        let text: String = text.chars().map(|c| if c.is_whitespace() { ' ' } else { c }).collect();
        let program = parser::parse(&text, parameters)?;
        let occurs = |p: usize| program.ops().contains(&Op::Parameter(p));
        if let Some(unused) = (0..parameters.len()).find(|p| !occurs(*p)) {
            return Err(FormulaError::Unused { name: parameters[unused].to_owned() });
        }
        let units = units::check(&text, &program, parameters.len(), (target.name(), target.unit()))?;
        let described = parameters.iter().zip(&units).zip(program.roles(parameters.len()));
        Ok(Formula {
            name: lasting(name),
            target,
            text,
            parameters: described.map(|((name, unit), role)| parameter(name, unit, role)).collect(),
            reads_place: [Variable::X, Variable::Y].iter().any(|place| program.ops().contains(&Op::Variable(*place))),
            program,
        })
    }

    /// Variables of formulas.
    pub fn variables() -> &'static [FormulaVariable] {
        &VARIABLES
    }

    /// The effect's name in files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The same formula under another name, which no effect of the catalogue has.
    pub(crate) fn named(&self, name: &str) -> Formula {
        Formula { name: lasting(name), ..self.clone() }
    }

    /// Its length: the number of its operations, variables and numbers.
    pub(crate) fn length(&self) -> usize {
        self.program.ops().len()
    }

    /// Its meaning for the robot with these values, in a sentence; `None` unless it is a wave over time or distance.
    pub fn meaning(&self, values: &[f64]) -> Option<String> {
        meaning::meaning(self, values)
    }

    /// What it acts on.
    pub fn target(&self) -> Target {
        self.target
    }

    /// As it was written, in one line.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its numbers, with their units where those follow from the formula.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Whether it depends on x or y.
    pub(super) fn reads_place(&self) -> bool {
        self.reads_place
    }

    /// Changes believed into true wheel travel \[m\] of a robot with this drive.
    #[inline]
    pub(super) fn wheels<T: Real>(
        &self,
        p: &[T],
        at: &Here<T>,
        drive: &DifferentialDrive,
        travel: &mut WheelTravel<T>,
    ) {
        if !matches!(self.target, Target::LeftWheelScale | Target::RightWheelScale) {
            return;
        }
        let factor = self.program.evaluate(p, at, &drive.displacement(travel)) + 1.0;
        let side = if self.target == Target::LeftWheelScale { &mut travel.left } else { &mut travel.right };
        *side *= factor;
    }

    /// Changes the body motion that true wheel travel makes.
    #[inline]
    pub(super) fn body<T: Real>(&self, p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let exposure = self.target.exposure(at);
        if matches!(self.target, Target::LeftWheelScale | Target::RightWheelScale) || exposure == 0.0 {
            return;
        }
        let f = self.program.evaluate(p, at, motion) * exposure;
        match self.target {
            Target::HeadingPerMetre | Target::HeadingPerSecond => motion.rotation += f,
            Target::SidewaysPerMetre | Target::SidewaysPerRadian | Target::SidewaysPerSecond => motion.sideways += f,
            Target::ForwardPerRadian | Target::ForwardPerSecond => motion.forward += f,
            Target::TurnScale => motion.rotation *= f + 1.0,
            _ => motion.forward *= f + 1.0,
        }
    }

    /// Refuses a piece on which the formula, or a derivative of it, is not finite.
    pub(super) fn finite_at(&self, values: &[f64], at: &Here) -> Result<(), Singular> {
        if self.target.exposure(at) == 0.0 {
            return Ok(());
        }
        // A lane for each parameter, for heading and, where it is read, for x and y: mostly all at once.
        const { assert!(MAX_PARAMETERS < LANES) };
        let lanes = values.len() + if self.reads_place { 3 } else { 1 };
        let still = Displacement2 { forward: Dual::from(0.0), sideways: Dual::from(0.0), rotation: Dual::from(0.0) };
        let mut first: Option<usize> = None;
        for begin in (0..lanes).step_by(LANES) {
            let seeded = |value: f64, number: usize| {
                let mut dual = Dual::from(value);
                if let Some(eps) = number.checked_sub(begin).and_then(|lane| dual.eps.get_mut(lane)) {
                    *eps = 1.0;
                }
                dual
            };
            let mut duals = [Dual::from(0.0); MAX_PARAMETERS];
            duals.iter_mut().zip(values).enumerate().for_each(|(i, (dual, value))| *dual = seeded(*value, i));
            let [heading, x, y] = [(at.heading, 0), (at.x, 1), (at.y, 2)].map(|(v, i)| seeded(v, values.len() + i));
            let pose = Pose2::new(x, y, heading);
            self.program.watched(&duals, &at.at_pose(&pose), &still, |i, value| {
                if !(value.re.is_finite() && value.eps.iter().all(|e| e.is_finite())) {
                    first = Some(first.map_or(i, |first| first.min(i)));
                }
            });
        }
        first.map_or(Ok(()), |op| Err(self.singular(op, values, at)))
    }

    fn singular(&self, op: usize, values: &[f64], at: &Here) -> Singular {
        let span = self.program.span(op);
        let mut said: Vec<String> = Vec::new();
        for (i, inside) in self.program.ops().iter().enumerate() {
            let own = self.program.span(i);
            let text = match inside {
                Op::Variable(variable) => {
                    let (about, value) =
                        (variable.described(), variable.of(at, &mut Middle::new(at, &Displacement2::NONE)));
                    format!("{} = {value} {}", about.name, about.dimension).trim_end().to_owned()
                }
                Op::Parameter(p) => format!("{} = {}", self.parameters[*p].name, values[*p]),
                _ => continue,
            };
            if own.start >= span.start && own.end <= span.end && !said.contains(&text) {
                said.push(text);
            }
        }
        Singular { part: self.text[span].to_owned(), values: said.join(", ") }
    }
}

fn parameter(name: &str, unit: &Option<Unit>, role: Role) -> Parameter {
    Parameter {
        name: lasting(name),
        flag: "",
        unit: lasting(&unit.map(|unit| unit.to_string()).unwrap_or_default()),
        role,
        default: DefaultValue::Value(0.0),
        typical: 1.0,
        bounds: (f64::NEG_INFINITY, f64::INFINITY),
        meaning: "",
    }
}

fn check_name(name: &str, what: &'static str) -> Result<(), FormulaError> {
    let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if letters && name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        return Ok(());
    }
    let why = "it takes letters, digits and _, and begins with a letter";
    Err(FormulaError::Naming { name: name.to_owned(), what, why })
}

fn check_parameters(names: &[&str]) -> Result<(), FormulaError> {
    if names.len() > MAX_PARAMETERS {
        return Err(FormulaError::TooManyParameters { count: names.len() });
    }
    for (i, name) in names.iter().enumerate() {
        check_name(name, "a parameter")?;
        let why = match () {
            () if parser::is_taken(name) => "it has a meaning in every formula",
            () if names[..i].contains(name) => "another one has it",
            () => continue,
        };
        return Err(FormulaError::Naming { name: (*name).to_owned(), what: "a parameter", why });
    }
    Ok(())
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let names: Vec<&str> = self.parameters.iter().map(|p| p.name).collect();
        write!(f, "{}({}): {} = {}", self.name, names.join(", "), self.target.name(), self.text)
    }
}

impl PartialEq for Formula {
    fn eq(&self, other: &Formula) -> bool {
        let names = |formula: &Formula| formula.parameters.iter().map(|p| p.name).collect::<Vec<_>>();
        (self.name, self.target, &self.text) == (other.name, other.target, &other.text) && names(self) == names(other)
    }
}

#[cfg(test)]
mod tests;
