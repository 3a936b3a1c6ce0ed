//! The residuals of tracks: which part repeats, which error each source of noise would leave, and where runs are disturbed.

use crate::diagnose::options::Options;
use crate::diagnose::remains::{Chance, Remains, Trail};
use crate::evidence::tracks::Misses;
use crate::likelihood::{Block, Column, Disturbance, Noise, Observed, ObservedRun, Stretch};
use crate::random::Stream;
use crate::setup::PoseNoise;
use nalgebra::{SMatrix, SVector, Vector3};
use rayon::prelude::*;

/// Number of simulated sets for a source of noise; fewer if the data has more blocks than the second number.
const SETS: (usize, usize) = (40, 400_000);
const FEWEST_SETS: usize = 4;
/// A disturbance moves the robot by more than this many ticks, and by more than this many standard deviations of a single pose.
const TICKS: f64 = 2.0;
const POSES: f64 = 4.0;
/// Purpose of the stream.
const DOUBTS: u64 = 0x646f_7562;
/// Variance that makes a covariance without noise one that has a root.
const LEAST: f64 = 1e-18;
const NOTHING: PoseNoise = PoseNoise { position: 0.0, heading: 0.0 };

/// The remaining error of tracks: `misses` in total, and `left` run by run, from which effects of the reference that the model lacks are
/// subtracted.
pub(super) fn remains(
    observed: &Observed,
    noise: &Noise,
    left: &[Column],
    misses: &Misses,
    options: &Options,
) -> Remains {
    let wheelbase = observed.robot.drive.wheelbase();
    let runs = observed.runs.par_iter().zip(left);
    let trails: Vec<Trail> = runs.map(|(run, left)| trail(run, left, observed.setup.noise, wheelbase)).collect();
    let mut remains = Remains::of(&trails, 1.0 - options.size);
    remains.position.rms = misses.position;
    remains.heading.iter_mut().zip(misses.heading).for_each(|(left, rms)| left.rms = rms);
    remains.piece = observed.piece();
    remains.chance = chance(observed, noise, options.seed);
    let tick = observed.robot.metres_per_tick();
    let ticks = TICKS * tick.left.abs().max(tick.right.abs());
    let least = [
        ticks.max(POSES * observed.setup.noise.position),
        (ticks / wheelbase).max(POSES * observed.setup.noise.heading),
    ];
    let is_large = |at: &Disturbance| at.by[0].hypot(at.by[1]) > least[0] || at.by[2].abs() > least[1];
    remains.disturbances = noise.disturbances(&observed.runs, left, wheelbase);
    remains.disturbances.retain(is_large);
    remains
}

/// Residuals of a run at the blocks whose errors are reported.
fn trail(run: &ObservedRun, left: &Column, noise: PoseNoise, wheelbase: f64) -> Trail {
    let rolled = run.rolled(wheelbase);
    let mut trail = Trail {
        sense: run.track.contexts().first().map_or(0.0, |at| at.direction),
        rolled: Vec::new(),
        places: Vec::new(),
        left: Vec::new(),
        with_heading: run.blocks.iter().all(|block| block.headings > 0),
    };
    let Some(start) = run.blocks.first().map(|block| block.place) else { return trail };
    let (sine, cosine) = libm::sincos(start.heading);
    for stretch in run.stretches([noise.position, noise.heading]) {
        let own = stretch.less_start(run, left);
        for block in stretch.told() {
            let place = start.between(&run.blocks[block].place);
            let [x, y, heading] = own[block - stretch.blocks.start];
            trail.rolled.push(rolled[block]);
            trail.places.push([place.x, place.y]);
            trail.left.push([cosine * x + sine * y, cosine * y - sine * x, heading]);
        }
    }
    trail
}

/// The error that each source of noise alone would leave.
fn chance(observed: &Observed, noise: &Noise, seed: u64) -> Vec<Chance> {
    let blocks: usize = observed.runs.iter().map(|run| run.blocks.len()).sum();
    let sets = SETS.0.min(SETS.1 / blocks.max(1)).max(FEWEST_SETS);
    let silent = Noise::silent();
    let Noise { reference_position, reference_heading, reference_time, reference_delay, .. } = *noise;
    let Noise { within_position, within_heading, .. } = *noise;
    let wheels = [
        ("heading noise of the wheels", Noise { heading_per_metre: noise.heading_per_metre, ..silent }),
        ("heading noise in turns", Noise { heading_per_radian: noise.heading_per_radian, ..silent }),
        (
            "noise of the wheels ahead and aside",
            Noise {
                forward_per_metre: noise.forward_per_metre,
                sideways_per_metre: noise.sideways_per_metre,
                ..silent
            },
        ),
    ];
    let reference = Noise {
        reference_position,
        reference_heading,
        reference_time,
        reference_delay,
        within_position,
        within_heading,
        ..silent
    };
    let of = |(source, noise, single): (&'static str, Noise, PoseNoise)| {
        let simulated = simulated(observed, &noise, single, sets, seed);
        let root = |k: usize| (simulated.iter().map(|set| set[k] * set[k]).sum::<f64>() / sets as f64).sqrt();
        Chance { source, position: root(0), heading: root(1) }
    };
    let wheels = wheels.into_iter().map(|(source, noise)| (source, noise, NOTHING));
    wheels.chain([("noise of the reference", reference, observed.setup.noise)]).map(of).collect()
}

