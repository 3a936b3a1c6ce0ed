//! A law as it was fitted in the model that it was added to.

use super::law::{REMEMBERS, Repeated, UnlistedLaw};
use super::laws::SHAPE;
use super::lengths;
use crate::diagnose::suspect::Suspect;
use crate::diagnose::tracks::class;
use crate::diagnose::tracks::examination::Examination;
use crate::evidence::tracks::estimates;

impl UnlistedLaw {
    /// The law of this name as it was fitted in a model, and what its length means there.
    pub(in crate::diagnose::tracks) fn fitted(self, name: &'static str, exam: &Examination) -> UnlistedLaw {
        let model = exam.fitted.model.only(name);
        let c = estimates(&exam.fitted).into_iter().find(|e| e.effect == name && e.parameter == SHAPE);
        let nearest = class::nearest(exam, name);
        let is_way = self.follows.contains("period of {c} m");
        let means = c.filter(|_| is_way).and_then(|c| lengths::meaning(&exam.fitted.observed, &c));
        UnlistedLaw { model: Some(model), means, nearest, ..self }
    }
}

/// What repeats as a suspect: the law of this name in a model that it was added to.
pub(in crate::diagnose::tracks) fn suspect(repeated: &Repeated, name: &'static str, exam: &Examination) -> Suspect {
    let estimate: Vec<_> = estimates(&exam.fitted).into_iter().filter(|e| e.effect == name).collect();
    let freedom = [estimate.len() as f64, exam.system.rows as f64];
    let square = repeated.deviations * repeated.deviations;
    Suspect {
        class: vec![name],
        best: name,
        f: square / freedom[0].max(1.0),
        degrees_of_freedom: freedom,
        p: repeated.p_by_noise(REMEMBERS),
        p_adjusted: repeated.p,
        p_flips: Some(repeated.p),
        estimate,
        expected_drop: square,
    }
}
