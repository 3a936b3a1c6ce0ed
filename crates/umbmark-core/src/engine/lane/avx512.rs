//! Eight numbers in an AVX-512 register. All `unsafe` of this instruction set is here.

use super::Lane;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Eight numbers; whoever holds one runs on a machine with AVX-512F.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Eight(__m512d);

impl Eight {
    /// # Safety
    /// The machine must have AVX-512F.
    #[inline(always)]
    pub unsafe fn load(values: &[f64; 8]) -> Eight {
        // SAFETY: eight readable numbers; the caller guarantees the instructions.
        Eight(unsafe { _mm512_loadu_pd(values.as_ptr()) })
    }

    #[inline(always)]
    pub fn store(self, values: &mut [f64; 8]) {
        // SAFETY: eight writable numbers; `self` exists only where the instructions do.
        unsafe { _mm512_storeu_pd(values.as_mut_ptr(), self.0) }
    }
}

macro_rules! arithmetic {
    ($($operator:ident $function:ident $intrinsic:ident;)*) => {$(
        impl $operator for Eight {
            type Output = Eight;
            #[inline(always)]
            fn $function(self, other: Eight) -> Eight {
                // SAFETY: `self` exists only where the instructions do.
                Eight(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}

arithmetic! {
    Add add _mm512_add_pd;
    Sub sub _mm512_sub_pd;
    Mul mul _mm512_mul_pd;
    Div div _mm512_div_pd;
}

// SAFETY, for every block below: `self`, or whoever made the mask, exists only where the instructions do.
impl Lane for Eight {
    type Mask = __mmask8;

    #[inline(always)]
    fn splat(self, value: f64) -> Eight {
        Eight(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn floor(self) -> Eight {
        Eight(unsafe { _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Eight {
        Eight(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Eight) -> Eight {
        Eight(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Eight) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn equal(self, other: Eight) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, yes: Eight, no: Eight) -> Eight {
        Eight(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn either(a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    fn any(mask: __mmask8) -> bool {
        mask != 0
    }
}
