//! Long work that can be watched, and stopped.

use std::sync::atomic::{AtomicBool, Ordering};

/// How long work goes on, and who is told.
pub struct Watch<'a> {
    /// Once set, no further piece of work is begun.
    pub stop: &'a AtomicBool,
    /// Told the share of the work that is done.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Watch<'_> {
    /// Work that nobody watches.
    pub fn nobody<R>(work: impl FnOnce(&Watch) -> R) -> R {
        work(&Watch { stop: &AtomicBool::new(false), progress: &|_| () })
    }

    /// Whether the work should end with what is done.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
