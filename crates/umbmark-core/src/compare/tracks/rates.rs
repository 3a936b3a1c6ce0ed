//! Errors in proportion to the distance or rotation driven: whether they differ from zero, and what they depend on.

use super::covariate::{COVARIATES, Covariate, Rate, Span, Value};
use super::followed::{ErrorIncrement, Followed};
use super::mean::{Mean, Sum, p_of_slope, p_of_zero, shared};
use super::worth::{self, Test};
use crate::drive::Robot;

/// Runs differ in a covariate if their means scatter by more than this share of its range.
const DIFFER: f64 = 0.02;

/// A rate over all driving.
#[derive(Clone, Debug, PartialEq)]
pub struct Overall {
    /// Which.
    pub rate: Rate,
    /// Mean over the runs.
    pub mean: Mean,
    /// Of a rate of zero, by Student's t over runs; `None` for fewer than three runs.
    pub test: Option<Test>,
}

/// A rate as a function of a covariate.
#[derive(Clone, Debug)]
pub struct Against {
    /// Which rate.
    pub rate: Rate,
    /// What it may depend on.
    pub covariate: &'static Covariate,
    /// The rate in each bin.
    pub bins: Vec<Bin>,
    /// Whether one tick blurs the bins, so that they are not compared with each other.
    pub blurred: bool,
    /// Of a rate that does not depend on it; `None` if the runs are too few, or the covariate does not vary in them.
    pub test: Option<Test>,
}

/// A rate in one bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Where.
    pub span: Span,
    /// Amount of driving there, in all runs \[m or rad\].
    pub amount: f64,
    /// Mean over the runs with driving there; `None` if there is none.
    pub mean: Option<Mean>,
}

/// Every rate that the steps determine.
pub(super) fn overall(runs: &[Followed], robot: &Robot, confidence: f64) -> Vec<Overall> {
    let of = |rate: Rate| {
        let total = |run: &Followed| sums(&run.steps, rate, 1, |_| Some(0)).remove(0);
        let sums: Vec<Sum> = runs.iter().map(total).filter(|sum| sum.amount > 0.0).collect();
        let shown = match rate {
            Rate::Yaw | Rate::Turn => runs.iter().all(|run| run.with_heading),
            Rate::Forward => runs.iter().all(|run| !run.observed.headings_only),
            _ => runs.iter().all(|run| run.with_heading && !run.observed.headings_only),
        };
        let resolution = rate.resolution(robot);
        let mean = Mean::rate(&sums, resolution, confidence).filter(|_| shown)?;
        let rates: Vec<f64> = sums.iter().map(|sum| sum.error / sum.amount).collect();
        let p = p_of_zero(&rates, shared_rate(&sums, resolution));
        Some(Overall { rate, mean, test: p.map(|p| Test { p, gain: worth::of_level(runs, rate) }) })
    };
    Rate::ALL.into_iter().filter_map(of).collect()
}

/// The errors of a run in each of `bins`.
fn sums(steps: &[ErrorIncrement], rate: Rate, bins: usize, bin: impl Fn(&ErrorIncrement) -> Option<usize>) -> Vec<Sum> {
    let mut sums = vec![Sum::default(); bins];
    let mut before: Option<usize> = None;
    for step in steps {
        let counted = rate.of(step).zip(bin(step));
        if let Some(([error, amount], bin)) = counted {
            let sum = &mut sums[bin];
            sum.error += error;
            sum.amount += amount;
            sum.ends += usize::from(before.is_none());
        }
        if let (Some(last), None) = (before, counted) {
            sums[last].ends += 1;
        }
        before = counted.map(|(_, bin)| bin);
    }
    if let Some(last) = before {
        sums[last].ends += 1;
    }
    sums
}

/// Variance of a rate that all runs may share.
fn shared_rate(sums: &[Sum], resolution: f64) -> f64 {
    let amount = sums.iter().map(|sum| sum.amount).sum::<f64>() / sums.len().max(1) as f64;
    shared(sums.iter(), resolution) / (amount * amount).max(f64::MIN_POSITIVE)
}

/// Every determined rate against every covariate.
pub(super) fn against(runs: &[Followed], overall: &[Overall], robot: &Robot, confidence: f64) -> Vec<Against> {
    let shown = Rate::DEPENDING.into_iter().filter(|rate| overall.iter().any(|o| o.rate == *rate));
    let pairs = shown.flat_map(|rate| COVARIATES.iter().map(move |covariate| (rate, covariate)));
    pairs.filter_map(|(rate, covariate)| ask(runs, rate, covariate, robot, confidence)).collect()
}

