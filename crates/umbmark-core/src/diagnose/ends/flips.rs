//! Sign flips of the runs' scores: a test without a noise model.
//!
//! If an effect is absent, a run's score for it is as likely to be positive as negative, for any covariance of its coordinates. So the
//! observed |Σ s_i| / √(Σ s_i²) is compared with that of other signs. For effects that are tested together, the largest statistic is
//! compared with the largest under each flip. Source: the sign-flip score tests of Hemerik, Goeman & Finos (2020).

use super::asked::Asked;
use super::moments::Both;
use crate::random::Stream;
use nalgebra::Vector3;

/// Up to this many runs, all sign patterns are tried.
const ALL: usize = 12;
/// Number of random patterns beyond that.
const DRAWN: usize = 1999;
const SIGNS: u64 = 11;

/// p of every unit as one of the family; smallest possible: 2^(1 - runs).
pub(crate) fn certificate(asked: &Asked, seed: u64) -> Vec<f64> {
    let scores: Vec<Vec<f64>> = asked.units.iter().map(|unit| scores(asked, &unit.shift)).collect();
    let patterns = patterns(asked.runs.len(), seed);
    let greatest = |signs: &Vec<f64>| scores.iter().map(|s| statistic(s, signs)).fold(0.0, f64::max);
    let maxima: Vec<f64> = patterns.iter().map(greatest).collect();
    let all_up = vec![1.0; asked.runs.len()];
    let p = |s: &Vec<f64>| {
        let observed = statistic(s, &all_up) * (1.0 - 1e-12);
        maxima.iter().filter(|m| **m >= observed).count() as f64 / maxima.len() as f64
    };
    scores.iter().map(p).collect()
}

/// Score of each run for an effect: its residual times the effect's shift, less what the model absorbs.
fn scores(asked: &Asked, shift: &Both) -> Vec<f64> {
    let Some(inverse) = asked.moments.scatter.cholesky() else { return vec![0.0; asked.runs.len()] };
    let freedom = asked.moments.freedom();
    let factor = inverse.l();
    let score = |(group, z): &(usize, Vector3<f64>)| {
        let whitened = factor.solve_lower_triangular(z).unwrap_or_else(Vector3::zeros) * freedom.sqrt();
        shift.fixed_rows::<3>(group * 3).dot(&whitened) / asked.moments.count(*group).sqrt()
    };
    of_unit_length(asked.runs.iter().map(score).collect())
}

/// Scores whose squares sum to 1, so that flips need no more than a sum; none are left as they are.
fn of_unit_length(scores: Vec<f64>) -> Vec<f64> {
    let length = scores.iter().map(|s| s * s).sum::<f64>().sqrt();
    if length > 0.0 { scores.iter().map(|s| s / length).collect() } else { scores }
}

fn statistic(scores: &[f64], signs: &[f64]) -> f64 {
    scores.iter().zip(signs).map(|(s, f)| s * f).sum::<f64>().abs()
}

/// Patterns of signs, the observed one among them. The first run keeps its sign: only relative signs matter.
fn patterns(runs: usize, seed: u64) -> Vec<Vec<f64>> {
    if runs <= ALL {
        let sign = |pattern: usize, run: usize| if run > 0 && pattern >> (run - 1) & 1 == 1 { -1.0 } else { 1.0 };
        return (0..1 << (runs - 1)).map(|p| (0..runs).map(|run| sign(p, run)).collect()).collect();
    }
    let mut stream = Stream::new(seed, SIGNS, 0);
    let mut drawn: Vec<Vec<f64>> =
        (0..DRAWN).map(|_| (0..runs).map(|_| if stream.uniform() < 0.5 { -1.0 } else { 1.0 }).collect()).collect();
    drawn.push(vec![1.0; runs]);
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{asked_of, steep};

    #[test]
    fn ten_runs_have_512_patterns_and_many_runs_have_drawn_ones_with_the_observed_among_them() {
        let ten = patterns(10, 1);
        assert_eq!(ten.len(), 512);
        assert!(ten.iter().all(|p| p[0] == 1.0) && ten[511][1..].iter().all(|f| *f == -1.0));
        let many = patterns(40, 1);
        assert_eq!((many.len(), &many[DRAWN]), (2000, &vec![1.0; 40]));
        assert_eq!(many, patterns(40, 1));
    }

    #[test]
    fn equal_scores_are_as_striking_as_can_be() {
        let statistic = |scores: &[f64]| statistic(&of_unit_length(scores.to_vec()), &vec![1.0; scores.len()]);
        assert!((statistic(&[2.0; 9]) - 3.0).abs() < 1e-12);
        assert_eq!(statistic(&[0.0; 3]), 0.0);
    }

    #[test]
    fn runs_that_all_speak_for_an_effect_are_one_pattern_of_512() {
        let mut asked = asked_of(&steep());
        asked.units.retain(|unit| unit.effect.about.name == "floor_slope" && unit.parameter.name == "drift_x");
        assert_eq!(certificate(&asked, 1), [1.0 / 512.0]);
    }
}
