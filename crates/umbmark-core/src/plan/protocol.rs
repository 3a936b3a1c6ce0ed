//! What the experimenter does, step by step, and the table to be filled in.
//!
//! The procedure is that of section 3.4 of Borenstein & Feng (1995), for the robot's own path and in an order of runs that
//! keeps a drift of the session out of the estimates.

use super::{Order, Setting};
use crate::action::{Action, Wording};
use crate::dataset::RETURNS_COLUMNS;
use crate::effect::TestKind;
use crate::geometry::{Displacement2, Pose2};
use crate::path::{Direction, Move, Path};

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProtocolRun {
    /// With bumps, or without.
    pub test: TestKind,
    /// The sense in which the path is driven.
    pub direction: Direction,
    /// Number of the run among those of its test and direction, from 1.
    pub number: usize,
}

/// The sheet that goes to the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Protocol {
    /// The robot's name.
    pub robot: String,
    /// What is driven, how often and how long, in a sentence.
    pub summary: String,
    /// What is done, in order.
    pub steps: Vec<String>,
    /// The runs in the order in which they are driven.
    pub runs: Vec<ProtocolRun>,
    /// The columns of the table: those of `returns.csv`.
    pub columns: Vec<&'static str>,
}

impl Protocol {
    /// The sheet of n + n runs, and of as many again over bumps where there are any; what to do with it then is said in the words of an edge.
    ///
    /// ```
    /// use umbmark_core::{action::Action, drive::Robot, effect::Model, path::Path, plan::{Order, Protocol, Setting}};
    /// let mut truth = Model::new(&Robot::labmate());
    /// truth.set("wheel_noise", "k_sqrt_m", 1e-3)?;
    /// let sheet = Protocol::new(&Setting::new(&Path::umbmark(), &truth, 1)?, 5, Order::Mirrored, 0.0, Action::plain);
    /// assert_eq!((sheet.runs.len(), sheet.columns[0], sheet.columns.len()), (10, "direction", 8));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(setting: &Setting, n: usize, order: Order, bumps: f64, words: Wording) -> Protocol {
        let tests: &[TestKind] =
            if bumps > 0.0 { &[TestKind::Systematic, TestKind::Bumps] } else { &[TestKind::Systematic] };
        let runs: Vec<ProtocolRun> = tests.iter().flat_map(|test| runs_of(*test, order, n)).collect();
        let mut columns: Vec<&'static str> = RETURNS_COLUMNS.split(',').collect();
        if bumps > 0.0 {
            columns.insert(0, "test");
        }
        if !setting.with_heading {
            columns.retain(|column| !column.starts_with("theta"));
        }
        let minutes = runs.len() as f64 * setting.minutes_a_run();
        let summary = format!(
            "{}: {n} clockwise (cw) and {n} counter-clockwise (ccw) runs{}, about {minutes:.0} minutes.",
            path_in_words(&setting.path),
            if bumps > 0.0 { ", and as many over bumps" } else { "" },
        );
        let robot = setting.robot().name.clone();
        Protocol { robot, summary, steps: steps(setting, order, bumps, words), runs, columns }
    }
}

fn runs_of(test: TestKind, order: Order, n: usize) -> Vec<ProtocolRun> {
    let mut numbers = [0; 2];
    let sequence = order.sequence(n).into_iter();
    let run = |direction: Direction| {
        let number = &mut numbers[direction as usize];
        *number += 1;
        ProtocolRun { test, direction, number: *number }
    };
    sequence.map(run).collect()
}

fn path_in_words(path: &Path) -> String {
    let numbers = path.shape().parameters.iter().zip(path.values());
    let sizes: Vec<String> = numbers
        .map(|(p, value)| {
            format!("{} {value}{}{}", p.name.trim_end_matches("_m"), if p.unit.is_empty() { "" } else { " " }, p.unit)
        })
        .collect();
    let shape = path.shape().name.replace('_', "-");
    let sizes = if sizes.is_empty() { String::new() } else { format!(" ({})", sizes.join(", ")) };
    format!("{shape}{sizes} at {} m/s", path.speed.values()[0])
}

