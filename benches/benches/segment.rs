//! One segment of odometry: a 4 m leg, a quarter turn, any ratio of the wheel speeds.
//!
//! `cargo bench -p umbmark-benches --bench segment`; throughput is in segments per second where every tick counts, in
//! readings per second where the counters are sampled. Instruction sets a machine lacks fall back to the next one it has.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use umbmark_benches::{Draws, LEG_READINGS, TURN_READINGS, robot, tick_loop};
use umbmark_core::engine::{Instructions, Motion, SampledOdometry, TickOdometry, Update, WheelLine, oracle};

/// Enough that no branch predictor learns them by heart.
const LINES: usize = 4096;

fn kinds() -> [(&'static str, Vec<WheelLine>, u32); 3] {
    let mut draws = Draws::new(20_260_101);
    [
        ("leg", (0..LINES).map(|_| draws.leg()).collect(), LEG_READINGS),
        ("turn", (0..LINES).map(|_| draws.turn()).collect(), TURN_READINGS),
        ("generic", (0..LINES).map(|_| draws.generic()).collect(), LEG_READINGS),
    ]
}

fn tick_exact(criterion: &mut Criterion) {
    let odometry = TickOdometry::new(robot());
    for (kind, lines, _) in kinds() {
        let mut group = criterion.benchmark_group(format!("tick-exact {kind}"));
        group.throughput(Throughput::Elements(LINES as u64));
        let mut motions = vec![Motion::IDENTITY; LINES];
        group.bench_function("word, one by one", |bencher| {
            bencher.iter(|| {
                for (line, motion) in lines.iter().zip(&mut motions) {
                    *motion = odometry.motion(line);
                }
                black_box(&motions);
            });
        });
        for instructions in [Instructions::Avx2, Instructions::Avx512] {
            let odometry = odometry.limited_to(instructions);
            group.bench_function(format!("word, many, {instructions:?}"), |bencher| {
                bencher.iter(|| odometry.motions(black_box(&lines), &mut motions));
            });
        }
        let few = &lines[..16];
        group.throughput(Throughput::Elements(few.len() as u64));
        group.bench_function("tick loop", |bencher| {
            bencher.iter(|| few.iter().map(|line| tick_loop(odometry.geometry(), line).0).sum::<f64>());
        });
        group.bench_function("oracle", |bencher| {
            bencher.iter(|| few.iter().map(|line| oracle::motion(odometry.geometry(), line).pose.x).sum::<f64>());
        });
        group.finish();
    }
}

fn sampled(criterion: &mut Criterion) {
    for (kind, lines, readings) in kinds() {
        let lines = &lines[..512];
        let mut group = criterion.benchmark_group(format!("sampled {kind}"));
        group.throughput(Throughput::Elements(lines.len() as u64 * u64::from(readings)));
        let odometry = SampledOdometry::new(robot(), Update::Arc);
        group.bench_function("one by one", |bencher| {
            bencher.iter(|| lines.iter().map(|line| odometry.one_by_one(line, readings).pose.x).sum::<f64>());
        });
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            let mut odometry = odometry.clone().limited_to(instructions);
            group.bench_function(format!("eight at a time, {instructions:?}"), |bencher| {
                bencher.iter(|| lines.iter().map(|line| odometry.at_constant_rate(line, readings).pose.x).sum::<f64>());
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .sample_size(30);
    targets = tick_exact, sampled
}
criterion_main!(benches);
