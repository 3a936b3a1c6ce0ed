//! References with twice the digits of `f64`, for tests.

use super::{Letter, TickGeometry, WheelLine, oracle};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number as the unevaluated sum of two `f64`s, about 106 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct DoubleDouble {
    pub high: f64,
    pub low: f64,
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        DoubleDouble { high, low: 0.0 }
    }
}

/// a + b and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let kept = high - a;
    DoubleDouble { high, low: (a - (high - kept)) + (b - kept) }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (head, tail) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let head = two_sum(head.high, head.low + tail.high);
        two_sum(head.high, head.low + tail.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high) + (self.high * other.low + self.low * other.high);
        two_sum(high, low)
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let mut rest = self;
        let mut quotient = DoubleDouble::from(0.0);
        for _ in 0..3 {
            let digit = DoubleDouble::from(rest.high / other.high);
            quotient = quotient + digit;
            rest = rest - digit * other;
        }
        quotient
    }
}

impl DoubleDouble {
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    fn halved(self) -> Self {
        DoubleDouble { high: 0.5 * self.high, low: 0.5 * self.low }
    }

    /// (sin, cos): the power series of a small part of the angle, doubled back.
    pub fn sine_cosine(self) -> (Self, Self) {
        let one = DoubleDouble::from(1.0);
        if self.high.abs() > 0.01 {
            let (s, c) = self.halved().sine_cosine();
            return ((s * c) + (s * c), one - (s * s + s * s));
        }
        let (mut sine, mut cosine, mut term) = (self, one, self);
        let mut even = one;
        for k in 1..10 {
            let k = 2.0 * f64::from(k);
            even = -(even * self * self) / DoubleDouble::from(k * (k - 1.0));
            term = -(term * self * self) / DoubleDouble::from(k * (k + 1.0));
            cosine = cosine + even;
            sine = sine + term;
        }
        (sine, cosine)
    }
}

/// A motion tick by tick in double-double: x, y, heading, cosine and sine of the heading.
pub(super) fn motion(geometry: &TickGeometry, line: &WheelLine) -> [DoubleDouble; 5] {
    let zero = DoubleDouble::from(0.0);
    let wheelbase = DoubleDouble::from(geometry.wheelbase());
    let roll = |counts: [i64; 2]| {
        let left = DoubleDouble::from(geometry.left()) * DoubleDouble::from(counts[0] as f64);
        let right = DoubleDouble::from(geometry.right()) * DoubleDouble::from(counts[1] as f64);
        ((left + right).halved(), (right - left) / wheelbase)
    };
    let sign = line.backward().map(|backward| if backward { -1 } else { 1 });
    let tick = |counts: [i64; 2]| {
        let (distance, rotation) = roll(counts);
        let half = rotation.halved();
        let (s, c) = half.sine_cosine();
        let chord = if half.high == 0.0 { distance } else { distance * (s / half) };
        let (sine, cosine) = rotation.sine_cosine();
        [chord * c, chord * s, cosine, sine]
    };
    let ticks = [tick([sign[0], 0]), tick([0, sign[1]]), tick(sign)];
    let (mut x, mut y, mut cosine, mut sine) = (zero, zero, DoubleDouble::from(1.0), zero);
    for letter in oracle::letters(line) {
        let [dx, dy, c, s] = match letter {
            Letter::Left => ticks[0],
            Letter::Right => ticks[1],
            Letter::Joint => ticks[2],
        };
        x = x + (cosine * dx - sine * dy);
        y = y + (sine * dx + cosine * dy);
        (cosine, sine) = (cosine * c - sine * s, sine * c + cosine * s);
    }
    [x, y, roll(line.counts()).1, cosine, sine]
}

#[test]
fn sine_and_cosine_have_twice_the_digits() {
    for x in [-3.0, -0.7, 1e-3, 0.5, 2.0, 40.0] {
        let (s, c) = DoubleDouble::from(x).sine_cosine();
        assert!((s.value() - libm::sin(x)).abs() < 2e-16 && (c.value() - libm::cos(x)).abs() < 2e-16);
        let excess = s * s + c * c - DoubleDouble::from(1.0);
        assert!(excess.high.abs() < 1e-28, "{x}: {excess:?}");
    }
}
