//! Sign flips: the certificate that trusts no noise model.
//!
//! Where nothing is missing, the score of a run for an effect is as likely the one sign as the other. Flipping the signs of all runs'
//! scores at once therefore gives other outcomes of the same experiment, whatever the noise within a run looks like, and
//! the greatest statistic among all effects is compared with the greatest after each flip.
//!
//! Scores are taken beside fitted columns, so a flipped sum scatters less than the sum as it is: the fit has already taken from
//! it what looks like those columns, and flipping undoes that. Each sum is therefore measured against its own
//! covariance under its own flips. Without this the flips accuse too often where there are about as many fitted columns as runs.
//!
//! Source: Hemerik, Goeman & Finos (2020), Robust testing in generalized linear models by sign flipping score contributions;
//! standardised by the flip's own variance, De Santis, Goeman, Davenport, Hemerik & Finos (2022); the greatest statistic, Westfall & Young (1993).

use crate::random::Stream;
use crate::stats::f_upper_tail;
use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rayon::prelude::*;

/// Up to so many units all flips are taken, beyond as many at random.
const ALL: usize = 12;
/// Purpose of the stream of random flips.
const FLIPS: u64 = 0x666c_6970;
/// Share of the information that is left of it at least, however the signs fall: keeps a quotient of two nothings finite.
const LEAST: f64 = 1e-3;

/// The scores of a group of columns, unit by unit, and how they scatter.
#[derive(Clone, Debug)]
pub struct Scores {
    /// One a unit.
    pub units: Vec<DVector<f64>>,
    /// How much of the columns that were fitted out each unit's columns hold, those made orthonormal: one a unit.
    pub held: Vec<DMatrix<f64>>,
    /// What each unit holds of the information.
    pub parts: Vec<DMatrix<f64>>,
    /// Covariance of the sum of all scores.
    pub information: DMatrix<f64>,
}

impl Scores {
    /// How many units carry the group: all of them where each shows it as much, one where one shows it alone.
    pub fn carrying(&self) -> f64 {
        let weight = |part: &DMatrix<f64>| part.diagonal().component_div(&self.information.diagonal()).sum();
        let (sum, squares) = self.parts.iter().map(weight).fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
        if squares > 0.0 { sum * sum / squares } else { 0.0 }
    }

    /// p of a step by how the units' scores differ from what they would be at it: Student's t along the step, squared, with one
    /// value a unit. What noise that remembers does to whole runs is in it, where the noise model sees steps of centimetres.
    pub fn p_by_units(&self, step: &DVector<f64>) -> f64 {
        let units = self.units.len() as f64;
        let off = |(score, part): (&DVector<f64>, &DMatrix<f64>)| (score - part * step).dot(step).powi(2);
        let scatter: f64 = self.units.iter().zip(&self.parts).map(off).sum();
        let sum: f64 = self.units.iter().map(|score| score.dot(step)).sum();
        let t_squared = sum * sum * (units - 1.0) / (units * scatter);
        if units < 2.0 || t_squared.is_nan() { 1.0 } else { f_upper_tail(t_squared, [1.0, units - 1.0]) }
    }

