//! Odometry on the robot: one `update`, from counts to pose and covariance.
//!
//! `cargo bench -p umbmark-benches --bench embedded`; the time of one update is the time shown divided by the readings.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::f64::consts::TAU;
use std::hint::black_box;
use umbmark_core::apply::compiled;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::geometry::Pose2;
use umbmark_core::likelihood::Noise;
use umbmark_odometry::{Odometer, Table};

/// Readings at 100 Hz: a winding way with turns on the spot.
fn readings() -> Vec<(f64, [f64; 2])> {
    let (mut left, mut right) = (0.0_f64, 0.0_f64);
    let reading = |k: u32| {
        let turn = 12.0 * (TAU * f64::from(k) / 377.0).sin();
        let way = if k / 200 % 3 == 2 { 0.0 } else { 21.0 };
        (left, right) = (left + way - turn, right + way + turn);
        (0.01 * f64::from(k), [left.floor(), right.floor()])
    };
    (0..4096).map(reading).collect()
}

fn updates(criterion: &mut Criterion) {
    let wheels = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("scale", "e_s", 1.003)];
    let own = [("crab", "angle_rad", 0.004), ("wheel_eccentricity_left", "sine_m", 3e-4), ("backlash", "play_m", 5e-4)];
    let of_speed = [("speed_slip", "s_per_m", 0.01), ("turn_slip", "share", 0.01), ("floor_slope", "drift_x", 0.004)];
    let readings = readings();
    let mut group = criterion.benchmark_group("update");
    group.throughput(Throughput::Elements(readings.len() as u64));
    for (name, effects) in [
        ("E_d, E_b, E_s", wheels.to_vec()),
        ("six effects", [wheels, own].concat()),
        ("six effects, three of speed", [wheels, of_speed].concat()),
    ] {
        let mut model = Model::new(&Robot::labmate());
        for (effect, parameter, value) in effects {
            model.set(effect, parameter, value).expect("the values are in range");
        }
        let numbers = compiled(&model, Some(&Noise::default()), Pose2::IDENTITY).expect("all of them are compiled");
        let numbers: Vec<f64> = numbers.into_iter().map(|(_, number)| number).collect();
        let table = Table::read(&numbers).expect("it has just been written");
        let drive = |ahead: bool| {
            let mut odometer = Odometer::<16>::begin(&table);
            for (time, counts) in &readings {
                black_box(odometer.update(*time, *counts)).expect("good readings");
                if ahead {
                    black_box(odometer.ahead()).expect("good readings");
                }
            }
        };
        group.bench_function(name, |bencher| bencher.iter(|| drive(false)));
        if table.reads_speed() {
            group.bench_function(format!("{name}, ahead each time"), |bencher| bencher.iter(|| drive(true)));
        }
    }
    group.finish();
}

criterion_group!(benches, updates);
criterion_main!(benches);
