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
