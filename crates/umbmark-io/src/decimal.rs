//! The most usual kind of number in a text.

/// A number of at most 15 digits with or without a point: both its digits and the power of ten are exact numbers, so one
/// division rounds as it must (Clinger 1990).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decimal {
    /// The number; NaN where the bytes are no such number.
    pub value: f64,
    /// How many bytes were looked at: up to the first that cannot be part of one.
    pub length: usize,
}

const DIGITS: usize = 15;
const POWERS: [f64; DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

impl Decimal {
    /// Reads the number that some bytes begin with.
    #[inline]
    pub fn at_start_of(bytes: &[u8]) -> Decimal {
        let negative = bytes.first() == Some(&b'-');
        let begins = usize::from(negative);
        let (mut value, mut length) = digits(0, bytes, begins);
        let (mut count, mut decimals) = (length - begins, 0);
        if bytes.get(length) == Some(&b'.') {
            let point = length + 1;
            (value, length) = digits(value, bytes, point);
            decimals = length - point;
            count += decimals;
        }
        if !(1..=DIGITS).contains(&count) {
            return Decimal { value: f64::NAN, length };
        }
        let magnitude = value as f64 / POWERS[decimals];
        Decimal { value: if negative { -magnitude } else { magnitude }, length }
    }
}

/// Takes digits from place `at` on behind those of `value`, and where they end. Too many of them leave no number.
#[inline(always)]
fn digits(mut value: u64, bytes: &[u8], mut at: usize) -> (u64, usize) {
    while let Some(digit) = bytes.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (value, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::random::Stream;

    /// The number that a whole text is, if it is one of this kind.
    fn decimal(text: &str) -> Option<f64> {
        let Decimal { value, length } = Decimal::at_start_of(text.as_bytes());
        (length == text.len() && !value.is_nan()).then_some(value)
    }

    #[test]
    fn the_usual_numbers_are_read_to_the_same_bit_as_by_the_standard_library() {
        let mut stream = Stream::new(3, 1, 0);
        let mut read = 0;
        for _ in 0..200_000 {
            let (digits, decimals) = ((stream.uniform() * 18.0) as usize, (stream.uniform() * 18.0) as usize);
            let value = (stream.uniform() - 0.5) * 10f64.powi(digits as i32);
            let text = format!("{value:.decimals$}");
            let Some(fast) = decimal(&text) else { continue };
            assert_eq!(fast.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
            read += 1;
        }
        assert!(read > 50_000, "{read}");
        for text in ["0", "-0", "-0.0", "1.", ".5", "-.5", "007", "999999999999999", "0.00000000000001"] {
            assert_eq!(decimal(text).unwrap().to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
        }
        for text in ["", "-", ".", "-.", "1e3", "+1", "1.2.3", "--1", "nan", "1_0", "9999999999999999", "\u{661}"] {
            assert_eq!(decimal(text), None, "{text:?}");
        }
    }
}
