//! How soon a change would be found that happened now: simulated, with the mean and the scatter that the runs have.

use super::limits::limits;
use super::scores::{COMPONENTS, Scorer, Vector, cholesky};
use super::statistic::Scan;
use super::{Course, NUMBERS};
use crate::random::Stream;
use rayon::prelude::*;

/// Random numbers of these simulations.
const PURPOSE: u64 = 0x6472_6966_7400;

/// Simulated futures of each change.
const FUTURES: u64 = 200;

/// Runs of a future at most.
const LONGEST: usize = 60;

/// Runs of the past that a future is watched with.
const PAST: usize = 100;

/// Changes that are tried: a length by its key in robot.toml, and the share by which it grows.
pub const DELAYS: [(&str, f64); 6] = [
    ("wheel_diameter_right_m", -0.001),
    ("wheel_diameter_right_m", -0.002),
    ("wheel_diameter_right_m", -0.005),
    ("wheelbase_m", 0.002),
    ("wheelbase_m", 0.005),
    ("wheelbase_m", 0.01),
];

/// How soon a change would be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    /// The key of a length in robot.toml.
    pub key: &'static str,
    /// The share by which it grows.
    pub share: f64,
    /// Runs after which half of such changes are found; `None` for more than 60.
    pub half: Option<usize>,
    /// Runs after which nine of ten are.
    pub most: Option<usize>,
}

/// What a share of a length does to E_d, E_b and E_s.
fn numbers_of(key: &str) -> [f64; NUMBERS] {
    match key {
        "wheel_diameter_right_m" => [1.0, 0.0, 0.5],
        "wheel_diameter_left_m" => [-1.0, 0.0, 0.5],
        _ => [0.0, 1.0, 0.0],
    }
}

/// Each of the [`DELAYS`].
pub(super) fn delays(course: &Course, scorers: &[Scorer; 2], scan: &Scan, per_run: f64, seed: u64) -> Vec<Delay> {
    let past = scan.recent(PAST);
    let of = |(index, (key, share)): (usize, &(&'static str, f64))| {
        let mut runs: Vec<usize> = (0..FUTURES)
            .into_par_iter()
            .map(|future| {
                let mut stream = Stream::new(seed, PURPOSE + index as u64, future);
                runs_until_seen(
                    course,
                    scorers.clone(),
                    past.clone(),
                    scan.scored(),
                    (key, *share),
                    per_run,
                    &mut stream,
                )
            })
            .collect();
        runs.sort_unstable();
        let quantile = |of_ten: usize| Some(runs[runs.len() * of_ten / 10 - 1]).filter(|runs| *runs <= LONGEST);
        Delay { key, share: *share, half: quantile(5), most: quantile(9) }
    };
    DELAYS.iter().enumerate().map(of).collect()
}

/// Runs until one future is found, in turns by direction.
fn runs_until_seen(
    course: &Course,
    mut scorers: [Scorer; 2],
    mut scan: Scan,
    scored: usize,
    (key, share): (&str, f64),
    per_run: f64,
    stream: &mut Stream,
) -> usize {
    let count = course.signature.components;
    let driven: Vec<usize> = (0..2).filter(|direction| scorers[*direction].runs > 0).collect();
    let law = scorers.each_ref().map(|scorer| {
        let factor = cholesky(&scorer.scatter, count)?;
        let scale = 1.0 / ((scorer.runs.max(2) - 1) as f64).sqrt();
        Some((scorer.mean, factor.map(|row| row.map(|value| value * scale))))
    });
    let numbers = numbers_of(key);
    for run in 0..LONGEST {
        let direction = driven[run % driven.len()];
        let Some((mean, factor)) = &law[direction] else { return LONGEST + 1 };
        let slopes = &course.signature.slopes[direction];
        let draws: Vector = std::array::from_fn(|_| stream.normal());
        let mut components: Vector = [0.0; COMPONENTS];
        for k in 0..count {
            let noise: f64 = (0..=k).map(|j| factor[k][j] * draws[j]).sum();
            let shift: f64 = (0..NUMBERS).map(|number| slopes[k][number] * numbers[number]).sum();
            components[k] = mean[k] + noise + share * shift;
        }
        let seen = scorers[direction].add(&components);
        scan.add(direction, seen.as_ref());
        let limits = limits(&course.signature, course.directions, scored + run + 1, per_run);
        if scan.peaks().iter().zip(limits).any(|(peak, limit)| peak.height > limit) {
            return run + 1;
        }
    }
    LONGEST + 1
}