/// The floor that the path takes in both directions, seen from START: least x, greatest x, greatest |y| \[m\].
fn floor(path: &Path) -> [f64; 3] {
    const PIECES: usize = 16;
    let (mut pose, mut reach) = (Pose2::IDENTITY, [0.0_f64; 3]);
    for whole in path.moves(Direction::Ccw).iter().map(Move::displacement) {
        let [forward, sideways, rotation] =
            [whole.forward, whole.sideways, whole.rotation].map(|all| all / PIECES as f64);
        for _ in 0..PIECES {
            pose = pose.moved(&Displacement2 { forward, sideways, rotation });
            reach = [reach[0].min(pose.x), reach[1].max(pose.x), reach[2].max(pose.y.abs())];
        }
    }
    reach
}

fn steps(setting: &Setting, order: Order, bumps: f64, words: Wording) -> Vec<String> {
    let [behind, ahead, beside] = floor(&setting.path);
    let moves = setting.path.moves(Direction::Ccw);
    let on_the_spot = moves.iter().filter(|m| matches!(m, Move::Turn { .. })).count();
    let fixed = setting.path.slides() && moves.iter().all(|m| m.displacement().rotation == 0.0);
    let speed = setting.path.speed.values()[0];
    let back = if behind < -0.05 { format!(", {:.1} m behind", -behind) } else { String::new() };
    let heading = |yes: &str| if setting.with_heading { yes.to_owned() } else { String::new() };
    let mut steps = vec![
        format!(
            "Floor: level, clean and hard, free for {ahead:.1} m ahead of START{back} and {beside:.1} m to either side, and half a \
             metre more all round. Do not change it, the load or the tyre pressure during the session."
        ),
        format!(
            "START: near two walls at right angles, or two tape lines. Mark where the robot's wheels and front stand; x points \
             forward along the robot, y to its left{}. The same START, robot looking the same way, for cw and ccw: then ccw runs \
             lie to its left and cw runs to its right.",
            heading(", theta counter-clockwise")
        ),
        "Before each run put the robot on its marks and set its odometry to 0, 0, 0.".to_owned(),
        format!(
            "Drive the path once by the robot's own odometry, at {speed} m/s or slower{}. It need not end on START: it stops where \
             its odometry puts START.",
            if on_the_spot > 0 {
                format!(", with a stop before and after each of its {on_the_spot} turns on the spot")
            } else if fixed {
                ", with a stop at each corner and without turning".to_owned()
            } else {
                String::new()
            }
        ),
        format!(
            "Measure where the robot really stands, from the walls to two or three points on it: x_abs_m, y_abs_m{}. To 2 mm{}.",
            heading(", theta_abs_rad"),
            heading(" and 0.15 deg")
        ),
        format!(
            "Write down where its odometry says that it stands: x_calc_m, y_calc_m{}.",
            heading(", theta_calc_rad")
        ),
        match order {
            Order::Blocks => "Repeat in the order of the table: all cw, then all ccw. A drift during the session then looks like an \
                              error of the wheelbase or of the wheels; alternate where you can."
                .to_owned(),
            _ => "Repeat in the order of the table. It alternates, so that a drift during the session falls on both directions \
                  alike."
                .to_owned(),
        },
    ];
    if bumps > 0.0 {
        steps.push(format!(
            "Rows with bumps: {bumps:.0} times during the first leg, evenly along it, lay a round cable of 9 to 10 mm across the way \
             of the wheel that faces the inside of the path (right wheel in cw, left wheel in ccw runs), so that only this wheel \
             rolls over it. The heading is what counts: measure it well."
        ));
    }
    steps.push(format!(
        "Type the table into returns.csv ({} writes an empty one), then: {}.",
        words(Action::Begin),
        words(Action::ReadReturns)
    ));
    steps
}
