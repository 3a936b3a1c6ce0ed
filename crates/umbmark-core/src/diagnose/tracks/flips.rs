//! Sign flips: the certificate that trusts no noise model.
//!
//! Where nothing is missing, the score of a run for an effect is as likely the one sign as the other. Flipping the signs of all runs'
//! scores at once therefore gives other outcomes of the same experiment, whatever the noise within a run looks like, and
//! the greatest statistic among all effects is compared with the greatest after each flip.
//!
//! Source: Hemerik, Goeman & Finos (2020), Robust testing in generalized linear models by sign flipping score contributions;
//! the greatest statistic, Westfall & Young (1993).

use crate::random::Stream;
use nalgebra::{DMatrix, DVector};
use rand::Rng;

/// Up to so many units all flips are taken, beyond as many at random.
const ALL: usize = 12;
/// Purpose of the stream of random flips.
const FLIPS: u64 = 0x666c_6970;

/// The scores of a group of columns, unit by unit, and the inverse of their information.
#[derive(Clone, Debug)]
pub struct Scores {
    /// One a unit.
    pub units: Vec<DVector<f64>>,
    /// Covariance of the group's values.
    pub metric: DMatrix<f64>,
}

impl Scores {
    /// How far the flipped sum is from zero, as a standard normal's quantile (Wilson & Hilferty 1931).
    fn distance(&self, flips: &[bool]) -> f64 {
        let mut sum = DVector::zeros(self.metric.nrows());
        for (unit, flip) in self.units.iter().zip(flips) {
            if *flip { sum -= unit } else { sum += unit }
        }
        let terms = sum.len() as f64;
        let share = (sum.dot(&(&self.metric * &sum)) / terms).cbrt();
        let spread = 2.0 / (9.0 * terms);
        (share - (1.0 - spread)) / spread.sqrt()
    }
}

/// The family-wise p of each group: the share of flips under which some group is farther from zero than it is.
///
/// All flips of up to 12 units, else 4095 at random by `seed`; with the signs as they are, so that no p is 0.
pub fn family_wise(groups: &[Scores], seed: u64) -> Vec<f64> {
    let units = groups.first().map_or(0, |group| group.units.len());
    let mut stream = Stream::new(seed, FLIPS, 0);
    let count = 1_usize << (ALL.min(units.max(1)) - 1).max(if units > ALL { 12 } else { 0 });
    let mut flips = vec![false; units];
    let observed: Vec<f64> = groups.iter().map(|group| group.distance(&flips)).collect();
    let mut farther = vec![1_usize; groups.len()];
    for pattern in 1..count {
        for (unit, flip) in flips.iter_mut().enumerate() {
            *flip = if units <= ALL { pattern >> unit & 1 == 1 } else { stream.next_u64() >> 63 == 1 };
        }
        let greatest = groups.iter().map(|group| group.distance(&flips)).fold(f64::NEG_INFINITY, f64::max);
        for (count, distance) in farther.iter_mut().zip(&observed) {
            *count += usize::from(greatest >= *distance * (1.0 - 1e-12));
        }
    }
    farther.into_iter().map(|n| n as f64 / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(scores: &[f64]) -> Scores {
        let information: f64 = scores.iter().map(|s| s * s).sum();
        Scores {
            units: scores.iter().map(|s| DVector::from_element(1, *s)).collect(),
            metric: DMatrix::from_element(1, 1, 1.0 / information),
        }
    }

    #[test]
    fn scores_of_one_sign_have_the_least_p_there_is_and_balanced_ones_none() {
        let p = family_wise(&[group(&[1.0; 10]), group(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])], 1);
        // Of 512 flips only the alternating one takes the second group as far as the first is.
        assert_eq!(p[0], 2.0 / 512.0);
        assert_eq!(p[1], 1.0);
    }

    /// 2000 families of 8 groups with t-like tails, seed 7; the share of p <= 0.05 stays within 3 standard errors.
    #[test]
    fn the_size_is_held_with_heavy_tails_that_differ_from_run_to_run() {
        let mut stream = Stream::new(7, 0, 0);
        let families = 2000;
        let mut accused = 0;
        for _ in 0..families {
            let groups: Vec<Scores> = (0..8)
                .map(|_| {
                    let scores: Vec<f64> = (0..10)
                        .map(|i| stream.normal() * (1.0 + f64::from(i)) / stream.normal().abs().max(0.05))
                        .collect();
                    group(&scores)
                })
                .collect();
            accused += usize::from(family_wise(&groups, 1).into_iter().any(|p| p <= 0.05));
        }
        let share = f64::from(accused as u32) / f64::from(families);
        assert!((share - 0.05).abs() < 3.0 * (0.05 * 0.95 / f64::from(families)).sqrt(), "{share}");
    }
}
