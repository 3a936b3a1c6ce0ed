//! What all verbs share: options, the way out, progress, and the wish to stop.

use std::io::{self, BufWriter, IsTerminal, Stdout, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use anyhow::Context;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use umbmark_core::watch::Watch;
use umbmark_plot::render::terminal::Look;

use crate::budget::Budget;
use crate::files;

/// Exit code of work that was stopped: what was done until then is told, marked partial.
pub const INTERRUPTED: u8 = 130;

/// Steps of the bar of work that tells a share.
const STEPS: f64 = 100.0;

/// The options of every verb.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Common")]
pub struct Options {
    /// Print one JSON document on stdout, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,

    /// Seed of all random numbers: the same seed gives the same results
    #[arg(long, global = true, default_value_t = 1, value_name = "N", value_parser = crate::numbers::whole)]
    pub seed: u64,

    /// Threads to use; results do not depend on this number [default: all processors]
    #[arg(long, global = true, value_name = "N", value_parser = crate::numbers::whole_in::<u16>(1..=1024))]
    pub threads: Option<u16>,

    /// Memory to use at most: work that needs more is refused, or stopped with an error [default: half of what the machine has]
    #[arg(long, global = true, value_name = "SIZE", value_parser = crate::budget::size_argument)]
    pub memory: Option<u64>,

    /// No progress bars
    #[arg(long, global = true)]
    pub quiet: bool,

    /// Print the tables behind an answer, too
    #[arg(long, global = true)]
    pub verbose: bool,
}

/// One run of the command: its options, and where it prints.
#[derive(Debug)]
pub struct Session {
    options: Options,
    out: Output,
    interrupted: Arc<AtomicBool>,
    /// Whether the verb looks at that.
    caught: Arc<AtomicBool>,
}

/// Standard output, buffered; standard error as soon as a file goes to standard output. Names of files and topics may hold anything: nothing
/// that moves the cursor of a terminal goes out.
#[derive(Debug)]
struct Output(BufWriter<Stdout>);

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let moves = |byte: u8| byte == 0x7f || (byte < b' ' && !b"\n\t\r".contains(&byte));
        let safe: Vec<u8> = bytes.iter().map(|byte| if moves(*byte) { b'?' } else { *byte }).collect();
        if files::one_is_on_stdout() { io::stderr().write(&safe) } else { self.0.write(&safe) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Session {
    pub(crate) fn new(options: Options) -> Session {
        Session {
            options,
            out: Output(BufWriter::new(io::stdout())),
            interrupted: Arc::default(),
            caught: Arc::default(),
        }
    }

    /// What holds for every verb: a wish to stop leaves no unfinished file, and no more memory is taken than is allowed.
    pub(crate) fn begin(&self) -> anyhow::Result<()> {
        let (flag, caught) = (Arc::clone(&self.interrupted), Arc::clone(&self.caught));
        hang_up::keep_ignored(|| {
            ctrlc::set_handler(move || {
                let is_second = flag.swap(true, Ordering::SeqCst);
                if is_second || !caught.load(Ordering::SeqCst) {
                    umbmark_io::take_away_unfinished();
                    std::process::exit(INTERRUPTED.into());
                }
            })
        })
        .context("cannot catch Ctrl-C")?;
        if let Some(budget) = self.budget() {
            budget.keep();
        }
        Ok(())
    }

    fn budget(&self) -> Option<Budget> {
        Budget::of(self.options.memory)
    }

    /// Says that work needs much memory, or refuses what needs more than is allowed \[bytes\].
    pub fn needs(&self, bytes: u64) -> anyhow::Result<()> {
        let said = self.budget().map(|budget| budget.allow(bytes)).transpose()?.flatten();
        if let Some(text) = said.filter(|_| !self.options.quiet) {
            self.message("note", &text);
        }
        Ok(())
    }

    /// Whether a JSON document is wanted.
    pub fn json(&self) -> bool {
        self.options.json
    }

    /// Whether the tables behind an answer are wanted.
    pub fn verbose(&self) -> bool {
        self.options.verbose
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.options.seed
    }

    /// Whether people look at standard output, rather than a file or a program.
    pub fn on_terminal(&self) -> bool {
        io::stdout().is_terminal()
    }

    /// What standard output can show: characters beyond ASCII on a terminal, and colours unless `NO_COLOR` is set.
    pub fn look(&self) -> Look {
        let unicode = self.on_terminal();
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
        Look { unicode, colour: unicode && !refused && !dumb }
    }

    /// Standard output, buffered.
    pub fn out(&mut self) -> &mut impl Write {
        &mut self.out
    }

    /// Prints one JSON document.
    pub fn print_json(&mut self, document: &impl serde::Serialize) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut self.out, document)?;
        writeln!(self.out)
    }

    /// A message for people, on stderr.
    pub fn message(&self, kind: &str, text: &str) {
        let _ = writeln!(io::stderr(), "{kind}: {}", visible(text));
    }

    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// The number of threads that was asked for; 0 for all processors.
    pub fn threads(&self) -> usize {
        self.options.threads.map_or(0, usize::from)
    }

    /// Runs `work` on the number of threads that was asked for.
    pub fn on_threads<R: Send>(&self, work: impl FnOnce() -> R + Send) -> anyhow::Result<R> {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build().context("cannot start the threads")?;
        Ok(pool.install(work))
    }

    /// Runs `work` on the threads that were asked for: Ctrl-C stops it, and a bar of a hundred steps of `unit` shows how far it is.
    pub fn watched<R: Send>(&self, unit: &'static str, work: impl FnOnce(&Watch) -> R + Send) -> anyhow::Result<R> {
        let stop = self.catch_interrupt();
        self.told(unit, |progress| work(&Watch::new(&stop, progress)))
    }

    /// Runs `work` on the threads that were asked for; a bar of a hundred steps of `unit` shows the share that it tells.
    pub fn told<R: Send>(
        &self,
        unit: &'static str,
        work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> R + Send,
    ) -> anyhow::Result<R> {
        let progress = Mutex::new(self.progress(STEPS as u64, unit));
        self.on_threads(|| {
            work(&|share| {
                if let Ok(mut progress) = progress.lock() {
                    progress.at((share * STEPS) as u64);
                }
            })
        })
    }

    /// A flag that Ctrl-C sets from now on, instead of ending the process; a second one ends it.
    pub fn catch_interrupt(&self) -> Arc<AtomicBool> {
        self.caught.store(true, Ordering::SeqCst);
        Arc::clone(&self.interrupted)
    }

    /// Whether somebody wished it to stop.
    pub fn was_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    /// A progress bar on stderr for `total` steps of `unit`; it shows itself only where people look and after a second.
    pub fn progress(&self, total: u64, unit: &'static str) -> Progress {
        let shown = !self.options.quiet && io::stderr().is_terminal();
        Progress { bar: None, total, unit, began: Instant::now(), shown }
    }
}

