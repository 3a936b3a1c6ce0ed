//! Screening by elementary effects.

use super::{Estimate, Evaluator, Inputs, Response, SensitivityError, Watch, evaluate};
use crate::random::Stream;

/// Purpose of the streams that trajectories are drawn from.
const TRAJECTORIES: u64 = 21;

/// Levels of an input: the shares 1/8, 3/8, 5/8 and 7/8 of its distribution.
const LEVELS: u8 = 4;

/// Elementary effects of one input on one output, in the unit of the output.
///
/// An elementary effect is the change of the output divided by the change of the input's share u of its distribution; the
/// whole range of a uniform input has u from 0 to 1. That of the noise is the difference of two tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screened {
    /// μ, their mean: effects that change sign cancel in it.
    pub mean: Estimate,
    /// μ*, the mean of their sizes: how much the input matters.
    pub size: Estimate,
    /// σ, their standard deviation: how much the effect depends on where the input, or the others, stand.
    pub spread: Estimate,
}

/// The elementary effects of all inputs on all outputs.
#[derive(Clone, Debug)]
pub struct Screening {
    /// For each output, for each input, the noise last where there is noise.
    pub outputs: Vec<Vec<Screened>>,
    /// Trajectories done.
    pub trajectories: u64,
    /// Evaluations of the response.
    pub evaluations: u64,
    /// Whether fewer trajectories are done than were asked for.
    pub partial: bool,
}

/// Morris's screening with μ* of Campolongo.
///
/// Each trajectory starts anywhere on a grid of four levels and moves one input after the other, in random order, by half of
/// its distribution; the noise stays the same along it and moves last. Intervals are Student's over the independent
/// trajectories, that of σ by the jackknife. Noise that one test makes and another does not widens μ* and σ of no input but
/// its own.
///
/// Sources: Morris, Technometrics 33 (1991); Campolongo, Cariboni & Saltelli, Environ. Model. Softw. 22 (2007).
pub fn screen(
    response: &dyn Response,
    inputs: &Inputs,
    trajectories: u64,
    seed: u64,
    watch: &Watch,
) -> Result<Screening, SensitivityError> {
    if !inputs.are_independent() {
        return Err(SensitivityError::NeedsIndependence { what: "Morris screening" });
    }
    if !(4..=1_000_000).contains(&trajectories) {
        let allowed = "from 4 to 1000000";
        return Err(SensitivityError::Count { what: "trajectories", allowed, value: trajectories });
    }
    let walk = |evaluator: &mut Evaluator, number: usize| {
        trajectory(response, inputs, evaluator, &mut Stream::new(seed, TRAJECTORIES, number as u64), number as u64)
    };
    let all = watch.pieces(response, trajectories as usize, walk)?;
    let effects: Vec<Vec<Vec<f64>>> = all.into_iter().flatten().collect();
    if effects.len() < 4 {
        return Err(SensitivityError::Stopped);
    }
    let factors = inputs.count() + usize::from(response.is_noisy());
    let of = |output: usize, factor: usize| {
        screened(&effects.iter().map(|trajectory| trajectory[factor][output]).collect::<Vec<f64>>())
    };
    let done = effects.len() as u64;
    Ok(Screening {
        outputs: (0..response.outputs()).map(|output| (0..factors).map(|f| of(output, f)).collect()).collect(),
        trajectories: done,
        evaluations: done * (1 + factors as u64),
        partial: done < trajectories,
    })
}

