//! Angles on the circle.

use core::f64::consts::{PI, TAU};

/// The representative of `angle` \[rad\] in the half-open interval (-π, π].
///
/// ```
/// use core::f64::consts::PI;
/// # use umbmark_odometry::geometry::wrap;
/// assert_eq!(wrap(-PI), PI);
/// assert!((wrap(2.0 * PI + 0.25) - 0.25).abs() < 1e-15);
/// ```
pub fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    // The nearest multiple of a turn is subtracted exactly by `remainder`, whatever the size of the angle.
    let folded = libm::remainder(angle, TAU);
    if folded <= -PI { folded + TAU } else { folded }
}

/// The mean of `angles` \[rad\] that lie within half a turn of each other; `None` for an empty set.
///
/// The arithmetic mean as seen from the first of them, so that the cut at ±π does no harm, and with its full turns.
///
/// ```
/// use core::f64::consts::PI;
/// # use umbmark_odometry::geometry::mean_angle;
/// assert!((mean_angle([PI - 0.1, -PI + 0.3]).unwrap() - (PI + 0.1)).abs() < 1e-12);
/// ```
#[inline]
pub fn mean_angle(angles: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut angles = angles.into_iter();
    let first = angles.next()?;
    let (sum, count) = angles.fold((0.0, 1.0), |(sum, count), angle| (sum + wrap(angle - first), count + 1.0));
    Some(first + sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrap_keeps_the_direction_and_lands_in_the_half_open_interval() {
        for k in -8..=8 {
            for a in [-PI, -3.0, -1.0, -1e-300, 0.0, 1e-9, 2.0, PI] {
                let wrapped = wrap(a + TAU * f64::from(k));
                assert!(wrapped > -PI && wrapped <= PI, "{wrapped}");
                assert!(((wrapped - a).sin()).abs() < 1e-13 && (wrapped - a).cos() > 0.0, "{a} {k} {wrapped}");
            }
        }
        assert_eq!(wrap(PI), PI);
        assert_eq!(wrap(-PI), PI);
    }

    #[test]
    fn the_mean_of_angles_astride_the_cut_is_at_the_cut_and_keeps_the_full_turns_of_the_first() {
        let mean = mean_angle([PI - 0.1, -PI + 0.1]).unwrap();
        assert!((mean - PI).abs() < 1e-12);
        assert!((mean_angle([TAU + 0.2, 0.4, -TAU + 0.6]).unwrap() - (TAU + 0.4)).abs() < 1e-12);
        assert_eq!(mean_angle([]), None);
        assert_eq!(mean_angle([0.25]), Some(0.25));
    }
}
