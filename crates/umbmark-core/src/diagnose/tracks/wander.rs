//! Whether the headings of the reference are those of the way that it measured.
//!
//! Over a stretch of a drive, the measured way points elsewhere than the predicted one, and so do the measured headings: both by what the
//! wheels did before. Their difference,
//!
//! ```text
//! δ = arg Δmeasured - arg Δpredicted - mean of (measured - predicted) headings,
//! ```
//!
//! is noise of the reference alone, new in each stretch. Headings that drift, are set anew in each run or belong to a marker that turned on
//! the robot make neighbouring stretches alike: Σ δᵢ δᵢ₊₁ is then positive. It stays about zero, whatever the noise of each stretch is, since
//! two stretches have no pose in common. A constant δ, one that depends on the turn and one of the sense of driving are fitted first: the
//! yaw of the marker and a sideways slip of the wheels make those.

use crate::diagnose::reason::Reason;
use crate::effect::Model;
use crate::geometry::wrap;
use crate::likelihood::{Block, Column, Observed, ObservedRun};
use crate::stats::robust;

/// Way of a stretch \[m\]; from its beginning to its end it comes this share of it at least.
const LENGTH: f64 = 0.5;
const STRAIGHT: f64 = 0.8;
/// Minimum number of stretches.
const FEWEST: usize = 30;
/// Standard errors beyond which neighbouring stretches are not alike by chance: where all stretches scatter alike, and, which is coarse where
/// few runs or parts of a run are the odd ones, where each scatters as its own products say.
const SURELY: (f64, f64) = (4.5, 2.5);
/// Smaller deviations are left alone \[rad\]: they make E_s seem larger by half of their square, 0.005 %.
const LEAST: f64 = 0.01;

/// What is known of a stretch.
struct Stretch {
    /// δ \[rad\].
    apart: f64,
    /// Turn from its beginning to its end \[rad\], and +1 where it is driven ahead, -1 back.
    turned: f64,
    sense: f64,
    /// Whether the stretch before it in the list is that before it in its run.
    follows: bool,
}

/// The reason that headings which wander against the measured way give.
pub(super) fn of_headings(observed: &Observed, model: &Model) -> Option<Reason> {
    let chain = model.chain();
    let seen = observed.runs.iter().filter(|run| !run.relative && !run.headings_only);
    let stretches: Vec<Stretch> = seen.flat_map(|run| of_run(run, &run.residuals(&chain))).collect();
    let left = without_usual(&stretches)?;
    let pairs = (1..left.len()).filter(|k| stretches[*k].follows).map(|k| left[k - 1] * left[k]);
    let (count, sum, squares) =
        pairs.fold((0, 0.0, 0.0), |(count, sum, squares), pair| (count + 1, sum + pair, squares + pair * pair));
    let (count, variance) =
        (f64::from(count.max(1)), left.iter().map(|own| own * own).sum::<f64>() / left.len() as f64);
    let deviation = (sum / count).max(0.0).sqrt();
    let surely = sum > SURELY.0 * count.sqrt() * variance && sum > SURELY.1 * f64::sqrt(squares);
    let told = surely && deviation > LEAST;
    told.then_some(Reason::HeadingsWander { deviation })
}

/// The stretches of a run, one behind the other: each begins at the first observation behind that which ended the last one.
fn of_run(run: &ObservedRun, residuals: &Column) -> Vec<Stretch> {
    let told = |block: &Block| block.positions > 0 && block.headings > 0;
    let mut stretches = Vec::new();
    let (mut from, mut way, mut turns, mut follows) = (None, 0.0, Vec::new(), false);
    for (index, (block, residual)) in run.blocks.iter().zip(residuals).enumerate() {
        if block.afresh || !told(block) {
            (from, follows) = (None, false);
        }
        if !told(block) {
            continue;
        }
        let Some(first) = from else {
            (from, way, turns) = (Some(index), 0.0, vec![residual[2]]);
            continue;
        };
        way += block.growth.way;
        turns.push(residual[2]);
        if way < LENGTH {
            continue;
        }
        let (a, b, before) = (&run.blocks[first].place, &block.place, &residuals[first]);
        let [x, y] = [b.x - a.x, b.y - a.y];
        let straight = libm::hypot(x, y) > STRAIGHT * way;
        if straight {
            let [dx, dy] = [x + residual[0] - before[0], y + residual[1] - before[1]];
            let heading = turns.iter().sum::<f64>() / turns.len() as f64;
            let apart = wrap(libm::atan2(x * dy - y * dx, x * dx + y * dy) - heading);
            let (sine, cosine) = libm::sincos(0.5 * (a.heading + b.heading));
            let sense = f64::signum(x * cosine + y * sine);
            stretches.push(Stretch { apart, turned: b.heading - a.heading, sense, follows });
        }
        (from, follows) = (None, straight);
    }
    stretches
}

