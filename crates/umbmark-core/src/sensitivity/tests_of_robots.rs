//! Whole UMBmark tests as a function of the numbers that decide them.

use super::{Evaluator, Input, Response, SensitivityError};
use crate::dataset::ReturnError;
use crate::monte_carlo::{Bench, Distribution, Metric, NoiseFree, Quantity, Row, Study, StudyError, row};
use crate::score::summarise;

/// What is made of the noise of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Whole tests are simulated: wheel noise, bumps, quantisation and misplacement are one more input.
    Simulated,
    /// None: the return of exact kinematics, without noise, bumps and quantisation. There is then no sigma and no orientation
    /// error of bumps, and encoders do not matter.
    Absent,
}

/// The metrics of whole UMBmark tests, as a function of some of the numbers that decide them.
#[derive(Clone, Debug)]
pub struct Tests {
    study: Study,
    quantities: Vec<Quantity>,
    noise: Noise,
    metrics: Vec<Metric>,
    /// Where the quantities stand among the values of the model, if all are numbers of effects.
    places: Option<Vec<usize>>,
}

impl Tests {
    /// The tests of a study, of which some quantities are varied; numbers that the study draws stand at their middle.
    pub fn new(study: &Study, varied: &[(Quantity, Distribution)], noise: Noise) -> Result<Tests, StudyError> {
        let mut study = study.clone();
        for draw in std::mem::take(&mut study.draws) {
            study.model.set(draw.effect(), draw.parameter().name, draw.centre())?;
        }
        for (quantity, distribution) in varied {
            distribution.check(quantity.parameter())?;
            quantity.set(&mut study, distribution.centre())?;
        }
        let exists = |metric: &Metric| match noise {
            Noise::Simulated => true,
            Noise::Absent => !matches!(metric, Metric::Sigma | Metric::NonsysOrientation),
        };
        let quantities: Vec<Quantity> = varied.iter().map(|(quantity, _)| *quantity).collect();
        let places = quantities.iter().map(|q| study.model.place_of(q.effect()?, q.parameter().name)).collect();
        let metrics = study.metrics().into_iter().filter(exists).collect();
        Ok(Tests { study, quantities, noise, metrics, places })
    }

    /// What varies, as inputs of a response, named by their keys.
    pub fn inputs(varied: &[(Quantity, Distribution)]) -> Vec<Input> {
        let input = |(quantity, distribution): &(Quantity, Distribution)| Input {
            name: quantity.key(),
            distribution: *distribution,
            bounds: quantity.parameter().bounds,
            whole: quantity.is_whole(),
        };
        varied.iter().map(input).collect()
    }

    /// The outputs: the metrics that the test has.
    pub fn metrics(&self) -> &[Metric] {
        &self.metrics
    }

    /// The study with all quantities in the middle of their distributions.
    pub fn study(&self) -> &Study {
        &self.study
    }

    fn with(&self, values: &[f64]) -> Result<Study, StudyError> {
        let mut study = self.study.clone();
        self.quantities.iter().zip(values).try_for_each(|(quantity, value)| quantity.set(&mut study, *value))?;
        Ok(study)
    }

    fn bench(&self, study: &Study) -> Result<Bench, StudyError> {
        Ok(Bench::new(study)?.with_extended_test(self.study.extended()))
    }

    /// What the return errors without noise are as a row.
    fn give_noise_free(&self, runs: [usize; 2], returned: &[ReturnError; 2], outputs: &mut [f64]) {
        let [cw, ccw] = [0, 1].map(|i| if runs[i] > 0 { &returned[i..=i] } else { &[] });
        self.give(&row(&summarise(cw, ccw), f64::NAN), outputs);
    }

    fn give(&self, row: &Row, outputs: &mut [f64]) {
        outputs.iter_mut().zip(&self.metrics).for_each(|(output, metric)| *output = row[*metric as usize]);
    }
}

impl Response for Tests {
    fn outputs(&self) -> usize {
        self.metrics.len()
    }

    fn is_noisy(&self) -> bool {
        self.noise == Noise::Simulated
    }

