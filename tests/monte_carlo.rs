//! Ensembles held against theory and against themselves.

use std::ops::ControlFlow;

use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{Distribution, Draw, Ensemble, Metric, Study};
use umbmark_core::simulate::Odometry;

fn study(values: &[(&str, &str, f64)], trials: u64) -> Study {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in values {
        model.set(effect, parameter, *value).unwrap();
    }
    Study::new(model, trials, 20)
}

fn run(study: &Study) -> Ensemble {
    study.run(|_| ControlFlow::Continue(())).unwrap()
}

/// Wheel noise k on a square of side L: each side adds a heading noise of variance 2k²(L + turn)/b², so the variance of the
/// mean return heading of n runs is 4 · that / n. Seed 20, 4000 trials: the ratio of standard deviations is within 4 of its
/// own standard errors, 1/√(2·4000) = 1.1 %.
#[test]
fn the_scatter_of_the_return_heading_is_that_of_theory() {
    let k = 1e-3;
    let ensemble = run(&study(&[("wheel_noise", "k_sqrt_m", k)], 4000));
    let b = 0.340;
    let rolled = 4.0 + 0.25 * std::f64::consts::PI * b;
    let expected = (4.0 * 2.0 * k * k * rolled / (b * b) / 5.0).sqrt();
    for metric in [Metric::ReturnHeadingCw, Metric::ReturnHeadingCcw] {
        let s = ensemble.get(metric).unwrap();
        assert!((s.std_dev() / expected - 1.0).abs() < 4.0 * 0.0112, "{} {expected}", s.std_dev());
        assert!(s.mean().abs() < 4.0 * s.std_error());
    }
}

/// Noise does not move the means beyond its second order, and sigma is about the paper's 50 mm.
#[test]
fn wheel_noise_leaves_the_centroids_and_gives_the_papers_scatter() {
    let systematic = [("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 337.2 / 340.0)];
    let noisy = run(&study(&[&systematic[..], &[("wheel_noise", "k_sqrt_m", 1e-3)]].concat(), 4000));
    let quiet = run(&study(&systematic, 50));
    for metric in [Metric::CentroidCwX, Metric::CentroidCwY, Metric::CentroidCcwX, Metric::CentroidCcwY] {
        let (a, b) = (noisy.get(metric).unwrap(), quiet.get(metric).unwrap());
        // Second order: 16 m at a heading scatter of a degree shorten the path by a millimetre or two.
        assert!((a.mean() - b.mean()).abs() < 4.0 * a.std_error() + 2e-3, "{metric:?}: {} {}", a.mean(), b.mean());
    }
    let sigma = noisy.get(Metric::Sigma).unwrap().mean();
    assert!((0.031..0.060).contains(&sigma), "{sigma}");
}

/// Without noise, E_max,sys is that of Table I, to the quantisation of the encoders.
#[test]
fn a_quiet_ensemble_is_table_one() {
    let quiet = run(&study(&[("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 337.2 / 340.0)], 200));
    let e_max = quiet.get(Metric::EMaxSys).unwrap();
    assert!((e_max.mean() * 1e3 - 305.6).abs() < 1.0, "{}", e_max.mean());
    assert!(e_max.std_dev() < 1.4e-3);
    assert!(quiet.get(Metric::NonsysOrientation).is_none());
}

#[test]
fn ten_bumps_turn_the_robot_by_ten_times_one_bump() {
    let ensemble = run(&study(&[("placed_bumps", "count", 10.0), ("wheelbase", "e_b", 1.01)], 100));
    let degrees = ensemble.get(Metric::NonsysOrientation).unwrap().mean().to_degrees();
    // Each bump turns by D/(b E_b); Eq. (5) takes the systematic part away.
    assert!((degrees - 10.0 * 0.5729 / 1.01).abs() < 0.02, "{degrees}");
}

/// The fast product over the word and ticking one by one, trial by trial: the same to a nanometre.
#[test]
fn whole_trials_by_the_word_and_one_by_one_agree() {
    let fast = study(&[("wheel_noise", "k_sqrt_m", 1e-3), ("wheelbase", "e_b", 1.01)], 6);
    let slow = Study { odometry: Odometry::EveryTickOneByOne, ..fast.clone() };
    let rows = |study: &Study| {
        let mut rows = Vec::new();
        study
            .run(|batch| {
                rows.extend_from_slice(batch.rows);
                ControlFlow::Continue(())
            })
            .unwrap();
        rows
    };
    for (a, b) in rows(&fast).into_iter().zip(rows(&slow)) {
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{a:?} {b:?}");
    }
}

/// A parameter drawn per trial spreads the metric as its derivative says: dE_max/dE_b by difference.
#[test]
fn a_drawn_wheelbase_spreads_e_max_sys_by_its_derivative() {
    let at = |e_b: f64| run(&study(&[("wheelbase", "e_b", e_b)], 1)).get(Metric::EMaxSys).unwrap().mean();
    let slope = (at(1.011) - at(1.009)) / 2e-3;
    let sd = 5e-4;
    let mut drawn = study(&[("wheelbase", "e_b", 1.01)], 4000);
    drawn.draws.push(Draw::new("wheelbase", "e_b", Distribution::Normal { mean: 1.01, sd }).unwrap());
    let spread = run(&drawn).get(Metric::EMaxSys).unwrap().std_dev();
    assert!((spread / (slope.abs() * sd) - 1.0).abs() < 0.06, "{spread} {slope}");
}
