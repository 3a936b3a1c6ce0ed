//! Wheels that follow late and references that are filtered, beside a reference that is late by a constant time.

use crate::effect::Model;
use crate::evidence::FitError;
use crate::likelihood::{Fitted, Observed};

/// Wheels that follow late, and a reference that is filtered.
pub(super) const LAGS: [&str; 2] = ["wheel_lag", "reference_filter"];
/// A reference that is late by a constant time.
pub(super) const DELAY: &str = "reference_delay";
/// A lag and a delay cancel each other to this share of the lag where they only smooth the counts.
const SMOOTH: f64 = 0.25;

/// Whether a constant delay holds a part of a lag that is there: beside it more than all of the wheels or poses seem to follow late, or they
/// seem to be early.
pub(super) fn is_held(fitted: &Fitted, lag: &str) -> Result<bool, FitError> {
    let mut parts = fitted.model.parts().iter();
    let is_incredible = parts.clone().any(|part| part.effect.name() == lag && !part.is_credible());
    let has_delay = parts.any(|part| part.effect.name() == DELAY);
    Ok(is_incredible && has_delay && !only_smooths(fitted, lag)?)
}

/// Whether wheels or poses are said to follow late, and the reference to be early by as much, or by so much that no pose moves by more than a
/// count against a delay alone: together they only smooth the counts, and with them what whole counts hide.
pub(super) fn only_smooths(fitted: &Fitted, lag: &str) -> Result<bool, FitError> {
    let late = |model: &Model| Some(model.get(lag, "share")? * model.get(lag, "time_constant_s")?);
    let Some(own) = late(&fitted.model) else { return Ok(false) };
    let mut delayed = fitted.model.without(lag);
    let delay = fitted.model.get(DELAY, "delay_s").unwrap_or(0.0);
    let is_possible = delayed.set(DELAY, "delay_s", delay + own).is_ok();
    if is_possible && is_within_counts(&fitted.observed, [&fitted.model, &delayed]) {
        return Ok(true);
    }
    let mut with = fitted.model.clone();
    with.add(DELAY)?.free = true;
    let with = fitted.observed.fit(&with, &fitted.noise, &[])?.model;
    Ok(late(&with).zip(with.get(DELAY, "delay_s")).is_some_and(|(late, delay)| (late + delay).abs() < SMOOTH * late))
}

/// Whether all poses by two models are within a count of the wheels of each other.
fn is_within_counts(observed: &Observed, models: [&Model; 2]) -> bool {
    let [one, other] = models.map(Model::chain);
    observed.whole().runs.iter().all(|run| {
        let count = run.counts[0].max(run.counts[1]);
        let apart = run.residuals(&one).into_iter().zip(run.residuals(&other));
        apart.into_iter().all(|(a, b)| {
            let [x, y, turned] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            x.hypot(y) < count && turned.abs() * run.wheelbase < 2.0 * count
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::first_model;
    use crate::drive::{Encoder, Robot};
    use crate::likelihood::Noise;
    use crate::likelihood::watched::watched;

    /// A filter of 50 ms moves poses by about a millimetre beside a delay: less than a count of 2.4 mm, more than one of 0.02 mm.
    #[test]
    fn a_lag_that_moves_no_pose_by_a_count_only_smooths_the_counts() {
        for (counts, only) in [(200.0, true), (20_000.0, false)] {
            let mut robot = Robot::labmate();
            robot.encoder = Encoder::new(counts, None, None).unwrap();
            let filter = |model: &mut Model| {
                model.set("reference_filter", "share", 1.0).unwrap();
                model.set("reference_filter", "time_constant_s", 0.05).unwrap();
            };
            let mut truth = Model::new(&robot);
            filter(&mut truth);
            let data = watched(&truth, 1, 3);
            let mut model = first_model(&data).unwrap();
            filter(&mut model);
            let fitted = Observed::new(&data, &robot).unwrap().unfitted(&model, &Noise::default());
            assert_eq!(only_smooths(&fitted, "reference_filter").unwrap(), only, "{counts}");
        }
    }
}
