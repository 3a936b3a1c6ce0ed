//! What changed, after an alarm: since when, and by how much.
//!
//! Let D be the mean of the runs after the change less that of those before, by direction, with covariance C = Σ̂ (1/n_before + 1/n_after), Σ̂ pooled
//! over both sides. The change of the robot's numbers is δ = (Σ JᵀC⁻¹J)⁻¹ Σ JᵀC⁻¹D over the directions, with Student's t of the degrees of freedom of Σ̂.
//!
//! Where the return errors before are known for a path, J is taken at the numbers that explain them. The place of the change has the probabilities
//! e^h normalised, with h the logarithm of the likelihood ratio.

use super::observation::slopes_at;
use super::scores::{COMPONENTS, Matrix, Scorer, reach};
use super::statistic::{Kind, Scan};
use super::{Course, NUMBERS, Point, Step, Use};
use crate::calibrate::{Correction, drive_again};
use crate::drive::Robot;
use crate::geometry::wrap;
use crate::path::{Direction, Path};
use crate::stats::{Interval, f_quantile, f_upper_tail, student_t_quantile, t_two_sided};
use nalgebra::{DMatrix, DVector};

/// Intervals hold with this probability.
pub const CONFIDENCE: f64 = 0.95;

/// A change of place is told from one of numbers, and of scatter from one of place, at this p.
const TOLD_APART: f64 = 0.01;

/// Numbers account for a change if they account for this share of its square, whatever the rest is: large changes are not linear.
const ENOUGH: f64 = 0.8;

/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// Half the width of its 95 % interval.
    pub half: f64,
}

/// A number of the robot before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedNumber {
    /// "e_d", "e_b" or "e_s".
    pub key: &'static str,
    /// True over nominal before, if nothing else makes the return errors.
    pub before: Value,
    /// True over nominal after.
    pub after: Value,
    /// After less before.
    pub change: f64,
    /// 95 % interval of the change.
    pub interval: Interval,
    /// p of no change, adjusted for all numbers (Holm).
    pub p_adjusted: f64,
}

/// The mean return error of a direction, after less before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedPlace {
    /// The direction.
    pub direction: Direction,
    /// Along the START heading \[m\].
    pub x: Value,
    /// To the left \[m\].
    pub y: Value,
    /// Heading \[rad\], where it was measured.
    pub heading: Option<Value>,
}

/// The scatter of the runs, after over before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedScatter {
    /// Ratio of standard deviations.
    pub ratio: f64,
    /// Its 95 % interval.
    pub interval: Interval,
}

/// A length of the robot that accounts for the change by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alone {
    /// Its key in robot.toml.
    pub key: &'static str,
    /// What it is, in words.
    pub meaning: &'static str,
    /// Change of it as a share of itself.
    pub share: f64,
    /// Half the width of its 95 % interval.
    pub half: f64,
    /// p of what it leaves of the change.
    pub p: f64,
}

/// A change.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What changed.
    pub kind: Kind,
    /// Place of the first run after it.
    pub since: usize,
    /// The first run after it lies between this place
    pub earliest: usize,
    /// and this one, with 95 % probability.
    pub latest: usize,
    /// Place of the run with which the alarm was raised.
    pub seen: usize,
    /// The numbers of the robot.
    pub numbers: Vec<MovedNumber>,
    /// Lengths of which each accounts for the change of the numbers by itself.
    pub alone: Vec<Alone>,
    /// p of what the numbers leave of the change of place; `None` where they leave nothing to compare.
    pub p_left: Option<f64>,
    /// The mean return errors.
    pub places: Vec<MovedPlace>,
    /// The scatter, where it is known on both sides.
    pub scatter: Option<MovedScatter>,
    /// Outlying runs on both sides of the change.
    pub outlying: Vec<usize>,
}

impl Change {
    /// Runs that were compared from the first after the change to that of the alarm.
    pub fn runs_until_seen(&self, runs: &[Point]) -> usize {
        let left = |run: &&Point| !matches!(run.used, Use::LeftOut(_));
        runs[self.since..=self.seen.max(self.since)].iter().filter(left).count()
    }

    /// The numbers that moved by more than chance.
    pub fn moved(&self) -> impl Iterator<Item = &MovedNumber> {
        self.numbers.iter().filter(|number| number.p_adjusted < 1.0 - CONFIDENCE)
    }
}

