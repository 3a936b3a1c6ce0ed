//! The Rust side of `peers/run.py`: writes the work that all programs share, and does it.
//!
//! `peers export FOLDER TRIALS` writes the segments of that many plain trials, and where sampled odometry ends by exact
//! arcs from exact counts. `peers measure FOLDER TRIALS` does the same work by every kind of odometry and prints a line
//! for each: name, share of the work done, CPU seconds for all of it, largest error \[m\].

use std::fs;
use std::io::{self, Write as _};
use std::path::Path as FilePath;
use std::time::Instant;
use umbmark_benches::plain_trials::{MOVES, PlainTrials, SEGMENTS};
use umbmark_benches::studies::{self, SAMPLED, SEED};
use umbmark_benches::tick_loop;
use umbmark_core::engine::{
    Instructions, Integrator, Method, Motion, SampledOdometry, Segment, TickGeometry, UNITS_PER_TICK, Update,
};
use umbmark_core::monte_carlo::Study;

type Ends = Vec<[f64; 2]>;

/// Trials whose tick-exact ends are held against the oracle, which takes as long as all the rest.
const CHECKED_TRIALS: usize = 20;

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

    fn export(&self, folder: &FilePath) -> io::Result<()> {
        let runs: Vec<&[Segment]> = self.segments.chunks(MOVES).collect();
        let column = |of: fn(&Segment) -> f64, index: usize| runs.iter().map(move |run| of(&run[index]));
        let ticks = |units: i64| units as f64 / UNITS_PER_TICK as f64;
        let _ = ticks;
        let columns: [fn(&Segment) -> f64; 4] = [
            |s| s.line.start()[0] as f64 / UNITS_PER_TICK as f64,
            |s| s.line.start()[1] as f64 / UNITS_PER_TICK as f64,
            |s| s.line.travel()[0] as f64 / UNITS_PER_TICK as f64 / f64::from(s.readings),
            |s| s.line.travel()[1] as f64 / UNITS_PER_TICK as f64 / f64::from(s.readings),
        ];
        let all = (0..MOVES).flat_map(|index| columns.into_iter().flat_map(move |of| column(of, index)));
        write_numbers(&folder.join("segments.f64"), all)?;
        write_numbers(&folder.join("ends.f64"), self.reference().into_iter().flatten())?;
        let readings: Vec<u32> = self.segments[..MOVES].iter().map(|segment| segment.readings).collect();
        let (tick, wheelbase) = (self.geometry.left(), self.geometry.wheelbase());
        let description = format!(
            "{{\"trials\": {}, \"runs\": {}, \"readings\": {readings:?}, \"tick_m\": {tick}, \"wheelbase_m\": {wheelbase}}}\n",
            self.trials,
            runs.len()
        );
        fs::write(folder.join("work.json"), description)
    }
}
