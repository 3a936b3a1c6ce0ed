//! Models that the runs cannot separate from the learnt one.
//!
//! An effect is added as one of a class: others have nearly the same signature. With another one in its place the robot's numbers may be
//! different ones: counts that are missed above a speed and slip that grows from rest on differ by a scale.

use crate::effect::Model;
use crate::evidence::Evidence;
use crate::learn::Learnt;

/// The learnt model with each other effect of each class in place of the one that was added, fitted to what it was learnt from; those that
/// cannot be fitted are left out.
pub(super) fn of(evidence: &dyn Evidence, learnt: &Learnt) -> Vec<Model> {
    let classes = learnt.steps.iter().filter_map(|step| Some((step.added?, &step.class)));
    let pairs = classes.flat_map(|(added, class)| class.iter().map(move |other| (added, *other)));
    let others = pairs.filter(|(added, other)| added != other);
    others.filter_map(|(added, other)| with_other(evidence, &learnt.model, added, other)).collect()
}

fn with_other(evidence: &dyn Evidence, model: &Model, added: &str, other: &str) -> Option<Model> {
    let mut with_other = Model::new(model.robot());
    for part in model.parts().iter().filter(|part| part.effect.name() != added) {
        with_other.adopt(part);
    }
    with_other.add(other).ok()?.free = true;
    evidence.fit(&with_other).ok().map(|fit| fit.model)
}
