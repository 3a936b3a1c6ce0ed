//! Long work without the interpreter lock: watched by Python, which may stop it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuildError;

mod alone;

/// Time between two looks at whether Ctrl-C was pressed, and two calls of a progress function.
const LOOK: Duration = Duration::from_millis(50);

/// Steps that a share is told in.
const STEPS: f64 = 1000.0;

/// What the work tells and is told while it runs.
#[derive(Clone, Default)]
pub struct Watch {
    /// Set when the work should stop.
    pub stop: Arc<AtomicBool>,
    /// Steps done.
    pub done: Arc<AtomicU64>,
}

/// Runs short `work` without the interpreter lock. A panic in it is a fault of this library and reaches Python as
/// `RuntimeError`.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|_| fault())
}

/// Runs long `work` on `threads` of its own (0: one for each processor), so that a forked process may call too.
///
/// Ctrl-C raises `KeyboardInterrupt` at once; work that looks at [`Watch::stop`] ends within milliseconds, other work runs to its end, and
/// its result is discarded. `progress` is called with the steps done.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    Watched::begin(threads, work).end(py, progress, Left::Alone)
}

/// The same for work that writes down what is done: it ends before `KeyboardInterrupt` is raised.
pub fn watched_to_its_end<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    Watched::begin(threads, work).end(py, progress, Left::Awaited)
}

/// What becomes of work that is given up.
#[derive(PartialEq)]
enum Left {
    Alone,
    Awaited,
}

/// Work on threads of its own, and where its result arrives.
struct Watched<T> {
    watch: Watch,
    receiver: Receiver<Result<std::thread::Result<T>, ThreadPoolBuildError>>,
}

impl<T: Send + 'static> Watched<T> {
    fn begin(threads: usize, work: impl FnOnce(&Watch) -> T + Send + 'static) -> Watched<T> {
        let watch = Watch::default();
        let (sender, receiver) = sync_channel(1);
        let told = watch.clone();
        let whole = move || catch_unwind(AssertUnwindSafe(|| work(&told)));
        // Nobody listens where Python has given up.
        if threads == 1 {
            alone::run(Box::new(move |begun| drop(sender.send(begun.map(|()| whole())))));
            return Watched { watch, receiver };
        }
        std::thread::spawn(move || {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            drop(sender.send(pool.map(|pool| pool.install(whole))));
        });
        Watched { watch, receiver }
    }

    fn end(mut self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, left: Left) -> PyResult<T> {
        loop {
            let receiver = &mut self.receiver;
            let result = match py.detach(move || receiver.recv_timeout(LOOK)) {
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(given_up) = self.watch.look(py, progress) {
                        if left == Left::Awaited {
                            let receiver = &mut self.receiver;
                            let _ = py.detach(move || receiver.recv());
                        }
                        return Err(given_up);
                    }
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => return Err(fault()),
                Ok(result) => result,
            };
            if let Some(progress) = progress {
                progress.call1((self.watch.done.load(Ordering::Relaxed),))?;
            }
            let result =
                result.map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads: {error}")))?;
            return result.map_err(|_| fault());
        }
    }
}

impl Watch {
    /// Does work of the core, which tells the share that is done in thousandths.
    pub fn work<T>(&self, work: impl FnOnce(&umbmark_core::watch::Watch) -> T) -> T {
        let progress = |share: f64| self.done.store((share * STEPS) as u64, Ordering::Relaxed);
        work(&umbmark_core::watch::Watch::new(&self.stop, &progress))
    }

    /// Tells Python how far the work is and hears whether it should stop.
    fn look(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let heard = py.check_signals().and_then(|()| match progress {
            Some(progress) => progress.call1((self.done.load(Ordering::Relaxed),)).map(|_| ()),
            None => Ok(()),
        });
        heard.inspect_err(|_| self.stop.store(true, Ordering::Relaxed))
    }
}

fn fault() -> PyErr {
    PyRuntimeError::new_err(format!("a fault in umbmark {}: please report it", umbmark_core::VERSION))
}
