//! The targets of `fuzz/`, on good files with random damage: a second of what `cargo fuzz` does for hours.
//!
//! `UMBMARK_TEST_CASES=100000` damages each of them so many times.

use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::Study;
use umbmark_core::random::Stream;
use umbmark_core::result;
use umbmark_io::checkpoint::Written;

#[path = "../crates/umbmark-io/src/mutated_input/damage.rs"]
mod damage;
#[path = "../fuzz/src/lib.rs"]
mod targets;

/// Damages some good inputs many times, in turn.
fn survive(purpose: u64, good: &[Vec<u8>], rounds: u64, target: fn(&[u8]) -> bool) {
    let rounds = std::env::var("UMBMARK_TEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(rounds);
    for good in good {
        assert!(target(good), "input {purpose}: {:?} is good", String::from_utf8_lossy(good));
    }
    let mut stream = Stream::new(30, purpose, 0);
    let mut fine = 0;
    for (good, _) in good.iter().cycle().zip(0..rounds) {
        let input = damage::damage(good, &mut stream);
        fine += u64::from(target(&input));
    }
    assert!(fine > 0 && fine < rounds, "{fine}: damage too heavy or too light to tell anything");
}

fn examples() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples")
}

/// The first byte chooses the ending.
fn file(ending: &str, text: &[u8]) -> Vec<u8> {
    let first = targets::ENDINGS.iter().position(|own| *own == ending).unwrap() as u8;
    [&[first], text].concat()
}

#[test]
fn files_of_every_layout() {
    let log = b"t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n0.00,0,0,0.001,0,0\n0.05,40,42,,,\n0.10,80,85,0.02,0,0.01\n";
    let sheet = std::fs::read(examples().join("tape/returns.csv")).unwrap();
    survive(1, &[file("csv", log), file("csv", &sheet)], 400, targets::readers);
}

#[test]
fn robots_and_models() {
    let robot = targets::TAPE[0].as_bytes().to_vec();
    survive(2, &[robot], 4000, targets::robots);
    let carpet = std::fs::read(examples().join("carpet.toml")).unwrap();
    survive(3, &[carpet], 2000, targets::models);
}

#[test]
fn formulas_of_any_text() {
    let good = [
        "a * cos(2 * heading) + b * sin(2 * heading)",
        "a * exp(-(speed / 0.1)^2) + b",
        "a * x / (y + 1) + b * sqrt(abs(turn_rate))",
    ];
    survive(4, &good.map(|text| text.into()), 4000, targets::formulas);
}

#[test]
fn checkpoints_of_both_formats() {
    let mut model = Model::new(&Robot::labmate());
    model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
    let study = Study { runs: [1, 1], ..Study::new(model, 1, 3) };
    let told = result::Study::new(&study, &result::NoiseFree::of(&study).unwrap(), &result::Told::default());
    let ensemble = study.run(|_| std::ops::ControlFlow::Continue(())).unwrap();
    let written = Written { seed: 3, study: told, ensemble }.text().unwrap().into_bytes();
    // The first format has no line with a checksum, so that damage reaches what is behind it.
    let first = written.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    survive(5, &[written.clone(), written[first..].to_vec()], 1500, targets::checkpoints);
}

#[test]
fn datasets_whose_numbers_are_changed() {
    // A number multiplied by a hundred, another by -1, and none.
    let good = [vec![1, 3, 102, 1, 7, 210], vec![0, 1, 100], vec![1, 9, 101, 1, 12, 99, 0, 0, 101]];
    survive(6, &good, 60, targets::datasets);
}
