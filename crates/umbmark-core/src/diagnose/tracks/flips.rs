//! Sign flips: a test without a noise model.
//!
//! If nothing is missing, the score of a run for an effect is positive or negative with equal probability. Flipping the signs of the runs'
//! scores therefore gives other outcomes of the same experiment, for any noise within runs. The largest statistic of all effects is
//! compared with the largest under each flip.
//!
//! Scores are computed after other columns are projected out, so a flipped sum and the observed sum have different covariances. Each sum is
//! therefore standardised by its own covariance under its own flips. Without this, there are too many false alarms if there are about as
//! many fitted columns as runs.
//!
//! Source: Hemerik, Goeman & Finos (2020), Robust testing in generalized linear models by sign flipping score contributions;
//! standardised by the flip's own variance, De Santis, Goeman, Davenport, Hemerik & Finos (2022); the greatest statistic, Westfall & Young (1993).

use crate::geometry::{EIGHT, Eight};
use crate::geometry::{Instructions, by_width};
use crate::random::Stream;
use crate::stats::f_upper_tail;
use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rayon::prelude::*;

/// Up to this many units, all flips are used; beyond, random ones.
const ALL: usize = 12;
/// Purpose of the stream of random flips.
const FLIPS: u64 = 0x666c_6970;
/// Minimum share of the information that remains under any flip: it keeps a quotient of two zeros finite.
const LEAST: f64 = 1e-3;

/// The scores of a group of columns, unit by unit, and how they scatter.
#[derive(Clone, Debug)]
pub struct Scores {
    /// One per unit.
    pub units: Vec<DVector<f64>>,
    /// Projections of each unit's columns on the orthonormalised columns that were projected out, one per unit.
    pub held: Vec<DMatrix<f64>>,
    /// Contribution of each unit to the information.
    pub parts: Vec<DMatrix<f64>>,
    /// Covariance of the sum of all scores.
    pub information: DMatrix<f64>,
}

impl Scores {
    /// Effective number of units that show the group: all if each shows it equally, one if a single unit shows it.
    pub fn carrying(&self) -> f64 {
        let weight = |part: &DMatrix<f64>| part.diagonal().component_div(&self.information.diagonal()).sum();
        let (sum, squares) = self.parts.iter().map(weight).fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
        if squares > 0.0 { sum * sum / squares } else { 0.0 }
    }

    /// p of a step by the scatter between units: the square of Student's t along the step, with one value per unit. Unlike the noise model,
    /// which is estimated on steps of centimetres, it includes noise that is correlated over whole runs.
    pub fn p_by_units(&self, step: &DVector<f64>) -> f64 {
        let units = self.units.len() as f64;
        let off = |(score, part): (&DVector<f64>, &DMatrix<f64>)| (score - part * step).dot(step).powi(2);
        let scatter: f64 = self.units.iter().zip(&self.parts).map(off).sum();
        let sum: f64 = self.units.iter().map(|score| score.dot(step)).sum();
        let t_squared = sum * sum * (units - 1.0) / (units * scatter);
        if units < 2.0 || t_squared.is_nan() { 1.0 } else { f_upper_tail(t_squared, [1.0, units - 1.0]) }
    }

    /// Distance of the flipped sum from zero under each of eight flips, as a standard normal quantile (Wilson & Hilferty 1931); NaN if it
    /// has no covariance.
    fn distances(&self, signs: &[Eight]) -> [f64; EIGHT] {
        let scores = self;
        by_width!(Instructions::best(), |scores: &Scores, signs: &[Eight]| -> [f64; EIGHT] {
            scores.distances_plainly(signs)
        })
    }

    #[inline(always)]
    fn distances_plainly(&self, signs: &[Eight]) -> [f64; EIGHT] {
        let terms = self.information.nrows();
        let height = self.held.first().map_or(0, DMatrix::nrows);
        let mut sum = flipped_sums(self.units.iter().map(DVector::as_slice), signs, terms);
        let held = flipped_sums(self.held.iter().map(DMatrix::as_slice), signs, height * terms);
        // |L⁻¹ sum|², with L Lᵀ the covariance; L row by row.
        let mut root = vec![Eight::from(0.0); terms * terms];
        let mut square = Eight::from(0.0);
        for i in 0..terms {
            for j in 0..=i {
                let both = product(&held[i * height..][..height], &held[j * height..][..height]);
                let mut rest = Eight::from(self.information[(i, j)]) - both;
                if i == j {
                    rest = rest.at_least(0.0) + Eight::from(LEAST * self.information[(i, i)]);
                }
                rest -= product(&root[i * terms..][..j], &root[j * terms..][..j]);
                root[i * terms + j] = if i == j { rest.positive_root() } else { rest / root[j * terms + j] };
            }
            sum[i] = (sum[i] - product(&root[i * terms..][..i], &sum[..i])) / root[i * terms + i];
            square += sum[i] * sum[i];
        }
        let terms = terms as f64;
        let spread = 2.0 / (9.0 * terms);
        square.0.map(|square| ((square / terms).cbrt() - (1.0 - spread)) / spread.sqrt())
    }
}

