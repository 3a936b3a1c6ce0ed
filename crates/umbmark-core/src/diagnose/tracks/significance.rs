//! The tests: how much every group of columns explains beside a fitted model, and how significant that is.

use super::examination::Examination;
use super::finding::{Finding, worth};
use super::flips::{Family, Scores};
use super::responses::Question;
use crate::diagnose::options::Options;
use crate::evidence::tracks::{Packed, Projected, System, Unit};
use crate::stats::f_upper_tail;
use rayon::prelude::*;
use std::borrow::Cow;
use std::cell::OnceCell;
use std::sync::Arc;

/// Runs that carry a certificate on their own; with fewer, quarters of runs do.
const ENOUGH_RUNS: usize = 8;
/// The same of those runs in which a group shows: the flips of five runs never fall below 1/16.
const ENOUGH_CARRYING: f64 = 6.0;

/// All effects, the worthiest first, beside the model.
pub fn effects(exam: &Examination, options: &Options) -> Vec<Finding> {
    look(exam, false, options)
}

/// The same of the smooths.
pub fn smooths<'a>(exam: &'a Examination, options: &Options) -> &'a [Finding] {
    exam.smooths.get_or_init(|| look(exam, true, options))
}

/// All groups of one kind, the worthiest first, beside the model.
fn look(exam: &Examination, smooths: bool, options: &Options) -> Vec<Finding> {
    let products = &exam.system.whole;
    let rows = exam.system.rows;
    let plain = Arc::new(Projected::new(products, &exam.base(None)));
    let residual = exam.system.residual();
    let mut findings = Vec::new();
    for (index, asked) in exam.asked.iter().enumerate() {
        if matches!(asked.question, Question::Smooth(..)) != smooths {
            continue;
        }
        let own = asked.nuisance.then(|| Arc::new(Projected::new(products, &exam.base(Some(index)))));
        let projected = own.unwrap_or_else(|| Arc::clone(&plain));
        let Some(answer) = exam.answer(&projected, products, index) else { continue };
        let q = answer.columns.len() as f64;
        let spare = rows as f64 - projected.base.len() as f64 - q;
        let rest = projected.products[(residual, residual)] - answer.drop;
        let f = answer.drop / q / (rest / spare);
        let p = f_upper_tail(f.max(0.0), [q, spare]);
        findings.push(Finding { answer, p_f: p, p_flips: 1.0, degrees_of_freedom: [q, spare], f, p, projected });
    }
    certify(exam, &mut findings, options);
    findings.sort_by(|a, b| worth(&b.answer).total_cmp(&worth(&a.answer)));
    let mut named = Vec::new();
    findings.retain(|finding| {
        let effect = exam.asked[finding.answer.asked].effect().map(|effect| effect.about.name);
        let known = effect.is_some() && named.contains(&effect);
        named.push(effect);
        !known
    });
    findings
}

/// The p-values of findings that come from the scores of runs, or of quarters of runs where too few runs show a group.
fn certify(exam: &Examination, findings: &mut [Finding], options: &Options) {
    let few = exam.fitted.observed.runs.len() < ENOUGH_RUNS;
    let units = &exam.system.units;
    let own = |unit| Cow::Borrowed(of_unit(unit));
    let of =
        |finding: &Finding, by_quarter| scores((units, own), &finding.projected, &finding.answer.columns, by_quarter);
    let all = |by_quarter: bool| findings.par_iter().map(|finding| of(finding, by_quarter)).collect::<Vec<_>>();
    let by_run = all(few);
    let by_quarter = if by_run.iter().all(|own| own.carrying() >= ENOUGH_CARRYING) { Vec::new() } else { all(true) };
    let asked = findings.len() as f64;
    // In most data nothing is significant, and then no flips are computed.
    let families: [OnceCell<Family>; 2] = Default::default();
    for (index, finding) in findings.iter_mut().enumerate() {
        let quarters = by_run[index].carrying() < ENOUGH_CARRYING;
        let scores = if quarters { &by_quarter } else { &by_run };
        finding.p_f = (asked * finding.p.max(scores[index].p_by_units(&finding.answer.step))).min(1.0);
        if finding.p_f <= options.size {
            let family = families[usize::from(quarters)].get_or_init(|| Family::new(scores, options.seed));
            finding.p_flips = family.p(&scores[index]);
        }
    }
}

/// Whether the sizes that an effect would have are ones that it can have: no bump gives travel back.
pub fn possible(exam: &Examination, finding: &Finding) -> bool {
    let Question::Effect(_, parameters) = &exam.asked[finding.answer.asked].question else { return true };
    let columns = &exam.asked[finding.answer.asked].columns;
    finding.answer.columns.iter().zip(finding.answer.step.iter()).all(|(column, step)| {
        let parameter = columns.iter().position(|c| c == column).map(|which| parameters[which]);
        parameter.is_none_or(|p| p.check(p.default.resolve(exam.fitted.model.robot()) + step).is_ok())
    })
}

