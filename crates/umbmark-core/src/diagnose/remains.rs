//! The error that a model leaves: how much of it is the same in every run, and the sources of the rest.
//!
//! Two runs of one path have the same systematic error and independent noise. So multiply the residuals of two runs at the same share of
//! the path; the mean of this product over pairs of runs estimates the square of the repeating error, without a noise model:
//!
//! repeats² = Σ dᵢ(s)·dⱼ(s) / n,  i ≠ j of one path and sense,
//!
//! with an interval by the jackknife over the runs of each path. It is a lower bound: it contains neither errors that differ between runs
//! (each at its own speed, say) nor errors that the fitted values already absorb.
//!
//! Source: U-statistics and their jackknife, Arvesen (1969).

use crate::likelihood::Disturbance;
use crate::prose::counted;
use crate::stats::{Interval, student_t_quantile};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Runs drive one path where their lengths differ by no more than this share, and they are apart by no more than this share of how far
/// they go from START, and this \[m\].
const SAME_LENGTH: f64 = 0.05;
const SAME_PLACE: (f64, f64) = (0.1, 0.05);
/// A run is compared with at most this many runs before it.
const MOST_PARTNERS: usize = 50;
/// Minimum number of runs for an interval.
const FEWEST: usize = 3;

/// The remaining error, in one unit: metres of position, or radians of heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Left {
    /// Root mean square over all measurements.
    pub rms: f64,
    /// Lower bound of the part that is the same in every run; `None` if no two runs drive one path.
    pub repeats: Option<Repeating>,
}

/// How much is the same in every run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeating {
    /// Root mean square; 0 if the mean of products is negative, which happens in half of all cases if nothing repeats.
    pub value: f64,
    /// Its 95 % interval; `None` below three runs.
    pub interval: Option<Interval>,
}

impl Repeating {
    /// Whether it is significant.
    pub fn is_shown(&self) -> bool {
        self.interval.is_some_and(|interval| interval.low > 0.0)
    }
}

/// A source of noise, and the error that it causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chance {
    /// Its name.
    pub source: &'static str,
    /// Root mean square of positions \[m\] and headings \[rad\] that it alone would leave.
    pub position: f64,
    /// \[rad\]
    pub heading: f64,
}

/// A source of noise is reported if it contributes this share.
const TOLD: f64 = 0.1;
/// If the noise exceeds this multiple of the remaining error, the two contradict each other.
const UNDONE: f64 = 1.5;
/// Maximum number of disturbances in the report.
const NAMED: usize = 3;

/// A unit of the report.
#[derive(Clone, Copy)]
struct Unit {
    scale: f64,
    name: &'static str,
    decimals: usize,
}

const MILLIMETRES: Unit = Unit { scale: 1e3, name: "mm", decimals: 1 };
const DEGREES: Unit = Unit { scale: 180.0 / std::f64::consts::PI, name: "deg", decimals: 2 };

impl Unit {
    fn number(&self, value: f64) -> String {
        let text = format!("{:.*}", self.decimals, self.scale * value);
        if text.trim_start_matches('-').chars().all(|digit| matches!(digit, '0' | '.')) {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        }
    }

    fn text(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.name)
    }
}

/// The remaining error of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Remains {
    /// Of positions \[m\].
    pub position: Left,
    /// Of headings \[rad\]; `None` where none were measured.
    pub heading: Option<Left>,
    /// How many pairs of runs drive one path.
    pub pairs: usize,
    /// Mean duration of the pieces of long runs that these are errors of \[s\]: each begins at a START of its own. `None` for whole runs.
    pub piece: Option<f64>,
    /// Error that noise alone would leave, by source; empty for return poses.
    pub chance: Vec<Chance>,
    /// Places where a run is disturbed by more than that: accidental bumps, and wrong poses.
    pub disturbances: Vec<Disturbance>,
}

/// Residuals of one run along its path.
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    /// Runs of another sense follow another path: +1 counter-clockwise, -1 clockwise, 0 neither.
    pub sense: f64,
    /// How far the wheels have rolled at each measurement \[m\].
    pub rolled: Vec<f64>,
    /// Predicted positions in the frame of START \[m\].
    pub places: Vec<[f64; 2]>,
    /// Measured minus predicted, in the frame of START: x, y \[m\], heading \[rad\].
    pub left: Vec<[f64; 3]>,
    /// Whether headings were measured.
    pub with_heading: bool,
}

