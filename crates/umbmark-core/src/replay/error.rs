//! Why a log cannot be replayed.

use crate::dataset::TickLog;

/// Why a log cannot be replayed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// Columns of different lengths.
    #[error("time, left and right must have one value a sample, got {time}, {left} and {right}")]
    Lengths {
        /// Number of times.
        time: usize,
        /// Number of left counts.
        left: usize,
        /// Number of right counts.
        right: usize,
    },
    /// The counts of a wheel with rollers, of another length.
    #[error("wheel {wheel} must have one count a sample, got {counts} for {samples} samples")]
    Wheel {
        /// The wheel, from 1.
        wheel: usize,
        /// Number of its counts.
        counts: usize,
        /// Number of samples in the log.
        samples: usize,
    },
    /// An invalid count of a wheel with rollers.
    #[error("ticks of wheel {wheel} at sample {sample} must be finite, got {count}")]
    Roller {
        /// The wheel, from 1.
        wheel: usize,
        /// The sample, from 0.
        sample: usize,
        /// \[ticks\]
        count: f64,
    },
    /// An invalid count.
    #[error("ticks of sample {sample} must be finite, got left {left}, right {right}")]
    NotFinite {
        /// The sample, from 0.
        sample: usize,
        /// \[ticks\]
        left: f64,
        /// \[ticks\]
        right: f64,
    },
    /// Reference poses out of order or beyond the log.
    #[error("reference pose {index} belongs to sample {sample}; samples must not decrease and stay below {samples}")]
    Sample {
        /// The reference pose, from 0.
        index: usize,
        /// Its sample.
        sample: usize,
        /// Number of samples in the log.
        samples: usize,
    },
}

/// Refuses a log that cannot be replayed.
pub(super) fn check(log: &TickLog) -> Result<(), ReplayError> {
    let (time, left, right) = (log.time.len(), log.left.len(), log.right.len());
    if time != left || left != right {
        return Err(ReplayError::Lengths { time, left, right });
    }
    for (wheel, counts) in (1..).zip(&log.rollers) {
        if counts.len() != time {
            return Err(ReplayError::Wheel { wheel, counts: counts.len(), samples: time });
        }
        if let Some(sample) = counts.iter().position(|count| !count.is_finite()) {
            return Err(ReplayError::Roller { wheel, sample, count: counts[sample] });
        }
    }
    let ticks = log.left.iter().zip(&log.right).enumerate();
    if let Some((sample, (left, right))) = ticks.into_iter().find(|(_, (l, r))| !(l.is_finite() && r.is_finite())) {
        return Err(ReplayError::NotFinite { sample, left: *left, right: *right });
    }
    let mut before = 0;
    for (index, reference) in log.reference.iter().enumerate() {
        if reference.sample < before || reference.sample >= left {
            return Err(ReplayError::Sample { index, sample: reference.sample, samples: left });
        }
        before = reference.sample;
    }
    Ok(())
}
