//! Effects of a fitted model that do not help.

use super::examination::Examination;
use crate::effect::Part;
use crate::evidence::tracks::{LEAST_GAIN, Misses, last_part, silent};

/// An effect among those `asked` that does not help: the interval of each of its sizes holds zero, or held-out runs are predicted as
/// well without it.
pub fn idle(exam: &Examination, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
    let helps_not = |part: &Part| !helps(exam, part.effect.name());
    silent(&exam.fitted, &asked).or_else(|| last_part(&exam.fitted, asked, helps_not))
}

/// Whether held-out runs are predicted better with an effect of the model than without it.
fn helps(exam: &Examination, effect: &str) -> bool {
    let [with, without] = with_and_without(exam, effect);
    exam.columns_of(effect).is_empty() || with.gain(&without) >= LEAST_GAIN
}

/// Errors of held-out runs with an effect of the model, and without it, the others fitted again.
pub fn with_and_without(exam: &Examination, effect: &str) -> [Misses; 2] {
    let own = exam.columns_of(effect);
    let beside: Vec<usize> = exam.base(None).into_iter().filter(|column| !own.contains(column)).collect();
    let of_reference: Vec<usize> = beside.iter().copied().filter(|column| !exam.free.contains(column)).collect();
    [exam.left_out(&of_reference), exam.left_out_without(&own, &beside)]
}
