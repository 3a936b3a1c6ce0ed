//! The Monte Carlo studies that are measured, each with a fixed seed.

use std::ops::ControlFlow;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::engine::Update;
use umbmark_core::monte_carlo::{Distribution, Draw, Ensemble, Study};
use umbmark_core::path::{Path, SQUARE, SpeedProfile};
use umbmark_core::simulate::Odometry;

/// The seed of every study.
pub const SEED: u64 = 20_260_101;

/// Events that a run of [`events`] meets on average, both wheels together.
pub const EVENTS_PER_RUN: f64 = 50.0;

/// Way that the two wheels roll together in one run \[m\]: 16 m of legs and four turns of 90° on a wheelbase of 0.34 m.
const ROLLED: f64 = 2.0 * (16.0 + 0.34 * std::f64::consts::PI);

/// How the simulated robots compute their pose.
pub const ODOMETRIES: [(&str, Odometry); 3] =
    [("every tick", Odometry::EveryTick), ("100 Hz", SAMPLED), ("tick by tick", Odometry::EveryTickOneByOne)];

/// Counters read a hundred times a second.
pub const SAMPLED: Odometry = Odometry::Sampled { rate: 100.0, update: Update::Arc };

fn study(values: &[(&str, &str, f64)]) -> Study {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in [("wheel_noise", "k_sqrt_m", 1e-3)].iter().chain(values) {
        model.set(effect, parameter, *value).expect("a value within its bounds");
    }
    let mut study = Study::new(model, 1, SEED);
    for (effect, parameter, mean, sd) in
        [("wheel_diameter_ratio", "e_d", 1.002, 5e-4), ("wheelbase", "e_b", 1.01, 2e-3)]
    {
        let draw = Draw::new(effect, parameter, Distribution::Normal { mean, sd });
        study.draws.push(draw.expect("a parameter of the catalogue"));
    }
    study
}

/// Ten runs with wheel noise, E_d and E_b drawn for every trial.
pub fn plain() -> Study {
    study(&[])
}

/// The same and the extended test besides: ten more runs, each over ten bumps on its first leg.
pub fn ten_bumps() -> Study {
    study(&[("placed_bumps", "count", 10.0)])
}

/// The plain runs, each met by [`EVENTS_PER_RUN`] bumps at random places of both wheels.
pub fn events() -> Study {
    study(&[("bumps", "rate_per_m", EVENTS_PER_RUN / ROLLED), ("bumps", "height_m", 1e-3)])
}

/// The square at so large an acceleration that the speed is constant, 0.2 m/s.
pub fn without_ramps() -> Path {
    let speed = SpeedProfile::new(0.2, 1000.0, 1.0).expect("numbers within their bounds");
    Path::new(&SQUARE, &[4.0], speed).expect("4 m is a side")
}

/// Runs a study on the present rayon pool and keeps its statistics only.
pub fn run(study: &Study) -> Ensemble {
    study.run(|_| ControlFlow::Continue(())).expect("a study that can be driven")
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::monte_carlo::Metric;

    #[test]
    fn each_study_measures_what_its_name_says() {
        let trials = |study: Study| run(&Study { trials: 200, ..study });
        let sd = |ensemble: &Ensemble| ensemble.get(Metric::Sigma).map_or(f64::NAN, |s| s.mean());
        let (plain, events) = (trials(plain()), trials(events()));
        assert!((0.02..0.2).contains(&sd(&plain)), "{}", sd(&plain));
        assert!(sd(&events) > sd(&plain));
        assert!(plain.get(Metric::NonsysOrientation).is_none());
        let turned = trials(ten_bumps());
        let degrees = turned.get(Metric::NonsysOrientation).map(|s| s.mean().to_degrees());
        assert!(degrees.is_some_and(|degrees| (4.0..8.0).contains(&degrees)), "{degrees:?}");
    }
}