/// The hang-up of a terminal, which `nohup` has a command ignore.
mod hang_up {
    /// Sets the handlers of signals and has a hang-up that was ignored before be ignored still.
    #[cfg(unix)]
    pub fn keep_ignored<R>(set: impl FnOnce() -> R) -> R {
        let mut before = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
        // SAFETY: with no new action, the call only writes the present one to `before`, which is of its type and all zeros until then.
        let known = unsafe { libc::sigaction(libc::SIGHUP, std::ptr::null(), before.as_mut_ptr()) } == 0;
        // SAFETY: zeros are a valid `sigaction`, so it is initialised whether or not the call wrote to it.
        let is_ignored = known && unsafe { before.assume_init() }.sa_sigaction == libc::SIG_IGN;
        let set = set();
        if is_ignored {
            // SAFETY: SIG_IGN runs no code of ours.
            unsafe { libc::signal(libc::SIGHUP, libc::SIG_IGN) };
        }
        set
    }

    #[cfg(not(unix))]
    pub fn keep_ignored<R>(set: impl FnOnce() -> R) -> R {
        set()
    }
}

/// Text in which nothing moves the cursor: names of files and topics may hold anything.
pub fn visible(text: &str) -> String {
    let harmless = |c: &char| !c.is_control() || matches!(c, '\n' | '\t');
    text.chars()
        .map(|c| Some(c).filter(harmless).map_or_else(|| c.escape_default().to_string(), String::from))
        .collect()
}

/// A progress bar that appears when the work takes more than a second.
#[derive(Debug)]
pub struct Progress {
    bar: Option<ProgressBar>,
    total: u64,
    unit: &'static str,
    began: Instant,
    shown: bool,
}

impl Progress {
    /// Says that `done` steps are done.
    pub fn at(&mut self, done: u64) {
        if self.bar.is_none() && self.shown && self.began.elapsed() > Duration::from_secs(1) {
            let bar = ProgressBar::with_draw_target(Some(self.total), ProgressDrawTarget::stderr());
            let template = format!("{{wide_bar}} {{pos}}/{{len}} {} {{eta}} left", self.unit);
            if let Ok(style) = ProgressStyle::with_template(&template) {
                bar.set_style(style);
            }
            self.bar = Some(bar);
        }
        if let Some(bar) = &self.bar {
            bar.set_position(done);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
