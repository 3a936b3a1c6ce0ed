//! Several numbers at once: one algorithm for one segment and for eight.

use std::ops::{Add, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
pub(super) mod x86;

/// A pack of `f64`s on which the same operations are performed side by side; `f64` itself is a pack of one.
///
/// Every operation is that of IEEE 754 on each number by itself, so a number's result does not depend on the width of its
/// pack or on its neighbours. There is deliberately no fused multiply-add. A value can only be made from another value:
/// whoever holds one has already checked that the machine has the instructions for it.
pub(super) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// One truth value per number.
    type Mask: Copy;

    /// `value` in every place.
    fn splat(self, value: f64) -> Self;
    fn floor(self) -> Self;
    fn abs(self) -> Self;
    /// The larger of two numbers neither of which is NaN.
    fn max(self, other: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn equal(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true and `no` where it is false.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn any(mask: Self::Mask) -> bool;
}

impl Lane for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn floor(self) -> f64 {
        f64::floor(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        if self < other { other } else { self }
    }
    #[inline(always)]
    fn less(self, other: f64) -> bool {
        self < other
    }
    #[inline(always)]
    fn equal(self, other: f64) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn either(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}
