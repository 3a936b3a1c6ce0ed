//! All tests together: p of the most significant one, corrected for all of them.
//!
//! Each test has its own p, exact where there is an exact test, else from simulated null tests. The smallest of them is compared with the
//! smallest of each of many simulated null tests (Westfall & Young 1993), so nearly equal tests hardly cost any power.

use super::asked::{Asked, Unit};
use super::exact::wilks;
use super::moments::{Moments, Whitened};
use crate::diagnose::options::Options;
use crate::random::Stream;
use crate::stats::{f_upper_tail, student_t_quantile};
use rayon::prelude::*;

/// p of the whole-model test is multiplied by this. Most causes are in the catalogue, and their own tests are more powerful; the
/// whole-model test is for causes that are not in the catalogue.
const WHOLE: f64 = 4.0;

/// Purpose of the stream of simulated null tests.
const NULL_TESTS: u64 = 10;

/// Statistics of all tests for one set of moments: F of each unit, and of the whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Statistics {
    pub units: Vec<f64>,
    pub whole: f64,
}

/// p of every test, alone and as one of the family.
#[derive(Clone, Debug)]
pub(crate) struct Family {
    pub observed: Statistics,
    pub p: Vec<f64>,
    pub p_adjusted: Vec<f64>,
    /// Whether the whole has an exact F, and its degrees of freedom.
    pub exact_whole: Option<[f64; 2]>,
    pub p_whole: f64,
    pub p_whole_adjusted: f64,
    judges: Vec<Judge>,
    /// The smallest p of each simulated null test, rising.
    smallest: Vec<f64>,
}

/// F of every unit, without any p.
pub(crate) fn statistics(asked: &Asked, moments: &Moments) -> Option<Statistics> {
    let whitened = Whitened::new(moments, &asked.base)?;
    let unit = |unit: &Unit| match &unit.pattern {
        Some(pattern) => pattern.test(moments).map_or(0.0, |rao| rao.f),
        None => {
            let column = whitened.column(&unit.columns);
            let along = column.dot(&whitened.means);
            along * along / column.norm_squared()
        }
    };
    let whole =
        if asked.base.is_empty() { wilks(moments).map_or(0.0, |(f, _)| f) } else { whitened.means.norm_squared() };
    Some(Statistics { units: asked.units.iter().map(unit).collect(), whole })
}

impl Family {
    /// `None` if the runs have no scatter or no effect is left to test.
    pub fn new(asked: &Asked, options: &Options) -> Option<Family> {
        let observed = statistics(asked, &asked.moments)?;
        let (counts, size) = (asked.moments.counts, asked.moments.size);
        let draws: Vec<Statistics> = (0..options.draws as u64)
            .into_par_iter()
            .filter_map(|draw| {
                let mut stream = Stream::new(options.seed, NULL_TESTS, draw);
                statistics(asked, &Moments::draw(counts, size, &mut stream))
            })
            .collect();
        let judges: Vec<Judge> = (0..asked.units.len())
            .map(|i| match asked.units[i].pattern {
                Some(_) => Judge::Exact([1.0, (counts[0] + counts[1] - size) as f64]),
                None => Judge::simulated(&draws, &observed, |s| s.units[i]),
            })
            .collect();
        let exact_whole = asked.base.is_empty().then(|| wilks(&asked.moments).map(|(_, freedom)| freedom)).flatten();
        let has_rest = asked.base.len() < 2 * size;
        let whole = match exact_whole {
            Some(freedom) => Judge::Exact(freedom),
            None if has_rest => Judge::simulated(&draws, &observed, |s| s.whole),
            None => Judge::Silent,
        };
        let mut smallest: Vec<f64> = draws.par_iter().map(|draw| smallest(draw, &judges, &whole)).collect();
        smallest.sort_by(f64::total_cmp);
        let adjusted = |p: f64| {
            let as_small = smallest.partition_point(|s| *s <= p);
            (1 + as_small) as f64 / (1 + smallest.len()) as f64
        };
        let p: Vec<f64> = judges.iter().zip(&observed.units).map(|(judge, f)| judge.p(*f)).collect();
        let p_whole = whole.p(observed.whole);
        Some(Family {
            p_adjusted: p.iter().map(|p| adjusted(*p)).collect(),
            p_whole_adjusted: adjusted(WHOLE * p_whole),
            p,
            p_whole,
            exact_whole,
            observed,
            judges,
            smallest,
        })
    }

