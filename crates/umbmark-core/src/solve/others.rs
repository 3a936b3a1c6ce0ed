//! Effects that the runs cannot separate from the model that was learnt.
//!
//! An effect is added as one of a class: others have nearly the same signature. With another one in its place the robot's numbers may be
//! different ones: counts that are missed above a speed and slip that grows from rest on differ by a scale. An effect that is significant,
//! but lowers no error of runs left out, is not added, and may change the numbers all the same. How far the class reaches in these runs, the
//! likelihood of the whole model says.

use crate::calibrate::Correction;
use crate::effect::Model;
use crate::evidence::tracks::Alone;
use crate::evidence::{AnyEvidence, Evidence, tracks};
use crate::learn::{Learnt, criteria_of_ends};

/// Less likely effects are left out.
const LEAST_LIKELY: f64 = 1e-3;

/// Another effect in place of one that was added, or beside all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Other {
    /// The one in whose place it stands; `None` for one that is significant and was not added.
    pub added: Option<&'static str>,
    /// The other one.
    pub effect: &'static str,
    /// By how much the values of the robot's first effects differ with it.
    pub off: [f64; 3],
    /// How likely the runs are with it, relative to the model that was learnt: exp(-ΔAICc/2), at most 1.
    ///
    /// Source: Akaike weights; Burnham & Anderson (2002), Model Selection and Multimodel Inference, 2.9.
    pub likelihood: f64,
}

/// The other effects of each class, and those that are significant at this size of their test; those with which the model cannot be fitted,
/// or is much less likely, are left out.
pub(super) fn of(evidence: &AnyEvidence, learnt: &Learnt, size: f64) -> Vec<Other> {
    let classes = learnt.steps.iter().filter_map(|step| Some((step.added?, &step.class)));
    let in_place = classes.flat_map(|(added, class)| class.iter().map(move |effect| (Some(added), *effect)));
    let significant = learnt.diagnosis.ranking.iter().filter(|suspect| suspect.p_adjusted <= size);
    let beside = significant.flat_map(|suspect| suspect.class.iter().map(|effect| (None, *effect)));
    let has = |effect: &str| learnt.model.parts().iter().any(|part| part.effect.name() == effect);
    let pairs: Vec<_> = in_place.chain(beside).filter(|(_, effect)| !has(effect)).collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let Some((_, aicc)) = fitted(evidence, &learnt.model) else { return Vec::new() };
    let values = Correction::of(&learnt.model).values();
    let other = |(added, effect)| {
        let (other, other_aicc) = fitted(evidence, &with_other(&learnt.model, added, effect)?)?;
        let off = Correction::of(&other).values();
        let likelihood = libm::exp(0.5 * (aicc - other_aicc)).min(1.0);
        let off = [0, 1, 2].map(|which| off[which] - values[which]);
        (likelihood >= LEAST_LIKELY).then_some(Other { added, effect, off, likelihood })
    };
    pairs.into_iter().filter_map(other).collect()
}

fn with_other(model: &Model, added: Option<&str>, effect: &str) -> Option<Model> {
    let mut with_other = Model::new(model.robot());
    for part in model.parts().iter().filter(|part| Some(part.effect.name()) != added) {
        with_other.adopt(part);
    }
    with_other.add(effect).ok()?.free = true;
    Some(with_other)
}

/// The likeliest values of a model, and its AICc.
fn fitted(evidence: &AnyEvidence, model: &Model) -> Option<(Model, f64)> {
    match evidence {
        AnyEvidence::Ends(ends) => {
            let model = ends.fit(model).ok()?.model;
            let [aicc, _] = criteria_of_ends(ends, &model)?;
            Some((model, aicc))
        }
        AnyEvidence::Tracks(observed) => {
            let alone = Alone::new(tracks::fit(observed, model).ok()?);
            let (aicc, ..) = alone.criteria();
            Some((alone.into_fitted().model, aicc))
        }
    }
}
