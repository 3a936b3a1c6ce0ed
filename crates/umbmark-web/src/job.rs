//! Long work in a thread of its own: one at a time, watched and stopped.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use umbmark_core::watch::{Reached, Watch};

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
    steps: Vec<Reached>,
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
        let step = |step: &Reached| {
            json!({
                "added": step.added, "p_adjusted": step.p_adjusted, "rmse_m": step.rmse, "heldout_rmse_m": step.heldout_rmse,
            })
        };
        json!({
            "steps": job.steps.iter().map(step).collect::<Vec<_>>(),
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
            let number = job.number + 1;
            *job = Job { number, kind, running: true, stop: Arc::clone(&stop), ..Job::default() };
            job.number
        };
        let jobs = Arc::clone(self);
        let run = move || {
            let progress = |share: f64| jobs.now().share = share;
            let reached = |step: &Reached| {
                let steps = &mut jobs.now().steps;
                steps.truncate(step.after);
                steps.push(*step);
            };
            let watch = Watch { reached: Some(&reached), ..Watch::new(&stop, &progress) };
            let done = catch_unwind(AssertUnwindSafe(|| work(&watch)));
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
    fn steps_are_told_as_they_are_reached_and_those_taken_back_are_gone() {
        let jobs = Arc::new(Jobs::default());
        let reach = |after, added| Reached { after, added, p_adjusted: None, rmse: 2.0, heldout_rmse: 3.0 };
        jobs.begin("learn", move |watch| {
            for (after, added) in [(0, None), (1, Some("crab")), (2, Some("scale")), (1, Some("wheelbase"))] {
                watch.reach(|| reach(after, added));
            }
            Ok(())
        })
        .unwrap();
        let told = wait(&jobs);
        let added: Vec<&Value> = told["steps"].as_array().unwrap().iter().map(|step| &step["added"]).collect();
        assert_eq!(added, [&Value::Null, &json!("wheelbase")]);
        assert_eq!(told["steps"][0]["heldout_rmse_m"], 3.0);
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