/// The change behind an alarm of the run `seen`.
pub(super) fn change(
    course: &Course,
    scan: &Scan,
    runs: &[Point],
    seen: usize,
    robot: &Robot,
    path: Option<&Path>,
) -> Option<Change> {
    let mut alarmed: Vec<Kind> = runs[seen..].iter().flat_map(Point::alarms).collect();
    alarmed.sort();
    alarmed.dedup();
    let of_kind = |kind: Kind| {
        let [since, earliest, latest] = places(scan, kind, course, seen)?;
        let sides = Sides::of(course, since)?;
        let numbers = Numbers::of(&sides, course, robot, path);
        Some((kind, [since, earliest, latest], sides, numbers))
    };
    let is_moved = alarmed.iter().any(|kind| *kind != Kind::Scatter);
    let first = if alarmed.contains(&Kind::Numbers) { Kind::Numbers } else { Kind::Place };
    let moved = if is_moved { of_kind(first) } else { None };
    // Scores that grew in all directions shift by chance too.
    let moved = moved.filter(|(_, _, sides, _)| !alarmed.contains(&Kind::Scatter) || sides.p_of_shift() < TOLD_APART);
    let (kind, [since, earliest, latest], sides, numbers) = match moved {
        Some(moved) => moved,
        None => of_kind(if alarmed.contains(&Kind::Scatter) { Kind::Scatter } else { first })?,
    };
    let p_left = numbers.as_ref().and_then(|numbers| numbers.p_left);
    let accounts = numbers.as_ref().is_some_and(|numbers| numbers.accounts);
    let kind = match kind {
        Kind::Scatter => Kind::Scatter,
        _ if accounts => Kind::Numbers,
        _ => Kind::Place,
    };
    let places = sides.places();
    let scatter = sides.scatter(course);
    let (numbers, alone) = numbers.map(|numbers| (numbers.moved, numbers.alone)).unwrap_or_default();
    Some(Change {
        kind,
        since,
        earliest,
        latest,
        seen,
        numbers,
        alone,
        p_left,
        places,
        scatter,
        outlying: sides.outlying,
    })
}

/// The place of a change of a kind, and the ends of where it is with 95 % probability.
fn places(scan: &Scan, kind: Kind, course: &Course, seen: usize) -> Option<[usize; 3]> {
    let mut heights: Vec<(usize, f64)> = Vec::new();
    scan.each(|place, all| heights.push((place, all[kind as usize])));
    // The change was before the alarm.
    heights.retain(|(step, _)| course.steps[*step].place <= seen);
    let best = heights.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let mut weights: Vec<(usize, f64)> =
        heights.iter().map(|(step, height)| (*step, libm::exp(height - best.1))).collect();
    weights.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let all: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let (mut sum, mut low, mut high) = (0.0, best.0, best.0);
    for (step, weight) in weights {
        if sum >= CONFIDENCE * all {
            break;
        }
        sum += weight;
        (low, high) = (low.min(step), high.max(step));
    }
    Some([best.0, low, high].map(|step| course.steps[step].place))
}

/// A direction on both sides of a change.
#[derive(Clone, Debug, Default)]
struct Side {
    direction: usize,
    /// Runs before and after.
    counts: [usize; 2],
    means: [DVector<f64>; 2],
    /// Σ (y - ȳ)(y - ȳ)ᵀ before and after.
    scatters: [DMatrix<f64>; 2],
    /// Pooled covariance of a run.
    covariance: DMatrix<f64>,
}

/// Both directions, as far as they were driven on both sides.
#[derive(Clone, Debug)]
struct Sides {
    sides: Vec<Side>,
    /// Degrees of freedom of the covariances.
    freedom: f64,
    outlying: Vec<usize>,
}

