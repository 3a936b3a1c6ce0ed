//! Laws of the wheels' shape, and their play.

use super::{BodyLaw, WheelLaw, size};
use crate::context::Here;
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;

/// The ratio of the true wheel diameters, split symmetrically so that their mean stays nominal.
///
/// `s_R ← s_R · 2 E_d/(1 + E_d),  s_L ← s_L · 2/(1 + E_d)`
pub struct WheelDiameterRatio;

impl WheelLaw for WheelDiameterRatio {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], _at: &Here<T>, travel: &mut WheelTravel<T>) {
        let left = (p[0] + 1.0).recip() * 2.0;
        travel.left *= left;
        travel.right *= left * p[0];
    }
}

/// The ratio of the effective wheelbase to the nominal one.
///
/// `Δθ ← Δθ / E_b`
pub struct Wheelbase;

impl BodyLaw for Wheelbase {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation /= p[0];
    }
}

/// The ratio of the mean true wheel diameter to the nominal one.
///
/// `s_L ← E_s s_L,  s_R ← E_s s_R`
pub struct Scale;

impl WheelLaw for Scale {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], _at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.left *= p[0];
        travel.right *= p[0];
    }
}

/// A left wheel whose axle misses its centre.
///
/// `s_L ← s_L + c (cos φ₁ - cos φ₀) + s (sin φ₁ - sin φ₀),  φ the wheel's angle since START`
pub struct WheelEccentricityLeft;

impl WheelLaw for WheelEccentricityLeft {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.left += wave(p, at, 0);
    }
}

/// c (cos φ₁ - cos φ₀) + s (sin φ₁ - sin φ₀) over a piece \[m\].
#[inline(always)]
pub(super) fn wave<T: Real>(p: &[T], at: &Here<T>, wheel: usize) -> T {
    let half = 0.5 * at.wheel_rotation[wheel];
    let (sine, cosine) = (at.wheel_angle[wheel] + half).sine_cosine();
    (p[1] * cosine - p[0] * sine) * (2.0 * half.sine_cosine().0)
}

/// A right wheel whose axle misses its centre.
///
/// `s_R ← s_R + c (cos φ₁ - cos φ₀) + s (sin φ₁ - sin φ₀),  φ the wheel's angle since START`
pub struct WheelEccentricityRight;

impl WheelLaw for WheelEccentricityRight {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.right += wave(p, at, 1);
    }
}

/// Wheel diameters that grow with the way driven: their ratio in the run and in the session, and their mean in the run.
///
/// `s_R ← (1 + d/2 + m) s_R,  s_L ← (1 - d/2 + m) s_L,  d = k w + k' · way in the session,  m = k" w,  w = (1 - exp(-r · way in the run))/r`
pub struct DiameterDrift;

impl WheelLaw for DiameterDrift {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let half = 0.5 * at.length;
        let way = settled(at.distance + half, p[3]);
        let d = p[0] * way + p[1] * (at.session_distance + half);
        let mean = p[2] * way + 1.0;
        travel.left *= mean - d * 0.5;
        travel.right *= mean + d * 0.5;
    }
}

/// (1 - exp(-r s))/r: a way s \[m\] that counts less and less, at a rate r \[1/m\]; s itself where r is 0.
#[inline(always)]
fn settled<T: Real>(way: f64, rate: T) -> T {
    let share = rate * way;
    if share.value().abs() < NEARLY_NOTHING {
        return (share * (share * (1.0 / 6.0) - 0.5) + 1.0) * way;
    }
    (-(-share).exponential() + 1.0) / rate
}

/// Below this, the series of [`settled`] is exact to 1e-13.
const NEARLY_NOTHING: f64 = 1e-4;

/// A difference of the wheel radii that grows with centripetal acceleration.
///
/// `s_R ← (1 - c v ω/2) s_R,  s_L ← (1 + c v ω/2) s_L,  v and ω by the speeds of the rims`
pub struct CentripetalLoad;

impl WheelLaw for CentripetalLoad {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        // What knows no speed knows no wheelbase either.
        if at.wheel_speed == [0.0; 2] {
            return;
        }
        let left = size(travel.left, at, 0) * at.wheel_speed[0];
        let right = size(travel.right, at, 1) * at.wheel_speed[1];
        let half = p[0] * (left + right) * (right - left) * (0.25 / at.wheelbase);
        travel.left *= half + 1.0;
        travel.right *= -half + 1.0;
    }
}

/// Travel that a wheel does not make when its motor reverses.
///
/// `s_w ← s_w ∓ w  where the wheel begins to roll forward (-) or backward (+) after the opposite`
pub struct Backlash;

impl WheelLaw for Backlash {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.left -= p[0] * at.reversed[0];
        travel.right -= p[0] * at.reversed[1];
    }
}
