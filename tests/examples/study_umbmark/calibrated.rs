//! How much of the 26 and 20 mm of the calibrated LabMates of Table I is noise.

use crate::figure::{COLOURS, Figure};
use crate::shares::{quantile, share};
use crate::{Study, labmate};
use rayon::prelude::*;
use umbmark_core::calibrate::{Correction, Method, Options, calibrate};
use umbmark_core::dataset::{Dataset, ReturnError, Run};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::path::{Direction, Path};
use umbmark_core::plan::Setting;
use umbmark_core::score::{Scatter, e_max_sys_interval, summarise};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

/// Published: name, E_max,sys \[m\], sigma \[m\], and E_d and E_b before calibration with their sigma.
const TABLE_I: [(&str, f64, f64, [f64; 3]); 2] = [
    ("TRC-nomod/docal", 0.026, 0.032, [1.001_21, 337.2 / 340.0, 0.050]),
    ("TRC-3loop/docal", 0.020, 0.049, [1.002_03, 337.1 / 340.0, 0.031]),
];

/// Prints what chance alone reads, draws it.
pub fn study(study: &Study) {
    let tests = study.tests(20_000);
    println!("## The calibrated robots of Table I: {tests} tests of 5 + 5 runs each\n");
    println!(
        "| robot (published) | sigma is | robot | median reads [mm] | 5 to 95 % [mm] | reads as much or more | as little or less |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut figure = Figure::new(
        "E_max,sys of robots calibrated perfectly: chance alone (marks: published)",
        "E_max,sys reads [mm]",
        "tests a millimetre [%]",
        [0.0, 80.0],
        [0.0, 6.0],
    );
    for (index, (name, e_max, sigma, before)) in TABLE_I.into_iter().enumerate() {
        for (meaning, factor) in [("of one coordinate", 1.0), ("of the distance", std::f64::consts::FRAC_1_SQRT_2)] {
            let k = noise(sigma * factor);
            let perfect: Vec<f64> =
                (0..tests).into_par_iter().map(|t| read(&labmate(1.0, 1.0, k), study.seed, t)).collect();
            say(name, e_max, sigma, meaning, "perfect", &perfect);
            if factor == 1.0 {
                let colour = COLOURS[index];
                figure.curve(&density(&perfect), colour, &format!("{name}, sigma {:.0} mm", 1e3 * sigma));
                figure.mark(1e3 * e_max, colour, "");
            }
            let k_before = noise(before[2] * factor);
            let own = |t: u64| read(&calibrated(before, k_before, k, study.seed, t), study.seed, t + tests);
            let calibrated: Vec<f64> = (0..study.tests(4000)).into_par_iter().map(own).collect();
            say(name, e_max, sigma, meaning, "calibrated by 5 + 5 runs", &calibrated);
        }
    }
    figure.save(study.folder, "calibrated.svg");
    println!();
    for (name, e_max, sigma, _) in TABLE_I {
        let interval = interval(e_max, sigma);
        println!(
            "{name}: 95 % interval of the robot's own E_max,sys: {:.0} to {:.0} mm",
            1e3 * interval[0],
            1e3 * interval[1]
        );
    }
}

fn say(name: &str, e_max: f64, sigma: f64, meaning: &str, robot: &str, reads: &[f64]) {
    let mm = |p: f64| 1e3 * quantile(reads, p);
    let above = reads.iter().filter(|r| **r >= e_max).count();
    println!(
        "| {name} ({:.0} mm, sigma {:.0} mm) | {meaning} | {robot} | {:.1} | {:.1} to {:.1} | {} | {} |",
        1e3 * e_max,
        1e3 * sigma,
        mm(0.5),
        mm(0.05),
        mm(0.95),
        share(above, reads.len()),
        share(reads.len() - above, reads.len())
    );
}

/// k \[m^0.5\] of the wheel noise that gives a sigma of one coordinate on the paper's square: they are proportional.
fn noise(sigma: f64) -> f64 {
    let setting = Setting::new(&Path::umbmark(), &labmate(1.0, 1.0, 1e-3), 1).unwrap();
    1e-3 * sigma / setting.sigma()
}

fn returns(model: &Model, seed: u64, test: u64) -> [Vec<ReturnError>; 2] {
    let mut simulator = Simulator::new(model.robot(), &Path::umbmark(), Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(model);
    simulator.open(&mut truth, seed, test);
    let mut returned = Direction::BOTH.map(|_| vec![ReturnError::default(); 5]);
    simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(Vec::as_mut_slice));
    returned
}

/// E_max,sys as one test reads it \[m\].
fn read(model: &Model, seed: u64, test: u64) -> f64 {
    let [cw, ccw] = returns(model, seed, test);
    summarise(&cw, &ccw).e_max_sys().unwrap()
}

/// The robot after a calibration by one test: what is left of its errors.
fn calibrated([e_d, e_b, _]: [f64; 3], k_before: f64, k: f64, seed: u64, test: u64) -> Model {
    let model = labmate(e_d, e_b, k_before);
    let returned = returns(&model, seed, test);
    let of = |direction: Direction| {
        returned[direction as usize].iter().zip(1..).map(move |(error, number)| Run {
            name: format!("{}_{number}", direction.name()),
            number,
            direction: Some(direction),
            test: TestKind::Systematic,
            log: None,
            returned: Some(*error),
        })
    };
    let data = Dataset {
        robot: Some(model.robot().clone()),
        path: Some(Path::umbmark()),
        runs: Direction::BOTH.into_iter().flat_map(of).collect(),
        ..Dataset::default()
    };
    let calibration = calibrate(&data, &Options::default()).unwrap();
    let Correction { e_d: found_d, e_b: found_b, .. } = calibration.estimate(Method::Exact).unwrap().correction;
    labmate(e_d / found_d, e_b / found_b, k)
}

/// Share of tests in each millimetre \[%\].
fn density(reads: &[f64]) -> Vec<(f64, f64)> {
    const WIDTH: usize = 2;
    let of = |low: usize| {
        let inside = reads.iter().filter(|r| (low..low + WIDTH).contains(&((1e3 * **r) as usize))).count();
        ((low + WIDTH / 2) as f64, 100.0 * inside as f64 / reads.len() as f64 / WIDTH as f64)
    };
    (0..80).step_by(WIDTH).map(of).collect()
}

/// The interval of a test that read exactly this, one direction at E_max,sys along x and the other at START, its scatter that of
/// wheel noise.
fn interval(e_max: f64, sigma: f64) -> [f64; 2] {
    let truth = labmate(1.0, 1.0, 1e-3);
    let setting = Setting::new(&Path::umbmark(), &truth, 1).unwrap().with_sigma(sigma);
    let runs = umbmark_core::plan::expected_dataset(&setting, 5);
    let shifted = |direction: Direction, by: f64| -> Vec<ReturnError> {
        let runs = runs.runs.iter().filter(|run| run.direction == Some(direction));
        runs.filter_map(|run| run.returned).map(|e| ReturnError { x: e.x + by, ..e }).collect()
    };
    let (cw, ccw) = (shifted(Direction::Cw, e_max), shifted(Direction::Ccw, 0.0));
    let summary = summarise(&cw, &ccw);
    let scatter = Scatter::pooled(&cw, &ccw).unwrap();
    let interval = e_max_sys_interval(&summary.cw.unwrap(), &summary.ccw.unwrap(), &scatter, 0.95);
    [interval.low, interval.high]
}
