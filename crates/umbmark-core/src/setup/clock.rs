//! Delay of the reference's time stamps, run by run.

use super::Seen;
use super::agreement::{Agreement, Beside, Reading};
use super::windows::{Rolled, Rolling, Window};
use crate::drive::Robot;
use crate::run::TickLog;
use crate::stats::Measured;
use crate::stats::robust::{biweight, median, quantile};

/// Range and step of the delays that are tried \[s\], of both signs.
const FARTHEST: f64 = 1.0;
const STEP: f64 = 0.05;
/// A delay other than zero must reduce the disagreement by this share.
const CLEARLY: f64 = 0.05;
/// Length of a piece of a run in which the rate of a clock is negligible \[s\], and the minimum number of windows in it.
const PIECE: f64 = 60.0;
const FEWEST: usize = 20;
/// Maximum number of steps of the fit, first by absolute deviations: at steady speed only few windows show the delay, and far from the
/// solution these look like outliers. Then the change of the delay that ends the fit \[s\].
const STEPS: [usize; 2] = [5, 9];
const ENOUGH: f64 = 1e-6;
/// If the reference moves this many times as far as the wheels, its unit is another one.
const OTHER_UNIT: f64 = 5.0;
/// Where turns alone were measured, this quantile of their sizes in all windows is that of the wheels' turns, whatever the delay.
const LARGE: f64 = 0.95;
/// Half of the step of a derivative by time \[s\].
const HALF: f64 = 0.01;
/// The residual of a window has three coordinates; the median of its length, in standard deviations of one coordinate.
const MEDIAN_SIZE: f64 = 1.538;
/// Minimum standard deviation for weights \[m\]: the windows in which the motion changes show the delay, and they are not exact arcs.
const LEAST_SCALE: f64 = 1e-3;
/// A clock may increase the residuals by this share, because they are weighted differently.
const SLACK: f64 = 1e-2;
/// Beyond this many standard deviations a window has no weight.
const BEYOND: f64 = 6.0;

/// Clock of a run: delay at its middle, and the change of the delay per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Late {
    /// \[s\]
    pub delay: f64,
    /// \[s/s\]
    pub rate: f64,
    /// Time of the middle \[s\].
    pub middle: f64,
    /// Variances and covariance of delay and rate.
    pub covariance: [f64; 3],
    /// Number of windows that determine the delay: fewer where the motion seldom changes.
    pub told_by: f64,
}

impl Late {
    /// Delay of a time stamp \[s\].
    pub fn at(&self, time: f64) -> f64 {
        self.delay + self.rate * (time - self.middle)
    }

    /// The delay with its standard error; `None` if the motion does not determine it.
    pub fn measured(&self) -> Option<Measured> {
        // Neighbouring windows overlap by half.
        let (variance, parts) = (2.0 * self.covariance[0], (0.5 * self.told_by) as usize);
        (variance > 0.0).then(|| Measured::of_parts(self.delay, variance.sqrt(), parts))
    }

    /// The true time of a pose with this time stamp \[s\].
    pub fn taken(&self, time: f64) -> f64 {
        time - self.at(time)
    }
}

/// How the wheels rolled during the true time of each window.
pub(super) fn beside(windows: &[Window], rolled: &Rolled, late: &Late) -> Vec<Beside> {
    windows.iter().map(|w| (*w, rolled.between(late.taken(w.from), late.taken(w.to)))).collect()
}

/// The same of runs whose ticks are read otherwise, as in these logs, each with a delay that is guessed anew.
pub(super) fn reread(seen: &[Seen], logs: &[TickLog], robot: &Robot) -> Vec<Beside> {
    let one = |(seen, log): (&Seen, &TickLog)| {
        let rolled = Rolled::new(log, robot);
        let late = guess(&seen.windows, &rolled, robot.drive.wheelbase());
        beside(&seen.windows, &rolled, &late)
    };
    seen.iter().zip(logs).flat_map(one).collect()
}

