//! Which parameters of a model an experiment can determine, for any noise.

use super::candidates;
use crate::effect::Model;
use crate::evidence::FitError;
use crate::evidence::ends::{Ends, mirrored};
use crate::fit::{RANK_TOLERANCE, null_directions};
use crate::geometry::Pose2;
use crate::path::{Direction, Path};
use crate::replay::Track;
use nalgebra::{DMatrix, DVector, Vector3};

/// Change of the end pose per unit of a parameter, at the nominal robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// The effect.
    pub effect: &'static str,
    /// The parameter.
    pub parameter: &'static str,
    /// Largest shift of an end point \[m per unit\].
    pub position: f64,
    /// Largest turn of an end heading \[rad per unit\].
    pub heading: f64,
}

/// A combination of parameters that the experiment does not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Hidden {
    /// Parameters with their weights, the largest ±1: changed together in these proportions, they change no end pose.
    pub weights: Vec<(&'static str, f64)>,
    /// Where exactly two are involved: how many units of the second have the effect of one unit of the first.
    pub ratio: Option<f64>,
}

/// What an experiment determines of a model's free parameters, to first order.
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// The parameters.
    pub shares: Vec<Share>,
    /// How many combinations of them are determined.
    pub rank: usize,
    /// The combinations that are not.
    pub hidden: Vec<Hidden>,
}

/// What the end poses of a path, driven in some directions, determine of a model's free parameters.
///
/// ```
/// use umbmark_core::diagnose::{base_model, identifiability};
/// use umbmark_core::{drive::Robot, path::{Direction, Path}};
/// let model = base_model(&Robot::labmate())?;
/// // One direction of the square: E_d and E_b cannot be separated.
/// let one_way = identifiability(&model, &Path::umbmark(), &[Direction::Ccw], true)?;
/// assert_eq!(one_way.rank, 1);
/// assert!((one_way.hidden[0].ratio.unwrap() + 7.49).abs() < 0.01);
/// assert_eq!(identifiability(&model, &Path::umbmark(), &Direction::BOTH, true)?.rank, 2);
/// # Ok::<(), umbmark_core::evidence::FitError>(())
/// ```
pub fn identifiability(
    model: &Model,
    path: &Path,
    directions: &[Direction],
    with_heading: bool,
) -> Result<Identifiability, FitError> {
    let tracks: Vec<Track> = directions.iter().map(|d| Track::in_pieces(path, *d, model.robot())).collect();
    let ends: Vec<(Direction, usize)> = directions.iter().copied().zip(0..).collect();
    of_tracks(model, &tracks.iter().collect::<Vec<_>>(), &ends, with_heading)
}

/// The same of measured runs.
pub(super) fn of_ends(ends: &Ends, model: &Model) -> Result<Identifiability, FitError> {
    let tracks = ends.tracks(model.may_vary());
    let numbers: Vec<usize> = (0..tracks.len()).collect();
    let runs: Vec<(Direction, usize)> = ends.of_runs(&numbers).map(|(d, i)| (d, *i)).collect();
    of_tracks(model, &tracks, &runs, ends.with_heading)
}

fn of_tracks(
    model: &Model,
    tracks: &[&Track],
    runs: &[(Direction, usize)],
    with_heading: bool,
) -> Result<Identifiability, FitError> {
    let nominal = model.at_rest();
    let mut asked = Vec::new();
    for part in model.parts() {
        asked.extend(part.effect.parameters().iter().map(|p| (part.free, part.effect.name(), p.name)));
    }
    let (mut shares, mut columns): (Vec<Share>, Vec<DVector<f64>>) = Default::default();
    let free: Vec<usize> = asked.iter().enumerate().filter(|(_, (free, ..))| *free).map(|(index, _)| index).collect();
    for (index, by_run) in free.iter().zip(candidates::columns(&nominal, &free, tracks)) {
        let (_, effect, parameter) = asked[*index];
        let of_tracks: Vec<Pose2> = by_run.iter().filter_map(|poses| poses.last().copied()).collect();
        let poses: Vec<Pose2> = runs.iter().map(|(_, track)| of_tracks[*track]).collect();
        let position = poses.iter().map(|p| libm::hypot(p.x, p.y)).fold(0.0, f64::max);
        let heading = poses.iter().map(|p| p.heading.abs()).fold(0.0, f64::max);
        if position > 0.0 || heading > 0.0 {
            let d = if with_heading { 3 } else { 2 };
            let rows = poses.iter().zip(runs).flat_map(|(p, (direction, _))| {
                let v = mirrored(*direction, &Vector3::new(p.x, p.y, p.heading));
                (0..d).map(move |i| v[i])
            });
            columns.push(DVector::from_iterator(d * poses.len(), rows));
            shares.push(Share { effect, parameter, position, heading });
        }
    }
    if columns.is_empty() {
        return Ok(Identifiability { shares, rank: 0, hidden: Vec::new() });
    }
    let null = null_directions(&DMatrix::from_columns(&columns), RANK_TOLERANCE);
    let hidden = null.iter().map(|direction| hidden(direction, &shares)).collect();
    Ok(Identifiability { rank: shares.len() - null.len(), shares, hidden })
}

fn hidden(direction: &DVector<f64>, shares: &[Share]) -> Hidden {
    const ROUNDING: f64 = 1e-6;
    let involved = direction.iter().zip(shares).filter(|(w, _)| w.abs() > ROUNDING);
    let weights: Vec<(&'static str, f64)> = involved.map(|(w, share)| (share.parameter, *w)).collect();
    let ratio = match weights.as_slice() {
        [(_, a), (_, b)] => Some(-b / a),
        _ => None,
    };
    Hidden { weights, ratio }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::base_model;
    use crate::drive::Robot;
    use crate::path::{FIGURE_EIGHT, SpeedProfile};

    /// Section 6 of the theory: per unit E_d, 4πR/b = 73.9 rad of heading and nothing of position; per unit E_b, 4πR =
    /// 25.1 m of position and nothing of heading.
    #[test]
    fn a_figure_eight_shows_e_d_in_heading_only_and_e_b_in_position_only() {
        let model = base_model(&Robot::labmate()).unwrap();
        let path = Path::new(&FIGURE_EIGHT, &[2.0], SpeedProfile::default()).unwrap();
        for directions in [&Direction::BOTH[..], &[Direction::Ccw]] {
            let all = identifiability(&model, &path, directions, true).unwrap();
            let [e_d, e_b] = &all.shares[..] else { panic!("{all:?}") };
            assert!(e_d.position < 1e-9 && (e_d.heading - 73.9).abs() < 0.1, "{e_d:?}");
            assert!((e_b.position - 25.13).abs() < 0.01 && e_b.heading < 1e-9, "{e_b:?}");
            assert_eq!((all.rank, all.hidden.len()), (2, 0));
            let by_position = identifiability(&model, &path, directions, false).unwrap();
            assert_eq!(by_position.rank, 1);
            assert_eq!(by_position.hidden[0].weights, [("e_d", 1.0)]);
        }
    }

    #[test]
    fn one_direction_of_the_square_has_rank_one_with_or_without_heading() {
        let model = base_model(&Robot::labmate()).unwrap();
        for (direction, sign) in [(Direction::Ccw, -1.0), (Direction::Cw, 1.0)] {
            for with_heading in [true, false] {
                let one = identifiability(&model, &Path::umbmark(), &[direction], with_heading).unwrap();
                assert_eq!(one.rank, 1);
                assert!((one.hidden[0].ratio.unwrap() - sign * 7.49).abs() < 0.005, "{one:?}");
            }
        }
    }
}