impl Trail {
    fn length(&self) -> f64 {
        self.rolled.last().copied().unwrap_or(0.0)
    }

    /// Values at the same share of the path as a measurement of another run, interpolated linearly.
    fn at<const N: usize>(&self, values: &[[f64; N]], share: f64) -> [f64; N] {
        let way = share * self.length();
        let after = self.rolled.partition_point(|rolled| *rolled < way).min(values.len() - 1);
        let before = after.saturating_sub(1);
        let between = self.rolled[after] - self.rolled[before];
        let weight = if between > 0.0 { ((way - self.rolled[before]) / between).clamp(0.0, 1.0) } else { 1.0 };
        std::array::from_fn(|k| values[before][k] + weight * (values[after][k] - values[before][k]))
    }

    /// Shares of the way at its measurements.
    fn shares(&self) -> impl Iterator<Item = f64> + '_ {
        let length = self.length();
        self.rolled.iter().map(move |rolled| if length > 0.0 { rolled / length } else { 0.0 })
    }

    fn is_of_one_path(&self, other: &Trail) -> bool {
        let (a, b) = (self.length(), other.length());
        if self.sense != other.sense || (a - b).abs() > SAME_LENGTH * a.max(b) {
            return false;
        }
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        let (mut apart, mut gone) = (0.0, 0.0);
        for (share, place) in self.shares().zip(&self.places) {
            let there = other.at(&other.places, share);
            apart += square([place[0] - there[0], place[1] - there[1]]);
            gone += square([place[0] - self.places[0][0], place[1] - self.places[0][1]]);
        }
        let root = |sum: f64| (sum / self.places.len() as f64).sqrt();
        root(apart) <= SAME_PLACE.0 * root(gone) + SAME_PLACE.1
    }
}

/// Sums of products of a pair of runs: of positions and of headings.
#[derive(Clone, Copy, Debug)]
struct Pair {
    runs: [usize; 2],
    sums: [f64; 2],
    counts: [f64; 2],
}

impl Pair {
    fn new(runs: [usize; 2], trails: &[Trail]) -> Pair {
        let mut pair = Pair { runs, sums: [0.0; 2], counts: [0.0; 2] };
        for (own, other) in [(runs[0], runs[1]), (runs[1], runs[0])] {
            let (own, other) = (&trails[own], &trails[other]);
            for (share, a) in own.shares().zip(&own.left) {
                let b = other.at(&other.left, share);
                pair.sums[0] += a[0] * b[0] + a[1] * b[1];
                pair.counts[0] += 1.0;
                if own.with_heading && other.with_heading {
                    pair.sums[1] += a[2] * b[2];
                    pair.counts[1] += 1.0;
                }
            }
        }
        pair
    }
}

impl Remains {
    /// The remaining error of some runs, with an interval of this confidence.
    pub(crate) fn of(trails: &[Trail], confidence: f64) -> Remains {
        let trails: Vec<Trail> = trails.iter().filter(|trail| !trail.left.is_empty()).cloned().collect();
        let partners = |j: usize| (j.saturating_sub(MOST_PARTNERS)..j).map(move |i| [i, j]);
        let all: Vec<[usize; 2]> = (0..trails.len()).flat_map(partners).collect();
        let pairs: Vec<Pair> = all
            .into_par_iter()
            .filter(|[i, j]| trails[*i].is_of_one_path(&trails[*j]))
            .map(|runs| Pair::new(runs, &trails))
            .collect();
        let count = pairs.len();
        let paths = by_path(pairs, trails.len());
        let left = |which: usize| {
            let repeats = repeating(&paths, which, confidence);
            Left { rms: rms(&trails, which), repeats }
        };
        let with_heading = trails.iter().any(|trail| trail.with_heading);
        Remains {
            position: left(0),
            heading: with_heading.then(|| left(1)),
            pairs: count,
            piece: None,
            chance: Vec::new(),
            disturbances: Vec::new(),
        }
    }

    /// In sentences: the remaining error, the part that is the same in every run, the noise, and where runs are disturbed.
    pub fn sentences(&self) -> Vec<String> {
        let told = [Some(self.of_runs()), self.of_chance(), self.of_disturbances()];
        told.into_iter().flatten().map(|sentence| format!("{sentence}.")).collect()
    }

