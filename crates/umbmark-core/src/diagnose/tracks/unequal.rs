//! Whether the first effects differ from run to run.
//!
//! Noise that is fitted from step to step hardly grows where a whole run is 0.3 % longer than the next, and the interval of the common value is that
//! of one value for all runs. So each run's own values are compared.
//!
//! Source: Cochran (1954), Biometrics 10, 101 (Q); DerSimonian & Laird (1986), Controlled Clinical Trials 7, 177 (the variance between runs);
//! Kendall (1938), Biometrika 30, 81 (the test for a trend).

use super::doubts::REMEMBERS;
use super::examination::Examination;
use super::odd::{first_columns, products_of, steps};
use crate::diagnose::reason::Reason;
use crate::evidence::tracks::Misses;
use crate::path::Direction;
use crate::stats::chi_squared_upper_tail;
use nalgebra::{DMatrix, DVector};

/// Fewest runs of which it is told.
const FEWEST: usize = 4;
/// Maximum p over all that is compared, of all runs and without the one that is farthest off.
const SURE: [f64; 2] = [1e-4, 1e-2];
/// A run whose own value is so far from the common one hardly shows it: the estimate is linear.
const FAR: f64 = 0.1;
/// Least standard deviation between runs, and the greatest that a robot can have: beyond, runs hardly show the value, ...
const LEAST: f64 = 5e-4;
const MOST: f64 = 0.05;
/// ... and the share by which errors along the way fall at least with each run's own values.
const LEAST_FALL: f64 = 0.2;
/// Maximum p of a trend in the order of the runs.
const TREND: f64 = 0.01;

/// A first effect that differs from run to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Unequal {
    /// As it is called.
    pub effect: &'static str,
    /// Standard deviation between runs, beside that of each run's own estimate.
    pub deviation: f64,
    /// The smallest and the largest value of a run.
    pub range: [f64; 2],
    /// How many runs tell it.
    pub runs: usize,
    /// By how much it rises from the first run of a direction to the last, where it rises or falls in their order.
    pub trend: Option<f64>,
    /// Whether they are pieces of long runs.
    pub pieces: bool,
}

impl Unequal {
    /// In a sentence, without a full stop.
    pub fn sentence(&self) -> String {
        let Unequal { effect, deviation, range: [least, most], runs, trend, pieces } = self;
        let run = if *pieces { "piece" } else { "run" };
        let of = if *pieces { " of long runs" } else { "" };
        let told = format!(
            "{effect} differs from {run} to {run}{of}, by more than noise: {least:.5} to {most:.5} in {runs} {run}s, standard deviation {:.2} %. The \
             fitted number is their mean",
            100.0 * deviation
        );
        if let Some(rise) = trend {
            let rises = if *rise > 0.0 { "rises" } else { "falls" };
            return format!(
                "{told}. It {rises} in their order, by about {:.2} % from the first to the last, as with wheels that wear, warm up or lose air, or with a \
                 load that shifts",
                100.0 * rise.abs()
            );
        }
        if *pieces {
            return format!("{told}. Something changed between the pieces: floor, load, tyres, battery or reference");
        }
        format!(
            "{told}. What changed between the runs: floor, load, tyres, battery, reference? Give runs of one kind as a dataset of their own"
        )
    }

    /// Variance of the mean over the runs, from what is between them.
    pub fn variance(&self) -> f64 {
        self.deviation * self.deviation / self.runs as f64
    }
}

/// Estimates of one value, a run each.
struct Estimates {
    steps: Vec<f64>,
    variances: Vec<f64>,
}

