//! Whole tests of each drive, the paper's five runs each way, without effects but wheel noise; the CLAPPER's on its rectangle, in
//! fewer trials.
//!
//! `cargo bench -p umbmark-benches --bench drives`; throughput is in trials per second on one thread.

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use umbmark_benches::studies;
use umbmark_core::drive::{AckermannDrive, DriveKind, Encoder, Robot};
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{CHUNK, Study};
use umbmark_core::path::{DIAGONAL_SQUARE, FIXED_SQUARE, Path, ROUNDED_RECTANGLE, SQUARE, Shape, SpeedProfile};
use umbmark_core::preset::Preset;

fn tricycle() -> (Robot, Path) {
    let drive = AckermannDrive::new(0.5, 0.4, 0.15, 20_000.0, 0.0).expect("positive lengths");
    let encoder = Encoder::new(2000.0, None, None).expect("positive ticks");
    let path = Path::new(&ROUNDED_RECTANGLE, &[4.0, 4.0, 1.0], SpeedProfile::default()).expect("corners that fit");
    (Robot { name: "tricycle".into(), drive: drive.into(), encoder }, path)
}

/// A robot of usual numbers on a square of 4 m, its counters read a hundred times a second.
fn at_100_hz(kind: DriveKind, shape: &'static Shape) -> (Robot, Path) {
    let encoder = Encoder::new(2000.0, Some(100.0), None).expect("positive ticks");
    let path = Path::new(shape, &[4.0], SpeedProfile::default()).expect("4 m is a side");
    (Robot { name: kind.name().into(), drive: kind.usual(), encoder }, path)
}

fn drives(criterion: &mut Criterion) {
    let preset = |name: &str| {
        let preset = Preset::find(name).expect("a preset");
        (preset.robot(), preset.path())
    };
    let mut group = criterion.benchmark_group("drives");
    group.sampling_mode(SamplingMode::Flat);
    for (name, (robot, path), chunks) in [
        ("differential", preset("trc-labmate-docal"), 4),
        ("synchro", preset("k2a"), 4),
        ("ackermann", tricycle(), 4),
        ("clapper", preset("clapper"), 1),
        ("differential, 100 Hz", at_100_hz(DriveKind::Differential, &SQUARE), 1),
        ("mecanum, 100 Hz", at_100_hz(DriveKind::Mecanum, &SQUARE), 1),
        ("mecanum, fixed heading, 100 Hz", at_100_hz(DriveKind::Mecanum, &FIXED_SQUARE), 1),
        ("omni3, on its corner, 100 Hz", at_100_hz(DriveKind::Omni3, &DIAGONAL_SQUARE), 1),
    ] {
        let mut model = Model::new(&robot);
        model.set("wheel_noise", "k_sqrt_m", 1e-3).expect("a usual size");
        let study = Study { path, ..Study::new(model, chunks * CHUNK, 1) };
        group.throughput(Throughput::Elements(study.trials));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        group.bench_function(name, |bencher| pool.install(|| bencher.iter(|| studies::run(&study))));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(3))
        .sample_size(10);
    targets = drives
}
criterion_main!(benches);
