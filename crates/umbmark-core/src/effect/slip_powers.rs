//! Slip by the root, the square and the cube of the speed.
//!
//! The catalogue has slip in proportion to speed, and slip by its square. A robot's tyres need not follow either. Where runs do not tell
//! which power holds, they do not tell what the robot does at rest, and the values at rest (E_s, E_b) are others: the intervals of what is
//! learnt allow for these powers too. Those that are entries here have no cause that is known, so the catalogue does not have them.

use super::{About, ActsOn, BodyLaw, Effect, Entry, Here, WheelLaw, squared_forward_slip, squared_speed_slip};
use super::{at_work, body_speed_slip, forward_slip, speed_slip};
use crate::drive::WheelTravel;
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The slip of both wheels by their own speeds, in all powers.
pub(super) static OF_WHEELS: [&Entry; 4] = [
    &speed_slip::EFFECT,
    &squared_speed_slip::EFFECT,
    &Entry::of::<OfWheels<ROOT, 1, 1>>().wheels::<OfWheels<ROOT, 1, 1>>(),
    &Entry::of::<OfWheels<CUBE, 1, 1>>().wheels::<OfWheels<CUBE, 1, 1>>(),
];

/// The slip of the left wheel in other powers than 1.
pub(super) static OF_LEFT_WHEEL: [&Entry; 3] = [
    &Entry::of::<OfWheels<ROOT, 1, 0>>().wheels::<OfWheels<ROOT, 1, 0>>(),
    &Entry::of::<OfWheels<SQUARE, 1, 0>>().wheels::<OfWheels<SQUARE, 1, 0>>(),
    &Entry::of::<OfWheels<CUBE, 1, 0>>().wheels::<OfWheels<CUBE, 1, 0>>(),
];

/// The slip of the right wheel in other powers than 1.
pub(super) static OF_RIGHT_WHEEL: [&Entry; 3] = [
    &Entry::of::<OfWheels<ROOT, 0, 1>>().wheels::<OfWheels<ROOT, 0, 1>>(),
    &Entry::of::<OfWheels<SQUARE, 0, 1>>().wheels::<OfWheels<SQUARE, 0, 1>>(),
    &Entry::of::<OfWheels<CUBE, 0, 1>>().wheels::<OfWheels<CUBE, 0, 1>>(),
];

/// The slip of both wheels alike by the body's speed, in all powers.
pub(super) static OF_BODY: [&Entry; 4] = [
    &body_speed_slip::EFFECT,
    &Entry::of::<OfBody<ROOT>>().wheels::<OfBody<ROOT>>(),
    &Entry::of::<OfBody<SQUARE>>().wheels::<OfBody<SQUARE>>(),
    &Entry::of::<OfBody<CUBE>>().wheels::<OfBody<CUBE>>(),
];

/// The slip ahead, in all powers.
pub(super) static AHEAD: [&Entry; 4] = [
    &forward_slip::EFFECT,
    &squared_forward_slip::EFFECT,
    &Entry::of::<Ahead<ROOT>>().wheels::<Ahead<ROOT>>(),
    &Entry::of::<Ahead<CUBE>>().wheels::<Ahead<CUBE>>(),
];

/// The slip in turns by their rate, in other powers than 1.
pub(super) static IN_TURNS: [&Entry; 3] = [
    &Entry::of::<InTurns<ROOT>>().body::<InTurns<ROOT>>(),
    &Entry::of::<InTurns<SQUARE>>().body::<InTurns<SQUARE>>(),
    &Entry::of::<InTurns<CUBE>>().body::<InTurns<CUBE>>(),
];

// Powers, times two.
const ROOT: u8 = 1;
const SQUARE: u8 = 4;
const CUBE: u8 = 6;

/// `s_w ← (1 - k |v_w|^p) s_w` of the left wheel, the right wheel or both.
struct OfWheels<const TWICE: u8, const LEFT: u8, const RIGHT: u8>;

