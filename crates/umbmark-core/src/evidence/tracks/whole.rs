//! Shares that runs do not tell from all.
//!
//! A delay beside a filter of a part of the poses looks nearly like a longer delay beside a filter of a smaller part: the mean lag is told well,
//! its parts are not. All of the poses are filtered, or none, so the share is 1 where the runs do not deny it; the delay and the time constant
//! then are told as well as the lag.

use super::{Alone, estimates};
use crate::effect::{Model, Part};
use crate::likelihood::Fitted;

/// A share of its own is fitted only where AICc falls by this against a share of 1.
const LIKELIER: f64 = 10.0;

/// What a part of the lag may be taken for.
const DELAY: (&str, &str) = ("reference_delay", "delay_s");
const TIME: &str = "time_constant_s";

/// A fit with the shares that it does not tell from 1 kept at 1.
pub(crate) fn whole(mut fitted: Fitted) -> Fitted {
    let is_asked = |part: &&Part| part.free && part.share().is_some_and(|share| !part.fixed.contains(&share));
    let parts: Vec<Part> = fitted.model.parts().iter().filter(is_asked).cloned().collect();
    for part in parts {
        let aicc = |fitted: &Fitted| Alone::new(fitted.clone()).criteria().0;
        let least = aicc(&fitted) + LIKELIER;
        let mut tried = starts(&fitted.model, &part).into_iter().filter_map(|start| {
            let fit = fitted.observed.fit(&start, &fitted.noise, &[]).ok()?;
            let is_fitted = estimates(&fit).iter().all(|own| own.standard_error.is_finite());
            let is_allowed = fit.observed.tracks().all(|track| track.check(&fit.model).is_ok());
            (is_fitted && is_allowed && aicc(&fit) < least).then_some(fit)
        });
        if let Some(whole) = tried.next() {
            fitted = Fitted { taken: fitted.taken, usual_noise: fitted.usual_noise, ..whole };
        }
    }
    fitted
}

/// The model with the share of a part kept at 1: once with all of the lag as its time constant and no delay, and once with the time constant that
/// it has and the rest of the lag as the delay.
fn starts(model: &Model, part: &Part) -> Vec<Model> {
    let name = part.effect.name();
    let Some((share, time)) = part.share().and_then(|share| Some((share, model.get(name, TIME)?))) else {
        return Vec::new();
    };
    let late = model.get(name, share).unwrap_or(1.0) * time;
    let is_delayed = |part: &Part| part.effect.name() == DELAY.0 && part.free;
    let delay = model.parts().iter().any(is_delayed).then(|| model.get(DELAY.0, DELAY.1)).flatten();
    let lag = late + delay.unwrap_or(0.0);
    let with = |time: f64| {
        let mut whole = model.clone();
        whole.set(name, share, 1.0).ok()?;
        whole.set(name, TIME, time).ok()?;
        whole.fix(name, share).ok()?;
        if delay.is_some() {
            whole.set(DELAY.0, DELAY.1, lag - time).ok()?;
        }
        Some(whole)
    };
    [lag, time].into_iter().filter_map(with).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::first_model;
    use crate::diagnose::tests::robot_with;
    use crate::drive::Robot;
    use crate::evidence::tracks::fit;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    /// A reference that is filtered to a share, fitted from a share of 0.4 beside a delay.
    fn fitted(share: f64) -> Fitted {
        let filter = |parameter, value| ("reference_filter", parameter, value);
        let noise = ["position_sd_m", "heading_sd_rad"].map(|parameter| ("reference_noise", parameter, 2e-3));
        let truth = robot_with(&[filter("share", share), filter("time_constant_s", 0.2), noise[0], noise[1]]);
        let data = watched(&truth, 2, 4);
        let mut model = first_model(&data).unwrap();
        for (effect, parameter, value) in
            [filter("share", 0.4), filter("time_constant_s", 0.2), ("reference_delay", "delay_s", 0.1)]
        {
            model.set(effect, parameter, value).unwrap();
            model.add(effect).unwrap().free = true;
        }
        whole(fit(&Observed::new(&data, &Robot::labmate()).unwrap(), &model).unwrap())
    }

    #[test]
    fn a_share_that_may_be_all_is_all_and_the_delay_beside_it_is_told_then() {
        let fitted = fitted(1.0);
        let of = |effect, parameter| {
            estimates(&fitted).into_iter().find(|own| (own.effect, own.parameter) == (effect, parameter))
        };
        assert_eq!((fitted.model.get("reference_filter", "share"), of("reference_filter", "share")), (Some(1.0), None));
        for (effect, parameter, truth) in
            [("reference_filter", "time_constant_s", 0.2), ("reference_delay", "delay_s", 0.0)]
        {
            let own = of(effect, parameter).unwrap();
            assert!(own.interval(0.99).unwrap().contains(truth) && own.standard_error < 2e-3, "{own:?}");
        }
        // A time constant is the size of a filter whose share is kept.
        let place = fitted.model.place_of("reference_filter", "time_constant_s").unwrap();
        assert_eq!((fitted.model.nothing(place), fitted.model.shapes().contains(&place)), (Some(0.0), false));
    }

    #[test]
    fn a_share_that_is_half_stays_free() {
        let fitted = fitted(0.5);
        let share = estimates(&fitted).into_iter().find(|own| own.parameter == "share").unwrap();
        assert!((share.value - 0.5).abs() < 3.0 * share.standard_error && share.standard_error < 0.1, "{share:?}");
    }
}
