//! Numbers in sentences.

/// A size without its sign, to three digits.
pub(super) fn size(value: f64) -> String {
    let value = value.abs();
    let digits = if value > 0.0 { 2.0 - libm::floor(libm::log10(value)) } else { 0.0 };
    format!("{value:.*}", digits.clamp(0.0, 9.0) as usize)
}

/// A length in mm.
pub(super) fn mm(metres: f64) -> String {
    format!("{} mm", size(1e3 * metres))
}

/// An angle \[rad\] in whole degrees; zero has no sign.
pub(super) fn whole_degrees(radians: f64) -> f64 {
    libm::round(radians.to_degrees()) + 0.0
}

/// An angle in degrees.
pub(super) fn deg(radians: f64) -> String {
    format!("{} deg", size(radians.to_degrees()))
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", size(100.0 * share))
}

/// The word for the sign of a value.
pub(super) fn either(value: f64, positive: &'static str, negative: &'static str) -> &'static str {
    if value < 0.0 { negative } else { positive }
}

/// To the left (counter-clockwise) or to the right.
pub(super) fn side(value: f64) -> &'static str {
    either(value, "left", "right")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_three_digits_and_no_sign() {
        let said = [0.0, -12.3456, 0.00123456, 1234.56, 99.96].map(size);
        assert_eq!(said, ["0", "12.3", "0.00123", "1235", "99.96"].map(|s| if s == "99.96" { "100.0" } else { s }));
        assert_eq!((mm(-9e-4), deg(0.1), percent(0.0123)), ("0.900 mm".into(), "5.73 deg".into(), "1.23 %".into()));
        assert_eq!([-0.001, 0.001, -1.57].map(|angle| whole_degrees(angle).to_string()), ["0", "0", "-90"]);
        assert_eq!((side(1.0), side(-1e-9)), ("left", "right"));
    }
}