impl Estimates {
    fn weighted(&self, power: i32) -> impl Iterator<Item = f64> + '_ {
        self.variances.iter().map(move |variance| (1.0 / variance).powi(power))
    }

    /// Cochran's Q and the weighted mean.
    fn spread(&self) -> (f64, f64) {
        let mean =
            self.weighted(1).zip(&self.steps).map(|(w, step)| w * step).sum::<f64>() / self.weighted(1).sum::<f64>();
        (self.weighted(1).zip(&self.steps).map(|(w, step)| w * (step - mean).powi(2)).sum(), mean)
    }

    fn p(&self) -> f64 {
        chi_squared_upper_tail(self.spread().0, self.steps.len() as f64 - 1.0)
    }

    /// The same without the run that is farthest from the mean.
    fn without_farthest(&self) -> Estimates {
        let (_, mean) = self.spread();
        let off = |i: &usize| (self.steps[*i] - mean).powi(2) / self.variances[*i];
        let farthest = (0..self.steps.len()).max_by(|a, b| off(a).total_cmp(&off(b)));
        let kept = || (0..self.steps.len()).filter(|i| Some(*i) != farthest);
        Estimates {
            steps: kept().map(|i| self.steps[i]).collect(),
            variances: kept().map(|i| self.variances[i]).collect(),
        }
    }

    /// By how much they rise from the first to the last, where ranks and order agree by more than chance within each of these groups.
    fn trend(&self, groups: &[Option<Direction>]) -> Option<f64> {
        let (mut agreement, mut variance, mut along, mut whole, mut longest) = (0.0, 0.0, 0.0, 0.0, 0.0_f64);
        for group in [None, Some(Direction::Cw), Some(Direction::Ccw)] {
            let own = groups.iter().zip(&self.steps).filter(|(of, _)| **of == group).map(|(_, step)| *step);
            let own: Vec<f64> = own.collect();
            let n = own.len() as f64;
            let pairs = (0..own.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
            agreement += pairs.map(|(i, j)| (own[j] - own[i]).signum()).sum::<f64>();
            variance += n * (n - 1.0) * (2.0 * n + 5.0) / 18.0;
            let from_middle = |i: usize| i as f64 - 0.5 * (n - 1.0);
            along += own.iter().enumerate().map(|(i, step)| from_middle(i) * step).sum::<f64>();
            whole += (0..own.len()).map(|i| from_middle(i).powi(2)).sum::<f64>();
            longest = longest.max(n - 1.0);
        }
        let square = (agreement.abs() - 1.0).max(0.0).powi(2) / variance;
        (chi_squared_upper_tail(square, 1.0) <= TREND).then_some(longest * along / whole)
    }

    /// The standard deviation between runs.
    fn between(&self) -> f64 {
        let (q, _) = self.spread();
        let [one, two] = [1, 2].map(|power| self.weighted(power).sum::<f64>());
        ((q - (self.steps.len() as f64 - 1.0)) / (one - two / one)).max(0.0).sqrt()
    }
}

/// The reason for doubt from the first effect that differs most, where one does.
pub(super) fn unequal(exam: &Examination) -> Option<Reason> {
    let columns = first_columns(exam);
    let told = (0..exam.fitted.observed.runs.len()).map(|run| steps(exam, &products_of(exam, run), &columns));
    let told: Vec<_> = told.map(|told| told.filter(|(own, _)| own.amax() < FAR)).collect();
    let runs = told.iter().flatten().count();
    if columns.is_empty() || runs < FEWEST {
        return None;
    }
    let of = |place: usize| Estimates {
        steps: told.iter().flatten().map(|(own, _)| own[place]).collect(),
        variances: told.iter().flatten().map(|(_, all)| REMEMBERS * REMEMBERS * all[(place, place)]).collect(),
    };
    let all: Vec<Estimates> = (0..columns.len()).map(of).collect();
    let sure = |estimates: &Estimates, most: f64| estimates.p() * columns.len() as f64 <= most;
    let differs = |place: &usize| {
        let estimates = &all[*place];
        let sure = sure(estimates, SURE[0]) && sure(&estimates.without_farthest(), SURE[1]);
        sure && (LEAST..MOST).contains(&estimates.between())
    };
    let place = (0..columns.len()).filter(differs).min_by(|a, b| all[*a].p().total_cmp(&all[*b].p()))?;
    let value = exam.fitted.model.values().nth(exam.fitted.free[columns[place]]).unwrap_or(1.0);
    let range = all[place]
        .steps
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], step| [low.min(value + step), high.max(value + step)]);
    (fall(exam, &columns, &told) >= LEAST_FALL).then(|| {
        let effect = exam.name(columns[place]).unwrap_or_default();
        let observed = &exam.fitted.observed;
        let groups = observed.runs.iter().zip(&told).filter(|(_, told)| told.is_some()).map(|(run, _)| run.direction);
        let (trend, pieces) = (all[place].trend(&groups.collect::<Vec<_>>()), observed.piece().is_some());
        Reason::RunsDiffer(Unequal { effect, deviation: all[place].between(), range, runs, trend, pieces })
    })
}

