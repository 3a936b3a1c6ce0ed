//! The effects that a model may be missing, and the derivatives of its predicted poses by each of them.

use crate::effect::{Chain, Changes, Entry, Model, ModelError, Number, of_drive};
use crate::geometry::{Dual, LANES, Pose2, seeded};
use crate::parameter::Parameter;
use crate::replay::Track;
use rayon::prelude::*;

/// A parameter in which an effect is linear near zero, and the response to a unit of it.
#[derive(Clone, Debug)]
pub struct Size {
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Derivative of each observed pose (x \[m\], y \[m\], heading \[rad\]) by the parameter, run by run.
    pub columns: Vec<Vec<Pose2>>,
}

/// An effect that is not in a model, with its response there.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static Entry,
    /// Its sizes. Lengths, thresholds and the like are not among them: they have no influence while the size is zero.
    pub sizes: Vec<Size>,
}

/// Every effect of the catalogue that changes the mean of what `tracks` observe and is not in the model.
pub fn candidates(model: &Model, tracks: &[Track]) -> Result<Vec<Candidate>, ModelError> {
    of_tracks(model, |_| tracks.iter().collect())
}

/// Every effect of the catalogue that changes the mean of what may be observed of a model's robot, and is not in the model.
pub(crate) fn missing(model: &Model) -> impl Iterator<Item = &'static Entry> {
    let has = |entry: &Entry| model.parts().iter().any(|part| part.effect == *entry);
    of_drive(model.robot().drive.kind()).filter(move |entry| entry.changes.include(Changes::MEAN) && !has(entry))
}

/// [`candidates`] with tracks cut as finely as a model needs them: `tracks(true)` for one that varies along the way.
pub(crate) fn of_tracks<'a>(
    model: &Model,
    tracks: impl Fn(bool) -> Vec<&'a Track>,
) -> Result<Vec<Candidate>, ModelError> {
    let mut asked: [Vec<(&'static Entry, &'static Parameter)>; 2] = Default::default();
    for effect in missing(model) {
        let mut with = model.clone();
        with.add(effect.about.name)?;
        asked[usize::from(with.may_vary())].extend(effect.about.parameters.iter().map(|parameter| (effect, parameter)));
    }
    let mut sizes: Vec<(&'static Entry, Size)> = Vec::new();
    for (varies, asked) in [(false, &asked[0]), (true, &asked[1])] {
        let tracks = tracks(varies);
        let number =
            |(effect, parameter): &(&'static Entry, &'static Parameter)| Number::of(effect.about.name, parameter.name);
        let derived = model.derived(&asked.iter().map(number).collect::<Vec<_>>())?;
        let columns: Vec<_> = derived.par_iter().map(|d| slopes(&d.chain, d.numbers.len(), &tracks)).collect();
        for (number, columns) in derived.iter().zip(columns).flat_map(|(d, columns)| d.numbers.iter().zip(columns)) {
            let (effect, parameter) = asked[*number];
            sizes.push((effect, Size { parameter, columns }));
        }
    }
    let moves = |size: &Size| size.columns.iter().flatten().any(|p| p.x != 0.0 || p.y != 0.0 || p.heading != 0.0);
    sizes.retain(|(_, size)| moves(size));
    let candidate = |effect: &'static Entry| {
        let own = |parameter: &'static Parameter| {
            let found = sizes.iter().find(|(e, size)| *e == effect && size.parameter.name == parameter.name);
            found.map(|(_, size)| size.clone())
        };
        Candidate { effect, sizes: effect.about.parameters.iter().filter_map(own).collect() }
    };
    Ok(missing(model).map(candidate).filter(|candidate| !candidate.sizes.is_empty()).collect())
}

/// Derivatives of all observed poses by some values of a model, in the order of [`Model::values`]: value by value, run by run.
pub fn columns(model: &Model, values: &[usize], tracks: &[&Track]) -> Vec<Vec<Vec<Pose2>>> {
    let of_some = |places: &[usize]| slopes(&model.chain_with(&seeded(model.values(), places)), places.len(), tracks);
    values.chunks(LANES).flat_map(of_some).collect()
}

/// The derivatives in the first `count` lanes of a chain: lane by lane, run by run.
fn slopes(chain: &Chain<Dual>, count: usize, tracks: &[&Track]) -> Vec<Vec<Vec<Pose2>>> {
    // Where a robot is measured at the end of its way only, it stands there: neither a delay nor a filter shows.
    let ends = |track: &Track| *track.seen_after() == [track.travel().len()];
    let observed = |track: &&Track| if ends(track) { vec![track.end(chain)] } else { track.poses(chain) };
    let poses: Vec<Vec<Pose2<Dual>>> = tracks.iter().map(observed).collect();
    let of_lane = |lane: usize| poses.iter().map(|run| run.iter().map(|pose| pose.slope(lane)).collect()).collect();
    (0..count).map(of_lane).collect()
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

    #[test]
    fn a_delay_and_a_filter_are_candidates_where_a_moving_robot_is_measured_and_not_where_it_stands() {
        let robot = Robot::labmate();
        let late = ["reference_delay", "reference_filter"];
        let of = |tracks: &[Track]| {
            let found = candidates(&Model::new(&robot), tracks).unwrap();
            late.map(|name| found.iter().any(|candidate| candidate.effect.about.name == name))
        };
        let path = Path::umbmark();
        assert_eq!(of(&Direction::BOTH.map(|d| Track::in_pieces(&path, d, &robot))), [false; 2]);
        assert_eq!(of(&Direction::BOTH.map(|d| Track::watched(&path, d, &robot))), [true; 2]);
    }
}
