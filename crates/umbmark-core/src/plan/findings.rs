//! All that is said of a planned test.

use super::{
    Alternative, Drift, ExpectedInterval, ExtendedTest, Options, PlanError, Planned, Setting, Shown, Sought,
    alternatives, drifts, expected_dataset, extended_test, intervals, runs_needed,
};
use crate::diagnose::{Experiment, Unseen, base_model, separating};
use crate::stats::Interval;
use crate::watch::Watch;

/// Bumps of an extended test where the robot's own has none: those of Table II.
const BUMPS: f64 = 10.0;

/// What is asked of a planned test.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Runs a direction.
    pub runs: usize,
    /// Sizes that are to be seen, with their values as they were given.
    pub see: &'a [(Sought, f64)],
    /// Probability with which they are to be seen.
    pub power: f64,
    /// Numbers of runs a direction that are looked at beside.
    pub numbers: &'a [usize],
    /// Where σ may lie \[m\], where it was measured.
    pub sigma_interval: Option<Interval>,
    /// How it is tested.
    pub options: Options,
}

/// What is said of one size that is to be seen.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The size.
    pub sought: Sought,
    /// Its value, as it was given.
    pub value: f64,
    /// Runs a direction that it takes; `None` where [`MOST_RUNS`](super::MOST_RUNS) are too few.
    pub runs: Option<usize>,
    /// The same at both ends of σ's interval.
    pub runs_at_sigma: Option<[Option<usize>; 2]>,
    /// Probability that the planned runs show it.
    pub power: f64,
    /// By what.
    pub shown: Shown,
    /// Experiments that show it where return poses do not.
    pub separable: Vec<Experiment>,
}

/// What one number of runs shows.
#[derive(Clone, Debug)]
pub struct OfRuns {
    /// E_max,sys and its interval.
    pub interval: ExpectedInterval,
    /// The least of each size.
    pub least: Vec<Option<f64>>,
}

/// All that is said.
#[derive(Clone, Debug)]
pub struct Findings {
    /// What is to be seen.
    pub answers: Vec<Answer>,
    /// Sizes that the planned test would show.
    pub sizes: Vec<Sought>,
    /// Effects that it cannot show.
    pub unseen: Vec<Unseen>,
    /// What each number of runs shows of `sizes`.
    pub by_runs: Vec<OfRuns>,
    /// Other tests.
    pub alternatives: Vec<Alternative>,
    /// Sizes that the other tests are compared by.
    pub compared: Vec<Sought>,
    /// With bumps; `None` without headings.
    pub extended: Option<ExtendedTest>,
    /// What drifts do in each order of the runs.
    pub drifts: Vec<Drift>,
    /// Whether it was stopped early.
    pub partial: bool,
}

impl Request<'_> {
    /// All that can be said before the robot is driven. Once stopped, the parts that are done.
    pub fn findings(&self, setting: &Setting, watch: &Watch) -> Result<Findings, PlanError> {
        let steps = (self.see.len() + self.numbers.len() + 1) as f64;
        let told = |done: usize| (watch.progress)(done as f64 / steps);
        let planned = Planned::new(setting, self.runs, &self.options)?;
        let mut answers = Vec::new();
        for (sought, value) in self.see.iter().take_while(|_| !watch.is_stopped()) {
            answers.push(self.answer(setting, &planned, sought, *value)?);
            told(answers.len());
        }
        let sizes = planned.sizes();
        let mut by_runs = Vec::new();
        for n in self.numbers.iter().take_while(|_| !watch.is_stopped()) {
            by_runs.extend(self.of_runs(setting, *n, &sizes)?);
            told(answers.len() + by_runs.len());
        }
        let compared = self.compared(&planned, &sizes);
        let mut findings = Findings {
            answers,
            unseen: planned.unseen().to_vec(),
            by_runs,
            alternatives: Vec::new(),
            compared,
            extended: None,
            drifts: Vec::new(),
            partial: watch.is_stopped(),
            sizes,
        };
        if !findings.partial {
            findings.alternatives = alternatives(setting, self.runs, &findings.compared, self.power, &self.options)?;
            findings.extended = self.extended(setting)?;
            findings.drifts = drifts(setting, self.runs, &findings.sizes[..findings.sizes.len().min(2)])?;
            (watch.progress)(1.0);
        }
        Ok(findings)
    }

    fn answer(&self, setting: &Setting, planned: &Planned, sought: &Sought, value: f64) -> Result<Answer, PlanError> {
        let needed = |setting: &Setting| runs_needed(setting, sought, self.power, &self.options);
        let runs = needed(setting)?;
        let at = |sigma: f64| needed(&setting.clone().with_sigma(sigma));
        let runs_at_sigma = match self.sigma_interval {
            Some(sigma) => Some([at(sigma.low)?, at(sigma.high)?]),
            None => None,
        };
        let shown = planned.shown(sought);
        let separable = match &shown {
            Shown::Absorbed(by) => {
                let data = expected_dataset(setting, planned.runs);
                separating(&data, &base_model(setting.robot())?, [by[0], sought.effect.about.name])?
            }
            _ => Vec::new(),
        };
        Ok(Answer { sought: *sought, value, runs, runs_at_sigma, power: planned.power(sought), shown, separable })
    }

    fn of_runs(&self, setting: &Setting, n: usize, sizes: &[Sought]) -> Result<Option<OfRuns>, PlanError> {
        let Options { size, draws, seed, .. } = self.options;
        let least = Planned::new(setting, n, &self.options)?.least_of(sizes, self.power);
        let expected = intervals(setting, &[n], 1.0 - size, 2 * draws as u32, seed);
        Ok(expected.first().map(|interval| OfRuns { interval: *interval, least }))
    }

    /// E_d and E_b, and what else is to be seen and can be.
    fn compared(&self, planned: &Planned, sizes: &[Sought]) -> Vec<Sought> {
        let mut compared: Vec<Sought> = sizes.iter().take(2).copied().collect();
        let is_new = |s: &&Sought| compared.iter().all(|known| known.parameter.name != s.parameter.name);
        let sought = self.see.iter().map(|(sought, _)| sought);
        let others = sought.filter(|s| matches!(planned.shown(s), Shown::Fitted(_) | Shown::Asked));
        let others: Vec<Sought> = others.filter(is_new).copied().collect();
        compared.extend(others);
        compared
    }

    fn extended(&self, setting: &Setting) -> Result<Option<ExtendedTest>, PlanError> {
        if !setting.with_heading {
            return Ok(None);
        }
        let bumps = Some(setting.bumps()).filter(|bumps| *bumps > 0.0).unwrap_or(BUMPS);
        extended_test(setting, self.runs, bumps, &self.options).map(Some)
    }
}
