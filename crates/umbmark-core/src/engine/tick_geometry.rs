//! What one tick means.

use super::EngineError;
use crate::drive::Wheel;

/// The geometry that odometry assumes: the distance that a wheel rolls per tick, and the distance of the wheels.
///
/// Nominal or calibrated: the two tick lengths may differ. The same three numbers that a calibration corrects
/// (Borenstein & Feng 1996, equations 1 and 2, with the encoder resolution and gear ratio folded in).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickGeometry {
    left: f64,
    right: f64,
    wheelbase: f64,
}

impl TickGeometry {
    /// Metres per tick of the left and the right wheel, and the distance between their contact points \[m\].
    ///
    /// # Errors
    /// [`EngineError::TickLength`] or [`EngineError::Wheelbase`] unless all are positive and finite.
    pub fn new(left: f64, right: f64, wheelbase: f64) -> Result<TickGeometry, EngineError> {
        for (wheel, value) in Wheel::BOTH.into_iter().zip([left, right]) {
            if !(value.is_finite() && value > 0.0) {
                return Err(EngineError::TickLength { wheel, value });
            }
        }
        if !(wheelbase.is_finite() && wheelbase > 0.0 && ((left + right) / wheelbase).is_finite()) {
            return Err(EngineError::Wheelbase { value: wheelbase });
        }
        Ok(TickGeometry { left, right, wheelbase })
    }

    /// Metres per tick of the left wheel.
    #[inline]
    pub fn left(&self) -> f64 {
        self.left
    }

    /// Metres per tick of the right wheel.
    #[inline]
    pub fn right(&self) -> f64 {
        self.right
    }

    /// Distance between the contact points of the wheels \[m\].
    #[inline]
    pub fn wheelbase(&self) -> f64 {
        self.wheelbase
    }

    /// The distance \[m\] the midpoint of the axle moves for these changes of the counters (left, right):
    /// (n_R δ_R + n_L δ_L) / 2.
    #[inline]
    pub fn distance(&self, counts: [i64; 2]) -> f64 {
        0.5 * (counts[1] as f64 * self.right + counts[0] as f64 * self.left)
    }

    /// The heading \[rad\] after these changes of the counters (left, right): (n_R δ_R - n_L δ_L) / b.
    ///
    /// It does not depend on the order of the ticks, so it is exact to its own rounding however long the way.
    #[inline]
    pub fn heading(&self, counts: [i64; 2]) -> f64 {
        (counts[1] as f64 * self.right - counts[0] as f64 * self.left) / self.wheelbase
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_are_not_lengths_are_refused() {
        for bad in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                TickGeometry::new(bad, 1e-3, 0.3),
                Err(EngineError::TickLength { wheel: Wheel::Left, .. })
            ));
            assert!(matches!(
                TickGeometry::new(1e-3, bad, 0.3),
                Err(EngineError::TickLength { wheel: Wheel::Right, .. })
            ));
            assert!(matches!(TickGeometry::new(1e-3, 1e-3, bad), Err(EngineError::Wheelbase { .. })));
        }
        assert!(matches!(TickGeometry::new(1e10, 1e10, 1e-300), Err(EngineError::Wheelbase { .. })));
    }

    #[test]
    fn equal_counts_of_equal_wheels_leave_the_heading_at_zero() {
        let geometry = TickGeometry::new(2.356e-4, 2.356e-4, 0.34).unwrap();
        assert_eq!(geometry.heading([16_977, 16_977]), 0.0);
        assert!(geometry.heading([0, 1]) > 0.0);
        assert_eq!(geometry.distance([3, -3]), 0.0);
    }
}
