//! Effects that the runs cannot separate from the model that was learnt.
//!
//! An effect is added as one of a class: others have nearly the same signature. With another one in its place the robot's numbers may be
//! different ones: counts that are missed above a speed and slip that grows from rest on differ by a scale, and so does slip by another power
//! of the speed, in the catalogue or not. An effect that is significant,
//! but lowers no error of runs left out, is not added, and may change the numbers all the same. How far the class reaches in these runs, the
//! likelihood of the whole model says.

use crate::diagnose::{Diagnosis, Reason, missing};
use crate::effect::{Entry, Model, find};
use crate::evidence::tracks::Alone;
use crate::evidence::{AnyEvidence, Estimate, Evidence, tracks};
use crate::learn::{Learnt, criteria_of_ends};
use nalgebra::{DMatrix, DVector};

/// Effects of less weight are left out.
const LEAST: f64 = 1e-3;

/// Another effect in place of one that was added, or beside all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Other {
    /// The one in whose place it stands; `None` for one that is significant and was not added.
    pub added: Option<&'static str>,
    /// The other one.
    pub effect: &'static str,
    /// By how much each fitted number of the model differs with it, in the order of `Diagnosis::fitted`; 0 for a number of the effect that it
    /// replaces.
    pub off: Vec<f64>,
    /// Its Akaike weight among the model that was learnt and all the others: exp(-AICc/2) over their sum.
    ///
    /// Source: Burnham & Anderson (2002), Model Selection and Multimodel Inference, 2.9.
    pub weight: f64,
}

