//! What a calibration warns of.

use super::closed_form::ClosedForm;
use super::estimate::{Estimate, Method};
use super::observations::Observations;
use crate::dataset::ReturnError;
use crate::score::FEWEST_RUNS;

pub(super) fn of_what_does_not_show(shown: &[bool; 3], observations: &Observations, warnings: &mut Vec<String>) {
    let [e_d, e_b, e_s] = *shown;
    if e_b && !e_s {
        warnings.push(
            "E_s is not determined: end poses of a closed path show E_b/E_s only. E_s = 1 is assumed; the wheelbase and the \
             wheel diameters in metres are right only if the mean wheel diameter is. Measure one straight leg by tape, or \
             a pose on the way."
                .into(),
        );
    }
    if !(e_d && e_b) {
        let (missing, verb) = match (e_d, e_b) {
            (false, false) => ("E_d and E_b are", "them"),
            (false, true) => ("E_d is", "it"),
            _ => ("E_b is", "it"),
        };
        let directions: Vec<_> = observations.drives.iter().map(|d| d.direction).collect();
        let one_way = directions.iter().all(|d| *d == directions[0]);
        let advice = if one_way { "Drive the path in the other direction too" } else { "Drive a square both ways" };
        warnings
            .push(format!("{missing} not determined: this experiment does not tell {verb} from the rest. {advice}."));
    }
}

/// The closed forms do not apply where they would leave a fifth of E_max,sys and twice what the exact fit leaves: their own scatter
/// does not explain so large a rest.
pub(super) fn of_large_errors(estimates: &[Estimate], warnings: &mut Vec<String>) {
    let of = |method| estimates.iter().find(|estimate| estimate.method == method);
    let left = |estimate: &Estimate| estimate.e_max_sys_after.zip(estimate.e_max_sys_before);
    let (Some((mean, before)), Some((exact, _))) =
        (of(Method::ClosedForm(ClosedForm::Mean)).and_then(left), of(Method::Exact).and_then(left))
    else {
        return;
    };
    if mean > 0.2 * before && mean > 2.0 * exact {
        warnings.push(format!(
            "The closed forms are of first order in the errors, and these are large: their mean would leave {:.0} of {:.0} mm. Use the \
             exact fit.",
            1e3 * mean,
            1e3 * before
        ));
    }
}

pub(super) fn of_few_runs(cw: &[ReturnError], ccw: &[ReturnError], warnings: &mut Vec<String>) {
    if [cw.len(), ccw.len()].iter().any(|n| (1..FEWEST_RUNS).contains(n)) {
        warnings.push(format!(
            "Few runs: {} cw and {} ccw. {FEWEST_RUNS} or more a direction are needed to trust the intervals; the paper drives 5.",
            cw.len(),
            ccw.len()
        ));
    }
}
