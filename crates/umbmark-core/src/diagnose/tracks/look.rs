//! Every group asked beside a fitted model: how much it explains, and how sure that is.

use super::examination::{ALIKE, Answer, Examination, Question, worth};
use super::flips::{Scores, family_wise};
use super::system::Projected;
use crate::diagnose::{Estimate, Options, Suspect};
use crate::stats::f_upper_tail;

/// Runs that carry a certificate on their own; with fewer, quarters of runs do.
const ENOUGH_RUNS: usize = 8;

/// A group beside the base that it was asked in.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The group after one step.
    pub answer: Answer,
    /// Family-wise p by F and Bonferroni, among effects (or among smooths).
    pub p_f: f64,
    /// Family-wise p by sign flips.
    pub p_flips: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// F.
    pub f: f64,
    /// p by F alone.
    pub p: f64,
    projected: Projected,
}

impl Finding {
    /// Whether both tests accuse it.
    pub fn certified(&self, options: &Options) -> bool {
        self.p_f <= options.size && self.p_flips <= options.size
    }

    /// The larger of the two.
    pub fn p_adjusted(&self) -> f64 {
        self.p_f.max(self.p_flips).min(1.0)
    }
}

/// All groups of one kind, the worthiest first, beside the model and what was `found` before.
pub fn look(exam: &Examination, found: &[usize], smooths: bool, options: &Options) -> Vec<Finding> {
    let products = exam.system.sum(|_| true);
    let rows = exam.system.rows(|_| true);
    let plain = with(exam.base(None), found);
    let plain_projected = Projected::new(&products, &plain);
    let residual = exam.system.residual();
    let mut findings = Vec::new();
    for (index, asked) in exam.asked.iter().enumerate() {
        if matches!(asked.question, Question::Smooth(..)) != smooths || exam.is_found(asked, found) {
            continue;
        }
        let own = asked.nuisance.then(|| Projected::new(&products, &with(exam.base(Some(index)), found)));
        let projected = own.unwrap_or_else(|| plain_projected.clone());
        let Some(answer) = exam.answer(&projected, &products, index) else { continue };
        let q = answer.columns.len() as f64;
        let spare = rows as f64 - projected.base.len() as f64 - q;
        let rest = projected.products[(residual, residual)] - answer.drop;
        let f = answer.drop / q / (rest / spare);
        let p = f_upper_tail(f.max(0.0), [q, spare]);
        findings.push(Finding { answer, p_f: p, p_flips: 1.0, degrees_of_freedom: [q, spare], f, p, projected });
    }
    let asked = findings.len() as f64;
    let scores: Vec<Scores> = findings.iter().map(|finding| scores(exam, finding)).collect();
    for (finding, p) in findings.iter_mut().zip(family_wise(&scores, options.seed)) {
        finding.p_f = (asked * finding.p).min(1.0);
        finding.p_flips = p;
    }
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

fn with(mut base: Vec<usize>, found: &[usize]) -> Vec<usize> {
    base.extend(found.iter().filter(|c| !base.contains(c)).copied().collect::<Vec<_>>());
    base
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

/// Scores of a group by run, or by quarter of a run where runs are few.
fn scores(exam: &Examination, finding: &Finding) -> Scores {
    let by_quarter = exam.fitted.observed.runs.len() < ENOUGH_RUNS;
    let mut units: Vec<nalgebra::DVector<f64>> = Vec::new();
    let mut before = None;
    for unit in &exam.system.units {
        let score = finding.projected.score(&unit.white, &finding.answer.columns);
        if by_quarter || before != Some(unit.run) {
            units.push(score);
        } else if let Some(last) = units.last_mut() {
            *last += score;
        }
        before = Some(unit.run);
    }
    Scores { units, metric: finding.answer.covariance.clone() }
}

/// The effects whose response could be taken for that of a finding, itself first.
pub fn class(exam: &Examination, finding: &Finding, found: &[usize]) -> Vec<&'static str> {
    let products = exam.system.sum(|_| true);
    let mut class = Vec::new();
    let Some(own) = exam.asked[finding.answer.asked].effect() else { return class };
    class.push(own.about.name);
    for (index, other) in exam.asked.iter().enumerate() {
        let Some(effect) = other.effect().filter(|effect| effect.about.name != own.about.name) else { continue };
        if exam.is_found(other, found) || class.contains(&effect.about.name) {
            continue;
        }
        // The rival's own place in the base, if it has one, is free while the two are compared.
        let base: Vec<usize> =
            finding.projected.base.iter().copied().filter(|column| !other.columns.contains(column)).collect();
        let projected = Projected::new(&products, &base);
        let Some(answer) = exam.answer(&projected, &products, index) else { continue };
        if projected.likeness(&finding.answer.columns, &finding.answer.step, &answer.columns) > ALIKE {
            class.push(effect.about.name);
        }
    }
    class
}

/// A finding about an effect, for people.
pub fn suspect(exam: &Examination, finding: &Finding, found: &[usize]) -> Option<Suspect> {
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
    let shape = exam.asked[finding.answer.asked].shape.map(|(parameter, value)| Estimate {
        effect: entry.about.name,
        parameter: parameter.name,
        value,
        standard_error: f64::NAN,
        degrees_of_freedom: finding.degrees_of_freedom[1],
    });
    Some(Suspect {
        class: class(exam, finding, found),
        best: entry.about.name,
        f: finding.f,
        degrees_of_freedom: finding.degrees_of_freedom,
        p: finding.p,
        p_adjusted: finding.p_adjusted(),
        p_flips: Some(finding.p_flips),
        estimate: estimate.chain(shape).collect(),
        expected_drop: finding.answer.drop,
    })
}
