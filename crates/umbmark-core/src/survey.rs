//! Many robots of one kind: the numbers of each, how far they are apart, and which of them stand out.
//!
//! Each robot is fitted, and where it is asked diagnosed, by itself; only its row is kept. A number x_i of robot i with its standard error s_i
//! varies among robots with a standard deviation τ of its own beside the errors:
//!
//! ```text
//! x_i ~ N(μ, τ² + s²)
//! ```
//!
//! with the mean s² of all s_i², each of which is known by few runs, by restricted maximum likelihood: what remains of the spread once the errors of the tests are
//! taken off is the tolerance with which such robots are made. Robots that stand out are left out of μ and τ: one by one, the farthest from the
//! mean of those that are left is compared with the largest of so many normal deviations, and all up to the last that is certain stand out, at most one in
//! four (generalised extreme studentised deviates).
//!
//! Sources: Raudenbush (2009), in The Handbook of Research Synthesis; Rosner (1983), Technometrics 25, 165.

#[cfg(test)]
mod tests;

use crate::conditions::{Number, between, mean_and_deviation};
use crate::dataset::Dataset;
use crate::diagnose::{Options, Verdict, diagnose, first_model};
use crate::evidence::{Estimate, fit, fit_to_returns};
use crate::score::score_dataset;
use crate::stats::{Interval, student_t_quantile, t_two_sided};
use crate::watch::Watch;
use rayon::prelude::*;
use std::borrow::Borrow;
use std::fmt::Display;
use std::sync::atomic::{AtomicUsize, Ordering};

/// At most one robot in so many stands out.
const ROBOTS_PER_OUTLIER: usize = 4;
/// Fewer robots do not show how far they are apart.
pub const FEWEST: usize = 3;

/// What is found of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its name.
    pub robot: String,
    /// Number of runs.
    pub runs: usize,
    /// Its numbers: E_d, E_b and, of tracks, E_s, or those of its drive.
    pub numbers: Vec<Estimate>,
    /// E_max,sys \[m\], where both directions returned.
    pub e_max_sys: Option<f64>,
    /// Whether these numbers explain the runs; `None` where nobody asked.
    pub verdict: Option<Verdict>,
    /// The class of effects that is missing.
    pub missing: Vec<&'static str>,
    /// Numbers in which it stands out from the others, each with p adjusted for all robots and numbers.
    pub stands_out: Vec<(Number, f64)>,
}

/// How far robots are apart in one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Among {
    /// The number.
    pub number: Number,
    /// Number of robots that show it and do not stand out.
    pub robots: usize,
    /// Their mean.
    pub mean: f64,
    /// Its interval.
    pub interval: Interval,
    /// τ: standard deviation between robots.
    pub deviation: f64,
    /// Its interval.
    pub deviation_interval: Interval,
    /// Typical standard error of one robot's number: root mean square.
    pub error: f64,
}

/// Many robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// A row for each robot of which something was found, in their order.
    pub rows: Vec<Row>,
    /// Robots of which nothing was found, each with the reason.
    pub failed: Vec<(String, String)>,
    /// How far they are apart.
    pub among: Vec<Among>,
    /// False-alarm rate: of a verdict on one robot, and of all robots that stand out together.
    pub size: f64,
    /// Whether the work was stopped before all robots were asked.
    pub partial: bool,
}

/// Fits, and where `diagnosed` diagnoses, robots in parallel. `load` gives the runs of one by its place, or why there are none; they are dropped once its row is
/// made.
pub fn survey<D: Borrow<Dataset>, E: Display>(
    names: &[String],
    load: impl Fn(usize) -> Result<D, E> + Sync,
    diagnosed: bool,
    options: &Options,
    watch: &Watch,
) -> Survey {
    let done = AtomicUsize::new(0);
    let of_robot = |(place, name): (usize, &String)| {
        if watch.is_stopped() {
            return None;
        }
        let found = load(place)
            .map_err(|error| error.to_string())
            .and_then(|data| row(name, data.borrow(), diagnosed, options).map_err(|error| error.to_string()));
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        (watch.progress)(count as f64 / names.len() as f64);
        Some((name.clone(), found))
    };
    let found: Vec<Option<(String, Result<Row, String>)>> =
        names.par_iter().enumerate().with_max_len(1).map(of_robot).collect();
    let partial = found.iter().any(Option::is_none);
    let (mut rows, mut failed) = (Vec::new(), Vec::new());
    for (name, found) in found.into_iter().flatten() {
        match found {
            Ok(row) => rows.push(row),
            Err(why) => failed.push((name, why)),
        }
    }
    stand_out(&mut rows, options.size);
    let among = numbers(&rows).into_iter().filter_map(|number| among(&rows, number, 1.0 - options.size)).collect();
    Survey { rows, failed, among, size: options.size, partial }
}

fn row(name: &str, data: &Dataset, diagnosed: bool, options: &Options) -> Result<Row, crate::evidence::FitError> {
    let model = first_model(data)?;
    let options = Options { experiments: false, ..*options };
    let (numbers, verdict, missing) = if diagnosed {
        let found = diagnose(data, &model, &options)?;
        let first = found.ranking.first().filter(|suspect| suspect.p_adjusted < options.size);
        let missing = first.map_or(Vec::new(), |suspect| suspect.class.clone());
        (found.fitted, Some(found.verdict), missing)
    } else if options.ends_only {
        (fit_to_returns(data, &model)?.1, None, Vec::new())
    } else {
        (fit(data, &model)?.estimates, None, Vec::new())
    };
    let first = model.robot().drive.first_effects();
    let numbers = numbers.into_iter().filter(|own| first.contains(&own.effect)).collect();
    let e_max_sys = score_dataset(data, 1.0 - options.size).ok().and_then(|score| score.summary.e_max_sys());
    let (robot, runs) = (name.to_owned(), data.runs.len());
    Ok(Row { robot, runs, numbers, e_max_sys, verdict, missing, stands_out: Vec::new() })
}

