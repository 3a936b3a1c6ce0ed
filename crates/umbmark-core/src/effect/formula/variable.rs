//! What a formula may depend on.

use super::units::Unit;
use crate::effect::Context;
use crate::geometry::Real;

/// A quantity of the [`Context`], as it is in the middle of the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Speed,
    TurnRate,
    Acceleration,
    TurnAcceleration,
    Heading,
    WheelAngleLeft,
    WheelAngleRight,
    Distance,
    Time,
    SessionDistance,
    SinceTurn,
    LastTurn,
    Direction,
}

const METRE: Unit = Unit { metres: 1.0, seconds: 0.0 };

impl Variable {
    /// All of them, with their names and units.
    pub const ALL: [(&'static str, Variable, Unit); 13] = [
        ("speed", Variable::Speed, Unit { metres: 1.0, seconds: -1.0 }),
        ("turn_rate", Variable::TurnRate, Unit { metres: 0.0, seconds: -1.0 }),
        ("acceleration", Variable::Acceleration, Unit { metres: 1.0, seconds: -2.0 }),
        ("turn_acceleration", Variable::TurnAcceleration, Unit { metres: 0.0, seconds: -2.0 }),
        ("heading", Variable::Heading, Unit::PLAIN),
        ("wheel_angle_left", Variable::WheelAngleLeft, Unit::PLAIN),
        ("wheel_angle_right", Variable::WheelAngleRight, Unit::PLAIN),
        ("distance", Variable::Distance, METRE),
        ("time", Variable::Time, Unit { metres: 0.0, seconds: 1.0 }),
        ("session_distance", Variable::SessionDistance, METRE),
        ("since_turn", Variable::SinceTurn, METRE),
        ("last_turn", Variable::LastTurn, Unit::PLAIN),
        ("direction", Variable::Direction, Unit::PLAIN),
    ];

    /// Its name and unit.
    pub fn described(self) -> (&'static str, Unit) {
        let (name, _, unit) = Variable::ALL[self as usize];
        (name, unit)
    }

    /// Its value; `heading` is that of the middle of the piece.
    #[inline]
    pub fn of<T: Real>(self, at: &Context<T>, heading: T) -> T {
        let half = 0.5 * at.length;
        T::from(match self {
            Variable::Heading => return heading,
            Variable::Speed => at.speed,
            Variable::TurnRate => at.turn_rate,
            Variable::Acceleration => at.acceleration(),
            Variable::TurnAcceleration => at.turn_acceleration(),
            Variable::WheelAngleLeft => at.wheel_angle[0] + 0.5 * at.wheel_rotation[0],
            Variable::WheelAngleRight => at.wheel_angle[1] + 0.5 * at.wheel_rotation[1],
            Variable::Distance => at.distance + half,
            Variable::Time => at.time + 0.5 * at.duration,
            Variable::SessionDistance => at.session_distance + half,
            Variable::SinceTurn => at.since_turn + half,
            Variable::LastTurn => at.last_turn,
            Variable::Direction => at.direction,
        })
    }
}