impl Sides {
    fn of(course: &Course, since: usize) -> Option<Sides> {
        let count = course.signature.components;
        let mut sides = Vec::new();
        let mut outlying = Vec::new();
        for direction in 0..2 {
            let steps: Vec<&Step> = course.steps.iter().filter(|step| step.direction == direction).collect();
            let (before, after): (Vec<&Step>, Vec<&Step>) = steps.into_iter().partition(|step| step.place < since);
            if before.len() < 2 || after.is_empty() {
                continue;
            }
            let far = far(&[&before, &after], count);
            let kept = |steps: Vec<&Step>| -> Vec<DVector<f64>> {
                let near = steps.iter().filter(|step| !far.contains(&step.place));
                near.map(|step| DVector::from_row_slice(&step.components[..count])).collect()
            };
            let of = [kept(before), kept(after)];
            if of[0].len() < 2 || of[1].is_empty() {
                continue;
            }
            outlying.extend(far);
            let counts = [of[0].len(), of[1].len()];
            let means = of.each_ref().map(|runs| runs.iter().sum::<DVector<f64>>() / runs.len() as f64);
            let scatter = |side: usize| {
                let off = |run: &DVector<f64>| (run - &means[side]) * (run - &means[side]).transpose();
                of[side].iter().map(off).sum::<DMatrix<f64>>()
            };
            let scatters = [scatter(0), scatter(1)];
            if counts[0] + counts[1] < count + 3 {
                continue;
            }
            let covariance = (&scatters[0] + &scatters[1]) / (counts[0] + counts[1] - 2) as f64;
            sides.push(Side { direction, counts, means, scatters, covariance });
        }
        outlying.sort_unstable();
        let freedom: usize = sides.iter().map(|side| side.counts[0] + side.counts[1] - 2).sum();
        (!sides.is_empty()).then(|| Sides { sides, freedom: (freedom + 1 - count).max(1) as f64, outlying })
    }

    fn shift(side: &Side) -> DVector<f64> {
        &side.means[1] - &side.means[0]
    }

    /// The inverse of the covariance of the shift.
    fn weight(side: &Side) -> Option<DMatrix<f64>> {
        let [before, after] = side.counts.map(|count| 1.0 / count as f64);
        (&side.covariance * (before + after)).try_inverse()
    }

    /// p of no shift, if the scatter after is another than before.
    fn p_of_shift(&self) -> f64 {
        let (mut square, mut count) = (0.0, 0);
        for side in &self.sides {
            let own = |at: usize| {
                let known = side.counts[at] > side.covariance.nrows() + 1;
                let own =
                    if known { &side.scatters[at] / (side.counts[at] - 1) as f64 } else { side.covariance.clone() };
                own / side.counts[at] as f64
            };
            let Some(inverse) = (own(0) + own(1)).try_inverse() else { return 0.0 };
            let shift = Sides::shift(side);
            square += (inverse * &shift).dot(&shift);
            count += shift.len();
        }
        f_upper_tail(square / count as f64, [count as f64, self.freedom])
    }

    fn places(&self) -> Vec<MovedPlace> {
        let quantile = student_t_quantile(0.5 + 0.5 * CONFIDENCE, self.freedom);
        let of = |side: &Side| {
            let shift = Sides::shift(side);
            let [before, after] = side.counts.map(|count| 1.0 / count as f64);
            let value = |k: usize| Value {
                value: shift[k],
                half: quantile * (side.covariance[(k, k)] * (before + after)).sqrt(),
            };
            let heading = (shift.len() > 2).then(|| value(2));
            MovedPlace { direction: Direction::BOTH[side.direction], x: value(0), y: value(1), heading }
        };
        self.sides.iter().map(of).collect()
    }

    /// Ratio of the scatters, in the shape that they have before.
    fn scatter(&self, course: &Course) -> Option<MovedScatter> {
        let count = course.signature.components;
        let (mut square, mut freedoms) = (0.0, [0.0; 2]);
        for side in self.sides.iter().filter(|side| side.counts[0] > count + 2 && side.counts[1] > 1) {
            let [before, after] = side.counts.map(|count| (count - 1) as f64);
            // The inverse of an estimated covariance is too large by ν/(ν - q - 1).
            let inverse = side.scatters[0].clone().try_inverse()? * (before - count as f64 - 1.0);
            square += (inverse * &side.scatters[1]).trace();
            freedoms[0] += count as f64 * before;
            freedoms[1] += count as f64 * after;
        }
        if freedoms[1] == 0.0 {
            return None;
        }
        let squared = square / freedoms[1];
        let end = |p: f64| (squared / f_quantile(p, [freedoms[1], freedoms[0]])).sqrt();
        let tail = 0.5 * (1.0 - CONFIDENCE);
        let interval = Interval { low: end(1.0 - tail), high: end(tail) };
        let is_known = squared.is_finite() && squared > 0.0 && interval.high.is_finite();
        is_known.then(|| MovedScatter { ratio: squared.sqrt(), interval })
    }
}

