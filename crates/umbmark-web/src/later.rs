//! A result that a thread of its own works out while others go on without it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use crate::bench::Trouble;

/// Nothing yet, then a result or why there is none.
#[derive(Debug)]
pub struct Later<T> {
    found: Mutex<Option<Result<Arc<T>, Trouble>>>,
    done: Condvar,
}

impl<T> Default for Later<T> {
    fn default() -> Self {
        Later { found: Mutex::new(None), done: Condvar::new() }
    }
}

impl<T> Later<T> {
    /// Works it out on this thread.
    pub fn make(&self, work: impl FnOnce() -> Result<T, Trouble>) {
        let failed = || Trouble("The runs could not be made ready for fits.".into());
        let made = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err(failed())).map(Arc::new);
        *self.found.lock().unwrap_or_else(PoisonError::into_inner) = Some(made);
        self.done.notify_all();
    }

    /// What is found until now; never waits.
    pub fn found(&self) -> Option<Result<Arc<T>, Trouble>> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits until it is found, or for as long.
    pub fn wait(&self, most: Option<Duration>) {
        let found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        match most {
            Some(most) => drop(self.done.wait_timeout_while(found, most, |found| found.is_none())),
            None => drop(self.done.wait_while(found, |found| found.is_none())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn others_go_on_without_it_until_they_wait() {
        let later = &Later::default();
        let (go, gate) = channel();
        std::thread::scope(|scope| {
            scope.spawn(move || later.make(move || gate.recv().map_err(Trouble::because)));
            later.wait(Some(Duration::from_millis(1)));
            assert_eq!(later.found(), None);
            go.send(7).unwrap();
            later.wait(None);
            assert_eq!(later.found(), Some(Ok(Arc::new(7))));
        });
    }

    #[test]
    fn who_waits_hears_of_work_that_panics() {
        let later = Later::<u32>::default();
        std::thread::scope(|scope| {
            scope.spawn(|| later.make(|| panic!("seen by the test")));
            later.wait(None);
        });
        assert!(later.found().unwrap().unwrap_err().to_string().contains("could not be made ready"));
    }
}