    /// How far the flipped sum is from zero, as a standard normal's quantile (Wilson & Hilferty 1931).
    fn distance(&self, flips: &[bool], flipped: &mut Flipped) -> f64 {
        let terms = self.information.nrows();
        let height = self.held.first().map_or(0, DMatrix::nrows);
        let Flipped { sum, held, root } = flipped;
        for (of, length) in [(&mut *sum, terms), (&mut *held, height * terms), (&mut *root, terms * terms)] {
            of.clear();
            of.resize(length, 0.0);
        }
        for ((unit, own), flip) in self.units.iter().zip(&self.held).zip(flips) {
            let sign = if *flip { -1.0 } else { 1.0 };
            sum.iter_mut().zip(unit.as_slice()).for_each(|(sum, unit)| *sum += sign * unit);
            held.iter_mut().zip(own.as_slice()).for_each(|(held, own)| *held += sign * own);
        }
        // |L⁻¹ sum|², with L Lᵀ the covariance.
        let mut square = 0.0;
        for i in 0..terms {
            for j in 0..=i {
                let both = held[i * height..][..height].iter().zip(&held[j * height..][..height]);
                let mut rest = self.information[(i, j)] - both.map(|(a, b)| a * b).sum::<f64>();
                if i == j {
                    rest = rest.max(0.0) + LEAST * self.information[(i, i)];
                }
                let before = root[i * terms..][..j].iter().zip(&root[j * terms..][..j]);
                rest -= before.map(|(a, b)| a * b).sum::<f64>();
                if i == j && !(rest > 0.0) {
                    return f64::NEG_INFINITY;
                }
                root[i * terms + j] = if i == j { rest.sqrt() } else { rest / root[j * terms + j] };
            }
            let before = root[i * terms..][..i].iter().zip(&sum[..i]);
            sum[i] = (sum[i] - before.map(|(a, b)| a * b).sum::<f64>()) / root[i * terms + i];
            square += sum[i] * sum[i];
        }
        let terms = terms as f64;
        let share = (square / terms).cbrt();
        let spread = 2.0 / (9.0 * terms);
        (share - (1.0 - spread)) / spread.sqrt()
    }
}

/// Room for what is worked out of a group under a flip, one group after the other.
#[derive(Default)]
struct Flipped {
    sum: Vec<f64>,
    held: Vec<f64>,
    /// L, row by row.
    root: Vec<f64>,
}

/// Groups of columns under every flip of the signs of their units.
///
/// All flips of up to 12 units, else 4095 at random by `seed`; with the signs as they are, so that no p is 0. *Rejected*: flips of
/// what is left when the observed group has been fitted too. They have more power, but beside seven fitted columns ten runs have
/// too little left.
pub struct Family {
    /// How far the farthest group is from zero under each flip but that which is none.
    farthest: Vec<f64>,
}

impl Family {
    /// All groups, with the same units.
    pub fn new(groups: &[Scores], seed: u64) -> Family {
        let patterns = patterns(groups.first().map_or(0, |group| group.units.len()), seed);
        let farthest = |flips: &Vec<bool>| {
            let mut flipped = Flipped::default();
            let distances = groups.iter().map(|group| group.distance(flips, &mut flipped));
            distances.fold(f64::NEG_INFINITY, f64::max)
        };
        Family { farthest: patterns[1..].par_iter().map(farthest).collect() }
    }

    /// The share of flips under which some group is farther from zero than `observed`, one of them, is as it is.
    pub fn p(&self, observed: &Scores) -> f64 {
        let distance = observed.distance(&vec![false; observed.units.len()], &mut Flipped::default()) * (1.0 - 1e-12);
        let count = 1 + self.farthest.iter().filter(|farthest| **farthest >= distance).count();
        count as f64 / (1 + self.farthest.len()) as f64
    }
}