/// Root mean square of positions \[m\] and headings \[rad\] in simulated sets with only this noise.
pub(super) fn simulated(
    observed: &Observed,
    noise: &Noise,
    single: PoseNoise,
    sets: usize,
    seed: u64,
) -> Vec<[f64; 2]> {
    let stretches: Vec<Vec<Stretch>> = observed
        .runs
        .iter()
        .map(|run| run.stretches([observed.setup.noise.position, observed.setup.noise.heading]))
        .collect();
    (0..sets)
        .into_par_iter()
        .map(|set| {
            let mut sums = [[0.0; 2]; 2];
            for (index, (run, stretches)) in observed.runs.iter().zip(&stretches).enumerate() {
                let mut stream = Stream::new(seed, DOUBTS, (set * observed.runs.len() + index) as u64);
                let errors = random_walk(run, noise, single, &mut stream);
                for stretch in stretches {
                    let left = stretch.less_start(run, &errors);
                    for block in stretch.told() {
                        let [x, y, heading] = left[block - stretch.blocks.start];
                        sums[0] = [sums[0][0] + x * x + y * y, sums[0][1] + 1.0];
                        if run.blocks[block].headings > 0 {
                            sums[1] = [sums[1][0] + heading * heading, sums[1][1] + 1.0];
                        }
                    }
                }
            }
            sums.map(|[sum, count]| (sum / f64::max(count, 1.0)).sqrt())
        })
        .collect()
}

/// Random errors of a run by its noise alone: (x, y, heading) per block.
fn random_walk(run: &ObservedRun, noise: &Noise, single: PoseNoise, stream: &mut Stream) -> Vec<[f64; 3]> {
    let mut state = Vector3::zeros();
    let late = noise.reference_delay * stream.normal();
    let draw = |stream: &mut Stream| Vector3::from_fn(|_, _| stream.normal());
    // What is found of a single pose before the fit is, of steps, the whole noise of one.
    let single = if run.relative { NOTHING } else { single };
    let block = |block: &Block| {
        if run.relative {
            state = Vector3::zeros();
        }
        let before = state;
        let [end, mean] = grown(noise, block, stream);
        state += end;
        let at_mean = before + mean;
        let (x, y) = (block.place.x, block.place.y);
        let measured = draw(stream);
        let [in_position, in_heading] = block.resolution;
        let own = |shared: f64, [within, single]: [f64; 2], count: usize, hidden: f64| {
            let of_mean = |sd: f64| sd * sd / count.max(1) as f64;
            (shared * shared * block.steps + of_mean(single).max(of_mean(within) + hidden)).sqrt()
        };
        let (position, heading) = ([noise.within_position, single.position], [noise.within_heading, single.heading]);
        let position = own(noise.reference_position, position, block.count, in_position);
        let heading = own(noise.reference_heading, heading, block.headings, in_heading);
        let time = late + noise.reference_time * stream.normal();
        [
            at_mean[0] - y * at_mean[2] + position * measured[0] + time * block.velocity[0],
            at_mean[1] + x * at_mean[2] + position * measured[1] + time * block.velocity[1],
            at_mean[2] + heading * measured[2] + time * block.velocity[2],
        ]
    };
    run.blocks.iter().map(block).collect()
}

/// What a block adds to the random error of a pose until its end, and until the mean of its observations.
fn grown(noise: &Noise, block: &Block, stream: &mut Stream) -> [Vector3<f64>; 2] {
    let [whole, seen, of_mean] =
        [&block.growth, &block.growth_seen, &block.growth_of_mean].map(|growth| noise.growth(growth));
    let covariance = SMatrix::<f64, 6, 6>::from_fn(|i, j| match (i < 3, j < 3) {
        (true, true) => whole[i][j],
        (false, false) => of_mean[i - 3][j - 3],
        _ => seen[i % 3][j % 3],
    });
    let drawn = SVector::<f64, 6>::from_fn(|_, _| stream.normal());
    let Some(root) = (covariance + SMatrix::identity() * LEAST).cholesky() else { return [Vector3::zeros(); 2] };
    let errors = root.l() * drawn;
    [errors.fixed_rows::<3>(0).into_owned(), errors.fixed_rows::<3>(3).into_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::likelihood::watched::watched;

    /// Oracle: the covariance of the end with the mean of a walk, by its definition.
    #[test]
    fn the_end_and_the_mean_of_a_block_are_drawn_with_what_they_share() {
        let observed = Observed::new(&watched(&Model::new(&Robot::labmate()), 1, 3), &Robot::labmate()).unwrap();
        let noise = Noise { heading_per_metre: 0.02, forward_per_metre: 0.01, ..Noise::default() };
        let block = &observed.runs[0].blocks[3];
        let expected = [&block.growth, &block.growth_seen, &block.growth_of_mean].map(|growth| noise.growth(growth));
        assert!(expected[2][2][2] < 0.9 * expected[1][2][2] && expected[1][2][2] < 0.9 * expected[0][2][2]);
        let mut stream = Stream::new(5, 0, 0);
        let drawn: Vec<[Vector3<f64>; 2]> = (0..20_000).map(|_| grown(&noise, block, &mut stream)).collect();
        for (k, (first, second)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            for i in 0..3 {
                let product = |[end, mean]: &[Vector3<f64>; 2]| [end, mean][first][i] * [end, mean][second][i];
                let found = drawn.iter().map(product).sum::<f64>() / drawn.len() as f64;
                // Some four standard errors of 20 000 draws.
                assert!((found / expected[k][i][i] - 1.0).abs() < 0.04, "{k} {i}: {found} {:?}", expected[k][i][i]);
            }
        }
    }
}
