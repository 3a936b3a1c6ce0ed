//! Reasons against a fitted model as a whole, even where no missing effect is certified.

use super::{chance, wander};
use crate::diagnose::reason::Reason;
use crate::effect::{Model, Part};
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
/// The scale may be open by this share: usual tapes and motion capture are no better.
const OPEN_SCALE: f64 = 2.5e-4;
/// Errors may exceed the 95 % quantile of simulated sets by this factor: noise that is correlated over metres makes drifts 2.6 times as
/// large as the noise model predicts.
pub(super) const REMEMBERS: f64 = 2.5;

/// Reasons from the noise, the jumps, the size of the residuals and the headings. The runs lie along the model.
pub(super) fn of_model(observed: &Observed, model: &Model, noise: &Noise, left: &Misses, seed: u64) -> Vec<Reason> {
    let mut reasons: Vec<Reason> = observed.setup.faults.iter().cloned().map(Reason::Fault).collect();
    reasons.extend(observed.setup.suspicions_of_tracks(&observed.robot).into_iter().map(Reason::Data));
    reasons.extend(of_noise(observed, noise));
    reasons.extend(of_size(observed, noise, left, seed));
    reasons.extend(wander::of_headings(observed, model));
    reasons.extend(of_scale(model));
    reasons
}

/// The reason of an effect beside which the reference does not show the scale.
fn of_scale(model: &Model) -> Option<Reason> {
    let unknown = |part: &Part| {
        let entry = part.effect.entry()?;
        let share = (entry.unknown_scale)(&part.values);
        (share > OPEN_SCALE).then_some(Reason::UnknownScale { title: entry.about.title, share })
    };
    model.parts().iter().find_map(unknown)
}

/// A size of the noise.
struct Size {
    /// In words.
    what: &'static str,
    of: fn(&Noise) -> f64,
    /// Factor by which a larger value is still usual for this robot.
    wider: f64,
    /// Unit of the report.
    unit: &'static str,
}

impl Size {
    /// The largest credible value.
    fn most(&self) -> f64 {
        self.wider * (self.of)(&MAX_NOISE)
    }
}

/// Units of the report in an SI unit: all are thousandths.
const REPORTED: f64 = 1e3;

/// The sizes of the wheels' noise that the runs determine: not those of runs with hardly any distance or rotation.
fn of_wheels(observed: &Observed) -> Vec<Size> {
    let slim = (USUAL_BASE / observed.robot.drive.wheelbase()).max(1.0);
    let of_run = |of: fn(&Growth) -> f64| {
        let blocks = observed.runs.iter().flat_map(|run| &run.blocks);
        blocks.map(|block| of(&block.growth)).sum::<f64>() / observed.runs.len().max(1) as f64
    };
    let (drives, turns) = (of_run(|g| g.way) > LEAST.0, of_run(|g| g.heading_per_radian[5]) > LEAST.1);
    let size = |what, of, wider, unit| Size { what, of, wider, unit };
    let sizes = [
        (drives, size("heading noise of the wheels", |n| n.heading_per_metre, slim, "mrad per root metre")),
        (turns, size("heading noise in turns", |n| n.heading_per_radian, slim, "mrad per root radian")),
        (drives, size("forward noise of the wheels", |n| n.forward_per_metre, 1.0, "mm per root metre")),
        (drives, size("sideways noise of the wheels", |n| n.sideways_per_metre, 1.0, "mm per root metre")),
    ];
    sizes.into_iter().filter_map(|(told, size)| told.then_some(size)).collect()
}

/// The sizes of the reference's noise.
fn of_reference() -> [Size; 4] {
    let size = |what, of, unit| Size { what, of, wider: 1.0, unit };
    [
        size("noise of the reference's positions", |n| n.reference_position, "mm"),
        size("noise of the reference's headings", |n| n.reference_heading, "mrad"),
        size("noise of the reference's clock from pose to pose", |n| n.reference_time, "ms"),
        size("noise of the reference's clock from run to run", |n| n.reference_delay, "ms"),
    ]
}

/// Sizes at their limit, or too large.
fn of_noise(observed: &Observed, noise: &Noise) -> Vec<Reason> {
    let limits = Noise::largest();
    let told = of_wheels(observed).into_iter().chain(of_reference()).filter_map(|size| {
        let (found, most) = ((size.of)(noise), size.most());
        let Size { what, unit, .. } = size;
        let value = REPORTED * found;
        if found >= AT_LIMIT * (size.of)(&limits) {
            return Some(Reason::NoiseAtLimit { what, value, unit });
        }
        (found > most).then_some(Reason::NoiseTooLarge { what, value, most: REPORTED * most, unit })
    });
    told.collect()
}

/// The reason that the wheels' noise gives where held-out runs are predicted better with noise of the usual sizes.
pub(crate) fn of_usual_noise(observed: &Observed, noise: &Noise) -> Option<Reason> {
    let size = of_wheels(observed).into_iter().find(|size| (size.of)(noise) > DOUBTED * size.most())?;
    Some(Reason::NoiseAbsorbs { what: size.what, value: REPORTED * (size.of)(noise), unit: size.unit })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::likelihood::watched::watched;

    /// Noise of the wheels just below and just above half of the largest credible; noise of the reference does not count.
    #[test]
    fn noise_that_predicts_worse_than_the_usual_is_doubted_from_half_of_the_credible_on() {
        let observed = Observed::new(&watched(&Model::new(&Robot::labmate()), 1, 3), &Robot::labmate()).unwrap();
        let of = |noise: Noise| of_usual_noise(&observed, &noise);
        let usual = Noise { reference_delay: MAX_NOISE.reference_delay, ..Noise::default() };
        assert_eq!(of(usual), None);
        assert_eq!(of(Noise { heading_per_metre: 0.0149, forward_per_metre: 0.0199, ..usual }), None);
        let reason = of(Noise { heading_per_radian: 0.0151, ..usual }).unwrap();
        assert!(
            reason
                .sentence()
                .starts_with("the heading noise in turns is 15.10 mrad per root radian, and held-out runs")
        );
        assert!(of(Noise { sideways_per_metre: 0.0201, ..usual }).is_some());
    }
}
