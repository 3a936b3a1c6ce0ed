//! What the machine can do at once.

/// The widest registers that may be used. Results are the same bits on all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Instructions {
    /// What every machine has.
    Portable,
    /// Four numbers at once (x86-64).
    Avx2,
    /// Eight numbers at once (x86-64).
    Avx512,
}

impl Instructions {
    /// The best of this machine, found out at run time.
    pub fn best() -> Instructions {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
                return Instructions::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Instructions::Avx2;
            }
        }
        Instructions::Portable
    }
}

/// Returns from a function what an expression is worth, compiled for registers of the width that these [`Instructions`] say: the
/// same bits on all of them. What the expression calls is to be marked `#[inline(always)]`.
///
/// ```text
/// by_width!(Instructions::best(), |values: &[f64], columns: usize| -> DMatrix<f64> { gram_of(values, columns) })
/// ```
///
/// Before the arguments may stand the generic ones in brackets, as in `[T: Real] |..|`.
macro_rules! by_width {
    ($instructions:expr, $([$($generics:tt)*])? |$($name:ident: $Type:ty),+| -> $Result:ty { $work:expr }) => {{
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq")]
            fn eight$(<$($generics)*>)?($($name: $Type),+) -> $Result {
                $work
            }
            #[target_feature(enable = "avx2")]
            fn four$(<$($generics)*>)?($($name: $Type),+) -> $Result {
                $work
            }
            match $instructions {
                // SAFETY: instructions are never more than what the machine was found to have.
                $crate::geometry::Instructions::Avx512 => return unsafe { eight($($name),+) },
                // SAFETY: as above.
                $crate::geometry::Instructions::Avx2 => return unsafe { four($($name),+) },
                $crate::geometry::Instructions::Portable => {}
            }
        }
        let _ = $instructions;
        $work
    }};
}
pub(crate) use by_width;
