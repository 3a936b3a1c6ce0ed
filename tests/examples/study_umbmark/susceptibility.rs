//! Whether sigma ranks robots by their susceptibility to bumps, which the paper doubts.
//!
//! Robots of different wheelbase, wheel radius and slip, on floors of different roughness. Susceptibility is what one bump of
//! 10 mm turns the robot by, D/b.

use crate::Study;
use crate::figure::{COLOURS, Figure};
use crate::shares::{pairs_alike, rank_correlation};
use rayon::prelude::*;
use umbmark_core::dataset::ReturnError;
use umbmark_core::drive::{DifferentialDrive, Encoder, Robot};
use umbmark_core::effect::{Model, TestKind, extra_travel};
use umbmark_core::path::{Direction, Path};
use umbmark_core::random::Stream;
use umbmark_core::score::{Convention, Extended, summarise};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

/// A floor: bumps per metre and wheel, and their height.
const FLOORS: [(&str, f64, f64); 4] = [
    ("smooth", 0.0, 0.0),
    ("1 mm bumps, 2 a metre", 2.0, 0.001),
    ("3 mm bumps, 2 a metre", 2.0, 0.003),
    ("3 mm bumps, equal slip", 2.0, 0.003),
];

/// What one robot scored.
struct Scored {
    susceptibility: f64,
    sigma: f64,
    extended: f64,
}

/// Prints rank correlations, draws sigma against susceptibility.
pub fn study(study: &Study) {
    let robots = study.tests(400);
    println!("## Does sigma rank robots by susceptibility? {robots} robots, 5 + 5 runs, and as many over ten bumps\n");
    println!("| floor | rank correlation of sigma | pairs right | of the extended test | pairs right |");
    println!("|---|---|---|---|---|");
    let mut figure = Figure::new(
        "Each dot a robot: sigma of its 5 + 5 runs against what a 10 mm bump does to it",
        "turn by one bump of 10 mm [deg]",
        "sigma [mm]",
        [0.2, 1.1],
        [0.0, 140.0],
    );
    for (index, (name, rate, height)) in FLOORS.into_iter().enumerate() {
        let equal_slip = index == 3;
        let scored: Vec<Scored> =
            (0..robots).into_par_iter().map(|robot| score(study.seed, robot, rate, height, equal_slip)).collect();
        let of = |which: fn(&Scored) -> f64| scored.iter().map(which).collect::<Vec<f64>>();
        let (truth, sigma, extended) = (of(|s| s.susceptibility), of(|s| s.sigma), of(|s| s.extended));
        let told = |numbers: &[f64]| {
            let [rho, low, high] = rank_correlation(&truth, numbers);
            format!("{rho:.2} ({low:.2} to {high:.2}) | {:.0} %", 100.0 * pairs_alike(&truth, numbers))
        };
        println!("| {name} | {} | {} |", told(&sigma), told(&extended));
        if index == 1 || index == 3 {
            let dots: Vec<(f64, f64)> =
                truth.iter().zip(&sigma).map(|(t, s)| (t.to_degrees(), (1e3 * s).min(140.0))).collect();
            figure.dots(&dots, COLOURS[usize::from(index == 3)], name);
        }
    }
    figure.save(study.folder, "susceptibility.svg");
    println!();
}

fn score(seed: u64, number: u64, rate: f64, height: f64, equal_slip: bool) -> Scored {
    let mut stream = Stream::new(seed, 100, number);
    let mut between = |low: f64, high: f64| low + (high - low) * stream.uniform();
    let (wheelbase, radius) = (between(0.25, 0.60), between(0.05, 0.12));
    // Slip turns a robot by k/b: drawn as a turn, so that it has nothing to do with the wheelbase.
    let slip = wheelbase * if equal_slip { 1e-3 } else { between(0.6e-3, 4e-3) };
    let drive = DifferentialDrive::new(wheelbase, 2.0 * radius, 2.0 * radius).unwrap();
    let robot = Robot { name: "drawn".into(), drive, encoder: Encoder::new(2000.0, None, None).unwrap() };
    let mut model = Model::new(&robot);
    for (effect, parameter, value) in [
        ("wheel_noise", "k_sqrt_m", slip),
        ("bumps", "rate_per_m", rate),
        ("bumps", "height_m", height),
        ("bumps", "wheel_radius_m", radius),
        ("placed_bumps", "count", 10.0),
        ("placed_bumps", "wheel_radius_m", radius),
    ] {
        model.set(effect, parameter, value).unwrap();
    }
    let mut simulator = Simulator::new(&robot, &Path::umbmark(), Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, seed, number);
    let mut drive = |test: TestKind| {
        let mut returned = Direction::BOTH.map(|_| vec![ReturnError::default(); 5]);
        simulator.test(&mut truth, test, returned.each_mut().map(Vec::as_mut_slice));
        returned
    };
    let (regular, bumped) = (drive(TestKind::Systematic), drive(TestKind::Bumps));
    let extended = Extended::new(bumped.each_ref().map(Vec::as_slice), regular.each_ref().map(Vec::as_slice), 0.95);
    Scored {
        susceptibility: extra_travel(0.010, radius, true) / wheelbase,
        sigma: summarise(&regular[0], &regular[1]).sigma_axis().unwrap(),
        extended: extended.unwrap().orientation(Convention::Mean),
    }
}