/// The other effects of each class, each effect by another power of the speed, in place of what was added from return poses all effects of the
/// catalogue, and the effects that are significant at this size of their test; those with which the model cannot be fitted, or of hardly any weight, are left out.
pub(super) fn of(evidence: &AnyEvidence, learnt: &Learnt, size: f64) -> Vec<Other> {
    let entries =
        |class: &[&'static str]| -> Vec<&'static Entry> { class.iter().filter_map(|name| find(name).ok()).collect() };
    let classes = learnt.steps.iter().filter_map(|step| Some((step.added?, entries(&step.class))));
    let of_class = classes.flat_map(|(added, class)| class.into_iter().map(move |entry| (Some(added), entry)));
    let added = learnt.steps.iter().filter_map(|step| find(step.added?).ok());
    let of_power = added.clone().flat_map(|own| (own.powers)().iter().map(move |entry| (Some(own.about.name), *entry)));
    // A few means tell few effects apart, whatever the likeness of their signatures says of one that was not added yet.
    let first = learnt.model.robot().drive.first_effects();
    let of_means: Vec<&Entry> = match evidence {
        AnyEvidence::Ends(_) => added.filter(|own| !first.contains(&own.about.name)).collect(),
        AnyEvidence::Tracks(_) => Vec::new(),
    };
    let of_means =
        of_means.iter().flat_map(|own| missing(&learnt.model).map(move |entry| (Some(own.about.name), entry)));
    let significant = learnt.diagnosis.ranking.iter().filter(|suspect| suspect.p_adjusted <= size);
    let beside = significant.flat_map(|suspect| entries(&suspect.class)).map(|entry| (None, entry));
    let has = |entry: &Entry| learnt.model.parts().iter().any(|part| part.effect == *entry);
    let mut pairs: Vec<(Option<&'static str>, &'static Entry)> = Vec::new();
    for pair in of_class.chain(of_power).chain(of_means).chain(beside).filter(|(_, entry)| !has(entry)) {
        if !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    if pairs.is_empty() {
        return Vec::new();
    }
    let Some((_, aicc)) = fitted(evidence, &learnt.model) else { return Vec::new() };
    let other = |(added, entry): (Option<&'static str>, &'static Entry)| {
        let (other, aicc) = fitted(evidence, &with_other(&learnt.model, added, entry)?)?;
        let off = |own: &Estimate| value_of(&other, own).map_or(0.0, |value| value - own.value);
        let off = learnt.diagnosis.fitted.iter().map(off).collect();
        Some((Other { added, effect: entry.about.name, off, weight: 0.0 }, aicc))
    };
    let mut others: Vec<(Other, f64)> = pairs.into_iter().filter_map(other).collect();
    let least = others.iter().fold(aicc, |least, (_, own)| least.min(*own));
    let likelihood = |aicc: f64| libm::exp(0.5 * (least - aicc));
    let sum: f64 = likelihood(aicc) + others.iter().map(|(_, own)| likelihood(*own)).sum::<f64>();
    others.iter_mut().for_each(|(other, own)| other.weight = likelihood(*own) / sum);
    others.into_iter().map(|(other, _)| other).filter(|other| other.weight >= LEAST).collect()
}

/// The value of a number in a model that has it.
fn value_of(model: &Model, number: &Estimate) -> Option<f64> {
    model.values().nth(model.place_of(number.effect, number.parameter)?)
}

/// Makes the estimates of what was learnt as uncertain as other effects leave them.
///
/// Where another effect of weight w would do, the distance d of its values is one more error, w d dᵀ. Where a value differs from run to run,
/// it is the mean over the runs. What an effect that is left out may do is told where it is beyond the wider interval too.
///
/// Source: Buckland, Burnham & Augustin (1997), Biometrics 53, 603: the variance of an estimate after a model was selected.
pub(super) fn widen(diagnosis: &mut Diagnosis, others: &[Other], level: f64) {
    let count = diagnosis.fitted.len();
    let mut added = DMatrix::zeros(count, count);
    for other in others {
        let off = DVector::from_column_slice(&other.off);
        added.ger(other.weight, &off, &off, 1.0);
    }
    for reason in &diagnosis.reasons {
        if let Reason::RunsDiffer(unequal) = reason {
            let place = diagnosis.fitted.iter().position(|own| own.effect == unequal.effect);
            place.into_iter().for_each(|place| added[(place, place)] += unequal.variance());
        }
    }
    let before: Vec<f64> = diagnosis.fitted.iter().map(|own| own.standard_error).collect();
    for (place, own) in diagnosis.fitted.iter_mut().enumerate().filter(|(place, _)| added[(*place, *place)] > 0.0) {
        own.standard_error = (own.standard_error * own.standard_error + added[(place, place)]).sqrt();
    }
    let after: Vec<f64> = diagnosis.fitted.iter().map(|own| own.standard_error).collect();
    for (i, row) in diagnosis.correlations.iter_mut().enumerate() {
        for (j, correlation) in row.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let product = after[i] * after[j];
            if product > 0.0 && product.is_finite() {
                *correlation = (*correlation * before[i] * before[j] + added[(i, j)]) / product;
            }
        }
    }
    for confounder in &mut diagnosis.confounders {
        for bias in &mut confounder.biases {
            let own = diagnosis.fitted.iter().find(|own| (own.effect, own.parameter) == (bias.effect, bias.parameter));
            let interval = own.and_then(|own| own.interval(level));
            bias.half_width = interval.map_or(bias.half_width, |interval| 0.5 * (interval.high - interval.low));
        }
        confounder.biases.retain(|bias| bias.bias > bias.half_width);
    }
    diagnosis.confounders.retain(|confounder| !confounder.biases.is_empty());
    diagnosis.confounders.sort_by(|a, b| b.worst().total_cmp(&a.worst()));
}

fn with_other(model: &Model, added: Option<&str>, entry: &'static Entry) -> Option<Model> {
    let mut with_other = Model::new(model.robot());
    for part in model.parts().iter().filter(|part| Some(part.effect.name()) != added) {
        with_other.adopt(part);
    }
    with_other.add_entry(entry).ok()?.free = true;
    Some(with_other)
}

/// The likeliest values of a model, and its AICc.
fn fitted(evidence: &AnyEvidence, model: &Model) -> Option<(Model, f64)> {
    let (model, aicc) = match evidence {
        AnyEvidence::Ends(ends) => {
            let model = ends.fit(model).ok()?.model;
            let [aicc, _] = criteria_of_ends(ends, &model)?;
            (model, aicc)
        }
        AnyEvidence::Tracks(observed) => {
            let alone = Alone::new(tracks::fit(observed, model).ok()?);
            let (aicc, ..) = alone.criteria();
            (alone.into_fitted().model, aicc)
        }
    };
    aicc.is_finite().then_some((model, aicc))
}