    fn evaluator(&self) -> Result<Evaluator<'_>, SensitivityError> {
        let seed = self.study.seed;
        Ok(match (self.noise, &self.places) {
            (Noise::Simulated, Some(places)) => {
                let mut bench = self.bench(&self.study)?;
                let mut all: Vec<f64> = self.study.model.values().collect();
                Box::new(move |values, noise, outputs| {
                    places.iter().zip(values).for_each(|(place, value)| all[*place] = *value);
                    self.give(&bench.test_with(&all, seed, noise), outputs);
                    Ok(())
                })
            }
            (Noise::Simulated, None) => Box::new(move |values, noise, outputs| {
                let study = self.with(values)?;
                let all: Vec<f64> = study.model.values().collect();
                self.give(&self.bench(&study)?.test_with(&all, seed, noise), outputs);
                Ok(())
            }),
            (Noise::Absent, Some(places)) => {
                let Study { model, path, runs, .. } = &self.study;
                let mut exact = NoiseFree::new(model, path, model.may_vary());
                let mut all: Vec<f64> = model.values().collect();
                Box::new(move |values, _, outputs| {
                    places.iter().zip(values).for_each(|(place, value)| all[*place] = *value);
                    exact.set_values(&all);
                    self.give_noise_free(*runs, &exact.returned(), outputs);
                    Ok(())
                })
            }
            (Noise::Absent, None) => Box::new(move |values, _, outputs| {
                let study = self.with(values)?;
                self.give_noise_free(study.runs, &study.noise_free()?, outputs);
                Ok(())
            }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use std::ops::ControlFlow;

    fn study() -> Study {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        Study::new(model, 8, 3)
    }

    fn varied(names: &[(&str, f64)]) -> Vec<(Quantity, Distribution)> {
        let study = study();
        let one = |(name, value): &(&str, f64)| {
            let distribution = Distribution::Uniform { min: *value, max: *value };
            (Quantity::find(name, &study).unwrap(), distribution)
        };
        names.iter().map(one).collect()
    }

    fn row_of(tests: &Tests, values: &[f64], noise: u64) -> Vec<f64> {
        let mut outputs = vec![0.0; tests.outputs()];
        tests.evaluator().unwrap()(values, noise, &mut outputs).unwrap();
        outputs
    }

    /// The trials of a study whose numbers are set by hand, to the last bit: by the bench that is kept, where only effects
    /// vary, and by benches made anew.
    #[test]
    fn a_test_with_some_values_is_the_trial_of_a_study_that_has_them() {
        for names in [
            &[("ed", 1.002), ("bumps", 10.0)][..],
            &[("ed", 1.002), ("side", 3.0), ("ticks-per-revolution", 700.0), ("runs", 3.0), ("encoder-rate", 30.0)],
        ] {
            let varied = varied(names);
            let tests = Tests::new(&study(), &varied, Noise::Simulated).unwrap();
            let values: Vec<f64> = names.iter().map(|(_, value)| *value).collect();
            let mut by_hand = study();
            for ((quantity, _), value) in varied.iter().zip(&values) {
                quantity.set(&mut by_hand, *value).unwrap();
            }
            let mut rows = Vec::new();
            by_hand
                .run(|batch| {
                    rows.extend_from_slice(batch.rows);
                    ControlFlow::Continue(())
                })
                .unwrap();
            let columns: Vec<usize> = by_hand.metrics().iter().map(|metric| *metric as usize).collect();
            for (trial, row) in rows.iter().enumerate() {
                let expected: Vec<f64> = columns.iter().map(|column| row[*column]).collect();
                assert_eq!(row_of(&tests, &values, trial as u64), expected, "{names:?} {trial}");
            }
        }
    }

    #[test]
    fn without_noise_the_return_is_that_of_exact_kinematics() {
        let varied = varied(&[("ed", 1.00121), ("eb", 337.2 / 340.0)]);
        let tests = Tests::new(&study(), &varied, Noise::Absent).unwrap();
        assert_eq!(tests.metrics()[0], Metric::EMaxSys);
        assert!(!tests.metrics().contains(&Metric::Sigma));
        let row = row_of(&tests, &[1.00121, 337.2 / 340.0], 5);
        let anew = self::varied(&[("ed", 1.00121), ("eb", 337.2 / 340.0), ("side", 4.0)]);
        let made_anew = Tests::new(&study(), &anew, Noise::Absent).unwrap();
        assert_eq!(row_of(&made_anew, &[1.00121, 337.2 / 340.0, 4.0], 5), row);
        assert!((row[0] - 0.3056).abs() < 1e-4 && row == row_of(&tests, &[1.00121, 337.2 / 340.0], 6), "{row:?}");
    }
}