fn number(estimate: &Estimate) -> Number {
    Number { effect: estimate.effect, parameter: estimate.parameter }
}

/// The numbers that some robots show, in the order in which they do.
fn numbers(rows: &[Row]) -> Vec<Number> {
    let mut numbers: Vec<Number> = Vec::new();
    for own in rows.iter().flat_map(|row| &row.numbers).map(number) {
        if !numbers.contains(&own) {
            numbers.push(own);
        }
    }
    numbers
}

/// The robots that show a number, by their places, with its value.
fn showing(rows: &[Row], wanted: Number) -> Vec<(usize, &Estimate)> {
    let of = |(place, row): (usize, &'_ Row)| {
        let own = row.numbers.iter().position(|own| number(own) == wanted && own.standard_error > 0.0);
        own.map(|own| (place, own))
    };
    rows.iter().enumerate().filter_map(of).map(|(place, own)| (place, &rows[place].numbers[own])).collect()
}

/// Names the robots that stand out: the most that are one by one the farthest, and surely farther than chance makes.
fn stand_out(rows: &mut [Row], size: f64) {
    let all = numbers(rows);
    for wanted in &all {
        let farthest = farthest(rows, *wanted);
        let certain = farthest.iter().map(|(place, p)| (*place, (all.len() as f64 * p).min(1.0))).collect::<Vec<_>>();
        let count = certain.iter().rposition(|(_, p)| *p < size).map_or(0, |last| last + 1);
        let mut least = 1.0_f64;
        // One that stands behind a farther one that is certain is as certain.
        for (place, p) in certain[..count].iter().rev() {
            least = least.min(*p);
            rows[*place].stands_out.push((*wanted, least));
        }
    }
}

/// The robots that are farthest from the mean in a number, each among those that are left, with the p of the largest of so many normal deviations.
fn farthest(rows: &[Row], wanted: Number) -> Vec<(usize, f64)> {
    let shown = showing(rows, wanted);
    // The error of a robot is known by few runs, the variance of a run by those of all robots.
    let runs = |place: usize| rows[place].runs.max(1) as f64;
    let of_run = shown.iter().map(|(place, own)| runs(*place) * own.standard_error.powi(2)).sum::<f64>();
    let error = |place: usize| (of_run / shown.len() as f64 / runs(place)).sqrt();
    let mut left: Vec<(usize, f64, f64)> =
        shown.iter().map(|(place, own)| (*place, own.value, error(*place))).collect();
    let mut found = Vec::new();
    for _ in 0..(shown.len() / ROBOTS_PER_OUTLIER).max(1) {
        let robots = left.len() as f64;
        let values: Vec<f64> = left.iter().map(|(_, value, _)| *value).collect();
        let errors: Vec<f64> = left.iter().map(|(.., error)| *error).collect();
        let Some((mean, apart)) = mean_and_deviation(&values, &errors).filter(|_| left.len() >= FEWEST) else { break };
        let off = |(_, value, error): &(usize, f64, f64)| (value - mean) / apart.hypot(*error);
        let deviation = (left.iter().map(|one| off(one).powi(2)).sum::<f64>() / (robots - 1.0)).sqrt();
        let Some(place) = (0..left.len()).max_by(|a, b| off(&left[*a]).abs().total_cmp(&off(&left[*b]).abs())) else {
            break;
        };
        let largest = off(&left[place]).abs() / deviation;
        if !largest.is_finite() {
            break;
        }
        let rest = ((robots - 1.0).powi(2) - robots * largest * largest).max(0.0);
        let t = largest * (robots * (robots - 2.0) / rest).sqrt();
        found.push((left.remove(place).0, (robots * t_two_sided(t, robots - 2.0)).min(1.0)));
    }
    found
}

fn among(rows: &[Row], wanted: Number, level: f64) -> Option<Among> {
    let is_usual =
        |(place, _): &(usize, &Estimate)| rows[*place].stands_out.iter().all(|(number, _)| *number != wanted);
    let usual: Vec<&Estimate> = showing(rows, wanted).into_iter().filter(is_usual).map(|(_, own)| own).collect();
    if usual.len() < FEWEST {
        return None;
    }
    let values: Vec<f64> = usual.iter().map(|own| own.value).collect();
    // Each error is known by few runs: weights of their own would favour those that are too small by chance, and show a spread where there is none.
    let squares: Vec<f64> = usual.iter().map(|own| own.standard_error * own.standard_error).collect();
    let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let found = between(&values, &vec![error; values.len()], level)?;
    let half = student_t_quantile(0.5 + 0.5 * level, (usual.len() - 1) as f64) * found.mean_error;
    Some(Among {
        number: wanted,
        robots: usual.len(),
        mean: found.mean,
        interval: Interval::around(found.mean, half),
        deviation: found.deviation,
        deviation_interval: found.interval,
        error,
    })
}

impl Survey {
    /// Robots that stand out from the others.
    pub fn outliers(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.stands_out.is_empty())
    }

    /// Robots whose runs their numbers do not explain.
    pub fn unexplained(&self) -> impl Iterator<Item = &Row> {
        let doubted = |row: &&Row| {
            row.verdict.is_some_and(|verdict| !matches!(verdict, Verdict::Explained | Verdict::NotEnoughData))
        };
        self.rows.iter().filter(doubted)
    }
}
