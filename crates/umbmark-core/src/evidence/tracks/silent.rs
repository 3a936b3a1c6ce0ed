//! Effects of a fitted model that are not told from none.

use super::estimates;
use crate::effect::{ModelError, Part};
use crate::evidence::Estimate;
use crate::likelihood::{Fitted, Noise};

/// A fit without one of its effects.
pub(crate) fn without(fitted: &Fitted, effect: &str) -> Result<Fitted, ModelError> {
    let taken = fitted.taken.iter().filter(|taken| taken.effect != effect).copied().collect();
    let again = fitted.observed.fit(&fitted.model.without(effect), &Noise::default(), &[])?;
    Ok(Fitted { taken, ..again })
}

/// An effect among those `asked` whose sizes all have an interval that holds zero.
pub(crate) fn silent(fitted: &Fitted, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
    let estimates = estimates(fitted);
    let is_silent = |part: &Part| {
        let own: Vec<&Estimate> = estimates.iter().filter(|e| e.effect == part.effect.name()).collect();
        let shows = |e: &&&Estimate| {
            let nothing = fitted.model.place_of(e.effect, e.parameter).and_then(|place| fitted.model.nothing(place));
            nothing.is_some_and(|nothing| e.interval(0.95).is_none_or(|interval| !interval.contains(nothing)))
        };
        !own.is_empty() && own.iter().all(|e| !shows(&e))
    };
    last_part(fitted, asked, is_silent)
}

/// Of the fitted effects that are `asked` and fulfil a condition, the one that was added last.
pub(crate) fn last_part(
    fitted: &Fitted,
    asked: impl Fn(&'static str) -> bool,
    is_such: impl Fn(&Part) -> bool,
) -> Option<&'static str> {
    let parts = fitted.model.parts().iter().filter(|part| part.free && asked(part.effect.name()));
    parts.rev().find(|part| is_such(part)).map(|part| part.effect.name())
}

/// A fit without the effects of the reference that were taken from the motion and that it does not show; and these.
pub(crate) fn without_silent_taken(mut fitted: Fitted) -> Result<(Fitted, Vec<&'static str>), ModelError> {
    let mut removed = Vec::new();
    let taken: Vec<&str> = fitted.taken.iter().map(|taken| taken.effect).collect();
    while let Some(effect) = silent(&fitted, |effect| taken.contains(&effect)) {
        fitted = without(&fitted, effect)?;
        removed.push(effect);
    }
    Ok((fitted, removed))
}

#[cfg(test)]
mod tests {
    use crate::diagnose::tests::robot_with;
    use crate::effect::{Formula, Target};
    use crate::evidence::fit;
    use crate::likelihood::watched::watched;

    /// A sideways motion in turns moves the poses as a marker ahead of the axle does: the motion alone takes it for one, and a model
    /// that has the motion leaves nothing for the marker.
    #[test]
    fn a_place_of_the_marker_that_was_taken_is_kept_only_where_the_fit_shows_it() {
        let mut truth =
            robot_with(&[("reference_noise", "position_sd_m", 8e-4), ("reference_noise", "heading_sd_rad", 8e-4)]);
        let crab = Formula::new("own", Target::SidewaysPerRadian, "a * sign(turn_rate)", &["a"]).unwrap();
        let first = truth.clone();
        truth.add_formula(crab, &[0.03]).unwrap();
        let data = watched(&truth, 5, 11);
        let taken = |mut model: crate::effect::Model| {
            model.add("wheelbase").unwrap().free = true;
            fit(&data, &model).unwrap().taken.iter().map(|taken| taken.effect).collect::<Vec<_>>()
        };
        assert_eq!((taken(truth.clone()), taken(first)), (vec![], vec!["marker_offset"]));
    }
}
