//! What a dataset can say of the robot.
//!
//! To first order a pose measured somewhere on a path tells a few linear combinations of the departures of E_d, E_b and
//! E_s from one, or of what a robot of another drive has in their place. A quantity can be determined where the measured combinations single it out: where its column of the
//! Jacobian is not a combination of the others. A path that is not known is taken to be the paper's square.

use super::{Coverage, Group, LogFacts};
use crate::drive::Robot;
use crate::effect::{Chain, Model, Place, Progress, TestKind};
use crate::engine::{Convoy, Predicted};
use crate::geometry::{Dual, Pose2, seeded};
use crate::path::{Direction, Path};
use nalgebra::DMatrix;
use std::collections::BTreeSet;

/// A quantity, and whether the data can determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct Determined {
    /// What is asked for.
    pub quantity: &'static str,
    /// Whether it can be had.
    pub yes: bool,
    /// Why, or why not and what would help.
    pub because: &'static str,
}

/// What is asked for of a differential drive; of others, their first effects by name.
const OF_WHEELS: [&str; 3] = ["E_d", "E_b (if E_s = 1)", "E_s"];
const NOTHING: &str = "there is no return error and no absolute pose; measure where the robot stands";
/// A track sees each move in so many places.
const PIECES: usize = 8;
/// Combinations weaker than this \[m or rad per unit of the ratio\], or this share of the strongest, show nothing that could be measured.
const WEAKEST: f64 = 1e-4;

/// The answers, and how many combinations of the three ratios are shown.
pub(super) fn determine(
    groups: &[Group],
    logs: &[LogFacts],
    robot: Option<&Robot>,
    path: Option<&Path>,
) -> (Vec<Determined>, usize) {
    let robot = robot.cloned().unwrap_or_else(Robot::labmate);
    let path = path.cloned().unwrap_or_else(Path::umbmark);
    let mut seen = Vec::new();
    for group in groups.iter().filter(|g| g.test == TestKind::Systematic && g.returns > 0) {
        let poses = jacobian(&robot, &path, group.direction.unwrap_or(Direction::Ccw));
        seen.extend(poses.last().map(|pose| rows(pose, group.headings > 0)).into_iter().flatten());
    }
    let on_the_way = logs.iter().filter_map(|log| {
        let reference = log.reference.as_ref().filter(|r| r.coverage >= Coverage::OnTheWay)?;
        Some((log.direction, reference.headings > 0))
    });
    let kinds: BTreeSet<(Option<Direction>, bool)> = on_the_way.collect();
    let tracked = !kinds.is_empty();
    for (direction, headings) in kinds {
        let poses = jacobian(&robot, &path, direction.unwrap_or(Direction::Ccw));
        seen.extend(poses.iter().flat_map(|pose| rows(pose, headings)));
    }
    let first = robot.drive.first_effects();
    let [bends, turns, lengthens] = if first == Robot::labmate().drive.first_effects() { OF_WHEELS } else { first };
    let mut answers = vec![
        ratio(bends, &seen, 0, tracked),
        ratio(turns, &seen, 1, tracked),
        scale(lengthens, &seen, tracked, lengthens == OF_WHEELS[2]),
    ];
    answers.extend(other_answers(groups));
    (answers, rank(&seen, &[0, 1, 2]))
}

/// Derivatives of the pose by each quantity, along the path.
fn jacobian(robot: &Robot, path: &Path, direction: Direction) -> Vec<[Pose2; 3]> {
    let mut model = Model::new(robot);
    let first = robot.drive.first_effects();
    // Every drive's first effects stand in the catalogue.
    first.iter().for_each(|effect| drop(model.add(effect)));
    let place = |effect: &str| -> usize {
        model.parts().iter().take_while(|part| part.effect.name() != effect).map(|part| part.values.len()).sum()
    };
    let chain = model.chain_with(&seeded(model.values(), &first.map(place)));
    match Convoy::new(robot, path, direction) {
        Some(convoy) => along_with_trucks(&convoy, &chain),
        None => along(robot, path, direction, &chain),
    }
}

