//! One model for both tests.

use super::{ChangeError, Learned};
use crate::effect::{ActsOn, Model, ModelError, Part};
use crate::evidence::{Fit, FitError};

/// Whether an effect belongs to the test and not to the robot: clock and mounting of the reference, and START.
pub(crate) fn is_of_test(part: &Part) -> bool {
    let acts_on = part.effect.entry().map(|entry| entry.about.acts_on);
    matches!(acts_on, Some(ActsOn::Reference | ActsOn::Start))
}

/// Fits all effects of the robot that one of the tests shows to both. One that the other does not determine is taken to be in it as in the
/// first; these are named.
pub(super) fn fitted(tests: &[Learned; 2]) -> Result<([Fit; 2], Vec<&'static str>), ChangeError> {
    let models = [0, 1].map(|k| {
        let mut model = tests[k].model.clone();
        let other = tests[1 - k].model.parts().iter().filter(|part| !is_of_test(part));
        for part in other {
            if lacks(&model, part) {
                model.adopt(part);
            }
        }
        model
    });
    let fit = |k: usize, model: &Model| {
        let test = ["before", "after"][k];
        tests[k].evidence.fit(model).map_err(|source: FitError| ChangeError::Fit { test, source })
    };
    let mut assumed = Vec::new();
    // Effects of the other test may have no place in this one: its fit leaves their bounds.
    let mut fit_or_assume = |k: usize| {
        fit(k, &models[k]).or_else(|error| {
            let mut held = tests[k].model.clone();
            let theirs = models[k].parts().iter().filter(|part| lacks(&tests[k].model, part));
            let theirs: Vec<&Part> = theirs.filter(|part| part.free).collect();
            if theirs.is_empty() {
                return Err(error);
            }
            for part in theirs {
                held.adopt(&Part { free: false, ..part.clone() });
                assumed.push(part.effect.name());
            }
            fit(k, &held)
        })
    };
    let mut fits = [fit_or_assume(0)?, fit_or_assume(1)?];
    for k in [0, 1] {
        let silent = not_shown(&fits[k]);
        let known: Vec<&Part> = fits[1 - k]
            .model
            .parts()
            .iter()
            .filter(|part| silent.contains(&part.effect.name()) && !is_of_test(part))
            .filter(|part| !not_shown(&fits[1 - k]).contains(&part.effect.name()))
            .collect();
        if known.is_empty() {
            continue;
        }
        let mut model = fits[k].model.clone();
        for part in known {
            model.adopt(&Part { free: false, ..part.clone() });
            assumed.push(part.effect.name());
        }
        fits[k] = fit(k, &model)?;
    }
    Ok((fits, assumed))
}

/// Whether a model does not have the effect of a part.
fn lacks(model: &Model, part: &Part) -> bool {
    model.parts().iter().all(|own| own.effect.name() != part.effect.name())
}

/// Free effects that were not fitted, because the runs do not determine them.
fn not_shown(fit: &Fit) -> Vec<&'static str> {
    let free = fit.model.parts().iter().filter(|part| part.free).map(|part| part.effect.name());
    free.filter(|name| fit.estimates.iter().all(|own| own.effect != *name)).collect()
}

/// The model of a test with the robot of another one.
pub(super) fn with_numbers_of(test: &Model, robot: &Model) -> Result<Model, ModelError> {
    let (robot, _) = robot.converted(test.robot())?;
    let mut model = Model::new(test.robot());
    robot.parts().iter().filter(|part| !is_of_test(part)).for_each(|part| model.adopt(part));
    test.parts().iter().filter(|part| is_of_test(part)).for_each(|part| model.adopt(part));
    Ok(model)
}
