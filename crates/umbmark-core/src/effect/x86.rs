//! The laws of motion compiled for wider registers.

use super::{Context, Effect, Mean};
use crate::drive::WheelTravel;
use crate::geometry::{Displacement2, Dual, Instructions};

/// What an effect does with derivatives, for each width of registers.
#[derive(Debug)]
pub(super) struct Wide {
    eight: Mean<Dual>,
    four: Mean<Dual>,
}

impl Wide {
    pub const fn of<E: Effect>() -> Wide {
        let plain = Mean::of_duals::<E>();
        // SAFETY: `best` hands these out to machines only that were found to have such registers.
        Wide {
            eight: Mean {
                wheels: |p, at, travel| unsafe { wheels_by_eight::<E>(p, at, travel) },
                body: |p, at, motion| unsafe { body_by_eight::<E>(p, at, motion) },
                ..plain
            },
            four: Mean {
                wheels: |p, at, travel| unsafe { wheels_by_four::<E>(p, at, travel) },
                body: |p, at, motion| unsafe { body_by_four::<E>(p, at, motion) },
                ..plain
            },
        }
    }

    /// That for the widest registers of this machine.
    pub fn best(&self) -> Option<&Mean<Dual>> {
        match Instructions::best() {
            Instructions::Avx512 => Some(&self.eight),
            Instructions::Avx2 => Some(&self.four),
            Instructions::Portable => None,
        }
    }
}

#[target_feature(enable = "avx512f,avx512dq")]
fn wheels_by_eight<E: Effect>(p: &[Dual], at: &Context<Dual>, travel: &mut WheelTravel<Dual>) {
    E::wheels(p, at, travel);
}

#[target_feature(enable = "avx512f,avx512dq")]
fn body_by_eight<E: Effect>(p: &[Dual], at: &Context<Dual>, motion: &mut Displacement2<Dual>) {
    E::body(p, at, motion);
}

#[target_feature(enable = "avx2")]
fn wheels_by_four<E: Effect>(p: &[Dual], at: &Context<Dual>, travel: &mut WheelTravel<Dual>) {
    E::wheels(p, at, travel);
}

#[target_feature(enable = "avx2")]
fn body_by_four<E: Effect>(p: &[Dual], at: &Context<Dual>, motion: &mut Displacement2<Dual>) {
    E::body(p, at, motion);
}
