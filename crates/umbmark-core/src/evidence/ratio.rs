//! What is known beforehand of E_d, E_b and E_s, the ratios of a robot's true to its nominal lengths.

/// Start values of E_b that are tried if the fit from the nominal robot ends far from it.
pub(crate) const STARTS: [f64; 8] = [0.4, 0.5, 0.65, 0.8, 1.25, 1.6, 2.0, 2.5];
/// E_d or E_b counts as far from nominal if it differs from 1 by more than this.
pub(crate) const FAR_FIT: f64 = 0.04;

/// Whether a ratio is physically possible, by the bounds of the effects.
pub(crate) fn is_possible(ratio: f64) -> bool {
    (0.2..=5.0).contains(&ratio)
}
