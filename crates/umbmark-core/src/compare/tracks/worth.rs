//! What a repeating error is worth: by how much the errors of a run fall along its way if it is corrected as the other runs tell.
//!
//! Many steps show errors that are too small to matter. A dependence speaks against a model only if it is worth something.

use super::covariate::{Bins, Rate, Value};
use super::followed::{ErrorIncrement, Followed};
use crate::evidence::tracks::LEAST_GAIN;
use crate::geometry::Pose2;
use crate::stats::median;

/// A run is far off whose root mean square error is so many times that of the median run.
const FAR_OFF: f64 = 3.0;

/// A test of a repeating error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// p of no such error.
    pub p: f64,
    /// Share by which the root mean square error along the way falls if each run is corrected as the other runs tell: of all runs together
    /// or, where that is more, of all but one that is far off, in position or heading, whichever falls more.
    pub gain: f64,
}

impl Test {
    /// Whether the error is large enough to speak against a model: by 2 %, as for effects that are added.
    pub fn matters(&self) -> bool {
        self.gain >= LEAST_GAIN
    }

    /// Whether the error is shown at this size of the test.
    pub(super) fn shows(&self, size: f64) -> bool {
        self.p < size
    }
}

/// What the mean rate of the other runs is worth.
pub(super) fn of_level(runs: &[Followed], rate: Rate) -> f64 {
    whatever_one_run_does(runs, |runs| {
        let totals: Vec<[f64; 2]> = runs.iter().map(|run| total(&run.steps, rate)).collect();
        gain(runs, rate, |run, _| Some(without(&totals, run)))
    })
}

/// What the dependence on a covariate is worth: by the means of its bins, or by the line through the means of whole runs, whichever is
/// worth more; both relative to the mean rate.
pub(super) fn of_dependence(runs: &[Followed], rate: Rate, bins: &Bins, between: Option<Value>) -> f64 {
    whatever_one_run_does(runs, |runs| dependence(runs, rate, bins, between))
}

/// The worth by all runs or, where that is more, without the run that is [far off](FAR_OFF) in position or in heading.
fn whatever_one_run_does(runs: &[Followed], worth: impl Fn(&[&Followed]) -> f64) -> f64 {
    let all: Vec<&Followed> = runs.iter().collect();
    let squares: Vec<[f64; 2]> = runs.iter().map(off).collect();
    let far_off = |k: usize| {
        let usual = median(squares.iter().map(|own| own[k]).collect())?;
        let far = (0..runs.len()).max_by(|a, b| squares[*a][k].total_cmp(&squares[*b][k]))?;
        (squares[far][k] > FAR_OFF * FAR_OFF * usual).then_some(far)
    };
    let (in_position, in_heading) = (far_off(0), far_off(1));
    let without = |far: usize| {
        let nearer = all.iter().enumerate().filter(|(run, _)| *run != far);
        worth(&nearer.map(|(_, run)| *run).collect::<Vec<&Followed>>())
    };
    let far = [in_position, in_heading.filter(|far| Some(*far) != in_position)];
    far.into_iter().flatten().map(without).fold(worth(&all), f64::max)
}

fn dependence(runs: &[&Followed], rate: Rate, bins: &Bins, between: Option<Value>) -> f64 {
    let spans = bins.spans().len();
    let of_run = |run: &&Followed| {
        let of_bin = |bin| total(run.steps.iter().filter(|step| bins.index(step) == Some(bin)), rate);
        (0..spans).map(of_bin).collect::<Vec<[f64; 2]>>()
    };
    let by_run: Vec<Vec<[f64; 2]>> = runs.iter().map(of_run).collect();
    let totals: Vec<[f64; 2]> = runs.iter().map(|run| total(&run.steps, rate)).collect();
    let of_others = |run: usize| {
        let level = without(&totals, run);
        let bin = |bin: usize| {
            let own: Vec<[f64; 2]> = by_run.iter().map(|run| run[bin]).collect();
            own.iter().enumerate().any(|(other, sum)| other != run && sum[1] > 0.0).then(|| without(&own, run) - level)
        };
        (0..spans).map(bin).collect::<Vec<Option<f64>>>()
    };
    let means: Vec<Vec<Option<f64>>> = (0..runs.len()).map(of_others).collect();
    let of_bins = gain(runs, rate, |run, step| bins.index(step).and_then(|bin| means[run][bin]));
    let of_line = between.map(|value| {
        let lines: Vec<Option<[f64; 2]>> = (0..runs.len()).map(|run| line(runs, &totals, rate, value, run)).collect();
        gain(runs, rate, |run, step| lines[run].map(|[slope, centre]| slope * (value(&step.at) - centre)))
    });
    of_line.map_or(of_bins, |of_line| of_bins.max(of_line))
}

