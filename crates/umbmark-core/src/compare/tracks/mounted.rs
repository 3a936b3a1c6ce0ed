//! The mounting of a reference, where a written model lacks it because it is small.
//!
//! A marker some millimetres aside is fitted along with every model. It is not added where it is small beside the noise of the wheels, but the
//! tests of `compare` are finer than that noise: they would hold it against a model that is right.

use super::against_as_written;
use crate::diagnose::Options;
use crate::effect::{Model, Part, find};
use crate::evidence::FitError;
use crate::evidence::tracks::estimates;
use crate::likelihood::{NUISANCE, Noise, Observed};

/// A model with the mounting of the reference that explains what the tests hold against it, and that in words.
#[derive(Clone, Debug)]
pub(crate) struct Mounted {
    /// The model.
    pub model: Model,
    /// The mounting.
    pub words: String,
}

/// Of a model that the tests reject: the mounting of the reference that it lacks, if they do not reject it with this; its own values are kept.
pub(crate) fn mounted(
    observed: &Observed,
    model: &Model,
    noise: &Noise,
    options: &Options,
) -> Result<Option<Mounted>, FitError> {
    let mut with = fixed(model);
    let lacks = |name: &&str| model.parts().iter().all(|part| part.effect.name() != *name);
    let lacking: Vec<&str> = NUISANCE.into_iter().filter(lacks).collect();
    for name in &lacking {
        with.add(name)?.free = true;
    }
    if lacking.is_empty() {
        return Ok(None);
    }
    let fitted = observed.fit(&with, noise, &[])?;
    let estimates = estimates(&fitted);
    // Only what is shown is kept: fitted noise explains nothing.
    let is_shown = |effect: &str| {
        let mut own = estimates.iter().filter(|own| own.effect == effect);
        own.any(|own| own.interval(1.0 - options.size).is_some_and(|interval| !interval.contains(0.0)))
    };
    let shown: Vec<&str> = lacking.into_iter().filter(|name| is_shown(name)).collect();
    let mut kept = fixed(model);
    for part in fitted.model.parts().iter().filter(|part| shown.contains(&part.effect.name())) {
        kept.adopt(&Part { free: false, ..part.clone() });
    }
    if shown.is_empty() || against_as_written(observed, &kept, options).is_some() {
        return Ok(None);
    }
    let said = |name: &&str| kept.meaning(name).or_else(|| find(name).ok().map(|entry| entry.about.title.to_owned()));
    let words = shown.iter().filter_map(said).collect::<Vec<_>>().join(" ");
    Ok(Some(Mounted { model: kept, words }))
}

/// A model of which nothing is free.
pub(crate) fn fixed(model: &Model) -> Model {
    let mut fixed = Model::new(model.robot());
    model.parts().iter().for_each(|part| fixed.adopt(&Part { free: false, ..part.clone() }));
    fixed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::drive::Robot;
    use crate::likelihood::watched::watched;

    /// What is found of a model that knows the ratios alone, of a robot with one more effect.
    fn found(effect: (&'static str, &'static str, f64)) -> (Option<Mounted>, Model) {
        let noise = ["position_sd_m", "heading_sd_rad"].map(|parameter| ("reference_noise", parameter, 1e-3));
        let truth = robot_with(&[noise[0], noise[1], ("wheel_noise", "k_sqrt_m", 1e-3), effect]);
        let observed = Observed::new(&watched(&truth, 4, 4), &Robot::labmate()).unwrap();
        let mut model = Model::new(&Robot::labmate());
        for (effect, ratio) in [("wheel_diameter_ratio", "e_d"), ("wheelbase", "e_b")] {
            model.set(effect, ratio, truth.get(effect, ratio).unwrap()).unwrap();
        }
        (mounted(&observed, &model, &Noise::default(), &Options::default()).unwrap(), model)
    }

    #[test]
    fn a_marker_aside_is_found_with_its_place_beside_the_values_of_the_model() {
        let (found, own) = found(("marker_offset", "left_m", 4e-3));
        let Mounted { model, words } = found.unwrap();
        assert!((model.get("marker_offset", "left_m").unwrap() - 4e-3).abs() < 5e-4, "{model:?}");
        assert_eq!((model.get("wheelbase", "e_b"), model.is_free()), (own.get("wheelbase", "e_b"), false));
        assert!(words.contains("to the left of the middle of the axle"), "{words}");
    }

    #[test]
    fn a_marker_in_its_place_explains_nothing() {
        assert!(found(("reference_noise", "position_sd_m", 1e-3)).0.is_none());
    }
}
