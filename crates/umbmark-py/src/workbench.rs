//! The workbench in the browser, served beside the interpreter.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_web::{ServeError, Served, Workbench};

use crate::arguments::threads;
use crate::diagnose::options_of;
use crate::exception::refused;
use crate::work::detached;

/// A server that answers on a thread of its own until it is closed.
#[pyclass(frozen, module = "umbmark._umbmark")]
pub struct Server {
    address: String,
    stop: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<Result<(), ServeError>>>>,
}

#[pymethods]
impl Server {
    /// The address of its page.
    #[getter]
    fn address(&self) -> &str {
        &self.address
    }

    /// Whether it still answers.
    fn is_open(&self) -> bool {
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Ends it; a server that is closed stays closed.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.stop.store(true, Ordering::Relaxed);
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(thread) = thread else { return Ok(()) };
        match detached(py, || thread.join())? {
            Ok(ended) => ended.map_err(refused),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Opens the dataset at a place, and serves it.
#[pyfunction]
pub fn serve(
    py: Python<'_>,
    place: Option<PathBuf>,
    drops: PathBuf,
    port: u16,
    tests: (f64, usize, u64),
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<Server> {
    let options = options_of(tests, false)?;
    let served =
        Served { place, topics: umbmark_io::Topics::default(), drops, options, port, threads, actions: told::ACTIONS };
    let workbench = detached(py, || Workbench::open(served))?.map_err(refused)?;
    let (address, stop) = (workbench.address(), Arc::new(AtomicBool::new(false)));
    let told = Arc::clone(&stop);
    let thread = std::thread::spawn(move || workbench.serve(&told));
    Ok(Server { address, stop, thread: Mutex::new(Some(thread)) })
}