    fn of_runs(&self) -> String {
        let parts: Vec<(Left, Unit)> =
            std::iter::once((self.position, MILLIMETRES)).chain(self.heading.map(|left| (left, DEGREES))).collect();
        let told = |of: &dyn Fn(&Repeating) -> Option<f64>| {
            let parts = parts.iter().filter_map(|(left, unit)| Some(unit.text(of(&left.repeats?)?)));
            parts.collect::<Vec<_>>().join(" and ")
        };
        let mut left = parts.iter().map(|(left, unit)| unit.text(left.rms)).collect::<Vec<_>>().join(" and ");
        if let Some(seconds) = self.piece {
            left += &format!(" in pieces of {seconds:.0} s, each from a START of its own");
        }
        let pairs = match self.pairs {
            0 => {
                return format!(
                    "The model leaves {left}. No two runs drive the same path, so pairs of runs cannot separate what repeats from chance"
                );
            }
            1 => "one pair of runs of one path".to_owned(),
            pairs => format!("{pairs} pairs of runs of one path"),
        };
        let most = told(&|repeats| Some(repeats.interval?.high));
        let shown = told(&|repeats| Some(repeats.interval?.low).filter(|low| *low > 0.0));
        if most.is_empty() {
            return format!("The model leaves {left}. What of it repeats in every run, {pairs} cannot show");
        }
        if shown.is_empty() {
            return format!(
                "The model leaves {left}. No part of it is shown to repeat in every run (at most {most}; {pairs})"
            );
        }
        format!(
            "The model leaves {left}. The part that repeats in every run is at least {shown} (at most {most}; {pairs}); the rest is chance, or differs \
             between runs"
        )
    }

    /// What all noise together would leave of positions \[m\].
    fn of_noise(&self) -> f64 {
        self.chance.iter().map(|chance| chance.position.powi(2)).sum::<f64>().sqrt()
    }

    /// How many times as much is left as the noise makes, if that is clearly more.
    pub fn excess(&self) -> Option<f64> {
        let times = self.position.rms / self.of_noise();
        (times.is_finite() && times > UNDONE).then_some(times)
    }

    fn of_chance(&self) -> Option<String> {
        let total = self.of_noise();
        if total > UNDONE * self.position.rms {
            return Some(format!(
                "The fitted noise alone would leave {}: part of the noise from pose to pose does not accumulate, as with whole encoder ticks",
                MILLIMETRES.text(total)
            ));
        }
        let mut told: Vec<&Chance> =
            self.chance.iter().filter(|chance| chance.position >= TOLD * total && chance.position > 0.0).collect();
        told.sort_by(|a, b| b.position.total_cmp(&a.position));
        let one = |chance: &&Chance| format!("the {} leaves {}", chance.source, MILLIMETRES.text(chance.position));
        let told: Vec<String> = told.iter().map(one).collect();
        let excess = self.excess().map(|times| format!(". What is left is {times:.1} times all of that together"));
        let excess = excess.unwrap_or_default();
        (!told.is_empty()).then(|| format!("By chance alone, {}{excess}", told.join(", ")))
    }

