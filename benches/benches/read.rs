//! Files into the dataset type: reading, checking, mending and the return error, all that `umbmark_io::load` does.
//!
//! `cargo bench -p umbmark-benches --bench read`; throughput is in bytes of text per second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use umbmark_benches::logs::{ROBOT, log_text};

fn read(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).expect("a folder");
    std::fs::write(folder.path().join("robot.toml"), ROBOT).expect("a robot");
    let text = log_text(500_000);
    std::fs::write(runs.join("ccw_01.csv"), &text).expect("a log");
    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("csv", |bencher| bencher.iter(|| umbmark_io::load(folder.path()).expect("a dataset")));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(5))
        .sample_size(10);
    targets = read
}
criterion_main!(benches);
