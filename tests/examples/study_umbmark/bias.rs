//! How E_max,sys depends on the number of runs: the larger of two noisy distances is too long on average.

use crate::figure::{COLOURS, Figure};
use crate::{Study, labmate};
use std::ops::ControlFlow;
use umbmark_core::monte_carlo::{self, Metric};

const RUNS: [usize; 10] = [1, 2, 3, 4, 5, 7, 10, 15, 20, 30];

/// E_d and E_b of four robots: perfect, two well calibrated ones (E_b alone), and the uncalibrated LabMate.
const ROBOTS: [(&str, f64, f64); 4] =
    [("perfect", 1.0, 1.0), ("26 mm", 1.0, 1.001_46), ("100 mm", 1.0, 1.005_63), ("LabMate", 1.001_21, 337.2 / 340.0)];

/// Prints bias and spread, draws both.
pub fn study(study: &Study) {
    let tests = study.tests(20_000);
    println!("## E_max,sys against n: {tests} tests each, sigma 45 mm (k = 1e-3 m^0.5)\n");
    println!("| robot | true [mm] | n | mean reads [mm] | bias [mm] | std dev [mm] | 5 % [mm] | 95 % [mm] |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut figure = Figure::new(
        "What E_max,sys reads too much on average (band: 5 to 95 % of tests of the 26 mm robot)",
        "runs in each direction",
        "read - true [mm]",
        [1.0, 30.0],
        [-40.0, 120.0],
    );
    for ((name, e_d, e_b), colour) in ROBOTS.into_iter().zip(COLOURS) {
        let (mut line, mut low, mut high) = (Vec::new(), Vec::new(), Vec::new());
        for n in RUNS {
            let model = labmate(e_d, e_b, 1e-3);
            let plan = monte_carlo::Study { runs: [n, n], ..monte_carlo::Study::new(model, tests, study.seed) };
            let truth = plan.noise_free().unwrap().iter().map(|e| e.x.hypot(e.y)).fold(0.0, f64::max);
            let ensemble = plan.run(|_| ControlFlow::Continue(())).unwrap();
            let e_max = ensemble.get(Metric::EMaxSys).unwrap();
            let [mean, sd, error, q05, q95] =
                [e_max.mean(), e_max.std_dev(), e_max.std_error(), e_max.quantile(0.05), e_max.quantile(0.95)]
                    .map(|v| 1e3 * v);
            let truth = 1e3 * truth;
            let half = 1.96 * error;
            println!(
                "| {name} | {truth:.1} | {n} | {mean:.1} | {:+.1} ± {half:.1} | {sd:.1} | {q05:.1} | {q95:.1} |",
                mean - truth
            );
            line.push((n as f64, mean - truth));
            low.push((n as f64, q05 - truth));
            high.push((n as f64, q95 - truth));
        }
        if name == "26 mm" {
            figure.band(&low, &high, colour);
        }
        figure.curve(&line, colour, name);
    }
    figure.save(study.folder, "bias.svg");
    println!();
}