/// First guess of the delay: the one at which the sizes of both motions correlate best, whatever the columns are called. Nothing if the
/// motion is too uniform.
pub(super) fn guess(windows: &[Window], rolled: &Rolled, wheelbase: f64) -> Late {
    let (Some(first), Some(last)) = (windows.first(), windows.last()) else { return Late::default() };
    let middle = 0.5 * (first.from + last.to);
    let count = ((last.to - first.from) / PIECE).ceil().max(1.0);
    let span = (last.to - first.from) / count + 1e-9;
    let piece = |k: usize| {
        let from = first.from + k as f64 * span;
        let own: Vec<&Window> = windows.iter().filter(|w| w.from >= from && w.from < from + span).collect();
        Some((from + 0.5 * span, delay_of(&own, rolled, wheelbase)?))
    };
    let found: Vec<(f64, f64)> = (0..count as usize).filter_map(piece).collect();
    if found.is_empty() {
        return Late { middle, ..Late::default() };
    }
    let slopes =
        found.iter().enumerate().flat_map(|(k, a)| found[k + 1..].iter().map(move |b| (b.1 - a.1) / (b.0 - a.0)));
    // Two pieces give only one slope, which may be a step of the grid.
    let rate = if found.len() > 2 { median(slopes) } else { 0.0 };
    let delay = median(found.iter().map(|(at, delay)| delay - rate * (at - middle)));
    Late { delay, rate, middle, ..Late::default() }
}

/// The delay of a piece; `None` if its motion does not determine it.
fn delay_of(windows: &[&Window], rolled: &Rolled, wheelbase: f64) -> Option<f64> {
    if windows.len() < FEWEST {
        return None;
    }
    let moved = |w: &&Window| if w.headings_only { 0.0 } else { libm::hypot(w.moved[0], w.moved[1]) };
    let way: Vec<f64> = windows.iter().map(moved).collect();
    let only = windows.iter().any(|w| w.headings_only);
    let rolls = |rolling: Rolling| {
        if only { 0.5 * (rolling.travel[1] - rolling.travel[0]).abs() } else { faster(&rolling) }
    };
    let still: Vec<f64> = windows.iter().map(|w| rolls(rolled.between(w.from, w.to))).collect();
    // Positions in another unit than metres must not outweigh the rotations.
    let unit = Some(ratio(&way, &still)).filter(|ratio| *ratio > OTHER_UNIT).unwrap_or(1.0);
    let seen: Vec<f64> =
        windows.iter().zip(&way).map(|(w, way)| way / unit + 0.5 * wheelbase * w.turned.abs()).collect();
    // A robot that mostly drives straight does not turn in most windows: at a wrong delay, few of those in which the wheels turn show a turn.
    let large = |sizes: &[f64]| quantile(sizes.iter().copied(), LARGE);
    let alike = Some(large(&seen) / large(&still)).filter(|ratio| only && ratio.is_finite() && *ratio > 0.0);
    let reach = (FARTHEST / STEP).round() as i32;
    let off = |late: f64| {
        // The travel of the faster wheel is that of the body plus that of the lever arm, for all signs of the counts.
        let own: Vec<f64> = windows.iter().map(|w| rolls(rolled.between(w.from - late, w.to - late))).collect();
        let ratio = alike.unwrap_or_else(|| ratio(&seen, &own));
        let most = 2.0 * ratio * own.iter().fold(0.0_f64, |most, v| most.max(*v));
        own.iter().zip(&seen).map(|(own, seen)| (seen - ratio * own).abs().min(most)).sum::<f64>()
    };
    let found = (-reach..=reach).map(|k| f64::from(k) * STEP).map(|late| (off(late), late));
    let (least, late) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (least > 0.0).then(|| if off(0.0) > least * (1.0 + CLEARLY) { late } else { 0.0 })
}

/// The travel of the faster wheel; where the robot moves sideways, that of a wheel of the axle which would roll along its way.
fn faster(rolling: &Rolling) -> f64 {
    let [left, right] = rolling.travel;
    if rolling.aside == 0.0 {
        return left.abs().max(right.abs());
    }
    libm::hypot(0.5 * (left + right), rolling.aside) + 0.5 * (right - left).abs()
}

/// Ratio of the motion of the reference to that of the wheels, from windows with much motion.
fn ratio(seen: &[f64], own: &[f64]) -> f64 {
    let usual = median(own.iter().copied());
    let much = own.iter().zip(seen).filter(|(own, _)| **own >= usual && **own > 0.0);
    let ratio = median(much.map(|(own, seen)| seen / own));
    if ratio > 0.0 { ratio } else { 1.0 }
}

/// What one step of the fit of delay and rate needs of all windows.
#[derive(Default)]
struct Sums {
    /// Weighted products of the slopes by delay and rate: delay with itself, with the rate, and the rate with itself.
    products: [f64; 3],
    /// Their weighted products with the residuals, against which the fit goes.
    score: [f64; 2],
    /// Sums of the squares of what each window pulls at the delay, and of its share of the first product.
    squares: f64,
    shares: f64,
}

