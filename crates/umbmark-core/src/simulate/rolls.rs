//! Believed travel that is not yet turned into true motion.
//!
//! If effects do not vary along the path, the motion of a piece depends only on its own travel. So the pieces of a run are collected, and
//! each effect is applied to all of them at once.

use crate::drive::WheelTravel;
use crate::effect::{Chain, Here};
use crate::geometry::Displacement2;

/// The kind of a piece of travel.
#[derive(Clone, Copy, Debug)]
pub(super) enum Roll {
    /// A whole stretch, whose noise is known by this number.
    Whole(usize),
    /// Some of a stretch.
    Part,
    /// A bump, at which the wheels lose counted travel; effects on the wheels do not change it.
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

    /// Number of pending pieces that are not bumps.
    pub(super) fn stretches(&self) -> usize {
        self.kind.iter().filter(|kind| !matches!(kind, Roll::Bump(_))).count()
    }

    /// Computes true travel and motion of all pending pieces.
    pub(super) fn work_out(&mut self, chain: &Chain<f64>, at: &Here) {
        chain.change_wheels(at, &mut self.travel);
        for (travel, kind) in self.travel.iter_mut().zip(&self.kind) {
            if let Roll::Bump(lost) = kind {
                *travel = *lost;
            }
        }
        chain.bodies(at, &self.travel, &mut self.motion);
    }

    /// The computed pieces, each with its true travel and motion.
    pub(super) fn all(&self) -> impl Iterator<Item = (Roll, &WheelTravel, Displacement2)> {
        self.kind.iter().zip(&self.travel).zip(&self.motion).map(|((kind, travel), motion)| (*kind, travel, *motion))
    }
}
