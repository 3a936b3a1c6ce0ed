//! Angles on the circle.

use std::f64::consts::{PI, TAU};

/// The representative of `angle` \[rad\] in the half-open interval (-π, π].
///
/// ```
/// use std::f64::consts::PI;
/// # use umbmark_core::geometry::wrap;
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

/// The direction of the mean resultant vector of `angles` \[rad\], in (-π, π].
///
/// `None` for no angles, or where they cancel (resultant shorter than 1e-12 of their number) and no mean direction
/// exists. Source: Mardia & Jupp, *Directional Statistics* (2000), section 2.2.
pub fn circular_mean(angles: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sine, mut cosine, mut count) = (0.0, 0.0, 0usize);
    for angle in angles {
        let (s, c) = libm::sincos(angle);
        sine += s;
        cosine += c;
        count += 1;
    }
    (libm::hypot(sine, cosine) > 1e-12 * count as f64).then(|| wrap(libm::atan2(sine, cosine)))
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
    fn the_mean_of_angles_astride_the_cut_is_at_the_cut_and_opposite_angles_have_none() {
        let mean = circular_mean([PI - 0.1, -PI + 0.1]).unwrap();
        assert!((mean.abs() - PI).abs() < 1e-12);
        assert_eq!(circular_mean([0.0, PI]), None);
        assert_eq!(circular_mean([]), None);
        assert!((circular_mean([0.2, 0.4]).unwrap() - 0.3).abs() < 1e-15);
    }
}
