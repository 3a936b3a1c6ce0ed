//! A turn that grows with time.

use super::words::{deg, side};
use super::{About, ActsOn, BodyLaw, Context, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// A turn of the robot per second in which it drives.
pub struct SlowTurn;

pub(super) static EFFECT: Entry = Entry::of::<SlowTurn>().body::<SlowTurn>();

impl Effect for SlowTurn {
    const ABOUT: About = About {
        name: "slow_turn",
        title: "turn with time",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "rad_per_s",
            "slow-turn",
            "rad/s",
            1e-4,
            (-1.0, 1.0),
            "turn to the left per second of driving",
        )],
        equation: "Δθ ← Δθ + k · duration",
        physics: "A trial.",
        signature: "As E_d, and more where the robot drives slowly.",
        confused_with: &["wheel_diameter_ratio"],
        separated_by: "the same path at another speed",
        source: "a trial",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("In each second the robot turns by {} to the {}.", deg(p[0]), side(p[0]))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl BodyLaw for SlowTurn {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
        motion.rotation += p[0] * at.duration;
    }
}
