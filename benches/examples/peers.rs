//! The Rust side of `peers/run.py`: writes the work that all programs share, and does it.
//!
//! `peers export FOLDER TRIALS` writes the segments of that many plain trials, and where sampled odometry ends by exact
//! arcs from exact counts. `peers measure FOLDER TRIALS` does the same work by every kind of odometry on one thread and
//! prints a line for each: name, CPU seconds, largest error \[m\].

use std::fs;
use std::io::{self, Write as _};
use std::path::Path as FilePath;
use std::time::Instant;
use umbmark_benches::plain_trials::{MOVES, PlainTrials, RUNS, SEGMENTS};
use umbmark_benches::studies::{self, SAMPLED, SEED};
use umbmark_benches::tick_loop;
use umbmark_core::engine::{
    Instructions, Integrator, Method, Motion, SampledOdometry, Segment, TickGeometry, UNITS_PER_TICK, Update,
};
use umbmark_core::monte_carlo::Study;

/// Where each run ends, (x, y) \[m\].
type Ends = Vec<[f64; 2]>;

/// One trial in so many is done by the tick loop, whose time is multiplied.
const TICK_LOOP_SHARE: usize = 20;

/// One trial in so many is held against the oracle of tick-exact odometry.
const ORACLE_SHARE: usize = 500;

/// Fast programs are repeated for so long \[s\].
const ENOUGH_SECONDS: f64 = 0.5;

fn main() -> io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let usage = || io::Error::other("usage: peers (export | measure) FOLDER TRIALS");
    let [task, folder, trials] = &words[..] else { return Err(usage()) };
    let work = Work::new(trials.parse().map_err(|_| usage())?);
    match task.as_str() {
        "export" => work.export(folder.as_ref()),
        "measure" => work.measure(folder.as_ref()),
        _ => Err(usage()),
    }
}

/// The segments of plain trials, one after the other.
struct Work {
    trials: u64,
    geometry: TickGeometry,
    segments: Vec<Segment>,
}

impl Work {
    fn new(trials: u64) -> Work {
        let plain = PlainTrials::default();
        let segments = (0..trials).flat_map(|trial| plain.segments(SEED, trial)).collect();
        Work { trials, geometry: plain.geometry, segments }
    }

    /// Writes `work.json`; `segments.f64`, numbers of shape (move, [start left, start right, travel per reading left,
    /// right], run) in ticks; and `ends.f64`, of shape (run, [x, y]) in metres.
    fn export(&self, folder: &FilePath) -> io::Result<()> {
        let ticks = |units: i64| units as f64 / UNITS_PER_TICK as f64;
        let runs: Vec<&[Segment]> = self.segments.chunks(MOVES).collect();
        let mut numbers = Vec::with_capacity(4 * self.segments.len());
        for index in 0..MOVES {
            let segments = || runs.iter().map(|run| &run[index]);
            for wheel in 0..2 {
                numbers.extend(segments().map(|s| ticks(s.line.start()[wheel])));
            }
            for wheel in 0..2 {
                numbers.extend(segments().map(|s| ticks(s.line.travel()[wheel]) / f64::from(s.readings)));
            }
        }
        write_numbers(&folder.join("segments.f64"), &numbers)?;
        let readings: Vec<u32> = runs[0].iter().map(|segment| segment.readings).collect();
        let (tick, wheelbase) = (self.geometry.left(), self.geometry.wheelbase());
        let description = format!(
            "{{\"runs\": {}, \"readings\": {readings:?}, \"tick_m\": {tick}, \"wheelbase_m\": {wheelbase}}}\n",
            runs.len(),
        );
        fs::write(folder.join("work.json"), description)?;
        write_numbers(&folder.join("ends.f64"), self.reference().as_flattened())
    }

    /// Where sampled odometry ends: every count in whole numbers, every reading an exact arc at the heading of its own
    /// counts, positions summed with compensation. No code in common with the fast path.
    fn reference(&self) -> Ends {
        let odometry = SampledOdometry::new(self.geometry, Update::Arc);
        ends(&self.segments, |segment| {
            let (start, travel, readings) = (segment.line.start(), segment.line.travel(), i64::from(segment.readings));
            let count = |wheel: usize, k: i64| {
                (start[wheel] * readings + travel[wheel] * k).div_euclid(UNITS_PER_TICK * readings)
            };
            odometry.from_counts((1..=readings).map(|k| [count(0, k), count(1, k)]))
        })
    }

