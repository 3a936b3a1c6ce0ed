//! A test without noise, bumps and quantisation.

use crate::dataset::ReturnError;
use crate::effect::{Chain, Model};
use crate::geometry::Pose2;
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::simulate;

/// The return errors of exact kinematics along a path, for any values of a model.
#[derive(Clone, Debug)]
pub(crate) struct NoiseFree {
    chain: Chain<f64>,
    tracks: [Track; 2],
    ends: [Pose2; 2],
}

impl NoiseFree {
    /// Of a model along a path; in pieces of a centimetre where effects vary along the way.
    pub fn new(model: &Model, path: &Path, varies: bool) -> NoiseFree {
        let track = if varies { Track::in_pieces } else { Track::from_path };
        NoiseFree {
            chain: model.chain(),
            tracks: Direction::BOTH.map(|direction| track(path, direction, model.robot())),
            ends: Direction::BOTH.map(|direction| path.end(direction)),
        }
    }

    /// Takes other values of all parameters.
    pub fn set_values(&mut self, values: &[f64]) {
        self.chain.set_values(values);
    }

    /// The return errors \[cw, ccw\].
    pub fn returned(&self) -> [ReturnError; 2] {
        [0, 1].map(|i| simulate::return_error(&self.tracks[i].end(&self.chain), &self.ends[i]))
    }
}