/// The derivative of the pose in some places of each move.
fn along(robot: &Robot, path: &Path, direction: Direction, chain: &Chain<Dual>) -> Vec<[Pose2; 3]> {
    let place = Place { direction: Some(direction), ..Place::default() };
    let mut progress = Progress::new(robot, place, false);
    let mut pose: Pose2<Dual> = Pose2::IDENTITY.lift();
    let mut poses = Vec::new();
    for m in path.moves(direction) {
        let travel = m.wheel_travel(&robot.drive).scaled(1.0 / PIECES as f64);
        for _ in 0..PIECES {
            let speeds = [travel.left, travel.right];
            let at = progress.piece(&travel, 1.0, speeds, speeds);
            pose = pose.moved(&chain.displacement(&at.headed(pose.heading), &travel));
            poses.push([0, 1, 2].map(|lane| pose.slope(lane)));
        }
    }
    poses
}

/// The derivative of the front truck's return error after each move.
fn along_with_trucks(convoy: &Convoy, chain: &Chain<Dual>) -> Vec<[Pose2; 3]> {
    let mut floor = Predicted::by(chain);
    let mut trucks = convoy.at_start(chain.start(), &mut floor);
    let (mut made, mut poses) = (0, Vec::new());
    for stop in convoy.stops() {
        convoy.steps()[made..*stop].iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
        made = *stop;
        poses.push([0, 1, 2].map(|lane| {
            let [real, believed] = [&trucks.real[0], &trucks.believed[0]].map(|pose| pose.slope(lane));
            Pose2::new(real.x - believed.x, real.y - believed.y, real.heading - believed.heading)
        }));
    }
    poses
}

/// What a measured pose adds to the Jacobian.
fn rows(pose: &[Pose2; 3], heading: bool) -> Vec<[f64; 3]> {
    let mut rows = vec![pose.map(|p| p.x), pose.map(|p| p.y)];
    if heading {
        rows.push(pose.map(|p| p.heading));
    }
    rows
}

fn rank(rows: &[[f64; 3]], columns: &[usize]) -> usize {
    if rows.is_empty() || columns.is_empty() {
        return 0;
    }
    let matrix = DMatrix::from_fn(rows.len(), columns.len(), |r, c| rows[r][columns[c]]);
    let strengths = matrix.singular_values();
    let longest = rows.iter().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
    strengths.iter().filter(|s| **s > WEAKEST * longest * (rows.len() as f64).sqrt()).count()
}

/// E_d or E_b, the other being free and E_s being one.
fn ratio(quantity: &'static str, rows: &[[f64; 3]], column: usize, tracked: bool) -> Determined {
    let yes = rank(rows, &[0, 1]) > rank(rows, &[1 - column]);
    let because = match yes {
        _ if rows.is_empty() => NOTHING,
        true if tracked => "absolute poses on the way show it",
        true => "the returns show it",
        false if rank(rows, &[column]) == 0 => "this path does not show it; drive a square both ways",
        false => "one direction gives one combination of both; drive the other direction as well",
    };
    Determined { quantity, yes, because }
}

/// E_s, or what lengthens the way of another drive, both others being free.
fn scale(quantity: &'static str, rows: &[[f64; 3]], tracked: bool, of_wheels: bool) -> Determined {
    let yes = rank(rows, &[0, 1, 2]) > rank(rows, &[0, 1]);
    let because = match yes {
        _ if rows.is_empty() => NOTHING,
        true if tracked => "absolute poses on the way measure distances",
        true => "the path is open: its end measures a distance",
        false if of_wheels => "these returns give E_b/E_s only; measure the pose at a stop on the way, or a straight",
        false => "these returns do not tell it from the others; measure the pose at a stop on the way, or a straight",
    };
    Determined { quantity, yes, because }
}

fn other_answers(groups: &[Group]) -> [Determined; 3] {
    let each = |enough: &dyn Fn(&Group) -> bool| {
        Direction::BOTH.into_iter().all(|d| groups.iter().any(|g| g.direction == Some(d) && enough(g)))
    };
    let bumps = groups.iter().any(|g| g.test == TestKind::Bumps && g.headings > 0);
    let answer =
        |quantity, yes, because: [&'static str; 2]| Determined { quantity, yes, because: because[usize::from(!yes)] };
    [
        answer(
            "heading form",
            each(&|g| g.headings > 0),
            ["return headings were measured in both directions", "it needs return headings in both directions"],
        ),
        answer(
            "scatter sigma",
            each(&|g| g.returns >= 3),
            ["there are 3 or more returns in each direction", "it needs 3 or more returns in each direction"],
        ),
        answer(
            "extended test",
            bumps,
            [
                "there are runs over bumps with return headings",
                "it needs runs over bumps with return headings (column test = bumps)",
            ],
        ),
    ]
}
