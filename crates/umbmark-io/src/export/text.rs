//! Numbers as text that every reader takes for floats.

/// Smaller numbers are written with an exponent, with which they keep six digits.
const SMALL: f64 = 1e-3;

/// A float: always with a decimal point, to the billionth, and with a signed exponent where it is small, as YAML 1.1 wants it.
pub fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < SMALL {
        return format!("{value:.6e}");
    }
    let text = format!("{value:.9}");
    let text = text.trim_end_matches('0');
    if text.ends_with('.') { format!("{text}0") } else { text.to_owned() }
}

/// A list of them.
pub fn list(values: &[f64]) -> String {
    let numbers: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("[{}]", numbers.join(", "))
}

/// A length to the nanometre.
pub fn to_nanometre(length: f64) -> f64 {
    (length * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_keep_a_decimal_point_and_small_ones_their_digits() {
        assert_eq!(
            [0.0, 1.0, 0.25, 1.23456e-9, -3e-4, 2796.8, -3.0].map(number),
            ["0.0", "1.0", "0.25", "1.234560e-9", "-3.000000e-4", "2796.8", "-3.0"]
        );
        assert_eq!(list(&[0.5, 2e-6]), "[0.5, 2.000000e-6]");
    }
}
