//! Long work that can be watched, and stopped.

use std::sync::atomic::{AtomicBool, Ordering};

/// How long work goes on, and who is told.
pub struct Watch<'a> {
    /// Once set, no further piece of work is begun.
    pub stop: &'a AtomicBool,
    /// Told the share of the work that is done.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// Told each step of work that has steps, as soon as it is reached.
    pub reached: Option<&'a (dyn Fn(&Reached) + Sync)>,
}

/// A step that learning has reached. A later one may take it back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// How many steps before it stand; those after them were taken back.
    pub after: usize,
    /// The effect that was added; `None` for the nominal robot.
    pub added: Option<&'static str>,
    /// p of its class, corrected for all classes that were tested; `None` for an effect that was fitted without a test.
    pub p_adjusted: Option<f64>,
    /// Root mean square error of positions \[m\] in the runs that the model was fitted to.
    pub rmse: f64,
    /// The same in held-out runs.
    pub heldout_rmse: f64,
}

impl<'a> Watch<'a> {
    /// Work whose steps nobody is told.
    pub fn new(stop: &'a AtomicBool, progress: &'a (dyn Fn(f64) + Sync)) -> Watch<'a> {
        Watch { stop, progress, reached: None }
    }

    /// Work that nobody watches.
    pub fn nobody<R>(work: impl FnOnce(&Watch) -> R) -> R {
        work(&Watch::new(&AtomicBool::new(false), &|_| ()))
    }

    /// Whether the work should end with what is done.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Tells a step, if anybody listens.
    pub fn reach(&self, step: impl FnOnce() -> Reached) {
        if let Some(told) = self.reached {
            told(&step());
        }
    }
}