    /// The F above which a unit is certified at a family-wise size; infinite where there are too few draws for that size.
    pub fn critical(&self, unit: usize, size: f64) -> f64 {
        // Number of values `as_small` with (1 + as_small)/(1 + draws) < size.
        let allowed = (size * (1 + self.smallest.len()) as f64 - 1.0).ceil();
        if allowed < 1.0 {
            return f64::INFINITY;
        }
        let p = self.smallest.get(allowed as usize - 1).copied().unwrap_or(1.0);
        self.judges[unit].critical(p)
    }
}

/// The smallest p of one simulated test. Among exact tests with the same degrees of freedom it is that of the largest F.
fn smallest(draw: &Statistics, judges: &[Judge], whole: &Judge) -> f64 {
    let (mut smallest, mut largest) = (WHOLE * whole.p(draw.whole), None::<(f64, &Judge)>);
    for (judge, f) in judges.iter().zip(&draw.units) {
        match judge {
            Judge::Exact(_) if largest.is_none_or(|(most, _)| *f > most) => largest = Some((*f, judge)),
            Judge::Exact(_) => {}
            _ => smallest = smallest.min(judge.p(*f)),
        }
    }
    largest.map_or(smallest, |(f, judge)| smallest.min(judge.p(f)))
}

/// Source of the p of a statistic.
#[derive(Clone, Debug)]
enum Judge {
    Exact([f64; 2]),
    /// Statistics of the null tests and of the observed one, in increasing order: all are treated alike.
    Simulated(Vec<f64>),
    /// There is nothing to test.
    Silent,
}

impl Judge {
    fn simulated(draws: &[Statistics], observed: &Statistics, which: impl Fn(&Statistics) -> f64) -> Judge {
        let mut sorted: Vec<f64> = draws.iter().chain([observed]).map(which).collect();
        sorted.sort_by(f64::total_cmp);
        Judge::Simulated(sorted)
    }

    fn p(&self, statistic: f64) -> f64 {
        match self {
            Judge::Exact(freedom) => f_upper_tail(statistic, *freedom),
            Judge::Simulated(sorted) => {
                let as_large = sorted.len() - sorted.partition_point(|s| *s < statistic);
                as_large as f64 / sorted.len() as f64
            }
            Judge::Silent => 1.0,
        }
    }

    /// The statistic above which p is less than this; exact ones are squares of Student's t.
    fn critical(&self, p: f64) -> f64 {
        match self {
            Judge::Exact([_, freedom]) => {
                let t = student_t_quantile(1.0 - 0.5 * p, *freedom);
                t * t
            }
            Judge::Simulated(sorted) => {
                let as_large = (p * sorted.len() as f64).ceil() as usize;
                if as_large == 0 { f64::INFINITY } else { sorted[sorted.len().saturating_sub(as_large)] }
            }
            Judge::Silent => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_p_of_a_test_is_that_of_its_most_striking_part() {
        let whole = Judge::Simulated((0..100).map(f64::from).collect());
        let judges = [Judge::Exact([1.0, 8.0]), Judge::Simulated((0..50).map(f64::from).collect()), Judge::Silent];
        let of = |whole_of: f64, units: [f64; 3]| {
            smallest(&Statistics { whole: whole_of, units: units.to_vec() }, &judges, &whole)
        };
        assert_eq!(of(0.0, [0.0; 3]), 1.0);
        assert_eq!(of(99.0, [0.0; 3]), WHOLE / 100.0);
        assert_eq!(of(0.0, [0.0, 49.0, 9.0]), 1.0 / 50.0);
        assert_eq!(of(0.0, [100.0, 49.0, 0.0]), f_upper_tail(100.0, [1.0, 8.0]));
    }
}
