//! First effects with ratios that the motion denies.

use super::{estimates, fit};
use crate::effect::{Model, find};
use crate::evidence::FitError;
use crate::likelihood::{Fitted, Observed};

/// A fitted ratio is possible within this factor of the ratio that the motion alone gives.
const FAR: f64 = 1.5;

/// Whether a fitted value of an effect may be that of the robot: a ratio far from that of the motion stands for another error. On turns on
/// the spot, say, all the way is made of whole counts that the robot does not follow, and its mean diameter seems to be a fifth.
pub(crate) fn is_possible(fitted: &Fitted, effect: &str) -> bool {
    let own = estimates(fitted).into_iter().find(|e| e.effect == effect);
    let parameter = find(effect).ok().and_then(|entry| entry.about.parameters.first());
    let Some((own, parameter)) = own.zip(parameter) else { return true };
    let nothing = parameter.default.resolve(fitted.model.robot());
    let expected = fitted.observed.ratio_by_motion(effect).unwrap_or(nothing);
    nothing != 1.0 || (own.value / expected < FAR && expected / own.value < FAR)
}

/// Fits a model, without the first effects that would have impossible ratios, the last of them first. Each fit begins anew: beside an
/// impossible ratio the others are far off too. Nothing is left out where the motion was not compared with the reference.
pub(crate) fn fit_possible(observed: &Observed, model: &Model) -> Result<Fitted, FitError> {
    let drive = &observed.robot.drive;
    let is_compared = observed.setup.mounting.is_some() && drive.kind().has_axle_wheels();
    let (first, mut model) = (drive.first_effects(), model.clone());
    loop {
        let fitted = fit(observed, &model)?;
        match first.iter().rev().find(|effect| is_compared && !is_possible(&fitted, effect)) {
            Some(effect) => model = model.without(effect),
            None => return Ok(fitted),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::{Options, diagnose, first_model};
    use crate::drive::{Encoder, Robot};
    use crate::evidence;
    use crate::likelihood::watched::watched_on;
    use crate::path::{Path, SPIN, SpeedProfile};

    /// Turns on the spot by whole counts of 2.4 mm: the counts make ways of a millimetre that the robot does not drive.
    #[test]
    fn turns_on_the_spot_show_the_wheelbase_and_no_mean_diameter_made_of_counts() {
        let mut robot = Robot::labmate();
        robot.encoder = Encoder::new(200.0, None, None).unwrap();
        let mut truth = Model::new(&robot);
        let sizes = [
            ("wheelbase", "e_b", 1.02),
            ("reference_noise", "position_sd_m", 3e-4),
            ("reference_noise", "heading_sd_rad", 2e-3),
        ];
        sizes.iter().for_each(|(effect, parameter, value)| truth.set(effect, parameter, *value).unwrap());
        let spin = Path::new(&SPIN, &[3.0], SpeedProfile::default()).unwrap();
        let data = watched_on(&spin, &truth, 4, 3);
        let model = first_model(&data).unwrap();
        let plain = fit(&evidence::tracks::of(&data).unwrap(), &model).unwrap();
        let found = evidence::fit(&data, &model).unwrap();
        assert!(!is_possible(&plain, "scale"), "{:?}", estimates(&plain));
        assert!(found.estimates.iter().all(|e| e.effect != "scale"), "{:?}", found.estimates);
        assert_eq!(found.model.get("scale", "e_s"), Some(1.0));
        let e_b = found.estimates.iter().find(|e| e.effect == "wheelbase").unwrap();
        assert!((e_b.value - 1.02).abs() < 4.0 * e_b.standard_error && e_b.standard_error < 1e-3, "{e_b:?}");
        let told = diagnose(&data, &model, &Options::default()).unwrap();
        assert!(told.fitted.iter().all(|e| e.effect != "scale"), "{:?}", told.fitted);
    }
}
