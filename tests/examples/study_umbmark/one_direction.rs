//! How often a test in one direction passes a bad robot.

use crate::Study;
use crate::figure::{COLOURS, Figure};
use crate::labmate;
use crate::shares::{quantile, share};
use rayon::prelude::*;
use umbmark_core::dataset::ReturnError;
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::monte_carlo;
use umbmark_core::path::{Direction, Path};
use umbmark_core::random::Stream;
use umbmark_core::score::Cluster;
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

/// Spread of E_d and E_b over robots as they come: the LabMate's size.
const SPREAD: [f64; 2] = [1.2e-3, 8e-3];

/// E_d - 1 that a unit of E_b - 1 hides in ccw runs.
const E_D_PER_E_B: f64 = 1.0 / 7.49;

struct Tested {
    /// E_max,sys of the robot itself \[m\].
    truth: f64,
    /// Distance of the centre of gravity of five ccw runs \[m\].
    one_way: f64,
    /// E_max,sys as five and five runs read it \[m\].
    both_ways: f64,
}

/// Prints how many bad robots pass, draws both tests.
pub fn study(study: &Study) {
    let robots = study.tests(20_000);
    println!("## Bad robots that pass: {robots} robots each, sigma 45 mm\n");
    println!(
        "A robot passes if 5 ccw runs (or UMBmark, 5 + 5) read less than the limit; it is bad if its own E_max,sys is twice the limit or more.\n"
    );
    println!("| robots | limit [mm] | bad | pass in one direction | pass UMBmark |");
    println!("|---|---|---|---|---|");
    let as_they_come: Vec<Tested> = (0..robots).into_par_iter().map(|r| tested(study.seed, r, false)).collect();
    let tuned: Vec<Tested> = (0..robots).into_par_iter().map(|r| tested(study.seed, r, true)).collect();
    for (name, all) in [("as they come", &as_they_come), ("tuned until ccw runs close", &tuned)] {
        for limit in [0.05, 0.1] {
            let bad: Vec<&Tested> = all.iter().filter(|t| t.truth >= 2.0 * limit).collect();
            let passing = |which: fn(&Tested) -> f64| bad.iter().filter(|t| which(t) < limit).count();
            println!(
                "| {name} | {:.0} | {} of {robots} | {} | {} |",
                1e3 * limit,
                bad.len(),
                share(passing(|t| t.one_way), bad.len()),
                share(passing(|t| t.both_ways), bad.len())
            );
        }
    }
    let truths: Vec<f64> = tuned.iter().map(|t| 1e3 * t.truth).collect();
    let seen: Vec<f64> = tuned.iter().map(|t| 1e3 * t.one_way).collect();
    println!(
        "\ntuned in ccw runs: they read {:.0} mm (median), 95 % below {:.0} mm; the robots' own E_max,sys is {:.0} mm (median), 5 % above {:.0} mm\n",
        quantile(&seen, 0.5),
        quantile(&seen, 0.95),
        quantile(&truths, 0.5),
        quantile(&truths, 0.95)
    );
    let mut figure = Figure::new(
        "Each dot a robot: what five ccw runs read, and how bad it is",
        "E_max,sys of the robot itself [mm]",
        "five ccw runs read [mm]",
        [0.0, 700.0],
        [0.0, 700.0],
    );
    for (all, colour, name) in
        [(&as_they_come, COLOURS[0], "as they come"), (&tuned, COLOURS[1], "tuned until ccw runs close")]
    {
        let dots = all.iter().take(300).map(|t| (1e3 * t.truth, 1e3 * t.one_way));
        let inside: Vec<(f64, f64)> = dots.filter(|(x, y)| *x < 700.0 && *y < 700.0).collect();
        figure.dots(&inside, colour, name);
    }
    figure.save(study.folder, "one_direction.svg");
}

/// A robot drawn at random, tested both ways; `tuned`: its wheelbase set in software so that its ccw runs would close.
fn tested(seed: u64, number: u64, tuned: bool) -> Tested {
    let mut stream = Stream::new(seed, 101, number);
    let e_d = 1.0 + SPREAD[0] * stream.normal();
    let e_b = if tuned { 1.0 + (e_d - 1.0) / E_D_PER_E_B } else { 1.0 + SPREAD[1] * stream.normal() };
    let model: Model = labmate(e_d, e_b, 1e-3);
    let plan = monte_carlo::Study::new(model.clone(), 1, seed);
    let distances = plan.noise_free().unwrap().map(|e| e.x.hypot(e.y));
    let mut simulator = Simulator::new(model.robot(), &Path::umbmark(), Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, seed, number);
    let mut returned = Direction::BOTH.map(|_| vec![ReturnError::default(); 5]);
    simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(Vec::as_mut_slice));
    let [cw, ccw] = returned.map(|errors| Cluster::of(&errors).unwrap().distance());
    Tested { truth: distances[0].max(distances[1]), one_way: ccw, both_ways: cw.max(ccw) }
}
