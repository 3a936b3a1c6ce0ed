//! Something that the catalogue does not list: what it acts on, and what it depends on.

use super::curve::{Curve, curve};
use super::examination::Examination;
use super::finding::Finding;
use super::responses::Question;
use super::suggestion::{Suggestion, suggestion};
use crate::diagnose::suspect::Suspect;

/// A missing effect that is not in the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// The motion that it adds to: "forward", "sideways" or "yaw".
    pub acts_on: &'static str,
    /// What it depends on, as formulas of the user's own have it.
    pub depends_on: &'static str,
    /// The same in words.
    pub title: &'static str,
    /// p, corrected for all that was tested.
    pub p_adjusted: f64,
    /// By how much the misfit would fall, in units of the noise variance.
    pub drop: f64,
    /// What it adds, over the range of the covariate in the runs.
    pub curve: Curve,
    /// A formula with the same effect, if one of a small family fits.
    pub suggestion: Option<Suggestion>,
    /// The effect of the catalogue that comes nearest, and the share of the drop that it explains.
    pub nearest: Option<(&'static str, f64)>,
}

/// A smooth as a dependence of the report.
pub(crate) fn dependence(exam: &Examination, finding: &Finding, asked: &[Suspect]) -> Option<Dependence> {
    let Question::Smooth(covariate, motion) = &exam.asked[finding.answer.asked].question else { return None };
    let share = |suspect: &&Suspect| suspect.expected_drop / finding.answer.drop;
    let nearest = asked.iter().max_by(|a, b| a.expected_drop.total_cmp(&b.expected_drop));
    Some(Dependence {
        acts_on: motion.name(),
        depends_on: covariate.name,
        title: covariate.title,
        p_adjusted: finding.p_adjusted(),
        drop: finding.answer.drop,
        curve: curve(exam, finding, covariate, *motion),
        suggestion: suggestion(exam, finding, covariate, *motion),
        nearest: nearest.map(|suspect| (suspect.best, share(&suspect).min(1.0))),
    })
}
