//! Long work in a thread of its own: one at a time, watched and stopped.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use umbmark_core::watch::Watch;

use crate::bench::Trouble;

/// The work that goes on, or the last one.
#[derive(Debug, Default)]
pub struct Jobs {
    now: Mutex<Job>,
}

#[derive(Debug, Default)]
struct Job {
    number: u64,
    kind: &'static str,
    running: bool,
    share: f64,
    stop: Arc<AtomicBool>,
    error: Option<String>,
}

impl Jobs {
    fn now(&self) -> MutexGuard<'_, Job> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is told of it.
    pub fn told(&self) -> Value {
        let job = self.now();
        let stopped = job.stop.load(Ordering::Relaxed);
        json!({
            "number": job.number, "kind": job.kind, "running": job.running, "share": job.share, "stopped": stopped, "error": job.error,
        })
    }

    /// Stops the work after its current step.
    pub fn stop(&self) {
        self.now().stop.store(true, Ordering::Relaxed);
    }

    /// Whether some work goes on.
    pub fn busy(&self) -> Result<(), Trouble> {
        let job = self.now();
        if job.running { Err(Trouble(format!("Wait until {} is done, or cancel it.", job.kind))) } else { Ok(()) }
    }

    /// Begins some work.
    pub fn begin(
        self: &Arc<Jobs>,
        kind: &'static str,
        work: impl FnOnce(&Watch) -> Result<(), Trouble> + Send + 'static,
    ) -> Result<u64, Trouble> {
        let stop = Arc::new(AtomicBool::new(false));
        let number = {
            let mut job = self.now();
            if job.running {
                return Err(Trouble(format!("Wait until {} is done, or cancel it.", job.kind)));
            }
            *job =
                Job { number: job.number + 1, kind, running: true, share: 0.0, stop: Arc::clone(&stop), error: None };
            job.number
        };
        let jobs = Arc::clone(self);
        let run = move || {
            let progress = |share: f64| jobs.now().share = share;
            let done = catch_unwind(AssertUnwindSafe(|| work(&Watch { stop: &stop, progress: &progress })));
            let error = match done {
                Ok(Ok(())) => None,
                Ok(Err(trouble)) => Some(trouble.to_string()),
                Err(_) => Some(format!("{kind} failed; the work before it is kept.")),
            };
            let mut job = jobs.now();
            (job.running, job.error) = (false, error);
        };
        let failed = |error: std::io::Error| {
            self.now().running = false;
            Trouble(format!("The system gives no thread: {error}."))
        };
        std::thread::Builder::new().name(kind.to_owned()).spawn(run).map_err(failed)?;
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wait(jobs: &Arc<Jobs>) -> Value {
        while jobs.busy().is_err() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        jobs.told()
    }

    #[test]
    fn one_job_runs_at_a_time_and_is_stopped_by_its_watch() {
        let jobs = Arc::new(Jobs::default());
        let until_stopped = |watch: &Watch| {
            (watch.progress)(0.25);
            while !watch.is_stopped() {
                std::thread::yield_now();
            }
            Ok(())
        };
        jobs.begin("learn", until_stopped).unwrap();
        assert!(jobs.begin("fit", |_| Ok(())).unwrap_err().to_string().contains("Wait until learn is done"));
        jobs.stop();
        let told = wait(&jobs);
        assert_eq!((&told["stopped"], &told["error"], &told["share"]), (&json!(true), &Value::Null, &json!(0.25)));
    }

    #[test]
    fn work_that_fails_or_panics_says_so_and_the_next_one_runs() {
        let jobs = Arc::new(Jobs::default());
        jobs.begin("fit", |_| Err(Trouble("no".into()))).unwrap();
        assert_eq!(wait(&jobs)["error"], "no");
        jobs.begin("fit", |_| panic!("seen by the test")).unwrap();
        assert_eq!(wait(&jobs)["error"], "fit failed; the work before it is kept.");
        assert_eq!(jobs.begin("fit", |_| Ok(())).unwrap(), 3);
        assert_eq!(wait(&jobs)["error"], Value::Null);
    }
}
