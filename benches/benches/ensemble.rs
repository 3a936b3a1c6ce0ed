//! The same study on 1, 2, 4, ... threads, up to what the machine has.
//!
//! `cargo bench -p umbmark-benches --bench ensemble`; throughput is in trials per second. What matters is the ratio to
//! one thread.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use umbmark_benches::studies::{self, SAMPLED};
use umbmark_core::monte_carlo::{CHUNK, Study};

fn ensemble(criterion: &mut Criterion) {
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    let mut threads: Vec<usize> = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|n| *n < most).collect();
    threads.push(most);
    let studies = [
        ("every tick", Study { trials: 64 * CHUNK, ..studies::plain() }),
        ("100 Hz", Study { trials: 16 * CHUNK, path: studies::without_ramps(), odometry: SAMPLED, ..studies::plain() }),
    ];
    for (name, study) in studies {
        let mut group = criterion.benchmark_group(format!("ensemble {name}"));
        group.sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements(study.trials));
        for threads in &threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build().expect("threads");
            group.bench_function(BenchmarkId::new("threads", threads), |bencher| {
                pool.install(|| bencher.iter(|| studies::run(&study)));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(8))
        .sample_size(10);
    targets = ensemble
}
criterion_main!(benches);