/// By which share errors along the way fall with each run's own values: positions or headings.
fn fall(exam: &Examination, columns: &[usize], own: &[Option<(DVector<f64>, DMatrix<f64>)>]) -> f64 {
    let run_of: Vec<Option<usize>> =
        (0..exam.system.folds()).map(|fold| exam.system.of_fold(fold).next().map(|unit| unit.run)).collect();
    let left = |with_own: bool| {
        let squares = exam.errors.squares(|fold| match run_of[fold].and_then(|run| own[run].as_ref()) {
            Some((values, _)) if with_own => (columns.to_vec(), values.clone()),
            _ => (Vec::new(), DVector::zeros(0)),
        });
        let of = |k: usize| squares.iter().map(|fold| fold[k]).sum::<f64>().sqrt();
        Misses { position: of(0), heading: Some(of(1)).filter(|heading| *heading > 0.0), white: of(2) }
    };
    let [_, most] = left(true).falls(&left(false));
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::diagnose::tracks::diagnose;
    use crate::diagnose::{Options, Verdict, first_model};
    use crate::drive::Robot;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    /// Verdict and what differs, where the runs are of robots with these scales in turn.
    fn of_scales(scales: &[f64]) -> (Verdict, Vec<Unequal>) {
        let mut data = watched(&robot_with(&[]), 3, 5);
        let own = robot_with(&[]).get("scale", "e_s").unwrap_or(1.0);
        for (run, scale) in scales.iter().enumerate() {
            let other = watched(&robot_with(&[("scale", "e_s", own * scale)]), 3, 5);
            data.runs[run] = other.runs[run].clone();
        }
        let observed = Observed::new(&data, &Robot::labmate()).unwrap();
        let diagnosis = diagnose(&observed, &first_model(&data).unwrap(), &Options::default()).unwrap();
        let told = diagnosis.reasons.iter().filter_map(|reason| match reason {
            Reason::RunsDiffer(unequal) => Some(unequal.clone()),
            _ => None,
        });
        (diagnosis.verdict, told.collect())
    }

    #[test]
    fn a_scale_that_differs_from_run_to_run_is_told_and_one_run_that_differs_is_not_called_so() {
        let scales = [0.994, 1.003, 1.006, 0.998, 1.002, 0.997];
        let (verdict, told) = of_scales(&scales);
        let [told] = &told[..] else { panic!("{told:?}") };
        assert_eq!((verdict, told.effect, told.runs), (Verdict::NotExplained, "scale", 6));
        assert!((3e-3..7e-3).contains(&told.deviation), "{told:?}");
        assert!((told.range[1] - told.range[0] - 0.012).abs() < 2e-3, "{told:?}");
        assert!((told.variance() - told.deviation.powi(2) / 6.0).abs() < 1e-18);
        assert_eq!((told.trend, told.pieces), (None, false));
        assert!(told.sentence().ends_with("reference? Give runs of one kind as a dataset of their own"));
        assert_eq!(of_scales(&[1.0, 1.01]).1, []);
        // No robot differs so from run to run.
        let (verdict, told) = of_scales(&[0.8, 1.2, 0.85, 1.15, 0.9, 1.1]);
        assert!(verdict != Verdict::Explained && told.is_empty(), "{told:?}");
        assert_eq!(of_scales(&[]).1, []);
    }

    #[test]
    fn what_is_between_runs_is_found_beside_what_is_in_them() {
        let estimates = |steps: &[f64]| Estimates { steps: steps.to_vec(), variances: vec![1e-8; steps.len()] };
        // Of equal variances, Q is the sum of squares over the variance.
        let four = estimates(&[1e-3, -1e-3, 3e-3, -3e-3]);
        assert!((four.spread().0 / 2000.0 - 1.0).abs() < 1e-9 && four.spread().1.abs() < 1e-15);
        assert!((four.between().powi(2) / (2e-5 / 3.0 - 1e-8) - 1.0).abs() < 1e-9);
        assert_eq!(four.without_farthest().steps.len(), 3);
        assert_eq!(estimates(&[1e-5, -1e-5, 0.0]).between(), 0.0);
        // Six in order: p = 0.0085 by the normal approximation with continuity, of five 0.027.
        let one_way = [None; 6];
        let rising = [0.0, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3];
        assert!((estimates(&rising).trend(&one_way).unwrap() - 5e-3).abs() < 1e-15);
        assert!((estimates(&rising.map(|step| -step)).trend(&one_way).unwrap() + 5e-3).abs() < 1e-15);
        assert_eq!(estimates(&rising[..5]).trend(&one_way[..5]), None);
        assert_eq!(estimates(&[0.0, 1e-3, 2e-3, 3e-3, 5e-3, 4e-3]).trend(&one_way), None);
        // Five each way that rise, the later direction far below; and two directions that differ without a trend.
        let directions = [[Some(Direction::Cw); 5], [Some(Direction::Ccw); 5]].concat();
        let both: Vec<f64> = (0..10).map(|i| 1e-3 * f64::from(i % 5) - 0.1 * f64::from(i / 5)).collect();
        assert!((estimates(&both).trend(&directions).unwrap() - 4e-3).abs() < 1e-15);
        let apart: Vec<f64> = (0..10).map(|i| 1e-5 * f64::from(i * 7 % 5) + 0.1 * f64::from(i / 5)).collect();
        assert_eq!(estimates(&apart).trend(&directions), None);
    }
}
