//! Which effects the tracks cannot separate from one that was found.

use super::examination::Examination;
use super::finding::{Answer, Finding};
use super::responses::{Asked, Question};
use crate::diagnose::suspect::Suspect;
use crate::effect::{Entry, find};
use crate::evidence::Estimate;
use crate::evidence::tracks::Projected;
use nalgebra::DVector;

/// Share of the response that another effect must reproduce to be of the same class, as a cosine.
pub const ALIKE: f64 = 0.95;

/// The effects that can mimic the response of a finding, without itself: the best shape of each.
pub fn rivals(exam: &Examination, finding: &Finding) -> Vec<Answer> {
    let own = exam.asked[finding.answer.asked].effect();
    alike(exam, own, (&finding.answer.columns, &finding.answer.step), &finding.projected)
}

/// The same for an effect that the model already has: its name and those of its rivals.
pub fn class_of_own(exam: &Examination, effect: &'static str) -> Vec<&'static str> {
    let (own, others): (Vec<usize>, Vec<usize>) =
        exam.free.iter().copied().partition(|column| exam.name(*column) == Some(effect));
    let values = DVector::from_iterator(own.len(), own.iter().map(|column| exam.departure(*column)));
    let beside = Projected::new(&exam.system.whole, &others);
    let rivals = alike(exam, find(effect).ok(), (&own, &values), &beside);
    let names = rivals.iter().filter_map(|rival| exam.asked[rival.asked].effect()).map(|rival| rival.about.name);
    std::iter::once(effect).chain(names).collect()
}

/// The effect of the catalogue that is most similar to one of the model, and the share of its response that it reproduces, as a cosine.
pub fn nearest(exam: &Examination, effect: &str) -> Option<(&'static str, f64)> {
    let (own, others): (Vec<usize>, Vec<usize>) = exam
        .base(None)
        .into_iter()
        .partition(|column| exam.free.contains(column) && exam.name(*column) == Some(effect));
    let values = DVector::from_iterator(own.len(), own.iter().map(|column| exam.departure(*column)));
    let beside = Projected::new(&exam.system.whole, &others);
    let effects = exam.asked.iter().enumerate().filter(|(_, asked)| !asked.nuisance);
    let share = |(index, asked): (usize, &Asked)| {
        let answer = exam.answer(&beside, &exam.system.whole, index)?;
        Some((asked.effect()?.about.name, beside.likeness(&own, &values, &answer.columns)))
    };
    effects.filter_map(share).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The effects that can reproduce the response of some columns, without `own`: the best shape of each.
fn alike(
    exam: &Examination,
    own: Option<&Entry>,
    (columns, values): (&[usize], &DVector<f64>),
    beside: &Projected,
) -> Vec<Answer> {
    let mut alike: Vec<(&str, Answer)> = Vec::new();
    for (index, other) in exam.asked.iter().enumerate() {
        let Some(effect) = other.effect().filter(|effect| Some(*effect) != own) else { continue };
        if alike.iter().any(|(name, _)| *name == effect.about.name) {
            continue;
        }
        // The rival's own place in the base, if it has one, is free while the two are compared.
        let base: Vec<usize> = beside.base.iter().copied().filter(|column| !other.columns.contains(column)).collect();
        let freed = (base.len() < beside.base.len()).then(|| Projected::new(&exam.system.whole, &base));
        let projected = freed.as_ref().unwrap_or(beside);
        let Some(answer) = exam.answer(projected, &exam.system.whole, index) else { continue };
        if projected.likeness(columns, values, &answer.columns) > ALIKE {
            alike.push((effect.about.name, answer));
        }
    }
    alike.into_iter().map(|(_, answer)| answer).collect()
}

/// A finding about an effect as a suspect of the report.
pub fn suspect(exam: &Examination, finding: &Finding) -> Option<Suspect> {
    let Question::Effect(entry, parameters) = &exam.asked[finding.answer.asked].question else { return None };
    let columns = &exam.asked[finding.answer.asked].columns;
    let estimate = finding.answer.columns.iter().enumerate().filter_map(|(k, column)| {
        let which = columns.iter().position(|c| c == column)?;
        let zero = parameters[which].default.resolve(exam.fitted.model.robot());
        Some(Estimate {
            effect: entry.about.name,
            parameter: parameters[which].name,
            value: zero + finding.answer.step[k],
            standard_error: finding.answer.covariance[(k, k)].max(0.0).sqrt(),
            degrees_of_freedom: finding.degrees_of_freedom[1],
        })
    });
    let shapes = exam.asked[finding.answer.asked].shapes.iter().map(|(parameter, value)| Estimate {
        effect: entry.about.name,
        parameter: parameter.name,
        value: *value,
        standard_error: f64::NAN,
        degrees_of_freedom: finding.degrees_of_freedom[1],
    });
    let others = rivals(exam, finding).into_iter().filter_map(|rival| exam.asked[rival.asked].effect());
    Some(Suspect {
        class: std::iter::once(*entry).chain(others).map(|effect| effect.about.name).collect(),
        best: entry.about.name,
        f: finding.f,
        degrees_of_freedom: finding.degrees_of_freedom,
        p: finding.p,
        p_adjusted: finding.p_adjusted(),
        p_flips: Some(finding.p_flips),
        estimate: estimate.chain(shapes).collect(),
        expected_drop: finding.answer.drop,
    })
}
