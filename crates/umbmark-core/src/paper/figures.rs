//! The paper's figures and remarks, by exact kinematics.

use schemars::JsonSchema;
use serde::Serialize;

use super::{PaperError, Returns, preset};
use crate::drive::{Robot, Wheel};
use crate::effect::{Bump, Model, Stretch, TestKind, extra_travel};
use crate::geometry::Pose2;
use crate::path::{Direction, FIGURE_EIGHT, Path, RECTANGLE, SpeedProfile};
use crate::replay::Track;
use crate::simulate::{Course, Odometry, Phase, Simulator, Truth};

/// The heading error of each corner or leg in the paper's Fig. 2 \[deg\].
const PER_SIDE: f64 = 3.0;

/// What a robot returns with, either way.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BothWays {
    /// What is tried.
    pub what: &'static str,
    /// Its return errors.
    #[serde(flatten)]
    pub returns: Returns,
}

/// Figs. 2 to 4: two errors that cancel in one direction and add up in the other.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Masking {
    /// E_d of the robot.
    pub e_d: f64,
    /// E_b of the robot.
    pub e_b: f64,
    /// One error, the other, both.
    pub rows: Vec<BothWays>,
}

/// Section 3.1: what a figure-eight shows of E_d and E_b.
pub type Hidden = Vec<BothWays>;

/// Section 4.5: the 4 x 4 m square and the 7 x 4 m rectangle.
pub type Rectangle = Vec<BothWays>;

/// Fig. 5: the return positions of one direction.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cluster {
    /// Its name.
    pub direction: &'static str,
    /// x and y of each run, in m.
    pub returns_m: Vec<[f64; 2]>,
    /// Their centre of gravity, in m.
    pub centre_m: [f64; 2],
    /// Its distance from START, in m.
    pub r_m: f64,
}

/// Fig. 6: where ten bumps lie on the first leg.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BumpPlace {
    /// Where.
    pub bumps: &'static str,
    /// Distance from START after the run, in m.
    pub return_position_m: f64,
    /// Heading after the run, in rad.
    pub return_heading_rad: f64,
}

fn labmate(e_d: f64, e_b: f64) -> Result<Model, PaperError> {
    let mut model = Model::new(&Robot::labmate());
    model.set("wheel_diameter_ratio", "e_d", e_d)?;
    model.set("wheelbase", "e_b", e_b)?;
    Ok(model)
}

fn both_ways(what: &'static str, model: &Model, path: &Path) -> BothWays {
    let returned = |direction| {
        let end = Track::from_path(path, direction, model.robot()).end(&model.chain());
        let told = path.end(direction);
        [end.x - told.x, end.y - told.y, end.heading - told.heading]
    };
    BothWays { what, returns: Returns { ccw: returned(Direction::Ccw), cw: returned(Direction::Cw) } }
}

/// Figs. 2 to 4: corners of 87 degrees, legs bent by 3.1 degrees, and both.
pub fn masking() -> Result<Masking, PaperError> {
    let path = Path::umbmark();
    let e_b = 90.0 / (90.0 - PER_SIDE);
    // A leg of 4 m turns to the left by 3 degrees on the true wheelbase.
    let turn = PER_SIDE.to_radians() * 0.340 * e_b / 4.0;
    let e_d = (1.0 + 0.5 * turn) / (1.0 - 0.5 * turn);
    let rows = [
        ("E_b alone: corners of 87 deg", 1.0, e_b),
        ("E_d alone: legs bent by 3.1 deg", e_d, 1.0),
        ("both: hidden in ccw, plain in cw", e_d, e_b),
    ];
    let rows = rows.into_iter().map(|(what, d, b)| Ok(both_ways(what, &labmate(d, b)?, &path)));
    Ok(Masking { e_d, e_b, rows: rows.collect::<Result<_, PaperError>>()? })
}

/// Fig. 5: one test of the uncalibrated LabMate.
pub fn clusters(seed: u64) -> Result<Vec<Cluster>, PaperError> {
    let preset = preset("trc-labmate-nocal")?;
    let model = preset.model()?;
    let mut simulator = Simulator::new(model.robot(), &preset.path(), Odometry::EveryTick, Phase::Random)?;
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, seed, 0);
    let cluster = |direction: Direction| {
        let runs = (0..5).map(|_| simulator.run(&mut truth, direction, TestKind::Systematic));
        let returns_m: Vec<[f64; 2]> = runs.map(|error| [error.x, error.y]).collect();
        let centre_m = [0, 1].map(|i| returns_m.iter().map(|run| run[i]).sum::<f64>() / 5.0);
        Cluster { direction: direction.name(), returns_m, centre_m, r_m: centre_m[0].hypot(centre_m[1]) }
    };
    Ok(Direction::BOTH.map(cluster).into())
}

/// Fig. 6: ten bumps at the beginning of the first leg, all along it, and at its end.
pub fn bump_places() -> Result<Vec<BumpPlace>, PaperError> {
    let model = Model::new(&Robot::labmate());
    let lost = extra_travel(0.010, 0.075, true);
    let places = [
        ("path A: in the first tenth", 0.0, 0.1),
        ("evenly, as the test prescribes", 0.0, 1.0),
        ("path B: in the last tenth", 0.9, 1.0),
    ];
    let place = |(bumps, from, to): (&'static str, f64, f64)| {
        let end = with_bumps(&model, |i| from + (to - from) * (i as f64 + 0.5) / 10.0, lost)?;
        let (return_position_m, return_heading_rad) = (end.x.hypot(end.y), end.heading - std::f64::consts::TAU);
        Ok(BumpPlace { bumps, return_position_m, return_heading_rad })
    };
    places.into_iter().map(place).collect()
}

/// The end of a ccw run with ten bumps under the left wheel at places of the first leg.
fn with_bumps(model: &Model, place: impl Fn(usize) -> f64, lost: f64) -> Result<Pose2, PaperError> {
    let mut truth = Truth::new(model);
    truth.start(Direction::Ccw);
    let course = Course::new(model.robot(), &Path::umbmark(), Direction::Ccw)?;
    for (index, leg) in course.legs.iter().enumerate() {
        let stretch =
            Stretch { index, direction: Direction::Ccw, test: TestKind::Systematic, travel: leg.travel, left: 0.0 };
        truth.begin(stretch, leg);
        for bump in (0..10).filter(|_| index == 0) {
            truth.place(Bump { at: place(bump), wheel: Wheel::Left, lost });
        }
        truth.advance(1.0);
    }
    Ok(truth.pose())
}

/// What a figure-eight of two circles of 2 m shows of E_d and E_b.
pub fn figure_eight() -> Result<Hidden, PaperError> {
    let path = Path::new(&FIGURE_EIGHT, &[2.0], SpeedProfile::default())?;
    let rows = [("E_d = 1.001", 1.001, 1.0), ("E_b = 1.001", 1.0, 1.001)];
    rows.into_iter().map(|(what, d, b)| Ok(both_ways(what, &labmate(d, b)?, &path))).collect()
}

/// The uncalibrated LabMate on the 4 x 4 m square and on the 7 x 4 m rectangle.
pub fn rectangle() -> Result<Rectangle, PaperError> {
    let model = preset("trc-labmate-nocal")?.model()?;
    let rectangle = Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::default())?;
    let paths = [("4 x 4 m", Path::umbmark()), ("7 x 4 m", rectangle)];
    Ok(paths.iter().map(|(what, path)| both_ways(what, &model, path)).collect())
}