/// δ less what a constant, the turn and the sense of driving explain; `None` if the stretches are too few.
fn without_usual(stretches: &[Stretch]) -> Option<Vec<f64>> {
    let rows: Vec<([f64; 3], f64)> =
        stretches.iter().map(|stretch| ([1.0, stretch.turned, stretch.sense], stretch.apart)).collect();
    let line = robust::fit(&rows);
    let left = |(row, apart): &([f64; 3], f64)| apart - row.iter().zip(line.values).map(|(x, v)| x * v).sum::<f64>();
    (rows.len() >= FEWEST).then(|| rows.iter().map(left).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Dataset;
    use crate::drive::Robot;
    use crate::likelihood::watched::watched;
    use crate::random::Stream;

    /// Five runs of a complete model, and this model.
    fn complete(seed: u64) -> (Dataset, Model) {
        let mut model = Model::new(&Robot::labmate());
        for (effect, parameter, value) in [
            ("wheel_noise", "k_sqrt_m", 5e-4),
            ("reference_noise", "position_sd_m", 2e-3),
            ("reference_noise", "heading_sd_rad", 5e-3),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        (watched(&model, 5, seed), model)
    }

    /// What is told of them with headings that were changed, by the number of the run.
    fn told((data, model): &(Dataset, Model), mut change: impl FnMut(usize, &mut f64)) -> Option<Reason> {
        let mut data = data.clone();
        for (k, run) in data.runs.iter_mut().enumerate() {
            let poses = run.log.iter_mut().flat_map(|log| &mut log.reference);
            poses.flat_map(|pose| &mut pose.heading).for_each(|heading| change(k, heading));
        }
        let observed = Observed::new(&data, &Robot::labmate()).unwrap().along(model);
        of_headings(&observed, model)
    }

    /// A random walk of 3 mrad from pose to pose, an offset in one run of three, and a marker that turned in the middle of the first run.
    #[test]
    fn headings_that_are_not_those_of_the_way_are_told_and_noise_of_all_kinds_is_not() {
        for seed in 0..8 {
            let complete = complete(seed);
            assert_eq!(told(&complete, |_, _| ()), None);
            // What all runs have in common is the yaw of the marker.
            assert_eq!(told(&complete, |_, heading| *heading += 0.3), None);
        }
        let size = |reason: Option<Reason>| match reason {
            Some(Reason::HeadingsWander { deviation }) => deviation,
            other => panic!("{other:?}"),
        };
        let (mut stream, mut walk, mut last) = (Stream::new(3, 0, 0), 0.0, 0);
        let walked = size(told(&complete(20), |run, heading| {
            (walk, last) = (if run == last { walk } else { 0.0 } + 3e-3 * stream.normal(), run);
            *heading += walk;
        }));
        assert!((0.01..0.1).contains(&walked), "{walked}");
        let offset = size(told(&complete(21), |run, heading| *heading += if run % 3 == 0 { 0.05 } else { 0.0 }));
        assert!((0.02..0.04).contains(&offset), "{offset}");
        let mut seen = 0;
        let turned = size(told(&complete(22), |run, heading| {
            seen += usize::from(run == 0);
            *heading += if run == 0 && seen > 150 { 0.1 } else { 0.0 };
        }));
        assert!((0.01..0.1).contains(&turned), "{turned}");
    }
}