    fn of_disturbances(&self) -> Option<String> {
        let (lasting, passing): (Vec<&Disturbance>, Vec<&Disturbance>) =
            self.disturbances.iter().partition(|d| d.lasts);
        let mut parts = Vec::new();
        if !lasting.is_empty() {
            let mut largest = lasting.clone();
            largest.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
            let one = |at: &&Disturbance| {
                let [ahead, left, turned] = at.by;
                let to = |value: f64| if value < 0.0 { "right" } else { "left" };
                format!(
                    "{} after {:.2} m by {} ahead, {} to the {}, turned {} to the {}",
                    at.run,
                    at.rolled,
                    MILLIMETRES.text(ahead),
                    MILLIMETRES.text(left.abs()),
                    to(left),
                    DEGREES.text(turned.abs()),
                    to(turned)
                )
            };
            let told: Vec<String> = largest.iter().take(NAMED).map(one).collect();
            let (times, among) = match lasting.len() {
                1 => ("Once".to_owned(), ""),
                count => (format!("{count} times"), if count > NAMED { "among them " } else { "" }),
            };
            parts.push(format!(
                "{times} a chance bump or slip moves a run by more than that: {among}{}",
                told.join("; ")
            ));
        }
        if !passing.is_empty() {
            let most = passing.iter().map(|at| at.by[0].hypot(at.by[1])).fold(0.0, f64::max);
            let poses = counted(passing.len(), "reference pose");
            parts.push(format!("{poses} briefly wrong, by up to {}", MILLIMETRES.text(most)));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// Whether some of it is the same in every run.
    pub fn repeats(&self) -> bool {
        [Some(self.position), self.heading].into_iter().flatten().filter_map(|left| left.repeats).any(|r| r.is_shown())
    }
}

fn rms(trails: &[Trail], which: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for trail in trails.iter().filter(|trail| which == 0 || trail.with_heading) {
        for [x, y, heading] in &trail.left {
            sum += if which == 0 { x * x + y * y } else { heading * heading };
            count += 1.0;
        }
    }
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// The root of the mean of products, with the interval of the mean by the jackknife over the runs of each path.
fn repeating(paths: &[Vec<Pair>], which: usize, confidence: f64) -> Option<Repeating> {
    let add = |(sum, count): (f64, f64), pair: &Pair| (sum + pair.sums[which], count + pair.counts[which]);
    let all: Vec<(f64, f64)> = paths.iter().map(|path| path.iter().fold((0.0, 0.0), add)).collect();
    let count: f64 = all.iter().map(|(_, count)| count).sum();
    if count <= 0.0 {
        return None;
    }
    let square = all.iter().map(|(sum, _)| sum).sum::<f64>() / count;
    let (mut variance, mut freedom) = (0.0, 0.0);
    for (path, (sum, weight)) in paths.iter().zip(&all) {
        let runs = runs_of(path);
        let n = runs.len() as f64;
        let mut own = vec![(0.0, 0.0); runs.len()];
        for (pair, run) in path.iter().flat_map(|pair| pair.runs.map(|run| (pair, run))) {
            if let Ok(place) = runs.binary_search(&run) {
                own[place] = add(own[place], pair);
            }
        }
        let without: Vec<f64> = own
            .iter()
            .map(|(own, count)| (sum - own, weight - count))
            .filter(|(_, count)| *count > 0.0)
            .map(|(s, c)| s / c)
            .collect();
        if without.len() < runs.len() {
            return Some(Repeating { value: square.max(0.0).sqrt(), interval: None });
        }
        let middle = without.iter().sum::<f64>() / n;
        let own = (n - 1.0) / n * without.iter().map(|value| (value - middle).powi(2)).sum::<f64>();
        variance += (weight / count).powi(2) * own;
        freedom += n - 1.0;
    }
    let half = student_t_quantile(0.5 + 0.5 * confidence, freedom) * variance.sqrt();
    let root = |square: f64| square.max(0.0).sqrt();
    let interval = Some(Interval { low: root(square - half), high: root(square + half) });
    Some(Repeating { value: root(square), interval })
}

/// The runs of some pairs.
fn runs_of(pairs: &[Pair]) -> Vec<usize> {
    let mut runs: Vec<usize> = pairs.iter().flat_map(|pair| pair.runs).collect();
    runs.sort_unstable();
    runs.dedup();
    runs
}

/// Pairs of runs, grouped by path: runs that are connected by a chain of pairs drive the same path. Where some paths have three runs or
/// more, those of two are left out, since their uncertainty is unknown.
fn by_path(pairs: Vec<Pair>, runs: usize) -> Vec<Vec<Pair>> {
    let mut path_of: Vec<usize> = (0..runs).collect();
    let find = |path_of: &[usize], mut run: usize| {
        while path_of[run] != run {
            run = path_of[run];
        }
        run
    };
    for pair in &pairs {
        let [a, b] = pair.runs.map(|run| find(&path_of, run));
        path_of[a.max(b)] = a.min(b);
    }
    let mut paths: BTreeMap<usize, Vec<Pair>> = BTreeMap::new();
    for pair in pairs {
        paths.entry(find(&path_of, pair.runs[0])).or_default().push(pair);
    }
    if paths.values().any(|path| runs_of(path).len() >= FEWEST) {
        paths.retain(|_, path| runs_of(path).len() >= FEWEST);
    }
    paths.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    const STEPS: usize = 60;

    /// Runs of `count` each way around a circle, each with a drift of its own, and all with a law of this size \[m\].
    fn trails(count: usize, law: f64, seed: u64) -> Vec<Trail> {
        let one = |index: usize| {
            let mut stream = Stream::new(seed, 0, index as u64);
            let sense = if index < count { 1.0 } else { -1.0 };
            let length = 8.0 * (1.0 + 0.004 * stream.normal());
            let (mut heading, mut left) = (0.0, [0.0; 3]);
            let mut trail =
                Trail { sense, rolled: Vec::new(), places: Vec::new(), left: Vec::new(), with_heading: true };
            for step in 0..STEPS {
                let share = (step + 1) as f64 / STEPS as f64;
                let (sine, cosine) = libm::sincos(sense * 6.0 * share);
                heading += 1e-3 * stream.normal();
                left = [left[0] - sine * heading * 0.13, left[1] + cosine * heading * 0.13, heading];
                trail.rolled.push(length * share);
                trail.places.push([1.3 * sine.abs(), sense * 1.3 * (1.0 - cosine)]);
                trail.left.push([left[0] + law * sine, left[1] + law * sense * cosine, left[2]]);
            }
            trail
        };
        (0..2 * count).map(one).collect()
    }

    #[test]
    fn what_is_the_same_in_every_run_is_found_with_its_size() {
        let held = (0..40).filter(|seed| {
            let remains = Remains::of(&trails(5, 0.02, *seed), 0.95);
            assert_eq!(remains.pairs, 20);
            let repeats = remains.position.repeats.unwrap();
            assert!(repeats.is_shown() && remains.repeats(), "{remains:?}");
            repeats.interval.unwrap().contains(0.02)
        });
        let held = held.count();
        assert!(held >= 34, "{held}");
        let remains = Remains::of(&trails(5, 0.02, 1), 0.95);
        let said = &remains.sentences()[0];
        assert!(
            said.contains("The part that repeats in every run is at least ") && said.contains("20 pairs"),
            "{said}"
        );
        assert!(!said.contains("in pieces"), "{said}");
        let of_pieces = Remains { piece: Some(41.6), ..remains };
        let said = &of_pieces.sentences()[0];
        assert!(said.contains(" deg in pieces of 42 s, each from a START of its own. The part"), "{said}");
    }

    #[test]
    fn chance_is_seldom_said_to_be_the_same_in_every_run() {
        for count in [3, 5] {
            let shown = (0..400).filter(|seed| Remains::of(&trails(count, 0.0, 1000 + seed), 0.95).repeats()).count();
            assert!(shown <= 20, "{count}: {shown} of 400");
        }
    }

    #[test]
    fn an_error_far_above_what_the_noise_makes_is_said_to_be() {
        let chance = |position: f64| Chance { source: "noise of the wheels", position, heading: 0.0 };
        let mut remains = Remains::of(&trails(4, 0.0, 3), 0.95);
        let rms = remains.position.rms;
        for (noise, excess) in
            [(vec![chance(0.6 * rms), chance(0.8 * rms)], None), (vec![chance(0.5 * rms)], Some(2.0))]
        {
            remains.chance = noise;
            assert_eq!(remains.excess().map(|times| (10.0 * times).round() / 10.0), excess);
            let said = remains.of_chance().unwrap();
            assert_eq!(said.contains("What is left is 2.0 times all of that"), excess.is_some(), "{said}");
        }
        remains.chance = Vec::new();
        assert_eq!(remains.excess(), None);
    }

    #[test]
    fn runs_of_other_paths_are_no_pairs_and_two_runs_have_no_interval() {
        let mut few = trails(1, 0.02, 1);
        assert_eq!(Remains::of(&few, 0.95).pairs, 0);
        assert!(Remains::of(&few, 0.95).sentences()[0].contains("No two runs drive the same path"));
        few.push(trails(1, 0.02, 2).remove(0));
        let remains = Remains::of(&few, 0.95);
        let repeats = remains.position.repeats.unwrap();
        assert!(remains.pairs == 1 && repeats.interval.is_none() && !remains.repeats(), "{remains:?}");
        few[2].places.iter_mut().for_each(|[x, _]| *x *= -1.0);
        assert_eq!(Remains::of(&few, 0.95).pairs, 0);
        few[2].places.iter_mut().for_each(|[x, _]| *x *= -1.0);
        few[2].rolled.iter_mut().for_each(|rolled| *rolled *= 1.2);
        assert_eq!(Remains::of(&few, 0.95).pairs, 0);
    }
}
