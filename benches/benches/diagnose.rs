//! A diagnosis of ten end poses with 999 simulated null tests: fit, the whole catalogue, certificates, next experiments.
//!
//! `cargo bench -p umbmark-benches --bench diagnose`.

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::diagnose::{Options, base_model, diagnose};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::{Direction, Path};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

/// Five runs each way of the paper's robot.
fn ten_end_poses() -> Dataset {
    let (robot, path) = (Robot::labmate(), Path::umbmark());
    let mut model = base_model(&robot).expect("E_d and E_b are in the catalogue");
    model.set("wheel_noise", "k_sqrt_m", 1e-3).expect("so is wheel noise");
    let mut simulator =
        Simulator::new(&robot, &path, Odometry::Continuous, Phase::Edge).expect("the paper's test can be driven");
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, 1, 0);
    let mut runs = Vec::new();
    for direction in Direction::BOTH {
        for number in 1..=5 {
            let returned = Some(simulator.run(&mut truth, direction, TestKind::Systematic));
            let name = format!("{}_{number}", direction.name());
            let direction = Some(direction);
            runs.push(Run { name, number, direction, test: TestKind::Systematic, log: None, returned });
        }
    }
    Dataset { robot: Some(robot), path: Some(path), runs, ..Dataset::default() }
}

fn diagnosis(criterion: &mut Criterion) {
    let data = ten_end_poses();
    let model = base_model(&Robot::labmate()).expect("E_d and E_b are in the catalogue");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        criterion.bench_function(&format!("diagnose ten end poses, 999 draws, {threads} thread(s)"), |bencher| {
            pool.install(|| bencher.iter(|| diagnose(&data, &model, &Options::default())));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(5))
        .sample_size(20);
    targets = diagnosis
}
criterion_main!(benches);