/// Places of steps that lie far from the others of their side.
fn far(sides: &[&[&Step]; 2], count: usize) -> Vec<usize> {
    let median = |steps: &[&Step], k: usize| {
        crate::stats::median(steps.iter().map(|step| step.components[k]).collect()).unwrap_or(0.0)
    };
    let mut scorer = Scorer::new(count);
    let mut far = Vec::new();
    for steps in sides {
        let middle: Vec<f64> = (0..count).map(|k| median(steps, k)).collect();
        for step in *steps {
            let mut off = [0.0; COMPONENTS];
            (0..count).for_each(|k| off[k] = step.components[k] - middle[k]);
            far.extend(scorer.add(&off).filter(|scored| scored.distance > reach(count)).map(|_| step.place));
        }
    }
    // A side that lies far as a whole is not outlying.
    let kept = |steps: &[&Step]| steps.iter().filter(|step| !far.contains(&step.place)).count();
    if 2 * kept(sides[1]) <= sides[1].len() { Vec::new() } else { far }
}

/// The numbers of the robot on both sides.
struct Numbers {
    moved: Vec<MovedNumber>,
    alone: Vec<Alone>,
    p_left: Option<f64>,
    /// Whether they account for the change of place.
    accounts: bool,
}

/// Names of the numbers.
const KEYS: [&str; NUMBERS] = ["e_d", "e_b", "e_s"];

impl Numbers {
    fn of(sides: &Sides, course: &Course, robot: &Robot, path: Option<&Path>) -> Option<Numbers> {
        let (count, numbers) = (course.signature.components, course.signature.numbers);
        let by_path = path.filter(|_| numbers < NUMBERS);
        let jacobian = |slopes: &Matrix| DMatrix::from_fn(count, numbers, |k, number| slopes[k][number]);
        let linear = |side: &Side| jacobian(&course.signature.slopes[side.direction]);
        // What explains the return errors before.
        let mut at = DVector::from_element(numbers, 1.0);
        let correction = |at: &DVector<f64>| Correction { e_d: at[0], e_b: at[1], e_s: 1.0 };
        let slopes = |side: &Side, at: &DVector<f64>| -> Option<DMatrix<f64>> {
            let Some(path) = by_path else { return Some(linear(side)) };
            let all = slopes_at(robot, path, Direction::BOTH[side.direction], &correction(at))?;
            Some(DMatrix::from_fn(count, numbers, |k, number| all[k][number]))
        };
        let predicted = |side: &Side, at: &DVector<f64>| -> Option<DVector<f64>> {
            let Some(path) = by_path else { return Some(linear(side) * (at.add_scalar(-1.0))) };
            let end = drive_again(robot, path, Direction::BOTH[side.direction], &correction(at), &Correction::NONE)?;
            Some(DVector::from_row_slice(&[end.x, end.y, end.heading.unwrap_or(0.0)][..count]))
        };
        for _ in 0..10 {
            let (mut information, mut pull) = (DMatrix::zeros(numbers, numbers), DVector::zeros(numbers));
            for side in &sides.sides {
                let (jacobian, predicted) = (slopes(side, &at)?, predicted(side, &at)?);
                let weight = (&side.covariance / side.counts[0] as f64).try_inverse()?;
                let mut off = &side.means[0] - predicted;
                if count > 2 {
                    off[2] = wrap(off[2]);
                }
                information += jacobian.transpose() * &weight * &jacobian;
                pull += jacobian.transpose() * &weight * off;
            }
            at += information.try_inverse()? * pull;
        }
        let covariance = |of: &dyn Fn(&Side) -> f64| -> Option<DMatrix<f64>> {
            let mut information = DMatrix::zeros(numbers, numbers);
            for side in &sides.sides {
                let jacobian = slopes(side, &at)?;
                information += jacobian.transpose() * (&side.covariance * of(side)).try_inverse()? * jacobian;
            }
            information.try_inverse()
        };
        let of_change = covariance(&|side| side.counts.iter().map(|count| 1.0 / *count as f64).sum())?;
        let [of_before, of_after] = [0, 1].map(|at| covariance(&|side: &Side| 1.0 / side.counts[at] as f64));
        let (of_before, of_after) = (of_before?, of_after?);
        // The change is not linear where it is large: each step begins where the one before ended.
        let mut delta = DVector::zeros(numbers);
        let (mut whole, mut unexplained) = (0.0, 0.0);
        for _ in 0..6 {
            let (mut information, mut pull) = (DMatrix::zeros(numbers, numbers), DVector::zeros(numbers));
            (whole, unexplained) = (0.0, 0.0);
            for side in &sides.sides {
                let after = &at + &delta;
                let (weight, shift, jacobian) = (Sides::weight(side)?, Sides::shift(side), slopes(side, &after)?);
                let mut off = &shift - (predicted(side, &after)? - predicted(side, &at)?);
                if count > 2 {
                    off[2] = wrap(off[2]);
                }
                information += jacobian.transpose() * &weight * &jacobian;
                pull += jacobian.transpose() * &weight * &off;
                whole += (&weight * &shift).dot(&shift);
                unexplained += (&weight * &off).dot(&off);
            }
            delta += information.try_inverse()? * pull;
        }
        if !delta.iter().chain(at.iter()).all(|value| value.is_finite()) {
            return None;
        }
        let left = sides.sides.len() * count - numbers;
        let p_left = (left > 0).then(|| f_upper_tail(unexplained / left as f64, [left as f64, sides.freedom]));
        let quantile = student_t_quantile(0.5 + 0.5 * CONFIDENCE, sides.freedom);
        let p: Vec<f64> =
            (0..numbers).map(|k| t_two_sided(delta[k] / of_change[(k, k)].sqrt(), sides.freedom)).collect();
        let adjusted = holm(&p);
        let moved = (0..numbers).map(|k| {
            let half = |covariance: &DMatrix<f64>| quantile * covariance[(k, k)].sqrt();
            MovedNumber {
                key: KEYS[k],
                before: Value { value: at[k], half: half(&of_before) },
                after: Value { value: at[k] + delta[k], half: half(&of_after) },
                change: delta[k],
                interval: Interval::around(delta[k], half(&of_change)),
                p_adjusted: adjusted[k],
            }
        });
        let alone = alone(&delta, &of_change, sides.freedom, quantile)?;
        let accounts = p_left.is_none_or(|p| p >= TOLD_APART) || unexplained < (1.0 - ENOUGH) * whole;
        Some(Numbers { moved: moved.collect(), alone, p_left, accounts })
    }
}

