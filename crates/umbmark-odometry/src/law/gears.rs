//! Laws of the gears of synchro drives.

use super::BodyLaw;
use crate::context::Here;
use crate::geometry::{Displacement2, Real};

/// The ratio of true to nominal way; the steering has gears of its own and is not touched.
///
/// `forward ← E_s forward`
pub struct DriveScale;

impl BodyLaw for DriveScale {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.forward *= p[0];
    }
}

/// The ratio of true to believed turns of the course.
///
/// `Δθ ← r Δθ`
pub struct SteerScale;

impl BodyLaw for SteerScale {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation *= p[0];
    }
}

/// A turn of the course per metre driven.
///
/// `Δθ ← Δθ + e · forward`
pub struct SteerCoupling;

impl BodyLaw for SteerCoupling {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation += p[0] * motion.forward;
    }
}

/// Way per radian of turn.
///
/// `forward ← forward + t · Δθ`
pub struct ContactTrail;

impl BodyLaw for ContactTrail {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.forward += p[0] * motion.rotation;
    }
}

/// A rate of turn per metre that depends on how far the wheels are steered from where they were at START.
///
/// `Δθ ← Δθ + (c cos σ + s sin σ) · forward,  σ the steering since START`
pub struct BaseYaw;

impl BodyLaw for BaseYaw {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (sine, cosine) = (motion.rotation * 0.5 + at.believed_heading).sine_cosine();
        motion.rotation += (p[0] * cosine + p[1] * sine) * motion.forward;
    }
}
