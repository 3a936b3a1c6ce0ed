//! Numbers: one, or eight side by side.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub, SubAssign};

/// How many numbers an [`Eight`] holds.
pub(crate) const EIGHT: usize = 8;

/// What is computed with: `f64` for one case, [`Eight`] for so many at once.
pub trait Scalar:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// √x; `None` where that is no number, unless others beside it may be.
    fn root(self) -> Option<Self>;

    /// Whether every number is in a range.
    fn lies_in(self, range: std::ops::Range<f64>) -> bool;

    /// log x by `libm`.
    fn logarithm(self) -> Self;
}

impl Scalar for f64 {
    #[inline(always)]
    fn root(self) -> Option<f64> {
        (self > 0.0).then(|| self.sqrt())
    }

    #[inline(always)]
    fn lies_in(self, range: std::ops::Range<f64>) -> bool {
        range.contains(&self)
    }

    #[inline(always)]
    fn logarithm(self) -> f64 {
        libm::log(self)
    }
}

/// Eight independent `f64` lanes; a NaN in one does not affect the others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Eight(pub [f64; EIGHT]);

impl From<f64> for Eight {
    #[inline(always)]
    fn from(value: f64) -> Eight {
        Eight([value; EIGHT])
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident $assign:ident $assigned:ident $sign:tt),*) => {$(
        impl $operator for Eight {
            type Output = Eight;

            #[inline(always)]
            fn $method(mut self, other: Eight) -> Eight {
                self $sign other;
                self
            }
        }

        impl $assign for Eight {
            #[inline(always)]
            fn $assigned(&mut self, other: Eight) {
                for lane in 0..EIGHT {
                    self.0[lane] $sign other.0[lane];
                }
            }
        }
    )*};
}

arithmetic!(
    Add add AddAssign add_assign +=,
    Sub sub SubAssign sub_assign -=,
    Mul mul MulAssign mul_assign *=,
    Div div DivAssign div_assign /=
);

impl Eight {
    /// The greater of each number and a bound.
    #[inline(always)]
    pub fn at_least(mut self, bound: f64) -> Eight {
        for value in &mut self.0 {
            *value = if *value > bound { *value } else { bound };
        }
        self
    }

    /// √x; NaN where x is not positive.
    #[inline(always)]
    pub fn positive_root(mut self) -> Eight {
        for value in &mut self.0 {
            *value = if *value > 0.0 { value.sqrt() } else { f64::NAN };
        }
        self
    }
}

impl Scalar for Eight {
    #[inline(always)]
    fn root(mut self) -> Option<Eight> {
        for value in &mut self.0 {
            *value = value.sqrt();
        }
        Some(self)
    }

    #[inline(always)]
    fn lies_in(self, range: std::ops::Range<f64>) -> bool {
        let mut inside = true;
        for value in self.0 {
            inside &= range.start <= value && value < range.end;
        }
        inside
    }

    #[inline(always)]
    fn logarithm(self) -> Eight {
        Eight(self.0.map(libm::log))
    }
}