fn ask(
    runs: &[Followed],
    rate: Rate,
    covariate: &'static Covariate,
    robot: &Robot,
    confidence: f64,
) -> Option<Against> {
    let counted = || runs.iter().flat_map(|run| &run.steps).filter(|step| rate.of(step).is_some());
    let bins = covariate.bins(rate, counted())?;
    let spans = bins.spans();
    let resolution = rate.resolution(robot);
    let by_run: Vec<Vec<Sum>> =
        runs.iter().map(|run| sums(&run.steps, rate, spans.len(), |step| bins.index(step))).collect();
    let of_bin = |(index, span): (usize, Span)| {
        let own: Vec<Sum> = by_run.iter().map(|run| run[index]).filter(|sum| sum.amount > 0.0).collect();
        let amount = own.iter().map(|sum| sum.amount).sum();
        Bin { span, amount, mean: Mean::rate(&own, resolution, confidence) }
    };
    let told: Vec<Bin> = spans.iter().copied().enumerate().map(of_bin).collect();
    let range = told.iter().filter(|bin| bin.mean.is_some()).count() > 1;
    let value = covariate.value(rate)?;
    let between = covariate.between_runs.then(|| between(runs, rate, value, &told, resolution)).flatten();
    let blurred = covariate.blurred(rate, &spans, robot, counted());
    let within = if blurred { None } else { within(&by_run, resolution) };
    let tests: Vec<f64> = [within, between].into_iter().flatten().collect();
    let smallest = tests.iter().copied().reduce(f64::min);
    let p = smallest.filter(|_| range).map(|p| (p * tests.len() as f64).min(1.0));
    let between = covariate.between_runs.then_some(value);
    let test = p.map(|p| Test { p, gain: worth::of_dependence(runs, rate, &bins, between) });
    Some(Against { rate, covariate, bins: told, blurred, test })
}

/// p of the bin whose rate differs most from that of the whole run, run by run: Student's t, Bonferroni over the bins.
///
/// Each run is compared with itself, so neither its level nor differences between runs matter.
fn within(by_run: &[Vec<Sum>], resolution: f64) -> Option<f64> {
    let rest = |run: &Vec<Sum>, bin: usize| {
        let (error, amount) = run.iter().fold((0.0, 0.0), |(e, a), sum| (e + sum.error, a + sum.amount));
        let own = run[bin];
        (own.amount > 0.0 && own.amount < amount).then(|| (own.error - own.amount * error / amount, own))
    };
    let of_bin = |bin: usize| {
        let (rests, sums): (Vec<f64>, Vec<Sum>) = by_run.iter().filter_map(|run| rest(run, bin)).unzip();
        p_of_zero(&rests, shared(sums.iter(), resolution))
    };
    let p: Vec<f64> = (0..by_run.first()?.len()).filter_map(of_bin).collect();
    p.iter().copied().reduce(f64::min).map(|least| (least * p.len() as f64).min(1.0))
}

/// p of the slope of the runs' rates against their mean of the covariate, if runs differ in it.
fn between(runs: &[Followed], rate: Rate, value: Value, bins: &[Bin], resolution: f64) -> Option<f64> {
    let of_run = |run: &Followed| {
        let sum = sums(&run.steps, rate, 1, |_| Some(0)).remove(0);
        let at = run.steps.iter().filter_map(|step| Some(rate.of(step)?[1] * value(&step.at))).sum::<f64>();
        (sum.amount > 0.0).then(|| ([at / sum.amount, sum.error / sum.amount], sum))
    };
    let (means, sums): (Vec<[f64; 2]>, Vec<Sum>) = runs.iter().filter_map(of_run).unzip();
    let amounts: Vec<f64> = sums.iter().map(|sum| sum.amount).collect();
    let ends = bins.iter().flat_map(|bin| [bin.span.low, bin.span.high]).filter(|end| end.is_finite());
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), end| (l.min(end), h.max(end)));
    let n = means.len() as f64;
    let centre = means.iter().map(|m| m[0]).sum::<f64>() / n;
    let scatter = (means.iter().map(|m| (m[0] - centre).powi(2)).sum::<f64>() / n).sqrt();
    p_of_slope(&means, &amounts, shared_rate(&sums, resolution)).filter(|_| scatter > DIFFER * (high - low))
}
