//! The cloud of returns of simulated tests, for sliders: the same tests as those of `mc`.

use std::ops::ControlFlow;

use serde::Deserialize;
use serde_json::{Value, json};
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{Metric, Study};
use umbmark_core::path::{Path, SQUARE};
use umbmark_core::result::{self, NoiseFree, Told};

use crate::bench::Trouble;

/// Tests at most.
const MAX_TRIALS: u64 = 100_000;

/// What is simulated.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Ratio of the wheel diameters.
    pub e_d: f64,
    /// Ratio of actual to nominal wheelbase.
    pub e_b: f64,
    /// Noise of the wheels \[m^0.5\].
    pub noise: f64,
    /// Side of the square \[m\].
    pub side: f64,
    /// Runs each way of a test.
    pub runs: usize,
    /// Tests.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Asked {
    /// The study of `umbmark mc` with these numbers.
    pub fn study(&self) -> Result<Study, Trouble> {
        let mut model = Model::new(&Robot::labmate());
        let values = [
            ("wheel_diameter_ratio", "e_d", self.e_d),
            ("wheelbase", "e_b", self.e_b),
            ("wheel_noise", "k_sqrt_m", self.noise),
        ];
        for (effect, parameter, value) in values {
            model.set(effect, parameter, value).map_err(Trouble::because)?;
        }
        let path = Path::new(&SQUARE, &[self.side], Path::umbmark().speed).map_err(Trouble::because)?;
        if self.trials > MAX_TRIALS {
            return Err(Trouble(format!("At most {MAX_TRIALS} tests are drawn.")));
        }
        Ok(Study { path, runs: [self.runs; 2], ..Study::new(model, self.trials, self.seed) })
    }

    /// Centres of the returns of each test \[0.01 mm\], and the statistics of all tests.
    pub fn cloud(&self) -> Result<Value, Trouble> {
        let study = self.study()?;
        let places = [Metric::CentroidCwX, Metric::CentroidCwY, Metric::CentroidCcwX, Metric::CentroidCcwY];
        let mut columns = places.map(|_| Vec::new());
        let column = |metric: Metric| Metric::ALL.iter().position(|own| *own == metric).unwrap_or(0);
        let ensemble = study.run(|batch| {
            for row in batch.rows {
                for (values, metric) in columns.iter_mut().zip(places) {
                    values.push((1e5 * row[column(metric)]).round() as i64);
                }
            }
            ControlFlow::Continue(())
        });
        let ensemble = ensemble.map_err(Trouble::because)?;
        let noise_free = NoiseFree::of(&study).map_err(Trouble::because)?;
        let told = result::Study::new(&study, &noise_free, &Told::default());
        let said = result::MonteCarlo::new(&ensemble, study.seed, false, None, &told);
        let [cw_x, cw_y, ccw_x, ccw_y] = columns;
        let command = format!(
            "umbmark mc --ed {} --eb {} --wheel-noise {} --side {} --runs {} -n {} --seed {}",
            self.e_d, self.e_b, self.noise, self.side, self.runs, self.trials, self.seed
        );
        Ok(
            json!({ "cw": { "x": cw_x, "y": cw_y }, "ccw": { "x": ccw_x, "y": ccw_y }, "result": said, "command": command }),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Asked {
        Asked { e_d: 1.002, e_b: 1.01, noise: 0.001, side: 4.0, runs: 5, trials: 300, seed: 1 }
    }

    #[test]
    fn a_cloud_has_a_place_for_each_test_and_their_mean_is_that_of_the_statistics() {
        let cloud = some().cloud().unwrap();
        let x: Vec<f64> = serde_json::from_value(cloud["cw"]["x"].clone()).unwrap();
        assert_eq!(x.len(), 300);
        let mean = 1e-5 * x.iter().sum::<f64>() / 300.0;
        let told = cloud["result"]["metrics"]["centroid_cw_x_m"]["mean"].as_f64().unwrap();
        assert!((mean - told).abs() < 1e-5, "{mean} {told}");
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_with_the_reason() {
        let told = |asked: Asked| asked.cloud().unwrap_err().to_string();
        assert!(told(Asked { e_d: 0.0, ..some() }).contains("e_d must be"));
        assert!(told(Asked { side: -1.0, ..some() }).contains("must be"));
        assert!(told(Asked { trials: 100_001, ..some() }).contains("100000"));
        assert!(told(Asked { noise: f64::NAN, ..some() }).contains("must be"));
        assert!(told(Asked { runs: 0, ..some() }).contains("must be"));
    }
}