/// The signs as they are, and all other ways of flipping them; the last unit's sign stands, for flipping all changes nothing.
fn patterns(units: usize, seed: u64) -> Vec<Vec<bool>> {
    let mut stream = Stream::new(seed, FLIPS, 0);
    let count = 1_usize << (ALL.min(units.max(1)) - 1).max(if units > ALL { 12 } else { 0 });
    let flip = |pattern: usize, unit: usize, stream: &mut Stream| match units <= ALL {
        true => pattern >> unit & 1 == 1,
        false => stream.next_u64() >> 63 == 1,
    };
    let others = (1..count).map(|pattern| (0..units).map(|unit| flip(pattern, unit, &mut stream)).collect());
    std::iter::once(vec![false; units]).chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(scores: &[f64]) -> Scores {
        let information: f64 = scores.iter().map(|s| s * s).sum();
        Scores {
            units: scores.iter().map(|s| DVector::from_element(1, *s)).collect(),
            held: vec![DMatrix::zeros(0, 1); scores.len()],
            parts: vec![DMatrix::from_element(1, 1, information / scores.len() as f64); scores.len()],
            information: DMatrix::from_element(1, 1, information),
        }
    }

    #[test]
    fn scores_of_one_sign_have_the_least_p_there_is_and_balanced_ones_none() {
        let (one, balanced) = (group(&[1.0; 10]), group(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]));
        // Of 512 flips only the alternating one takes the second group as far as the first is.
        let both = [one.clone(), balanced.clone()];
        let family = Family::new(&both, 1);
        assert_eq!(family.p(&one), 2.0 / 512.0);
        assert_eq!(family.p(&balanced), 1.0);
    }

    /// Textbook: the mean of ten values, 1.0 more or less, t = mean/(sd/√10) with sd by n - 1.
    #[test]
    fn units_that_agree_speak_for_a_step_by_their_own_scatter() {
        let values = [1.3, 0.6, 1.1, 0.9, 1.4, 0.7, 1.2, 0.8, 1.0, 1.0];
        let scores = group(&values);
        let step = values.iter().sum::<f64>() / scores.information[(0, 0)];
        let mean = values.iter().sum::<f64>() / 10.0;
        let expected = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 9.0;
        let t_squared = 10.0 * mean * mean / expected;
        let p = scores.p_by_units(&DVector::from_element(1, step));
        assert!((p / f_upper_tail(t_squared, [1.0, 9.0]) - 1.0).abs() < 1e-9, "{p}");
        assert!((scores.carrying() - 10.0).abs() < 1e-9, "{}", scores.carrying());
        assert!(group(&[1.0, -1.0, 1.1, -0.9, 1.2, -0.8]).p_by_units(&DVector::from_element(1, 0.1)) > 0.3);
    }

    /// `asked` columns beside four that are fitted, in ten runs whose noise is the same all along a run and as heavy-tailed
    /// from run to run as t4: the least p of them all.
    fn beside_a_fit(stream: &mut Stream, asked: usize, standardised: bool) -> f64 {
        let draw = |stream: &mut Stream, columns| DMatrix::from_fn(10, columns, |_, _| stream.normal());
        let (base, columns, mut noise) = (draw(stream, 4), draw(stream, asked), draw(stream, 1));
        for value in noise.iter_mut() {
            let size: f64 = (0..4).map(|_| stream.normal().powi(2)).sum();
            *value /= (size / 4.0).sqrt();
        }
        let rest = |base: &DMatrix<f64>, y: &DMatrix<f64>| {
            y - base * base.tr_mul(base).cholesky().unwrap().solve(&base.tr_mul(y))
        };
        let columns = rest(&base, &columns);
        let (residual, factor) = (rest(&base, &noise), base.tr_mul(&base).cholesky().unwrap());
        let scores = |column: usize| {
            let own = columns.columns(column, 1).into_owned();
            let held = |run: usize| {
                let product = base.rows(run, 1).transpose() * own[run];
                if standardised { factor.l().solve_lower_triangular(&product).unwrap() } else { 0.0 * product }
            };
            Scores {
                units: (0..10).map(|run| DVector::from_element(1, own[run] * residual[run])).collect(),
                held: (0..10).map(held).collect(),
                parts: Vec::new(),
                information: own.tr_mul(&own),
            }
        };
        let groups: Vec<Scores> = (0..asked).map(scores).collect();
        let family = Family::new(&groups, 1);
        groups.iter().map(|own| family.p(own)).fold(1.0, f64::min)
    }

    /// 1000 cases of one and of eight columns asked, seed 8.
    #[test]
    fn the_size_is_held_beside_fitted_columns_by_the_flips_own_covariance_and_not_without() {
        let share = |asked: usize, standardised: bool| {
            let mut stream = Stream::new(8, 0, 0);
            let accused = (0..1000).filter(|_| beside_a_fit(&mut stream, asked, standardised) <= 0.05).count();
            accused as f64 / 1000.0
        };
        let (one, eight, without) = (share(1, true), share(8, true), share(8, false));
        assert!(one < 0.07 && eight < 0.07 && without > 0.15, "{one} of one, {eight} of eight, {without} without");
    }
}
