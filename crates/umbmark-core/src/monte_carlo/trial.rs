//! One trial on one thread.

use super::{Draw, Metric, Row, Study, StudyError};
use crate::dataset::ReturnError;
use crate::effect::{Model, ModelError, Part, TestKind};
use crate::random::Stream;
use crate::score::{self, Cluster, Convention, Summary, nonsystematic_orientation};
use crate::simulate::{Simulator, Truth};

/// Purpose of the stream that parameters are drawn from.
const PARAMETERS: u64 = 3;

/// The model of one trial: `model` with every drawn parameter drawn.
pub fn draw_parameters(model: &Model, draws: &[Draw], seed: u64, trial: u64) -> Result<Model, StudyError> {
    let centred = centred(model, draws)?;
    let mut drawn = centred.clone();
    let mut stream = Stream::new(seed, PARAMETERS, trial);
    for draw in centred.parts().iter().flat_map(|part| draws_of(part, draws)).flatten() {
        drawn.set(draw.effect(), draw.parameter().name, draw.draw(&mut stream))?;
    }
    Ok(drawn)
}

/// `model` with every drawn parameter in the middle of its distribution.
pub(super) fn centred(model: &Model, draws: &[Draw]) -> Result<Model, ModelError> {
    let mut centred = model.clone();
    for draw in draws {
        centred.set(draw.effect(), draw.parameter().name, draw.centre())?;
    }
    Ok(centred)
}

/// For each parameter of a part, in order, its draw if it has one.
fn draws_of<'a>(part: &'a Part, draws: &'a [Draw]) -> impl Iterator<Item = Option<&'a Draw>> {
    let effect = part.effect.name();
    part.effect
        .parameters()
        .iter()
        .map(move |p| draws.iter().find(|draw| draw.effect() == effect && draw.parameter().name == p.name))
}

/// What a thread needs to run trials, allocated once.
pub(crate) struct Bench {
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
    pub(crate) fn new(study: &Study) -> Result<Bench, StudyError> {
        let model = centred(&study.model, &study.draws)?;
        let all = model.parts().iter().flat_map(|part| draws_of(part, &study.draws));
        let draws = all.enumerate().filter_map(|(index, draw)| Some((index, draw?.clone()))).collect();
        let room = |n: usize| vec![ReturnError::default(); n];
        Ok(Bench {
            simulator: Simulator::new(study.robot(), &study.path, study.odometry, study.phase)?
                .limited_to(study.instructions),
            truth: Truth::new(&model).limited_to(study.instructions),
            values: model.values().collect(),
            draws,
            extended: study.extended(),
            returned: study.runs.map(room),
            bumped: study.runs.map(room),
        })
    }

    /// The same, with or without the extended test.
    pub(crate) fn with_extended_test(self, extended: bool) -> Bench {
        Bench { extended, ..self }
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
        self.test(seed, trial)
    }

    /// The metrics of a test of a robot with these values of all parameters, with the noise of trial number `trial`.
    pub(crate) fn test_with(&mut self, values: &[f64], seed: u64, trial: u64) -> Row {
        self.truth.set_values(values);
        self.test(seed, trial)
    }

    fn test(&mut self, seed: u64, trial: u64) -> Row {
        self.simulator.open(&mut self.truth, seed, trial);
        let places = self.returned.each_mut().map(Vec::as_mut_slice);
        self.simulator.test(&mut self.truth, TestKind::Systematic, places);
        let [cw, ccw] = &self.returned;
        let summary = score::summarise(cw, ccw);
        let nonsystematic =
            if self.extended { self.extended_test(heading(summary.cw), heading(summary.ccw)) } else { f64::NAN };
        row(&summary, nonsystematic)
    }

    /// The runs with bumps, and Eq. (5) over them.
    fn extended_test(&mut self, heading_cw: f64, heading_ccw: f64) -> f64 {
        let places = self.bumped.each_mut().map(Vec::as_mut_slice);
        self.simulator.test(&mut self.truth, TestKind::Bumps, places);
        let [cw, ccw] = &self.bumped;
        nonsystematic_orientation(cw, ccw, heading_cw, heading_ccw, Convention::Mean).unwrap_or(f64::NAN)
    }
}

/// The metrics of a test, from its regular runs and the orientation error of its bumped ones.
pub(crate) fn row(summary: &Summary, nonsystematic: f64) -> Row {
    let centroid = |cluster: Option<Cluster>| cluster.map_or([f64::NAN; 2], |c| [c.x, c.y]);
    Metric::ALL.map(|metric| match metric {
        Metric::EMaxSys => summary.e_max_sys().unwrap_or(f64::NAN),
        Metric::Sigma => summary.sigma_axis().unwrap_or(f64::NAN),
        Metric::CentroidCwX => centroid(summary.cw)[0],
        Metric::CentroidCwY => centroid(summary.cw)[1],
        Metric::CentroidCcwX => centroid(summary.ccw)[0],
        Metric::CentroidCcwY => centroid(summary.ccw)[1],
        Metric::ReturnHeadingCw => heading(summary.cw),
        Metric::ReturnHeadingCcw => heading(summary.ccw),
        Metric::NonsysOrientation => nonsystematic,
    })
}

/// Mean return heading error of a cluster; every simulated run has one.
fn heading(cluster: Option<Cluster>) -> f64 {
    cluster.and_then(|c| c.heading).unwrap_or(f64::NAN)
}
