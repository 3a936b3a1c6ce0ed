//! One trial on one thread.

use super::{Draw, Metric, Row, Study, StudyError};
use crate::dataset::ReturnError;
use crate::effect::TestKind;
use crate::path::Direction;
use crate::random::Stream;
use crate::score::{self, Cluster, Convention, nonsystematic_orientation};
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
        let (heading_cw, heading_ccw) = (heading(summary.cw), heading(summary.ccw));
        let nonsystematic = if self.extended { self.extended_test(heading_cw, heading_ccw) } else { f64::NAN };
        let centroid = |cluster: Option<Cluster>| cluster.map_or([f64::NAN; 2], |c| [c.x, c.y]);
        Metric::ALL.map(|metric| match metric {
            Metric::EMaxSys => summary.e_max_sys().unwrap_or(f64::NAN),
            Metric::Sigma => summary.sigma_axis().unwrap_or(f64::NAN),
            Metric::CentroidCwX => centroid(summary.cw)[0],
            Metric::CentroidCwY => centroid(summary.cw)[1],
            Metric::CentroidCcwX => centroid(summary.ccw)[0],
            Metric::CentroidCcwY => centroid(summary.ccw)[1],
            Metric::ReturnHeadingCw => heading_cw,
            Metric::ReturnHeadingCcw => heading_ccw,
            Metric::NonsysOrientation => nonsystematic,
        })
    }

    /// The runs with bumps, and Eq. (5) over them.
    fn extended_test(&mut self, heading_cw: f64, heading_ccw: f64) -> f64 {
        for direction in Direction::BOTH {
            for slot in &mut self.bumped[direction as usize] {
                *slot = self.simulator.run(&mut self.truth, direction, TestKind::Bumps);
            }
        }
        let [cw, ccw] = &self.bumped;
        nonsystematic_orientation(cw, ccw, heading_cw, heading_ccw, Convention::Mean).unwrap_or(f64::NAN)
    }
}

/// Mean return heading error of a cluster; every simulated run has one.
fn heading(cluster: Option<Cluster>) -> f64 {
    cluster.and_then(|c| c.heading).unwrap_or(f64::NAN)
}