impl Sums {
    /// Adds a window: its weight, its time from the middle of all, its residuals, and their slopes by the delay.
    fn add(&mut self, weight: f64, at: f64, residuals: &[f64; 3], slopes: [f64; 3]) {
        let (mut pull, mut share) = (0.0, 0.0);
        for (residual, slope) in residuals.iter().zip(slopes) {
            let x = [slope, slope * at];
            let products = [weight * x[0] * x[0], weight * x[0] * x[1], weight * x[1] * x[1]];
            self.products.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
            self.score.iter_mut().zip(x).for_each(|(sum, x)| *sum -= weight * x * residual);
            (pull, share) = (pull + weight * slope * residual, share + weight * slope * slope);
        }
        (self.squares, self.shares) = (self.squares + pull * pull, self.shares + share * share);
    }
}

/// The delay and the rate that fit a run best, with everything else as it agrees in all runs.
pub(super) fn refined(
    windows: &[Window],
    rolled: &Rolled,
    from: &Late,
    (agreement, reading, wheelbase): (&Agreement, Reading, f64),
) -> Late {
    let arm = 0.5 * wheelbase;
    // Rotations in metres, at the arm of a wheel.
    let residuals = |late: &Late, shift: f64| -> Vec<[f64; 3]> {
        let own = windows.iter().map(|w| {
            let of = (*w, rolled.between(late.taken(w.from) + shift, late.taken(w.to) + shift));
            let [x, y, turned] = agreement.residual(reading, &of, wheelbase);
            [x, y, arm * turned]
        });
        own.collect()
    };
    let span = windows.last().zip(windows.first()).map_or(0.0, |(last, first)| last.to - first.from);
    let with_rate = span > PIECE;
    let size = |r: &[f64; 3]| r.iter().map(|r| r * r).sum::<f64>().sqrt();
    let mut late = *from;
    // The travel in a window is known to whole counts at both ends.
    let least = LEAST_SCALE.max(rolled.uncertain(wheelbase));
    let mut widest = least;
    for step in 0..STEPS[0] + STEPS[1] {
        let (now, before, after) = (residuals(&late, 0.0), residuals(&late, -HALF), residuals(&late, HALF));
        // Some coordinates may have no noise at all.
        let scale = median(now.iter().map(size)) / MEDIAN_SIZE;
        widest = widest.max(scale);
        let mut sums = Sums::default();
        for (w, ((now, before), after)) in windows.iter().zip(now.iter().zip(&before).zip(&after)) {
            let off = size(now) / scale.max(least);
            let weight = if step < STEPS[0] { 1.0 / off.max(1.0) } else { biweight(off / BEYOND) };
            let at = if with_rate { 0.5 * (w.from + w.to) - late.middle } else { 0.0 };
            // Derivative of the residuals by time, which is minus that by the delay.
            let slopes = [0, 1, 2].map(|k| -(after[k] - before[k]) / (2.0 * HALF));
            sums.add(weight, at, now, slopes);
        }
        let Sums { products: [a, b, c], score, squares, shares } = sums;
        let determinant = a * c - b * b;
        let plain = determinant <= 1e-9 * a * c || c <= 0.0;
        let change = match (a > 0.0, plain) {
            (false, _) => break,
            (true, true) => [score[0] / a, 0.0],
            (true, false) => [(c * score[0] - b * score[1]) / determinant, (a * score[1] - b * score[0]) / determinant],
        };
        late.delay += change[0].clamp(-0.2, 0.2);
        late.rate = (late.rate + change[1]).clamp(-0.2, 0.2);
        // The windows that determine the delay are those in which the motion changes; their residuals may be larger than others (White
        // 1980).
        let variance = (scale * scale).max(squares / a);
        late.told_by = a * a / shares;
        late.covariance = if plain { [variance / a, 0.0, 0.0] } else { [c, -b, a].map(|v| variance * v / determinant) };
        if step >= STEPS[0] && change[0].abs() < ENOUGH {
            break;
        }
    }
    // If few windows determine the clock, the steps can diverge.
    let left = |late: &Late| residuals(late, 0.0).iter().map(|r| size(r).min(BEYOND * widest)).sum::<f64>();
    if left(&late) <= left(from) * (1.0 + SLACK) { late } else { Late { covariance: [0.0; 3], ..*from } }
}
