//! Whole runs and whole UMBmark tests on one thread: random numbers, true motion, odometry and score.
//!
//! `cargo bench -p umbmark-benches --bench trial`; throughput is in runs or trials per second. A trial is ten runs, five
//! each way; with ten bumps it is twenty, since the extended test comes on top.

use criterion::{
    BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use std::time::Duration;
use umbmark_benches::studies::{self, ODOMETRIES, SAMPLED, SEED};
use umbmark_core::effect::TestKind;
use umbmark_core::engine::Instructions;
use umbmark_core::monte_carlo::{CHUNK, Study};
use umbmark_core::path::Direction;
use umbmark_core::simulate::{Odometry, Simulator, Truth};

fn run(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("run");
    group.throughput(Throughput::Elements(1));
    let study = studies::plain();
    for (name, odometry) in ODOMETRIES {
        let mut simulator =
            Simulator::new(study.robot(), &study.path, odometry, study.phase).expect("the paper's test can be driven");
        let mut truth = Truth::new(&study.model);
        simulator.open(&mut truth, SEED, 0);
        group.bench_function(name, |bencher| {
            bencher.iter(|| simulator.run(&mut truth, Direction::Ccw, TestKind::Systematic));
        });
    }
    group.finish();
}

/// Measures so many trials at a time, a tenth of a second or more: less, and one sees the growth of the statistics'
/// sketches, some milliseconds a study. Instruction sets that the machine lacks fall back to the next one it has.
fn measure(group: &mut BenchmarkGroup<WallTime>, name: &str, study: Study, trials: u64) {
    let study = Study { trials, ..study };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    group.throughput(Throughput::Elements(trials));
    group.bench_function(name, |bencher| pool.install(|| bencher.iter(|| studies::run(&study))));
}

fn trial(criterion: &mut Criterion) {
    for (kind, study, chunks) in
        [("plain", studies::plain(), 64), ("ten bumps", studies::ten_bumps(), 32), ("events", studies::events(), 8)]
    {
        let mut group = criterion.benchmark_group(format!("trial {kind}"));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        measure(&mut group, "every tick", study.clone(), chunks * CHUNK);
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            let study = Study { instructions, ..study.clone() };
            measure(&mut group, &format!("every tick, {instructions:?}"), study, chunks * CHUNK);
        }
        let sampled = Study { odometry: SAMPLED, ..study.clone() };
        measure(&mut group, "100 Hz", sampled.clone(), CHUNK / 2);
        measure(&mut group, "100 Hz without ramps", Study { path: studies::without_ramps(), ..sampled }, 4 * CHUNK);
        if kind == "plain" {
            measure(
                &mut group,
                "no odometry",
                Study { odometry: Odometry::Continuous, ..study.clone() },
                chunks * CHUNK,
            );
            measure(&mut group, "tick by tick", Study { odometry: Odometry::EveryTickOneByOne, ..study }, 10);
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(4))
        .sample_size(20);
    targets = run, trial
}
criterion_main!(benches);
