//! What a model is missing: from ten end poses with 999 simulated null tests (fit, the whole catalogue, certificates, next
//! experiments), and from the tracks of ten runs of 10,000 samples, a pose with each fifth; the test for whatever repeats by itself too.
//!
//! `cargo bench -p umbmark-benches --bench diagnose`; throughput of the tracks is in samples per second.

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::diagnose::{Options, base_model, diagnose, what_repeats};
use umbmark_core::drive::{Encoder, Robot};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::evidence::fit;
use umbmark_core::learn::learn;
use umbmark_core::likelihood::{Column, Fitted, Noise, Observed};
use umbmark_core::path::{Direction, Path};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth, record_test};

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

/// Tracks of ten runs round the paper's square, 104 s each, counters read `rate` times a second and poses a fifth as often: a robot
/// with five systematic effects beside its noise.
fn tracks(rate: f64) -> Dataset {
    let labmate = Robot::labmate();
    let encoder = Encoder::new(labmate.encoder.ticks_per_revolution(), Some(rate), None).expect("a rate");
    let mut model = Model::new(&Robot { encoder, ..labmate });
    for (effect, parameter, value) in [
        ("wheel_noise", "k_sqrt_m", 2e-4),
        ("reference_noise", "position_sd_m", 1e-3),
        ("reference_noise", "heading_sd_rad", 2e-3),
        ("wheel_diameter_ratio", "e_d", 1.002),
        ("wheelbase", "e_b", 1.01),
        ("scale", "e_s", 0.997),
        ("wheel_eccentricity_left", "sine_m", 1e-3),
        ("caster_kick", "kick_rad", 7e-3),
    ] {
        model.set(effect, parameter, value).expect("a value within its bounds");
    }
    record_test(&model, &Path::umbmark(), &[TestKind::Systematic], [5, 5], rate / 5.0, [1, 0]).expect("a test")
}

/// The tracks of a dataset as they are fitted to.
fn observed(data: &Dataset) -> Observed {
    Observed::new(data, &Robot::labmate()).expect("tracks")
}

/// Of a fit, run by run: the columns of what was fitted, and the residual.
fn columns_of(fitted: &Fitted) -> Vec<Vec<Column>> {
    let Fitted { observed, model, .. } = fitted;
    let mut columns = observed.columns(model, &fitted.free);
    for (columns, run) in columns.iter_mut().zip(&observed.runs) {
        columns.push(run.residuals_along(&model.chain()));
    }
    columns
}

/// The same three steps as on the command line: what is missing, six parameters fitted, the whole loop.
fn tracked(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tracks of ten runs");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    let on_two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let base = Model::new(&Robot::labmate());
    let with = |effects: &[&str]| {
        let mut model = base.clone();
        effects.iter().for_each(|effect| model.add(effect).expect("an effect of the catalogue").free = true);
        model
    };
    let three = with(&["wheel_diameter_ratio", "wheelbase", "scale"]);
    let six = with(&["wheel_diameter_ratio", "wheelbase", "scale", "wheel_eccentricity_left", "crab"]);
    for rate in [50.0, 100.0, 200.0] {
        let data = tracks(rate);
        let samples: usize = data.runs.iter().filter_map(|run| Some(run.log.as_ref()?.time.len())).sum();
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(format!("diagnose, {rate} Hz"), |bencher| {
            on_two.install(|| bencher.iter(|| diagnose(&data, &three, &Options::default()).expect("tracks")));
        });
        group.bench_function(format!("fit of six, {rate} Hz"), |bencher| {
            on_two.install(|| bencher.iter(|| fit(&data, &six).expect("tracks")));
        });
        if rate == 100.0 {
            let fitted = observed(&data).fit(&six, &Noise::default(), &[]).expect("tracks");
            let columns = columns_of(&fitted);
            group.bench_function(format!("what repeats, {rate} Hz"), |bencher| {
                let Fitted { observed, model, noise, .. } = &fitted;
                on_two.install(|| bencher.iter(|| what_repeats(observed, model, noise, &columns, 1).expect("laws")));
            });
            let steps = learn(&data, &Options::default()).expect("tracks").steps.len() - 1;
            group.bench_function(format!("learn, {steps} steps"), |bencher| {
                on_two.install(|| bencher.iter(|| learn(&data, &Options::default()).expect("tracks")));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(5))
        .sample_size(20);
    targets = diagnosis, tracked
}
criterion_main!(benches);