    fn measure(&self, folder: &FilePath) -> io::Result<()> {
        let mut out = io::stdout().lock();
        let reference = read_ends(&folder.join("ends.f64"))?;
        let best = Instructions::best();
        let instructions = [Instructions::Portable, Instructions::Avx2, Instructions::Avx512];
        for instructions in instructions.into_iter().filter(|i| *i <= best) {
            let (seconds, ends) = timed(|| self.all(Method::Sampled(Update::Arc), instructions));
            writeln!(out, "sampled, {instructions:?}\t{seconds}\t{:e}", largest_gap(&ends, &reference))?;
        }
        let few = &self.segments[..SEGMENTS * (self.trials as usize).div_ceil(ORACLE_SHARE)];
        let mut oracle = Integrator::new(self.geometry, Method::EveryTickOneByOne);
        let every_tick = ends(few, |segment| oracle.motion(segment));
        for instructions in instructions.into_iter().filter(|i| *i <= best) {
            let (seconds, ends) = timed(|| self.all(Method::EveryTick, instructions));
            writeln!(out, "tick-exact, {instructions:?}\t{seconds}\t{:e}", largest_gap(&ends, &every_tick))?;
        }
        let few = &self.segments[..SEGMENTS * (self.trials as usize).div_ceil(TICK_LOOP_SHARE)];
        let (seconds, ends) = timed(|| self.tick_by_tick(few));
        let seconds = seconds * self.segments.len() as f64 / few.len() as f64;
        writeln!(out, "tick loop\t{seconds}\t{:e}", largest_gap(&ends, &every_tick))?;
        // Random numbers, true motion and statistics besides, as a user gets them; on this thread.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        let pool = pool.map_err(io::Error::other)?;
        let study = Study { trials: self.trials, path: studies::without_ramps(), ..studies::plain() };
        let sampled = Study { odometry: SAMPLED, ..study.clone() };
        for (name, study) in [("sampled", sampled), ("tick-exact", study)] {
            let (seconds, _) = timed(|| pool.install(|| studies::run(&study)));
            writeln!(out, "whole trials, {name}\t{seconds}\tnan")?;
        }
        Ok(())
    }

    /// Trial by trial, as a study does it.
    fn all(&self, method: Method, instructions: Instructions) -> Ends {
        let mut integrator = Integrator::new(self.geometry, method).limited_to(instructions);
        let mut motions = [Motion::IDENTITY; SEGMENTS];
        let mut ends = Vec::with_capacity(self.segments.len() / MOVES);
        for trial in self.segments.chunks(SEGMENTS) {
            integrator.motions(trial, &mut motions);
            ends.extend(motions.chunks(MOVES).map(|run| end(run.iter().copied())));
        }
        ends
    }

    /// The loop one writes by hand. Its turns end at the heading of their counts, as those of all others do.
    fn tick_by_tick(&self, segments: &[Segment]) -> Ends {
        ends(segments, |segment| {
            let (x, y) = tick_loop(&self.geometry, &segment.line);
            let heading = self.geometry.heading(segment.line.counts());
            Motion::from(umbmark_core::geometry::Pose2 { x, y, heading })
        })
    }
}

/// The ends of all runs, each move by `motion`.
fn ends(segments: &[Segment], mut motion: impl FnMut(&Segment) -> Motion) -> Ends {
    segments.chunks(MOVES).map(|run| end(run.iter().map(&mut motion))).collect()
}

fn end(moves: impl Iterator<Item = Motion>) -> [f64; 2] {
    let end = moves.fold(Motion::IDENTITY, |end, next| end.then(&next));
    [end.pose.x, end.pose.y]
}

/// Over the runs that both have.
fn largest_gap(ends: &[[f64; 2]], reference: &[[f64; 2]]) -> f64 {
    assert!(!ends.is_empty() && ends.len().min(reference.len()) >= 2 * RUNS);
    let pairs = ends.as_flattened().iter().zip(reference.as_flattened());
    pairs.fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

/// CPU seconds of one repetition, of as many as give the coarse clock of a thread time to move.
fn timed<T>(mut program: impl FnMut() -> T) -> (f64, T) {
    let (clock, before) = (Instant::now(), cpu_seconds());
    let mut repetitions = 0.0;
    loop {
        let result = program();
        repetitions += 1.0;
        let wall = clock.elapsed().as_secs_f64();
        if wall >= ENOUGH_SECONDS {
            let cpu = before.zip(cpu_seconds()).map_or(wall, |(before, after)| after - before);
            return (cpu / repetitions, result);
        }
    }
}

/// CPU time of this thread, to some milliseconds; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

fn write_numbers(file: &FilePath, numbers: &[f64]) -> io::Result<()> {
    fs::write(file, numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>())
}

fn read_ends(file: &FilePath) -> io::Result<Ends> {
    let bytes = fs::read(file)?;
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    Ok(numbers.as_chunks().0.to_vec())
}