/// Errors and amount of driving of steps.
fn total<'a>(steps: impl IntoIterator<Item = &'a ErrorIncrement>, rate: Rate) -> [f64; 2] {
    steps.into_iter().filter_map(|step| rate.of(step)).fold([0.0; 2], |[e, a], [error, amount]| [e + error, a + amount])
}

/// The mean rate of all sums but one; 0 if nothing is driven in them.
fn without(sums: &[[f64; 2]], one: usize) -> f64 {
    let others = sums.iter().enumerate().filter(|(run, _)| *run != one);
    let [error, amount] = others.fold([0.0; 2], |[e, a], (_, own)| [e + own[0], a + own[1]]);
    if amount > 0.0 { error / amount } else { 0.0 }
}

/// Slope and centre of the line through the rates of all runs but one against their means of a covariate.
fn line(runs: &[&Followed], totals: &[[f64; 2]], rate: Rate, value: Value, one: usize) -> Option<[f64; 2]> {
    let others = runs.iter().zip(totals).enumerate().filter(|(run, (_, [_, amount]))| *run != one && *amount > 0.0);
    let point = |(_, (run, [error, amount])): (usize, (&&Followed, &[f64; 2]))| {
        let at: f64 = run.steps.iter().filter_map(|step| Some(rate.of(step)?[1] * value(&step.at))).sum();
        [at / amount, error / amount]
    };
    let points: Vec<[f64; 2]> = others.map(point).collect();
    let n = points.len() as f64;
    let centre = points.iter().map(|p| p[0]).sum::<f64>() / n;
    let across: f64 = points.iter().map(|p| (p[0] - centre).powi(2)).sum();
    let along: f64 = points.iter().map(|p| (p[0] - centre) * p[1]).sum();
    (across > 0.0).then(|| [along / across, centre])
}

/// Share by which the errors fall if each step is corrected by a rate, given for the run and the step.
fn gain(runs: &[&Followed], rate: Rate, of: impl Fn(usize, &ErrorIncrement) -> Option<f64>) -> f64 {
    let mut squares = [[0.0; 2]; 2];
    for (index, run) in runs.iter().enumerate() {
        let own = corrected(run, |step| rate.made(step, of(index, step)?));
        squares = [0, 1].map(|k| [0, 1].map(|i| squares[k][i] + own[k][i]));
    }
    let fall = |[before, after]: [f64; 2]| if before > 0.0 { 1.0 - (after / before).sqrt() } else { 0.0 };
    fall(squares[0]).max(fall(squares[1]))
}

/// Sums of the squared errors of a run, of positions and of headings.
fn off(run: &Followed) -> [f64; 2] {
    corrected(run, |_| None).map(|[before, _]| before)
}

/// The same, each as predicted and with its steps corrected by these motions.
fn corrected(run: &Followed, of: impl Fn(&ErrorIncrement) -> Option<[f64; 3]>) -> [[f64; 2]; 2] {
    let mut squares = [[0.0; 2]; 2];
    let mut steps = run.steps.iter().peekable();
    let mut corrected = Pose2::IDENTITY;
    for (at, place) in run.places.iter().enumerate() {
        let step = steps.next_if(|step| step.ends == at);
        if place.starts || at == 0 {
            corrected = place.predicted;
            continue;
        }
        corrected = corrected.compose(&run.places[at - 1].predicted.between(&place.predicted));
        if let Some([x, y, heading]) = step.and_then(&of) {
            corrected = corrected.compose(&Pose2::new(x, y, heading));
        }
        for (which, pose) in [&place.predicted, &corrected].into_iter().enumerate() {
            squares[0][which] += (place.measured.x - pose.x).powi(2) + (place.measured.y - pose.y).powi(2);
            squares[1][which] += (place.measured.heading - pose.heading).powi(2);
        }
    }
    squares
}
