//! What a dataset can say of the robot.
//!
//! To first order, the return of a closed path driven one way gives one combination of E_d and E_b, and the other way
//! another; a common scale E_s cancels against E_b on every closed path and shows only where distances are measured.

use super::{Coverage, Group, LogFacts};
use crate::effect::TestKind;
use crate::path::{Direction, Path};

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

pub(super) fn determine(groups: &[Group], logs: &[LogFacts], path: Option<&Path>) -> Vec<Determined> {
    let on_the_way = |log: &&LogFacts| log.reference.as_ref().is_some_and(|r| r.coverage >= Coverage::OnTheWay);
    let has = |direction| {
        let returned = |g: &Group| g.test == TestKind::Systematic && g.direction == Some(direction) && g.returns > 0;
        groups.iter().any(returned)
    };
    let both = Direction::BOTH.into_iter().all(has);
    let tracked = logs.iter().filter(on_the_way).count() > 0;
    let open = path.is_some_and(|path| {
        let end = path.end(Direction::Ccw);
        libm::hypot(end.x, end.y) > 0.1 * path.length()
    }) && groups.iter().any(|g| g.returns > 0);
    let headings = groups.iter().any(|g| g.headings > 0);
    let repeated = Direction::BOTH.into_iter().all(|d| groups.iter().any(|g| g.direction == Some(d) && g.returns >= 3));
    let bumps = groups.iter().any(|g| g.test == TestKind::Bumps && g.headings > 0);
    vec![
        ratios(both, tracked),
        scale(tracked, open),
        answer(
            "heading form",
            headings && both,
            ["return headings were measured in both directions", "it needs return headings in both directions"],
        ),
        answer(
            "scatter sigma",
            repeated,
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

fn answer(quantity: &'static str, yes: bool, because: [&'static str; 2]) -> Determined {
    Determined { quantity, yes, because: because[usize::from(!yes)] }
}

fn ratios(both: bool, tracked: bool) -> Determined {
    let quantity = "E_d and E_b";
    match (both, tracked) {
        (_, true) => Determined { quantity, yes: true, because: "absolute poses on the way tell turns from legs" },
        (true, false) => Determined { quantity, yes: true, because: "returns of both directions tell them apart" },
        (false, false) => Determined {
            quantity,
            yes: false,
            because: "one direction gives one combination of the two; drive the other direction as well",
        },
    }
}

fn scale(tracked: bool, open: bool) -> Determined {
    let quantity = "E_s";
    match (tracked, open) {
        (true, _) => Determined { quantity, yes: true, because: "absolute poses on the way measure distances" },
        (false, true) => Determined { quantity, yes: true, because: "the path is open: its end measures a distance" },
        (false, false) => Determined {
            quantity,
            yes: false,
            because: "a return to START gives E_b/E_s only; measure the pose at a stop on the way, or a straight",
        },
    }
}
