//! Errors in proportion to what was driven: whether there are any, and what they depend on.

use super::covariate::{COVARIATES, Covariate, Rate, Span};
use super::followed::{Followed, Step};
use super::mean::{Mean, p_of_slope, p_of_zero};

/// Runs differ in a covariate where their means scatter by more than this share of its range.
const DIFFER: f64 = 0.02;

/// A rate over everything that was driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Overall {
    /// Which.
    pub rate: Rate,
    /// Mean over the runs.
    pub mean: Mean,
    /// p of no error at all: that of the runs' rates by Student's t; `None` below three runs.
    pub p: Option<f64>,
}

/// A rate against something that it may depend on.
#[derive(Clone, Debug)]
pub struct Against {
    /// Which rate.
    pub rate: Rate,
    /// What it may depend on.
    pub covariate: &'static Covariate,
    /// The rate in each bin.
    pub bins: Vec<Bin>,
    /// p of a rate that does not depend on it; `None` where the runs are too few, or it has no range in them.
    pub p: Option<f64>,
}

/// A rate in one bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Where.
    pub span: Span,
    /// How much was driven there, in all runs \[m or rad\].
    pub amount: f64,
    /// Mean over the runs that were there; `None` where none was.
    pub mean: Option<Mean>,
}

/// Every rate that the steps show.
pub(super) fn overall(runs: &[Followed], confidence: f64) -> Vec<Overall> {
    let of = |rate: Rate| {
        let sums: Vec<[f64; 2]> = runs.iter().filter_map(|run| total(rate, &run.steps)).collect();
        let shown = rate == Rate::Forward || runs.iter().all(|run| run.with_heading);
        let mean = Mean::rate(&sums, confidence).filter(|_| shown)?;
        let rates: Vec<f64> = sums.iter().map(|[error, amount]| error / amount).collect();
        Some(Overall { rate, mean, p: p_of_zero(&rates) })
    };
    Rate::ALL.into_iter().filter_map(of).collect()
}

fn total(rate: Rate, steps: &[Step]) -> Option<[f64; 2]> {
    let sum = steps.iter().filter_map(|s| rate.of(s)).fold([0.0; 2], |sum, [e, a]| [sum[0] + e, sum[1] + a]);
    (sum[1] > 0.0).then_some(sum)
}

/// Every rate that is shown, against everything that it may depend on.
pub(super) fn against(runs: &[Followed], overall: &[Overall], confidence: f64) -> Vec<Against> {
    let shown = Rate::DEPENDING.into_iter().filter(|rate| overall.iter().any(|o| o.rate == *rate));
    let pairs = shown.flat_map(|rate| COVARIATES.iter().map(move |covariate| (rate, covariate)));
    pairs.filter_map(|(rate, covariate)| ask(runs, rate, covariate, confidence)).collect()
}

fn ask(runs: &[Followed], rate: Rate, covariate: &'static Covariate, confidence: f64) -> Option<Against> {
    let counted = || runs.iter().flat_map(|run| &run.steps).filter(|step| rate.of(step).is_some());
    let bins = covariate.bins(rate, counted())?;
    let value = covariate.value(rate)?;
    let spans = bins.spans();
    let mut sums = vec![vec![[0.0; 2]; spans.len()]; runs.len()];
    let mut means = Vec::new();
    for (run, sums) in runs.iter().zip(&mut sums) {
        let (mut at, mut amount) = (0.0, 0.0);
        for step in &run.steps {
            let (Some([error, driven]), Some(bin)) = (rate.of(step), bins.index(step)) else { continue };
            sums[bin] = [sums[bin][0] + error, sums[bin][1] + driven];
            (at, amount) = (at + driven * value(&step.at), amount + driven);
        }
        if amount > 0.0 {
            means.push([at / amount, sums.iter().map(|s| s[0]).sum::<f64>() / amount]);
        }
    }
    let of_bin = |(index, span): (usize, Span)| {
        let own: Vec<[f64; 2]> = sums.iter().map(|run| run[index]).filter(|[_, amount]| *amount > 0.0).collect();
        Bin { span, amount: own.iter().map(|[_, amount]| amount).sum(), mean: Mean::rate(&own, confidence) }
    };
    let bins: Vec<Bin> = spans.into_iter().enumerate().map(of_bin).collect();
    let range = bins.iter().filter(|bin| bin.mean.is_some()).count() > 1;
    let between = covariate.between_runs.then(|| between(&means, &bins)).flatten();
    let tests: Vec<f64> = [within(&sums), between].into_iter().flatten().collect();
    let smallest = tests.iter().copied().reduce(f64::min);
    let p = smallest.filter(|_| range).map(|p| (p * tests.len() as f64).min(1.0));
    Some(Against { rate, covariate, bins, p })
}

/// p of the bin whose rate differs most from that of the whole run, run by run: Student's t, Bonferroni over the bins.
///
/// Each run is compared with itself, so neither the level nor what differs from run to run matters.
fn within(sums: &[Vec<[f64; 2]>]) -> Option<f64> {
    let rest = |run: &Vec<[f64; 2]>, bin: usize| {
        let [error, amount] = run.iter().fold([0.0; 2], |sum, [e, a]| [sum[0] + e, sum[1] + a]);
        let [own, there] = run[bin];
        (there > 0.0 && there < amount).then(|| own - there * error / amount)
    };
    let of_bin = |bin: usize| p_of_zero(&sums.iter().filter_map(|run| rest(run, bin)).collect::<Vec<_>>());
    let p: Vec<f64> = (0..sums.first()?.len()).filter_map(of_bin).collect();
    p.iter().copied().reduce(f64::min).map(|least| (least * p.len() as f64).min(1.0))
}

/// p of the slope of the runs' rates against their mean of the covariate, where runs differ in it.
fn between(means: &[[f64; 2]], bins: &[Bin]) -> Option<f64> {
    let ends = bins.iter().flat_map(|bin| [bin.span.low, bin.span.high]).filter(|end| end.is_finite());
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), end| (l.min(end), h.max(end)));
    let n = means.len() as f64;
    let centre = means.iter().map(|m| m[0]).sum::<f64>() / n;
    let scatter = (means.iter().map(|m| (m[0] - centre).powi(2)).sum::<f64>() / n).sqrt();
    p_of_slope(means).filter(|_| scatter > DIFFER * (high - low))
}
