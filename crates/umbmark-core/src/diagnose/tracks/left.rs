//! The residuals of a model on tracks, and the reasons against the model that follow from them.

use super::examination::Examination;
use super::repeats::{Repeated, what_repeats};
use super::{chance, doubts};
use crate::diagnose::options::Options;
use crate::diagnose::reason::Reason;
use crate::diagnose::remains::Remains;
use crate::effect::Model;
use crate::evidence::tracks::{Errors, LEAST_GAIN, Projected, System};
use crate::likelihood::{Column, Fitted, Noise, Observed};

/// What the model of an examination leaves.
pub(crate) fn remains_of(exam: &Examination, options: &Options) -> Remains {
    let base = exam.base(None);
    let values = Projected::fit(&exam.system.whole, &base);
    let own = exam.some_columns(&[&base[..], &[exam.system.residual()]].concat());
    let left: Vec<Column> = own.iter().map(|columns| less(columns, values.as_slice())).collect();
    let Fitted { observed, noise, .. } = &exam.fitted;
    chance::remains(observed, noise, &left, &exam.errors.in_sample(), options)
}

/// Reasons against the model of an examination as a whole.
pub(crate) fn doubts_of(exam: &Examination, options: &Options) -> Vec<Reason> {
    let Examination { fitted, errors, .. } = exam;
    doubts::of_model(&fitted.observed, &fitted.model, &fitted.noise, &errors.in_sample(), options.seed)
}

/// The reason for doubt from a repeating pattern in the residuals, if it is significant enough.
pub(crate) fn reason_to_doubt(repeated: Option<&Repeated>) -> Option<Reason> {
    repeated
        .filter(|repeated| repeated.is_doubt(LEAST_GAIN))
        .cloned()
        .map(|repeated| Reason::Repeats(Box::new(repeated)))
}

/// Reasons against a model with its given values: only START is fitted, and the noise is the likeliest for its residuals.
pub(crate) fn doubts_as_written(
    observed: &Observed,
    model: &Model,
    options: &Options,
) -> (Vec<Reason>, Option<Remains>) {
    if observed.runs.is_empty() {
        return (Vec::new(), None);
    }
    let fixed = observed.whole().unfitted(model, &Noise::default());
    let chain = fixed.model.chain();
    let columns: Vec<Vec<_>> = fixed.observed.runs.iter().map(|run| vec![run.residuals_along(&chain)]).collect();
    let noise = Noise::estimate(&fixed.observed, &chain, &columns, &fixed.noise);
    let system = System::new(&fixed.observed, &noise, &columns);
    let errors = Errors::new(&fixed.observed, &system, &columns, vec![0]);
    let mut reasons = doubts::of_model(&fixed.observed, &fixed.model, &noise, &errors.in_sample(), options.seed);
    let repeated = what_repeats(&fixed.observed, model, &noise, &columns, options.seed);
    reasons.extend(
        repeated.filter(|repeated| repeated.is_doubt(LEAST_GAIN)).map(|repeated| Reason::Repeats(Box::new(repeated))),
    );
    let left: Vec<Column> = columns.iter().map(|columns| less(columns, &[])).collect();
    let remains = chance::remains(&fixed.observed, &noise, &left, &errors.in_sample(), options);
    reasons.extend(Reason::of_remains(&remains, fixed.observed.resolution()));
    (reasons, Some(remains))
}

/// The last column minus the others, each times its value.
fn less(columns: &[Column], values: &[f64]) -> Column {
    let Some((left, others)) = columns.split_last() else { return Column::new() };
    let mut left = left.clone();
    for (column, value) in others.iter().zip(values) {
        left.iter_mut().zip(column).for_each(|(left, own)| (0..3).for_each(|k| left[k] -= value * own[k]));
    }
    left
}
