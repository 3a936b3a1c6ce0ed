//! One trial on one thread.

use super::{Draw, Metric, Row, Study, StudyError};
use crate::dataset::ReturnError;
use crate::effect::TestKind;
use crate::path::Direction;
use crate::random::Stream;
use crate::score;
use crate::simulate::{Simulator, Truth};

/// Purpose of the stream that parameters are drawn from.
const PARAMETERS: u64 = 3;

/// What a thread needs to run trials, allocated once.
pub(super) struct Bench {
    simulator: Simulator,
    truth: Truth,
    /// Values of all parameters of the model; the drawn ones are overwritten in each trial.
    values: Vec<f64>,
    draws: Vec<(usize, Draw)>,
    extended: bool,
    returned: [Vec<ReturnError>; 2],
    bumped: [Vec<ReturnError>; 2],
}

impl Bench {
    pub(super) fn new(study: &Study) -> Result<Bench, StudyError> {
        let mut model = study.model.clone();
        for draw in &study.draws {
            model.set(draw.effect(), draw.parameter().name, draw.centre())?;
        }
        let mut draws = Vec::new();
        let mut index = 0;
        for part in model.parts() {
            for parameter in part.effect.about.parameters {
                let found = study
                    .draws
                    .iter()
                    .find(|draw| draw.effect() == part.effect.about.name && draw.parameter().name == parameter.name);
                draws.extend(found.map(|draw| (index, draw.clone())));
                index += 1;
            }
        }
        let room = |n: usize| vec![ReturnError::default(); n];
        Ok(Bench {
            simulator: Simulator::new(&study.robot, &study.path, study.odometry, study.phase)?,
            truth: Truth::new(&model),
            values: model.values().collect(),
            draws,
            extended: study.extended(),
            returned: study.runs.map(room),
            bumped: study.runs.map(room),
        })
    }

    /// The metrics of trial number `trial`.
    pub(super) fn trial(&mut self, seed: u64, trial: u64) -> Row {
        if !self.draws.is_empty() {
            let mut stream = Stream::new(seed, PARAMETERS, trial);
            for (index, draw) in &self.draws {
                self.values[*index] = draw.draw(&mut stream);
            }
            self.truth.set_values(&self.values);
        }
        self.simulator.open(&mut self.truth, seed, trial);
        for direction in Direction::BOTH {
            for slot in &mut self.returned[direction as usize] {
                *slot = self.simulator.run(&mut self.truth, direction, TestKind::Systematic);
            }
        }
        let [cw, ccw] = &self.returned;
        let summary = score::summarise(cw, ccw);
        let mut row = [0.0; Metric::COUNT];
        for (slot, metric) in row.iter_mut().zip(Metric::ALL) {
            *slot = match metric {
                Metric::EMaxSys => summary.e_max_sys,
                Metric::Sigma => summary.sigma,
                Metric::CentroidCwX => summary.centroid_cw[0],
                Metric::CentroidCwY => summary.centroid_cw[1],
                Metric::CentroidCcwX => summary.centroid_ccw[0],
                Metric::CentroidCcwY => summary.centroid_ccw[1],
                Metric::ReturnHeadingCw => summary.heading_cw,
                Metric::ReturnHeadingCcw => summary.heading_ccw,
                Metric::NonsysOrientation => 0.0,
            };
        }
        if self.extended {
            for direction in Direction::BOTH {
                for slot in &mut self.bumped[direction as usize] {
                    *slot = self.simulator.run(&mut self.truth, direction, TestKind::Bumps);
                }
            }
        }
        row
    }
}
