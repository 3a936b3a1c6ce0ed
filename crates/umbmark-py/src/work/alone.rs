//! Work on one thread, which waits for more of it afterwards: to begin a thread takes longer than to score a robot.

use std::process;
use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

/// So many threads wait at most.
const WAITING: usize = 64;

/// Work that does not panic; it is told if the thread cannot be set up.
pub type Work = Box<dyn FnOnce(Result<(), ThreadPoolBuildError>) + Send>;

/// A thread that waits.
struct Waiting {
    /// Its process: a forked one has its memory and not the thread.
    process: u32,
    work: Sender<Work>,
}

static ALL: Mutex<Vec<Waiting>> = Mutex::new(Vec::new());

/// Begins work on a thread that waits, or on a new one; its parallel parts run one after the other.
pub fn run(mut work: Work) {
    // In a forked process the lock may be held by a thread that is not there.
    let waiting = ALL.try_lock().ok().and_then(|mut all| {
        all.retain(|waiting| waiting.process == process::id());
        all.pop()
    });
    if let Some(waiting) = waiting {
        match waiting.work.send(work) {
            Ok(()) => return,
            Err(unsent) => work = unsent.0,
        }
    }
    std::thread::spawn(move || serve(work));
}

/// Does work after work.
fn serve(mut work: Work) {
    let pool = match ThreadPoolBuilder::new().num_threads(1).use_current_thread().build() {
        Ok(pool) => pool,
        Err(error) => return work(Err(error)),
    };
    loop {
        pool.install(|| work(Ok(())));
        let (sender, receiver) = channel();
        let Ok(mut all) = ALL.lock() else { return };
        if all.len() >= WAITING {
            return;
        }
        all.push(Waiting { process: process::id(), work: sender });
        drop(all);
        let Ok(next) = receiver.recv() else { return };
        work = next;
    }
}
