//! Whether the formulas of a model are finite along the whole path.

use super::track::Track;
use crate::drive::{LinkReading, WheelTravel};
use crate::effect::{Context, Model, ModelError};
use crate::engine::{ConvoyStep, Floor, Predicted};
use crate::geometry::{Displacement2, Pose2};
use crate::path::{Direction, Path};

impl Track {
    /// Refuses a model with a formula that is not finite at some point of the path.
    ///
    /// If they depend on the place in the room, the path is the predicted one; otherwise it is that of the believed travel.
    pub fn check(&self, model: &Model) -> Result<(), ModelError> {
        if !model.has_formulas() || !model.reads_place() {
            return model.check_along(self.contexts.iter().map(Context::as_believed));
        }
        let chain = model.chain();
        if let Some(convoy) = &self.convoy {
            let mut floor = Checked { floor: Predicted::by(&chain), model, found: Ok(()) };
            let mut trucks = convoy.at_start(chain.start(), &mut floor);
            convoy.steps().iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
            return floor.found;
        }
        let mut pose = self.start(&chain);
        for (travel, at) in self.travel.iter().zip(&self.contexts) {
            let here = at.at_pose(&pose);
            model.check_along([here])?;
            pose.advance(&chain.displacement(&here, travel));
        }
        Ok(())
    }
}

/// Refuses a model whose formulas are not finite somewhere on a path, driven in either direction.
pub fn check_on_path(model: &Model, path: &Path) -> Result<(), ModelError> {
    let directions = Direction::BOTH.into_iter().filter(|_| model.has_formulas());
    directions
        .map(|direction| Track::in_pieces(path, direction, model.robot()))
        .try_for_each(|track| track.check(model))
}

/// A predicted floor on which the formulas of a model are checked.
struct Checked<'a> {
    floor: Predicted<'a, f64>,
    model: &'a Model,
    found: Result<(), ModelError>,
}

impl Floor<f64> for Checked<'_> {
    fn moved(&mut self, step: &ConvoyStep, truck: usize, believed: WheelTravel, real: &Pose2) -> Displacement2 {
        if self.found.is_ok() {
            self.found = self.model.check_along([step.contexts[truck].at_pose(real)]);
        }
        self.floor.moved(step, truck, believed, real)
    }

    fn shown(&mut self, link: LinkReading) -> LinkReading {
        self.floor.shown(link)
    }
}