/// Sums of each value over all units, with the signs of the units.
#[inline(always)]
fn flipped_sums<'a>(units: impl Iterator<Item = &'a [f64]> + Clone, signs: &[Eight], values: usize) -> Vec<Eight> {
    let sum = |value: usize| {
        let units = units.clone().zip(signs);
        units.fold(Eight::from(0.0), |sum, (unit, sign)| sum + *sign * Eight::from(unit[value]))
    };
    (0..values).map(sum).collect()
}

#[inline(always)]
fn product(a: &[Eight], b: &[Eight]) -> Eight {
    a.iter().zip(b).fold(Eight::from(0.0), |sum, (a, b)| sum + *a * *b)
}

/// Groups of columns under every flip of the signs of their units.
///
/// All flips of up to 12 units, else 4095 at random by `seed`; including the observed signs, so that no p is 0. *Rejected*: flips of the
/// residuals after the observed group was fitted too. They have more power, but after seven fitted columns too little remains of ten runs.
pub struct Family {
    /// Largest distance of a group from zero, under every flip except the identity.
    farthest: Vec<f64>,
}

impl Family {
    /// All groups, with the same units.
    pub fn new(groups: &[Scores], seed: u64) -> Family {
        let units = groups.first().map_or(0, |group| group.units.len());
        let patterns = patterns(units, seed);
        let farthest = |flips: &[Vec<bool>]| {
            // If there are fewer than eight, the first is repeated.
            let flipped = |lane: usize, unit: usize| flips.get(lane).unwrap_or(&flips[0])[unit];
            let sign = |lane, unit| if flipped(lane, unit) { -1.0 } else { 1.0 };
            let signs: Vec<Eight> =
                (0..units).map(|unit| Eight(std::array::from_fn(|lane| sign(lane, unit)))).collect();
            let mut farthest = [f64::NEG_INFINITY; EIGHT];
            for group in groups {
                farthest
                    .iter_mut()
                    .zip(group.distances(&signs))
                    .for_each(|(most, distance)| *most = most.max(distance));
            }
            farthest.into_iter().take(flips.len())
        };
        Family { farthest: patterns[1..].par_chunks(EIGHT).flat_map_iter(farthest).collect() }
    }

    /// Share of flips under which some group is at least as far from zero as `observed`, one of the groups, is without a flip.
    pub fn p(&self, observed: &Scores) -> f64 {
        let distance = observed.distances(&vec![Eight::from(1.0); observed.units.len()])[0] * (1.0 - 1e-12);
        // A sum without a covariance is no farther from zero than any.
        let count = 1 + self.farthest.iter().filter(|farthest| !(**farthest < distance)).count();
        count as f64 / (1 + self.farthest.len()) as f64
    }
}

/// The observed signs and all other patterns. The last unit keeps its sign, because flipping all signs changes nothing.
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

    #[test]
    fn distances_are_the_same_bits_in_registers_of_every_width_and_those_of_the_formula() {
        let mut stream = Stream::new(5, 0, 0);
        let mut draw = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| stream.normal());
        let (units, terms) = (7, 3);
        let scores = Scores {
            units: (0..units).map(|_| draw(terms, 1).column(0).into_owned()).collect(),
            held: (0..units).map(|_| draw(4, terms)).collect(),
            parts: Vec::new(),
            information: 500.0 * DMatrix::identity(terms, terms),
        };
        let signs: Vec<Eight> = (0..units).map(|_| Eight(std::array::from_fn(|k| draw(1, 8)[k].signum()))).collect();
        let all = scores.distances(&signs);
        assert_eq!(all, scores.distances_plainly(&signs));
        for (lane, distance) in all.into_iter().enumerate() {
            let (mut sum, mut held) = (DVector::zeros(terms), DMatrix::zeros(4, terms));
            for ((unit, own), sign) in scores.units.iter().zip(&scores.held).zip(&signs) {
                sum += unit * sign.0[lane];
                held += own * sign.0[lane];
            }
            let mut covariance = &scores.information - held.tr_mul(&held);
            (0..terms).for_each(|i| covariance[(i, i)] += LEAST * scores.information[(i, i)]);
            let mean_square = sum.dot(&(covariance.cholesky().unwrap().solve(&sum))) / terms as f64;
            let spread = 2.0 / (9.0 * terms as f64);
            let quantile = (mean_square.powf(1.0 / 3.0) - 1.0 + spread) / spread.sqrt();
            assert!((distance - quantile).abs() < 1e-9, "{distance} {quantile}");
        }
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
