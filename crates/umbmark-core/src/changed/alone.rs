//! Whether one length alone accounts for a change of the ratios that return poses show.
//!
//! With r = d_R/d_L and q = b/d of the mean wheel diameter d, a change by a small share δ of one length moves (ln r, ln q) by δ u:
//!
//! ```text
//! right wheel u = (1, -1/2)    left wheel u = (-1, -1/2)    wheelbase u = (0, 1)
//! δ = uᵀV⁻¹y / uᵀV⁻¹u,   F = (y - δu)ᵀV⁻¹(y - δu)
//! ```
//!
//! for the measured change y with covariance V; F has 1 and ν degrees of freedom where it is that length.

use super::quantities::{own, ratio};
use crate::evidence::Fit;
use crate::stats::f_upper_tail;
use nalgebra::{Matrix2, Vector2};

/// A length that accounts for a change by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alone {
    /// Its key in robot.toml.
    pub key: &'static str,
    /// What it is, in words.
    pub meaning: &'static str,
    /// Change of it as a share of itself.
    pub share: f64,
    /// Standard error of that.
    pub standard_error: f64,
    /// p of what it leaves of the change.
    pub p: f64,
}

const LENGTHS: [(&str, &str, [f64; 2]); 3] = [
    ("wheel_diameter_right_m", "wheel diameter right", [1.0, -0.5]),
    ("wheel_diameter_left_m", "wheel diameter left", [-1.0, -0.5]),
    ("wheelbase_m", "wheelbase", [0.0, 1.0]),
];

/// The lengths that account for the change at this size of the test; none where the fits do not show both ratios, or show the scale too.
pub(super) fn of(fits: &[Fit; 2], size: f64) -> Vec<Alone> {
    let drive = &fits[0].model.robot().drive;
    let (mut change, mut covariance, mut freedom) = (Vector2::zeros(), Matrix2::zeros(), 0.0);
    for (sign, fit) in [-1.0, 1.0].into_iter().zip(fits) {
        let shown = own(fit);
        let is_ratios = shown.shown.iter().map(|(which, _)| *which).eq([0, 1]);
        if !drive.kind().has_axle_wheels() || !is_ratios {
            return Vec::new();
        }
        let values = [0, 1].map(|which| ratio(fit, which).map(|ratio| ratio.value));
        let [Some(r), Some(q)] = values else { return Vec::new() };
        change += sign * Vector2::new(libm::log(r), libm::log(q));
        let [e_d, e_b] = [0, 1].map(|which| {
            let effect = drive.first_effects()[which];
            fit.estimates.iter().find(|own| own.effect == effect).map_or(1.0, |own| own.value)
        });
        let scale = Matrix2::from_diagonal(&Vector2::new(1.0 / e_d, 1.0 / e_b));
        covariance += scale * Matrix2::from_fn(|i, j| shown.covariance[(i, j)]) * scale;
        freedom += shown.freedom().unwrap_or(0.0);
    }
    let Some(inverse) = covariance.try_inverse() else { return Vec::new() };
    let alone = |(key, meaning, [a, b]): (&'static str, &'static str, [f64; 2])| {
        let u = Vector2::new(a, b);
        let information = (inverse * u).dot(&u);
        let share = (inverse * u).dot(&change) / information;
        let left = change - share * u;
        let p = f_upper_tail((inverse * left).dot(&left), [1.0, freedom.max(1.0)]);
        Alone { key, meaning, share, standard_error: information.recip().sqrt(), p }
    };
    LENGTHS.into_iter().map(alone).filter(|alone| alone.p >= size).collect()
}
