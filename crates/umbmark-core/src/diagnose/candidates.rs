//! The effects that a model may be missing, and what each would do to the poses that it predicts.

use crate::effect::{Entry, Model, ModelError, of_drive};
use crate::geometry::{Dual, Pose2};
use crate::parameter::Parameter;
use crate::replay::Track;
use rayon::prelude::*;

/// A parameter in which an effect is linear near where it does nothing, and what a unit of it does.
#[derive(Clone, Debug)]
pub struct Size {
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Derivative of each observed pose (x \[m\], y \[m\], heading \[rad\]) by the parameter, run by run.
    pub columns: Vec<Vec<Pose2>>,
}

/// An effect that is not in a model, as the model would feel it.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static Entry,
    /// Its sizes; lengths, thresholds and the like, which change nothing while the effect is at zero, are not among them.
    pub sizes: Vec<Size>,
}

/// Every effect of the catalogue that changes the mean of what `tracks` observe and is not in the model.
pub fn candidates(model: &Model, tracks: &[Track]) -> Result<Vec<Candidate>, ModelError> {
    of_tracks(model, |_| tracks.iter().collect())
}

/// [`candidates`] with tracks cut as finely as a model needs them: `tracks(true)` for one that varies along the way.
pub(crate) fn of_tracks<'a>(
    model: &Model,
    tracks: impl Fn(bool) -> Vec<&'a Track> + Sync,
) -> Result<Vec<Candidate>, ModelError> {
    let missing: Vec<&'static Entry> = of_drive(model.robot().drive.kind())
        .filter(|entry| model.parts().iter().all(|part| part.effect != *entry))
        .collect();
    let found: Vec<Candidate> =
        missing.into_par_iter().map(|effect| of_effect(effect, model, &tracks)).collect::<Result<_, _>>()?;
    Ok(found.into_iter().filter(|candidate| !candidate.sizes.is_empty()).collect())
}

/// An effect with those of its sizes that move some pose.
pub(crate) fn of_effect<'a>(
    effect: &'static Entry,
    model: &Model,
    tracks: impl Fn(bool) -> Vec<&'a Track>,
) -> Result<Candidate, ModelError> {
    let mut with = model.clone();
    with.add(effect.about.name)?;
    let tracks = tracks(with.may_vary());
    let before = with.parts().iter().take_while(|part| part.effect != effect);
    let first: usize = before.map(|part| part.values.len()).sum();
    let moves = |p: &Pose2| p.x != 0.0 || p.y != 0.0 || p.heading != 0.0;
    let size = |(index, parameter): (usize, &'static Parameter)| {
        let columns = of_value(&with, first + index, &tracks);
        columns.iter().flatten().any(moves).then_some(Size { parameter, columns })
    };
    Ok(Candidate { effect, sizes: effect.about.parameters.iter().enumerate().filter_map(size).collect() })
}

/// Derivatives of all observed poses by one value of a model, in the order of [`Model::values`], run by run.
pub fn columns(model: &Model, value: usize, tracks: &[Track]) -> Vec<Vec<Pose2>> {
    of_value(model, value, &tracks.iter().collect::<Vec<_>>())
}

pub(crate) fn of_value(model: &Model, value: usize, tracks: &[&Track]) -> Vec<Vec<Pose2>> {
    let seeded = model.values().enumerate();
    let values: Vec<Dual> = seeded.map(|(i, v)| Dual::new(v, f64::from(u8::from(i == value)))).collect();
    let chain = model.chain_with(&values);
    let derivative = |pose: &Pose2<Dual>| Pose2::new(pose.x.eps, pose.y.eps, pose.heading.eps);
    tracks.iter().map(|track| track.poses(&chain).iter().map(derivative).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::path::{Direction, Path};

    #[test]
    fn effects_outside_the_model_that_move_the_poses_are_candidates_with_their_sizes() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        model.add("wheelbase").unwrap();
        let tracks = Direction::BOTH.map(|d| Track::in_pieces(&Path::umbmark(), d, &robot));
        let found = candidates(&model, &tracks).unwrap();
        let named = |name: &str| found.iter().find(|c| c.effect.about.name == name);
        assert!(named("wheelbase").is_none() && named("wheel_noise").is_none());
        let e_d = &named("wheel_diameter_ratio").unwrap().sizes;
        assert_eq!((e_d.len(), e_d[0].parameter.name), (1, "e_d"));
        // A closed square turns by L d/b on each side, the same way in both directions.
        let turned = |run: usize| e_d[0].columns[run][0].heading;
        assert!((turned(0) - 16.0 / 0.34).abs() < 1e-9 && (turned(1) - 16.0 / 0.34).abs() < 1e-9);
        let start: Vec<_> = named("start_pose").unwrap().sizes.iter().map(|s| s.parameter.name).collect();
        assert_eq!(start, ["x_m", "y_m", "heading_rad"]);
    }
}
