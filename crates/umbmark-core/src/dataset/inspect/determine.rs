//! What a dataset can say of the robot.
//!
//! To first order a pose measured somewhere on a path tells a few linear combinations of the departures of E_d, E_b and
//! E_s from one. A quantity can be determined where the measured combinations single it out: where its column of the
//! Jacobian is not a combination of the others. A path that is not known is taken to be the paper's square.

use super::{Coverage, Group, LogFacts};
use crate::drive::Robot;
use crate::effect::{Context, Model, TestKind};
use crate::geometry::{Dual, Pose2};
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

/// The effects asked about, in the order of the Jacobian's columns.
const ASKED: [(&str, &str); 3] = [("wheel_diameter_ratio", "e_d"), ("wheelbase", "e_b"), ("scale", "e_s")];
const NOTHING: &str = "there is no return error and no absolute pose; measure where the robot stands";
/// A track sees each move in so many places.
const PIECES: usize = 8;
/// Combinations weaker than this \[m or rad per unit of the ratio\], or this share of the strongest, are rounding.
const WEAKEST: f64 = 1e-9;

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
    let mut answers =
        vec![ratio("E_d", &seen, 0, tracked), ratio("E_b (if E_s = 1)", &seen, 1, tracked), scale(&seen, tracked)];
    answers.extend(other_answers(groups));
    (answers, rank(&seen, &[0, 1, 2]))
}

/// Derivatives of the pose by each quantity, along the path.
fn jacobian(robot: &Robot, path: &Path, direction: Direction) -> Vec<[Pose2; 3]> {
    let mut model = Model::new(robot);
    for (effect, parameter) in ASKED {
        // The value that does nothing is always allowed.
        let _ = model.set(effect, parameter, 1.0);
    }
    let values: Vec<f64> = model.values().collect();
    let columns = [0, 1, 2].map(|column| {
        let seeded = values.iter().enumerate();
        let duals: Vec<Dual> = seeded.map(|(i, v)| Dual::new(*v, f64::from(u8::from(i == column)))).collect();
        let chain = model.chain_with(&duals);
        let mut pose: Pose2<Dual> = Pose2::IDENTITY.lift();
        let mut poses = Vec::new();
        for m in path.moves(direction) {
            let motion = chain.displacement(
                &Context::default().headed(pose.heading),
                &m.wheel_travel(&robot.drive).scaled(1.0 / PIECES as f64),
            );
            for _ in 0..PIECES {
                pose = pose.moved(&motion);
                poses.push(Pose2::new(pose.x.eps, pose.y.eps, pose.heading.eps));
            }
        }
        poses
    });
    (0..columns[0].len()).map(|i| [columns[0][i], columns[1][i], columns[2][i]]).collect()
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
        false => "one direction gives one combination of E_d and E_b; drive the other direction as well",
    };
    Determined { quantity, yes, because }
}

/// E_s, both others being free.
fn scale(rows: &[[f64; 3]], tracked: bool) -> Determined {
    let yes = rank(rows, &[0, 1, 2]) > rank(rows, &[0, 1]);
    let because = match yes {
        _ if rows.is_empty() => NOTHING,
        true if tracked => "absolute poses on the way measure distances",
        true => "the path is open: its end measures a distance",
        false => "these returns give E_b/E_s only; measure the pose at a stop on the way, or a straight",
    };
    Determined { quantity: "E_s", yes, because }
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
