//! Variables of formulas.

use super::units::Unit;
use crate::effect::Here;
use crate::geometry::{Displacement2, Real};

/// A quantity of a piece, as it is in the middle of the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Speed,
    TurnRate,
    Acceleration,
    TurnAcceleration,
    Heading,
    WheelAngleLeft,
    WheelAngleRight,
    X,
    Y,
    Distance,
    SessionDistance,
    SinceTurn,
    Time,
    LastTurn,
    Direction,
}

/// A quantity that formulas may depend on, as it is in the middle of a piece of the way.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct FormulaVariable {
    /// Its name in formulas.
    pub name: &'static str,
    /// Its unit, as people write it; empty for a plain number.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    #[serde(skip)]
    pub(super) variable: Variable,
    #[serde(skip)]
    pub(super) dimension: Unit,
}

const METRE: Unit = Unit { metres: 1.0, seconds: 0.0 };

const fn row(
    name: &'static str,
    variable: Variable,
    (unit, dimension): (&'static str, Unit),
    meaning: &'static str,
) -> FormulaVariable {
    FormulaVariable { name, unit, meaning, variable, dimension }
}

const M: (&str, Unit) = ("m", METRE);
const RAD: (&str, Unit) = ("rad", Unit::PLAIN);
const SENSE: (&str, Unit) = ("", Unit::PLAIN);

/// All of them, in the order of [`Variable`].
pub(super) static VARIABLES: [FormulaVariable; 15] = [
    row(
        "speed",
        Variable::Speed,
        ("m/s", Unit { metres: 1.0, seconds: -1.0 }),
        "speed of the axle's centre, forward positive",
    ),
    row(
        "turn_rate",
        Variable::TurnRate,
        ("rad/s", Unit { metres: 0.0, seconds: -1.0 }),
        "how fast the robot turns, counter-clockwise positive",
    ),
    row(
        "acceleration",
        Variable::Acceleration,
        ("m/s²", Unit { metres: 1.0, seconds: -2.0 }),
        "acceleration of the axle's centre",
    ),
    row(
        "turn_acceleration",
        Variable::TurnAcceleration,
        ("rad/s²", Unit { metres: 0.0, seconds: -2.0 }),
        "change of the turn rate",
    ),
    row("heading", Variable::Heading, RAD, "heading in the room, from the heading at START, as the model predicts it"),
    row("wheel_angle_left", Variable::WheelAngleLeft, RAD, "angle of the left wheel since START"),
    row("wheel_angle_right", Variable::WheelAngleRight, RAD, "angle of the right wheel since START"),
    row("x", Variable::X, M, "place in the room from START, along the heading at START, as the model predicts it"),
    row(
        "y",
        Variable::Y,
        M,
        "place in the room from START, to the left of the heading at START, as the model predicts it",
    ),
    row("distance", Variable::Distance, M, "path length driven in this run"),
    row("session_distance", Variable::SessionDistance, M, "path length driven in all runs of the session"),
    row("since_turn", Variable::SinceTurn, M, "path length since the last turn, or START"),
    row("time", Variable::Time, ("s", Unit { metres: 0.0, seconds: 1.0 }), "time since START"),
    row("last_turn", Variable::LastTurn, SENSE, "sense of the last turn: +1 left, -1 right, 0 before the first"),
    row("direction", Variable::Direction, SENSE, "sense of the run: +1 counter-clockwise, -1 clockwise, 0 for neither"),
];

/// Where the robot is when half of the motion of a piece is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Middle<'a, T> {
    motion: &'a Displacement2<T>,
    heading: T,
    /// Computed on demand: it needs a sine and a cosine, and most formulas do not use it.
    place: Option<[T; 2]>,
}

impl<'a, T: Real> Middle<'a, T> {
    /// That of a piece with this motion.
    #[inline]
    pub fn new(at: &Here<T>, motion: &'a Displacement2<T>) -> Middle<'a, T> {
        Middle { motion, heading: at.heading + motion.rotation * 0.5, place: None }
    }

    #[inline]
    fn place(&mut self, at: &Here<T>) -> [T; 2] {
        let motion = self.motion;
        *self.place.get_or_insert_with(|| halfway(at, motion))
    }
}

/// The place where half of a motion is made.
#[inline(never)]
fn halfway<T: Real>(at: &Here<T>, motion: &Displacement2<T>) -> [T; 2] {
    let Displacement2 { forward, sideways, rotation } = *motion;
    let half = Displacement2 { forward: forward * 0.5, sideways: sideways * 0.5, rotation: rotation * 0.5 };
    let middle = at.pose().moved(&half);
    [middle.x, middle.y]
}

impl Variable {
    /// Its name and unit.
    pub fn described(self) -> &'static FormulaVariable {
        &VARIABLES[self as usize]
    }

    /// Its value.
    #[inline]
    pub fn of<T: Real>(self, at: &Here<T>, middle: &mut Middle<T>) -> T {
        let half = 0.5 * at.length;
        T::from(match self {
            Variable::Heading => return middle.heading,
            Variable::X => return middle.place(at)[0],
            Variable::Y => return middle.place(at)[1],
            Variable::Speed => at.speed,
            Variable::TurnRate => at.turn_rate,
            Variable::Acceleration => at.acceleration(),
            Variable::TurnAcceleration => at.turn_acceleration(),
            Variable::WheelAngleLeft => at.wheel_angle[0] + 0.5 * at.wheel_rotation[0],
            Variable::WheelAngleRight => at.wheel_angle[1] + 0.5 * at.wheel_rotation[1],
            Variable::Distance => at.distance + half,
            Variable::SessionDistance => at.session_distance + half,
            Variable::SinceTurn => at.since_turn + half,
            Variable::Time => at.time + 0.5 * at.duration,
            Variable::LastTurn => at.last_turn,
            Variable::Direction => at.direction,
        })
    }
}
