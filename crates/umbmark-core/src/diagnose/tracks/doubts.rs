//! Reasons against a fitted model as a whole, even where no missing effect is certified.

use super::chance;
use crate::diagnose::reason::Reason;
use crate::evidence::tracks::Misses;
use crate::likelihood::{Growth, Noise, Observed};

/// Largest credible noise of a robot with [`USUAL_BASE`]: on carpet, with worn wheels and a reference good to centimetres.
const MAX_NOISE: Noise = Noise {
    heading_per_metre: 0.03,
    heading_per_radian: 0.03,
    forward_per_metre: 0.04,
    sideways_per_metre: 0.04,
    reference_position: 0.05,
    reference_heading: 0.05,
    reference_time: 0.03,
    reference_delay: 0.06,
    within_position: 0.1,
    within_heading: 0.1,
    start_position: 0.0,
    start_heading: 0.0,
};
/// Wheelbase of a usual robot \[m\]: with wheels nearer together, the same slip turns a robot more.
const USUAL_BASE: f64 = 0.3;
/// Where held-out runs are predicted better with noise of the usual sizes, noise above this share of the largest credible one is in doubt.
const DOUBTED: f64 = 0.5;
/// A size is at its limit within this share of it.
const AT_LIMIT: f64 = 0.9;
/// Mean distance \[m\] and rotation \[rad\] per run below which the wheel noise is not judged.
const LEAST: (f64, f64) = (1.0, 1.0);
/// Number of simulated sets that errors along the way are compared with; fewer where the data has more blocks than the second number.
const SETS: (usize, usize) = (100, 2_000_000);
/// Errors may exceed the 95 % quantile of simulated sets by this factor: noise that is correlated over metres makes drifts 2.6 times as
/// large as the noise model predicts.
const REMEMBERS: f64 = 2.5;

/// Reasons from the noise, the jumps and the size of the residuals.
pub(super) fn of_model(observed: &Observed, noise: &Noise, left: &Misses, seed: u64) -> Vec<Reason> {
    let mut reasons: Vec<Reason> = observed.setup.faults.iter().cloned().map(Reason::Fault).collect();
    reasons.extend(observed.setup.suspicions_of_tracks(&observed.robot).into_iter().map(Reason::Data));
    reasons.extend(of_noise(observed, noise));
    reasons.extend(of_size(observed, noise, left, seed));
    reasons
}

/// Name, accessor, whether the runs determine it, factor by which a larger value is still usual, unit of the report, and that unit per SI
/// unit.
type Size = (&'static str, fn(&Noise) -> f64, bool, f64, f64, &'static str);

/// The sizes of the noise. Runs with hardly any distance or rotation do not determine that of the wheels.
fn sizes(observed: &Observed) -> [Size; 8] {
    let slim = (USUAL_BASE / observed.robot.drive.wheelbase()).max(1.0);
    let of_run = |of: fn(&Growth) -> f64| {
        let blocks = observed.runs.iter().flat_map(|run| &run.blocks);
        blocks.map(|block| of(&block.growth)).sum::<f64>() / observed.runs.len().max(1) as f64
    };
    let (drives, turns) = (of_run(|g| g.way) > LEAST.0, of_run(|g| g.heading_per_radian[5]) > LEAST.1);
    [
        ("heading noise of the wheels", |n| n.heading_per_metre, drives, slim, 1e3, "mrad per root metre"),
        ("heading noise in turns", |n| n.heading_per_radian, turns, slim, 1e3, "mrad per root radian"),
        ("forward noise of the wheels", |n| n.forward_per_metre, drives, 1.0, 1e3, "mm per root metre"),
        ("sideways noise of the wheels", |n| n.sideways_per_metre, drives, 1.0, 1e3, "mm per root metre"),
        ("noise of the reference's positions", |n| n.reference_position, true, 1.0, 1e3, "mm"),
        ("noise of the reference's headings", |n| n.reference_heading, true, 1.0, 1e3, "mrad"),
        ("noise of the reference's clock from pose to pose", |n| n.reference_time, true, 1.0, 1e3, "ms"),
        ("noise of the reference's clock from run to run", |n| n.reference_delay, true, 1.0, 1e3, "ms"),
    ]
}

/// Sizes at their limit, or too large.
fn of_noise(observed: &Observed, noise: &Noise) -> Vec<Reason> {
    let limits = Noise::largest();
    let told = sizes(observed).into_iter().filter(|size| size.2).filter_map(|(what, of, _, wider, scale, unit)| {
        let (value, limit, most) = (of(noise), of(&limits), wider * of(&MAX_NOISE));
        if value >= AT_LIMIT * limit {
            return Some(Reason::NoiseAtLimit { what, value: scale * value, unit });
        }
        (value > most).then_some(Reason::NoiseTooLarge { what, value: scale * value, most: scale * most, unit })
    });
    told.collect()
}

/// The reason that the wheels' noise gives where held-out runs are predicted better with noise of the usual sizes.
pub(crate) fn of_usual_noise(observed: &Observed, noise: &Noise) -> Option<Reason> {
    let of_wheels = sizes(observed).into_iter().take(4).filter(|size| size.2);
    let mut doubted = of_wheels.filter(|(_, of, _, wider, ..)| of(noise) > DOUBTED * wider * of(&MAX_NOISE));
    doubted.next().map(|(what, of, _, _, scale, unit)| Reason::NoiseAbsorbs { what, value: scale * of(noise), unit })
}

/// Whether errors of positions and headings along the path exceed those of the noise.
fn of_size(observed: &Observed, noise: &Noise, left: &Misses, seed: u64) -> Vec<Reason> {
    let blocks: usize = observed.runs.iter().map(|run| run.blocks.len()).sum();
    let sets = SETS.0.min(SETS.1 / blocks.max(1)).max(20);
    let simulated = chance::simulated(observed, noise, observed.setup.noise, sets, seed);
    let most = |k: usize| {
        let mut sorted: Vec<f64> = simulated.iter().map(|s| s[k]).collect();
        sorted.sort_by(f64::total_cmp);
        REMEMBERS * sorted[(sorted.len() * 19 / 20).min(sorted.len() - 1)]
    };
    let mut reasons = Vec::new();
    for (k, left) in [Some(left.position), left.heading].into_iter().enumerate() {
        if let Some(left) = left.filter(|left| *left > most(k)) {
            let (expected, heading) = (most(k), k == 1);
            reasons.push(Reason::LargerThanNoise { place: "along the way", left, expected, heading });
        }
    }
    reasons
}