/// p adjusted for all of them.
fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let mut adjusted = vec![1.0; p.len()];
    let mut least = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        least = least.max((p.len() - rank) as f64 * p[index]).min(1.0);
        adjusted[index] = least;
    }
    adjusted
}

/// What a share of each length does to E_d, E_b and E_s; without E_s, E_b is that of wheelbase over diameter.
const LENGTHS: [(&str, &str, [f64; NUMBERS], [f64; NUMBERS]); 3] = [
    ("wheel_diameter_right_m", "wheel diameter right", [1.0, 0.0, 0.5], [1.0, -0.5, 0.0]),
    ("wheel_diameter_left_m", "wheel diameter left", [-1.0, 0.0, 0.5], [-1.0, -0.5, 0.0]),
    ("wheelbase_m", "wheelbase", [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
];

/// Lengths of which each accounts for the change by itself, the best first.
fn alone(delta: &DVector<f64>, covariance: &DMatrix<f64>, freedom: f64, quantile: f64) -> Option<Vec<Alone>> {
    let numbers = delta.len();
    let inverse = covariance.clone().try_inverse()?;
    let of = |(key, meaning, with_scale, without): (&'static str, &'static str, [f64; NUMBERS], [f64; NUMBERS])| {
        let all = if numbers == NUMBERS { with_scale } else { without };
        let u = DVector::from_row_slice(&all[..numbers]);
        let information = (&inverse * &u).dot(&u);
        let share = (&inverse * &u).dot(delta) / information;
        let left = delta - share * &u;
        let square = (&inverse * &left).dot(&left);
        let p = f_upper_tail(square / (numbers - 1) as f64, [(numbers - 1) as f64, freedom]);
        Alone { key, meaning, share, half: quantile / information.sqrt(), p }
    };
    let mut alone: Vec<Alone> = LENGTHS.into_iter().map(of).collect();
    alone.retain(|alone| alone.p >= 1.0 - CONFIDENCE);
    alone.sort_by(|a, b| b.p.total_cmp(&a.p));
    Some(alone)
}