/// The elementary effects of one trajectory: for each factor, on each output.
fn trajectory(
    response: &dyn Response,
    inputs: &Inputs,
    evaluator: &mut Evaluator,
    stream: &mut Stream,
    number: u64,
) -> Result<Vec<Vec<f64>>, SensitivityError> {
    let count = inputs.count();
    let share = |level: u8| (f64::from(level) + 0.5) / f64::from(LEVELS);
    let mut levels: Vec<u8> = (0..count).map(|_| (stream.uniform() * f64::from(LEVELS)) as u8).collect();
    let mut order: Vec<usize> = (0..count).collect();
    for place in (1..count).rev() {
        order.swap(place, (stream.uniform() * (place + 1) as f64) as usize);
    }
    let mut values = vec![0.0; count];
    let mut at = |levels: &[u8], noise: u64| {
        let shares: Vec<f64> = levels.iter().map(|level| share(*level)).collect();
        inputs.values(&shares, &mut values);
        let mut outputs = vec![0.0; response.outputs()];
        evaluate(evaluator, &values, noise, &mut outputs).map(|()| outputs)
    };
    let change = |after: &[f64], before: &[f64], by: f64| -> Vec<f64> {
        after.iter().zip(before).map(|(after, before)| (after - before) / by).collect()
    };
    let mut effects = vec![Vec::new(); count];
    let mut before = at(&levels, 2 * number)?;
    for input in order {
        let from = levels[input];
        levels[input] = (from + LEVELS / 2) % LEVELS;
        let after = at(&levels, 2 * number)?;
        effects[input] = change(&after, &before, share(levels[input]) - share(from));
        before = after;
    }
    if response.is_noisy() {
        effects.push(change(&at(&levels, 2 * number + 1)?, &before, 1.0));
    }
    Ok(effects)
}

fn screened(effects: &[f64]) -> Screened {
    let sizes: Vec<f64> = effects.iter().map(|effect| effect.abs()).collect();
    let spread = |without: Option<usize>| {
        let kept = || effects.iter().enumerate().filter(|(i, _)| Some(*i) != without).map(|(_, effect)| effect);
        let n = (effects.len() - usize::from(without.is_some())) as f64;
        let mean = kept().sum::<f64>() / n;
        (kept().map(|effect| (effect - mean) * (effect - mean)).sum::<f64>() / (n - 1.0)).sqrt()
    };
    Screened {
        mean: Estimate::of_mean(effects),
        size: Estimate::of_mean(&sizes),
        spread: Estimate::jackknife(effects.len(), spread),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::test_functions::{Function, uniform};

    /// y = 3 a - 2 b + 4 (c - 1/2)² with all inputs uniform on [0, 1]: the effects of a and b are constant; c moves between
    /// 1/8 and 5/8 or between 3/8 and 7/8, by which (c - 1/2)² changes by ∓1/8, so its effects are ∓1 with mean 0.
    #[test]
    fn a_linear_input_has_a_constant_effect_and_a_curved_one_a_spread() {
        let function = Function(|x| 3.0 * x[0] - 2.0 * x[1] + 4.0 * (x[2] - 0.5) * (x[2] - 0.5));
        let inputs = Inputs::new(uniform(3, 0.0, 1.0), &[]).unwrap();
        let screening = Watch::nobody(|watch| screen(&function, &inputs, 400, 2, watch)).unwrap();
        assert_eq!(screening.evaluations, 1600);
        let [a, b, c] = screening.outputs[0].as_slice() else { panic!() };
        for (effect, mean) in [(a, 3.0), (b, -2.0)] {
            assert!((effect.mean.value - mean).abs() < 1e-12 && (effect.size.value - f64::abs(mean)).abs() < 1e-12);
            assert!(effect.spread.value < 1e-12);
        }
        assert!((c.size.value - 1.0).abs() < 1e-12 && c.mean.interval.contains(0.0), "{c:?}");
        assert!((c.spread.value - 1.0).abs() < 0.01, "{c:?}");
    }

    #[test]
    fn too_few_trajectories_are_refused() {
        let inputs = Inputs::new(uniform(1, 0.0, 1.0), &[]).unwrap();
        let refused = Watch::nobody(|watch| screen(&Function(|x| x[0]), &inputs, 3, 1, watch)).unwrap_err();
        assert_eq!(refused.to_string(), "trajectories must be from 4 to 1000000, got 3");
    }
}
