//! Four numbers in an AVX register. All `unsafe` of this instruction set is here.

use super::Lane;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Four numbers; whoever holds one runs on a machine with AVX2.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Four(__m256d);

impl Four {
    /// # Safety
    /// The machine must have AVX2.
    #[inline(always)]
    pub unsafe fn load(values: &[f64; 4]) -> Four {
        // SAFETY: four readable numbers; the caller guarantees the instructions.
        Four(unsafe { _mm256_loadu_pd(values.as_ptr()) })
    }

    #[inline(always)]
    pub fn store(self, values: &mut [f64; 4]) {
        // SAFETY: four writable numbers; `self` exists only where the instructions do.
        unsafe { _mm256_storeu_pd(values.as_mut_ptr(), self.0) }
    }
}

macro_rules! arithmetic {
    ($($operator:ident $function:ident $intrinsic:ident;)*) => {$(
        impl $operator for Four {
            type Output = Four;
            #[inline(always)]
            fn $function(self, other: Four) -> Four {
                // SAFETY: `self` exists only where the instructions do.
                Four(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}

arithmetic! {
    Add add _mm256_add_pd;
    Sub sub _mm256_sub_pd;
    Mul mul _mm256_mul_pd;
    Div div _mm256_div_pd;
}

// SAFETY, for every block below: `self`, or whoever made the mask, exists only where the instructions do.
impl Lane for Four {
    /// All bits of a number or none.
    type Mask = __m256d;

    #[inline(always)]
    fn splat(self, value: f64) -> Four {
        Four(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn floor(self) -> Four {
        Four(unsafe { _mm256_floor_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Four {
        Four(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn max(self, other: Four) -> Four {
        Four(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Four) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn equal(self, other: Four) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Four, no: Four) -> Four {
        Four(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn either(a: __m256d, b: __m256d) -> __m256d {
        unsafe { _mm256_or_pd(a, b) }
    }
    #[inline(always)]
    fn any(mask: __m256d) -> bool {
        unsafe { _mm256_movemask_pd(mask) != 0 }
    }
}
