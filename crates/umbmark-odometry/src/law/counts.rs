//! Laws of the encoders.

use super::grip::turn_course;
use super::{BodyLaw, WheelLaw};
use crate::context::{Here, TIME_CONSTANTS};
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;

/// The share of what is counted that the wheels follow late, as a first-order lag.
///
/// `s_w ← s_w - κ Δℓ_w,  dℓ_w/dt = v_w - ℓ_w/τ,  only where the ticks were recorded`
pub struct WheelLag;

impl WheelLaw for WheelLag {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        if at.recorded {
            let weights = among_time_constants(p[1]);
            travel.left -= p[0] * weighted(&weights, &at.falls_behind[0]);
            travel.right -= p[0] * weighted(&weights, &at.falls_behind[1]);
        }
    }
}

/// Weights with which distances of the [`TIME_CONSTANTS`] give that of another: each as a share of its time constant, by the polynomial in
/// the logarithm. It is within 0.3 % of the lag from 0.035 to 0.3 s, and within 1 % elsewhere.
#[inline(always)]
fn among_time_constants<T: Real>(time: T) -> [T; TIME_CONSTANTS.len()] {
    let octaves = libm::log2(time.value() / TIME_CONSTANTS[0]);
    let place = time.mapped(octaves, core::f64::consts::LOG2_E / time.value());
    let mut weights = TIME_CONSTANTS.map(|own| time * (1.0 / own));
    for (k, weight) in weights.iter_mut().enumerate() {
        for other in (0..TIME_CONSTANTS.len()).filter(|other| *other != k) {
            *weight *= (place + -(other as f64)) * (1.0 / (k as f64 - other as f64));
        }
    }
    weights
}

/// Sum of numbers with weights.
#[inline(always)]
fn weighted<T: Real>(weights: &[T; TIME_CONSTANTS.len()], numbers: &[f64; TIME_CONSTANTS.len()]) -> T {
    let mut sum = T::from(0.0);
    for (weight, number) in weights.iter().zip(numbers) {
        sum += *weight * *number;
    }
    sum
}

/// The share of its counts that each wheel misses above a speed.
///
/// `s_w ← (1 + k_w max(0, |v_w| - v₀)) s_w`
pub struct MissedCounts;

impl WheelLaw for MissedCounts {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.left *= p[0] * above(at.wheel_speed[0], p[2]) + 1.0;
        travel.right *= p[1] * above(at.wheel_speed[1], p[2]) + 1.0;
    }
}

/// Excess of a wheel's speed over the threshold \[m/s\].
#[inline(always)]
fn above<T: Real>(speed: f64, threshold: T) -> T {
    let over = -threshold + speed.abs();
    if over.value() > 0.0 { over } else { T::from(0.0) }
}

/// How much later the right counter is read than the left.
///
/// `s_R ← s_R - τ Δv_R`
pub struct EncoderSkew;

impl WheelLaw for EncoderSkew {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.right -= p[0] * at.speed_change[1];
    }
}

/// Euler steps of the robot's own odometry, if its pose is not recomputed from its counts.
///
/// `(forward, sideways) ← R(ω T/2) (forward, sideways),  not where the ticks were recorded`
pub struct EncoderSampling;

impl BodyLaw for EncoderSampling {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if !at.recorded {
            turn_course(motion, p[0] * (0.5 * at.turn_rate));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::{Context, Nominal, Place, Progress};

    /// Oracle: the lag followed with its own time constant, piece by piece.
    #[test]
    fn a_lag_between_two_time_constants_is_within_three_thousandths_of_the_one_followed_exactly() {
        let edges = [0.02, 0.024, 0.028, 0.45, 0.55, 0.64].map(|time| (time, 0.01));
        for (time, share) in edges.into_iter().chain([0.036, 0.05, 0.11, 0.2148, 0.3].map(|time| (time, 0.003))) {
            let nominal = Nominal {
                wheelbase: 0.34,
                wheel_radius: [0.075; 2],
                metres_per_tick: WheelTravel { left: 1e-4, right: 1e-4 },
                axle_distance: 0.34,
                wheel_layout: [0.0; 2],
            };
            let mut progress = Progress::new(&nominal, &Place::default(), true);
            let (mut law, mut exact) = ([0.0; 2], [0.0; 2]);
            let mut most = 0.0_f64;
            for piece in 0..400 {
                // Two steps of the commanded speed, one of them back.
                let speed = if (20..180).contains(&piece) { [0.5, -0.2] } else { [0.0; 2] };
                let told = speed.map(|speed| 0.01 * speed);
                let believed = WheelTravel { left: told[0], right: told[1] };
                let at = progress.piece(&believed, 0.01, [0.0; 2], [0.0; 2]);
                let mut travel = believed;
                WheelLag::wheels(&[1.0, time], &at.as_believed(), &mut travel);
                law = [law[0] + told[0] - travel.left, law[1] + told[1] - travel.right];
                for wheel in 0..2 {
                    let gone = 1.0 - libm::exp(-0.01 / time);
                    exact[wheel] += gone * (speed[wheel] * time - exact[wheel]);
                    assert!((law[wheel] - exact[wheel]).abs() < share * 0.5 * time, "{time} {piece}");
                    most = most.max(exact[wheel].abs());
                }
            }
            assert!(most > 0.4 * time, "{most}");
        }
    }

    #[test]
    fn moves_that_are_only_planned_are_followed_to_their_end() {
        let at = Context { falls_behind: [[0.1; TIME_CONSTANTS.len()]; 2], ..Context::default() };
        let mut travel = WheelTravel { left: 0.3, right: 0.4 };
        WheelLag::wheels(&[1.0, 0.08], &at.as_believed(), &mut travel);
        assert_eq!((travel.left, travel.right), (0.3, 0.4));
        WheelLag::wheels(&[1.0, 0.08], &Context { recorded: true, ..at }.as_believed(), &mut travel);
        assert!((travel.left - 0.2).abs() < 1e-12 && (travel.right - 0.3).abs() < 1e-12);
    }
}
