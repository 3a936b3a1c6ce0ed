//! Derivatives about the middle of all distributions.

use super::{Estimate, Evaluator, Inputs, Response, SensitivityError, Watch, evaluate};

/// Shares of its distribution between which an input is moved.
const SHARES: [f64; 2] = [0.45, 0.55];

/// The derivative of one output by one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivative {
    /// Change of the mean output per unit of the input.
    pub per_unit: Estimate,
    /// The same per spread of the input: half of the way from its 15.87 to its 84.13 % quantile, which is the standard
    /// deviation of a normal distribution.
    pub per_spread: Estimate,
}

/// The derivatives of every output by every input where all inputs have their medians: for each output, for each input.
///
/// Central differences between the 45 and 55 % quantiles, the next whole numbers for counts, of `trials` pairs of evaluations
/// that share their noise; the interval is Student's over the trials. What curvature adds to the difference is not in the
/// interval. At a kink, as E_max,sys has one where both directions miss by the same, the mean of both slopes is found.
/// Correlations do not matter: one input moves at a time.
pub fn local_derivatives(
    response: &dyn Response,
    inputs: &Inputs,
    trials: u64,
    watch: &Watch,
) -> Result<Vec<Vec<Derivative>>, SensitivityError> {
    if !(2..=10_000_000).contains(&trials) {
        return Err(SensitivityError::Count { what: "trials", allowed: "from 2 to 10000000", value: trials });
    }
    let medians: Vec<f64> = inputs.all().iter().map(|input| input.quantile(0.5)).collect();
    let ends: Vec<[f64; 2]> = (0..inputs.count()).map(|i| ends(inputs, i, medians[i])).collect();
    let slopes = |evaluator: &mut Evaluator, trial: usize| {
        let mut values = medians.clone();
        let mut at = |values: &[f64]| {
            let mut outputs = vec![0.0; response.outputs()];
            evaluate(evaluator, values, trial as u64, &mut outputs).map(|()| outputs)
        };
        let mut slopes = Vec::with_capacity(inputs.count());
        for (input, [low, high]) in ends.iter().enumerate() {
            values[input] = *low;
            let below = at(&values)?;
            values[input] = *high;
            let above = at(&values)?;
            values[input] = medians[input];
            let slope = |(above, below): (&f64, &f64)| if high > low { (above - below) / (high - low) } else { 0.0 };
            slopes.push(above.iter().zip(&below).map(slope).collect::<Vec<f64>>());
        }
        Ok(slopes)
    };
    let all: Vec<_> = watch.pieces(response, trials as usize, slopes)?.into_iter().flatten().collect();
    if all.len() < 2 {
        return Err(SensitivityError::Stopped);
    }
    let derivative = |output: usize, input: usize| {
        let per_unit = Estimate::of_mean(&all.iter().map(|slopes| slopes[input][output]).collect::<Vec<f64>>());
        let of = |share| inputs.all()[input].quantile(share);
        let spread = 0.5 * (of(ONE_SIGMA) - of(1.0 - ONE_SIGMA));
        let per_spread = Estimate { value: per_unit.value * spread, interval: per_unit.interval.scaled(spread) };
        Derivative { per_unit, per_spread }
    };
    Ok((0..response.outputs()).map(|o| (0..inputs.count()).map(|i| derivative(o, i)).collect()).collect())
}

/// Share of a normal distribution below one standard deviation.
const ONE_SIGMA: f64 = 0.841_344_746_068_542_9;

/// Values of an input on both sides of its median.
fn ends(inputs: &Inputs, which: usize, median: f64) -> [f64; 2] {
    let input = &inputs.all()[which];
    let [low, high] = SHARES.map(|share| input.quantile(share));
    if input.whole && low == high {
        let (least, most) = input.bounds;
        return [(median - 1.0).max(least), (median + 1.0).min(most)];
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::geometry::seeded;
    use crate::monte_carlo::{Distribution, Metric, Quantity, Study};
    use crate::path::{Direction, Path};
    use crate::replay::Track;
    use crate::sensitivity::{Noise, Tests};

    /// Against exact derivatives: dual numbers through the chain of effects. The step is an eighth of a standard deviation,
    /// so curvature changes a slope by about a thousandth.
    #[test]
    fn derivatives_are_those_of_dual_numbers_through_the_effects() {
        let study = Study::new(Model::new(&Robot::labmate()), 1, 1);
        let varied = [("ed", 1.002, 1e-4), ("eb", 1.01, 1e-3), ("es", 1.001, 1e-3)];
        let varied =
            varied.map(|(name, mean, sd)| (Quantity::find(name, &study).unwrap(), Distribution::Normal { mean, sd }));
        let tests = Tests::new(&study, &varied, Noise::Absent).unwrap();
        let inputs = Inputs::new(Tests::inputs(&varied), &[]).unwrap();
        let found = Watch::nobody(|watch| local_derivatives(&tests, &inputs, 2, watch)).unwrap();
        let model = &tests.study().model;
        let track = Track::from_path(&Path::umbmark(), Direction::Cw, model.robot());
        for (input, (quantity, _)) in varied.iter().enumerate() {
            let end = track.end(&model.chain_with(&seeded(model.values(), &[input])));
            let [x, y, heading] = [end.x, end.y, end.heading].map(|d| d.eps[0]);
            // The cw runs end farther off: E_max,sys is their distance.
            let distance = libm::hypot(end.x.re, end.y.re);
            let exact = [
                (Metric::EMaxSys, (end.x.re * x + end.y.re * y) / distance),
                (Metric::CentroidCwX, x),
                (Metric::ReturnHeadingCw, heading),
            ];
            for (metric, exact) in exact {
                let output = tests.metrics().iter().position(|m| *m == metric).unwrap();
                let slope = found[output][input].per_unit.value;
                assert!(
                    (slope - exact).abs() < 2e-3 * exact.abs().max(1.0),
                    "{metric:?} {}: {slope} {exact}",
                    quantity.key()
                );
            }
        }
    }

    /// With wheel noise the mean slope of the return heading stays -2π by E_b, within its interval's fivefold width.
    #[test]
    fn noise_that_both_sides_share_leaves_the_slope() {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        let study = Study::new(model, 1, 1);
        let e_b = Quantity::find("eb", &study).unwrap();
        let varied = [(e_b, Distribution::Uniform { min: 0.99, max: 1.01 })];
        let tests = Tests::new(&study, &varied, Noise::Simulated).unwrap();
        let inputs = Inputs::new(Tests::inputs(&varied), &[]).unwrap();
        let found = Watch::nobody(|watch| local_derivatives(&tests, &inputs, 200, watch)).unwrap();
        let output = tests.metrics().iter().position(|m| *m == Metric::ReturnHeadingCcw).unwrap();
        let slope = found[output][0].per_unit;
        // The robot turns by 2π/E_b: the slope at 1 is -2π.
        let half_width = 0.5 * (slope.interval.high - slope.interval.low);
        assert!((slope.value + std::f64::consts::TAU).abs() < 5.0 * half_width + 1e-3, "{slope:?}");
        assert!(half_width < 0.02, "{slope:?}");
    }
}
