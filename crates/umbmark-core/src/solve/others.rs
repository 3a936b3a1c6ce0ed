//! Models that the runs cannot separate from the learnt one.
//!
//! An effect is added as one of a class: others have nearly the same signature. With another one in its place the robot's numbers may be
//! different ones: counts that are missed above a speed and slip that grows from rest on differ by a scale.

use crate::dataset::Dataset;
use crate::effect::Model;
use crate::evidence;
use crate::learn::Learnt;

/// The learnt model with each other effect of each class in place of the one that was added, fitted; those that cannot be fitted are left out.
pub(super) fn of(data: &Dataset, learnt: &Learnt) -> Vec<Model> {
    let others = |added: &'static str, class: &[&'static str]| {
        class.iter().filter(|other| **other != added).map(|other| (added, *other)).collect::<Vec<_>>()
    };
    let pairs = learnt.steps.iter().flat_map(|step| step.added.map_or(Vec::new(), |added| others(added, &step.class)));
    pairs.filter_map(|(added, other)| swapped(data, &learnt.model, added, other)).collect()
}

fn swapped(data: &Dataset, model: &Model, added: &str, other: &str) -> Option<Model> {
    let mut swapped = Model::new(model.robot());
    for part in model.parts().iter().filter(|part| part.effect.name() != added) {
        swapped.adopt(part);
    }
    swapped.add(other).ok()?.free = true;
    evidence::fit(data, &swapped).ok().map(|fit| fit.model)
}