/// p of an effect of the model, as if the model lacked it and it alone were tested: the greatest of the p-values by F, by the scatter
/// of the runs and by flips. `None` where none of its values was fitted, or the others do all that it does.
pub fn p_of_own(exam: &Examination, effect: &str, options: &Options) -> Option<f64> {
    let own = exam.columns_of(effect);
    let values: Vec<f64> = own.iter().map(|column| exam.departure(*column)).collect();
    let system = &exam.system;
    let without = System::with_added(&system.whole, &own, &values);
    let of_unit = |unit: &Unit| Cow::Owned(Packed::of(&System::with_added(&unit.white.whole(), &own, &values)));
    let base: Vec<usize> = exam.base(None).into_iter().filter(|column| !own.contains(column)).collect();
    let projected = Projected::new(&without, &base);
    let shown: Vec<usize> = own.iter().copied().filter(|column| !projected.absorbed(&without, *column)).collect();
    if shown.is_empty() {
        return None;
    }
    let (drop, step, _) = projected.drop(&shown)?;
    let residual = system.residual();
    let q = shown.len() as f64;
    let spare = system.rows as f64 - base.len() as f64 - q;
    let f = drop / q / ((projected.products[(residual, residual)] - drop) / spare);
    let of = |by_quarter| scores((&system.units, of_unit), &projected, &shown, by_quarter);
    let by_run = of(exam.fitted.observed.runs.len() < ENOUGH_RUNS);
    let is_by_few = by_run.carrying() < ENOUGH_CARRYING;
    let scores = if is_by_few { of(true) } else { by_run };
    let flips = Family::new(std::slice::from_ref(&scores), options.seed).p(&scores);
    Some(f_upper_tail(f.max(0.0), [q, spare]).max(scores.p_by_units(&step)).max(flips))
}

/// The products of a unit.
fn of_unit(unit: &Unit) -> &Packed {
    &unit.white
}

/// Scores of a group of columns by run or by quarter of a run: of some units, with the products that they have.
fn scores<'a>(
    (units, products): (&'a [Unit], impl Fn(&'a Unit) -> Cow<'a, Packed>),
    projected: &Projected,
    columns: &[usize],
    by_quarter: bool,
) -> Scores {
    let information = projected.information(columns);
    let mut scores = Scores { units: Vec::new(), held: Vec::new(), parts: Vec::new(), information };
    let mut before = None;
    for unit in units {
        let white = products(unit);
        let (score, held) = projected.score(&white, columns);
        let part = projected.information_of(&white, columns);
        match (scores.units.last_mut(), scores.held.last_mut(), scores.parts.last_mut()) {
            (Some(units), Some(all), Some(parts)) if !by_quarter && before == Some(unit.run) => {
                *units += score;
                *all += held;
                *parts += part;
            }
            _ => {
                scores.units.push(score);
                scores.held.push(held);
                scores.parts.push(part);
            }
        }
        before = Some(unit.run);
    }
    scores
}

#[cfg(test)]
mod tests {
    use super::super::class::suspect;
    use super::super::tests::{complete, fitted_to, on_grain};
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::effect::{Formula, Model, Target, find};
    use crate::evidence::Estimate;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn scores_of_runs_are_those_of_their_quarters_together() {
        let exam = complete();
        let runs = exam.fitted.observed.runs.len();
        for finding in &effects(exam, &Options::default()) {
            let units = (&exam.system.units[..], |unit| Cow::Borrowed(of_unit(unit)));
            let of = |by_quarter| scores(units, &finding.projected, &finding.answer.columns, by_quarter);
            let (by_run, by_quarter) = (of(false), of(true));
            assert_eq!((by_run.units.len(), by_quarter.units.len()), (runs, 4 * runs));
            for (run, (score, part)) in by_run.units.iter().zip(&by_run.parts).enumerate() {
                let own = 4 * run..4 * run + 4;
                let sum: DVector<f64> = by_quarter.units[own.clone()].iter().sum();
                let parts: DMatrix<f64> = by_quarter.parts[own].iter().sum();
                assert!((sum - score).amax() <= 1e-9 * score.amax() && (&parts - part).amax() <= 1e-9 * part.amax());
            }
        }
    }

    #[test]
    fn a_finding_is_possible_where_every_size_that_it_estimates_may_be() {
        let exam = complete();
        let may_be = |estimate: &Estimate| {
            let about = &find(estimate.effect).unwrap().about;
            let parameter = about.parameters.iter().find(|p| p.name == estimate.parameter).unwrap();
            parameter.check(estimate.value).is_ok()
        };
        let findings = effects(exam, &Options::default());
        let expected = findings.iter().map(|finding| suspect(exam, finding).unwrap().estimate.iter().all(may_be));
        let expected: Vec<bool> = expected.collect();
        assert_eq!(findings.iter().map(|finding| possible(exam, finding)).collect::<Vec<_>>(), expected);
        assert!(expected.contains(&true) && expected.contains(&false), "{expected:?}");
    }

    /// The wave of a grain is there or is not.
    #[test]
    fn an_effect_of_the_model_is_as_certain_as_if_it_were_asked() {
        let p_on = |truth: &Model| {
            let mut model = fitted_to(truth).model;
            let law = Formula::new(
                "mine",
                Target::HeadingPerMetre,
                "a * cos(2 * heading) + b * sin(2 * heading)",
                &["a", "b"],
            );
            model.add_formula(law.unwrap(), &[0.0; 2]).unwrap().free = true;
            let observed = fitted_to(truth).observed;
            let exam = Examination::new(crate::evidence::tracks::fit(&observed.whole(), &model).unwrap()).unwrap();
            p_of_own(&exam, "mine", &Options::default()).unwrap()
        };
        let (there, not) = (p_on(&on_grain()), p_on(&robot_with(&[])));
        assert!(there < 0.01 && not > 0.05, "{there} {not}");
    }
}