impl<const TWICE: u8, const LEFT: u8, const RIGHT: u8> Effect for OfWheels<TWICE, LEFT, RIGHT> {
    const ABOUT: About = about(
        match (LEFT, RIGHT) {
            (1, 1) => named(["speed_slip_root", "speed_slip_square", "speed_slip_cube"], TWICE),
            (1, _) => named(["speed_slip_left_root", "speed_slip_left_square", "speed_slip_left_cube"], TWICE),
            _ => named(["speed_slip_right_root", "speed_slip_right_square", "speed_slip_right_cube"], TWICE),
        },
        "s_w ← (1 - k |v_w|^p) s_w",
    );

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl<const TWICE: u8, const LEFT: u8, const RIGHT: u8> WheelLaw for OfWheels<TWICE, LEFT, RIGHT> {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let [left, right] = at.wheel_speed.map(power::<TWICE>);
        travel.left *= -p[0] * (f64::from(LEFT) * left) + 1.0;
        travel.right *= -p[0] * (f64::from(RIGHT) * right) + 1.0;
    }
}

/// `s_w ← (1 - k |v|^p) s_w` of both wheels, v the body's speed.
struct OfBody<const TWICE: u8>;

impl<const TWICE: u8> Effect for OfBody<TWICE> {
    const ABOUT: About = about(
        named(["body_speed_slip_root", "body_speed_slip_square", "body_speed_slip_cube"], TWICE),
        "s_w ← (1 - k |v|^p) s_w",
    );

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl<const TWICE: u8> WheelLaw for OfBody<TWICE> {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let kept = -p[0] * power::<TWICE>(at.speed) + 1.0;
        travel.left *= kept;
        travel.right *= kept;
    }
}

/// `s_w ← s_w - k |v|^p (s_L + s_R)/2` of both wheels, v the body's speed.
struct Ahead<const TWICE: u8>;

impl<const TWICE: u8> Effect for Ahead<TWICE> {
    const ABOUT: About = about(
        named(["forward_slip_root", "forward_slip_square", "forward_slip_cube"], TWICE),
        "s_w ← s_w - k |v|^p (s_L + s_R)/2",
    );

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl<const TWICE: u8> WheelLaw for Ahead<TWICE> {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let lost = p[0] * power::<TWICE>(at.speed) * (travel.left + travel.right) * 0.5;
        travel.left -= lost;
        travel.right -= lost;
    }
}

/// `Δθ ← (1 - k |ω|^p) Δθ`
struct InTurns<const TWICE: u8>;

impl<const TWICE: u8> Effect for InTurns<TWICE> {
    const ABOUT: About = about(
        named(["turn_slip_rate_root", "turn_slip_rate_square", "turn_slip_rate_cube"], TWICE),
        "Δθ ← (1 - k |ω|^p) Δθ",
    );

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl<const TWICE: u8> BodyLaw for InTurns<TWICE> {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation *= -p[0] * power::<TWICE>(at.turn_rate) + 1.0;
    }
}

/// |v|^(TWICE/2)
fn power<const TWICE: u8>(speed: f64) -> f64 {
    let speed = speed.abs();
    match TWICE {
        ROOT => speed.sqrt(),
        SQUARE => speed * speed,
        _ => speed * speed * speed,
    }
}

/// The name for a power, of those for root, square and cube.
const fn named(names: [&'static str; 3], twice: u8) -> &'static str {
    match twice {
        ROOT => names[0],
        SQUARE => names[1],
        _ => names[2],
    }
}

const fn about(name: &'static str, equation: &'static str) -> About {
    const SHARE: Parameter =
        Parameter::size("share", "", "", 0.03, (-1e3, 1e3), "share that is lost at 1 m/s, or at 1 rad/s");
    About {
        name,
        title: "slip by a power of the speed",
        acts_on: ActsOn::Wheels,
        parameters: &[SHARE],
        equation,
        physics: "",
        signature: "",
        confused_with: &[],
        separated_by: "",
        source: "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;

    /// Each power of a law is another law, and takes nothing from a robot at rest.
    #[test]
    fn each_shape_of_a_law_can_stand_beside_it_in_a_model() {
        for shapes in [&OF_WHEELS[..], &OF_LEFT_WHEEL, &OF_RIGHT_WHEEL, &OF_BODY, &AHEAD, &IN_TURNS] {
            let mut model = Model::new(&Robot::labmate());
            for shape in shapes {
                model.add_entry(shape).unwrap().free = true;
            }
            assert_eq!(model.parts().len(), shapes.len());
        }
    }

    #[test]
    fn powers_are_those_of_the_size_of_the_speed() {
        for (root, square, cube, speed) in [(0.5, 0.0625, 0.015_625, 0.25), (0.5, 0.0625, 0.015_625, -0.25)] {
            assert_eq!([power::<ROOT>(speed), power::<SQUARE>(speed), power::<CUBE>(speed)], [root, square, cube]);
        }
    }
}
