//! Several numbers in a register of x86-64. All `unsafe` of these instructions is here.

use super::Lane;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Numbers that lie in one register; whoever holds one runs on a machine that has it.
pub(in crate::engine) trait Register<const N: usize>: Lane {
    /// # Safety
    /// The machine must have the register's instructions.
    unsafe fn load(values: &[f64; N]) -> Self;
    fn store(self, values: &mut [f64; N]);
}

/// A register from its instructions.
macro_rules! register {
    (
        $(#[$about:meta])* $Register:ident($Raw:ty) of $N:literal, masked by $Mask:ty:
        $load:ident, $store:ident, $splat:ident, $max:ident;
        $($operator:ident $function:ident $intrinsic:ident,)*;
        floor |$floored:ident| $floor:expr;
        abs |$signed:ident| $abs:expr;
        less |$smaller:ident, $greater:ident| $less:expr;
        equal |$one:ident, $other:ident| $equal:expr;
        select |$mask:ident, $yes:ident, $no:ident| $select:expr;
        either |$a:ident, $b:ident| $either:expr;
        any |$some:ident| $any:expr;
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub(in crate::engine) struct $Register($Raw);

        $(impl $operator for $Register {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                // SAFETY: `self` exists only where the instructions do.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        })*

        impl Register<$N> for $Register {
            #[inline(always)]
            unsafe fn load(values: &[f64; $N]) -> Self {
                // SAFETY: so many readable numbers; the instructions are there by guaranteed by the caller.
                Self(unsafe { $load(values.as_ptr()) })
            }
            #[inline(always)]
            fn store(self, values: &mut [f64; $N]) {
                // SAFETY: so many writable numbers; `self` exists only where the instructions do.
                unsafe { $store(values.as_mut_ptr(), self.0) }
            }
        }

        // SAFETY, for every block below: `self`, or whoever made the mask, exists only where the instructions do.
        impl Lane for $Register {
            type Mask = $Mask;

            #[inline(always)]
            fn splat(self, value: f64) -> Self {
                Self(unsafe { $splat(value) })
            }
            #[inline(always)]
            fn floor(self) -> Self {
                let $floored = self.0;
                Self(unsafe { $floor })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                let $signed = self.0;
                Self(unsafe { $abs })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn less(self, other: Self) -> $Mask {
                let ($smaller, $greater) = (self.0, other.0);
                unsafe { $less }
            }
            #[inline(always)]
            fn equal(self, other: Self) -> $Mask {
                let ($one, $other) = (self.0, other.0);
                unsafe { $equal }
            }
            #[inline(always)]
            fn select($mask: $Mask, yes: Self, no: Self) -> Self {
                let ($yes, $no) = (yes.0, no.0);
                Self(unsafe { $select })
            }
            #[inline(always)]
            fn either($a: $Mask, $b: $Mask) -> $Mask {
                $either
            }
            #[inline(always)]
            fn any($some: $Mask) -> bool {
                $any
            }
        }
    };
}

register! {
    /// Four numbers of AVX2; all bits of a number or none are its mask.
    Avx2(__m256d) of 4, masked by __m256d:
    _mm256_loadu_pd, _mm256_storeu_pd, _mm256_set1_pd, _mm256_max_pd;
    Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd,;
    floor |x| _mm256_floor_pd(x);
    abs |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
    less |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
    equal |a, b| _mm256_cmp_pd::<_CMP_EQ_OQ>(a, b);
    select |mask, yes, no| _mm256_blendv_pd(no, yes, mask);
    either |a, b| unsafe { _mm256_or_pd(a, b) };
    any |mask| unsafe { _mm256_movemask_pd(mask) != 0 };
}

register! {
    /// Eight numbers of AVX-512F.
    Avx512(__m512d) of 8, masked by __mmask8:
    _mm512_loadu_pd, _mm512_storeu_pd, _mm512_set1_pd, _mm512_max_pd;
    Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd,;
    floor |x| _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(x);
    abs |x| _mm512_abs_pd(x);
    less |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b);
    equal |a, b| _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, b);
    select |mask, yes, no| _mm512_mask_blend_pd(mask, no, yes);
    either |a, b| a | b;
    any |mask| mask != 0;
}
