//! Believed travel that waits to become true motion.
//!
//! Where effects do not vary along the way, a piece of travel becomes motion by what it is alone. So the pieces of a run wait for
//! each other's company: one effect after the other then changes all of them, and no piece waits until the one before
//! it has been through all effects.

use crate::drive::WheelTravel;
use crate::effect::{Chain, Context};
use crate::geometry::Displacement2;

/// What a piece of travel is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Roll {
    /// A whole stretch, whose noise is known by this number.
    Whole(usize),
    /// Some of a stretch.
    Part,
    /// A bump, at which the wheels lose what is counted: travel that no effect on the wheels changes.
    Bump(WheelTravel),
}

/// Pieces of travel, and the motions that they become.
#[derive(Clone, Debug, Default)]
pub(super) struct Rolls {
    travel: Vec<WheelTravel>,
    kind: Vec<Roll>,
    motion: Vec<Displacement2>,
}

impl Rolls {
    pub(super) fn clear(&mut self) {
        self.travel.clear();
        self.kind.clear();
    }

    #[inline]
    pub(super) fn push(&mut self, believed: WheelTravel, kind: Roll) {
        self.travel.push(believed);
        self.kind.push(kind);
    }

    /// How many that wait are no bumps.
    pub(super) fn stretches(&self) -> usize {
        self.kind.iter().filter(|kind| !matches!(kind, Roll::Bump(_))).count()
    }

    /// Makes true travel and motion of all that wait.
    pub(super) fn work_out(&mut self, chain: &Chain<f64>, at: &Context) {
        chain.change_wheels(at, &mut self.travel);
        for (travel, kind) in self.travel.iter_mut().zip(&self.kind) {
            if let Roll::Bump(lost) = kind {
                *travel = *lost;
            }
        }
        chain.bodies(at, &self.travel, &mut self.motion);
    }

    /// What was worked out: each piece with its true travel and motion.
    pub(super) fn all(&self) -> impl Iterator<Item = (Roll, &WheelTravel, Displacement2)> {
        self.kind.iter().zip(&self.travel).zip(&self.motion).map(|((kind, travel), motion)| (*kind, travel, *motion))
    }
}
