//! Other tests with the same robot: side, speed, one direction only, bumps.

use super::intervals::{drawn, intervals};
use super::{Options, PlanError, Planned, Setting, Sought};
use crate::dataset::ReturnError;
use crate::effect::{Model, TestKind};
use crate::path::{Direction, Path, SpeedProfile};
use crate::random::Stream;
use crate::score::{Convention, Extended};
use crate::simulate::{Odometry, Phase, Simulator, Truth};
use nalgebra::Matrix3;

/// Simulated tests that an expected interval is taken from.
const TESTS: u32 = 1000;
/// Purpose of the stream that runs with bumps are drawn from.
const EXTENDED: u64 = 15;

/// A test that could be driven instead.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// In words.
    pub what: String,
    /// Runs clockwise and counter-clockwise.
    pub runs: [usize; 2],
    /// How long it takes \[min\].
    pub minutes: f64,
    /// σ \[m\].
    pub sigma: f64,
    /// Mean of half the width of the interval of E_max,sys \[m\]; `None` where the test has no E_max,sys.
    pub half_width: Option<f64>,
    /// For each size that was sought, the least that is seen with the wanted power; `None` where it never is.
    pub least: Vec<Option<f64>>,
}

/// The test itself, then half and twice its size, twice its speed, and as many runs in one direction only.
pub fn alternatives(
    setting: &Setting,
    n: usize,
    sought: &[Sought],
    power: f64,
    options: &Options,
) -> Result<Vec<Alternative>, PlanError> {
    let path = &setting.path;
    let [top, acceleration, pause] = path.speed.values();
    let faster = SpeedProfile::new(2.0 * top, acceleration, pause).ok();
    let paths = [
        ("as planned".to_owned(), Some(path.clone())),
        ("half the size".to_owned(), resized(path, 0.5)),
        ("twice the size".to_owned(), resized(path, 2.0)),
        (format!("at {} m/s", 2.0 * top), faster.and_then(|speed| Path::new(path.shape(), path.values(), speed).ok())),
    ];
    let mut found = Vec::new();
    for (what, path) in paths.into_iter().filter_map(|(what, path)| Some((what, path?))) {
        let other = setting.on(&path)?;
        let planned = Planned::new(&other, n, options)?;
        let expected = intervals(&other, &[n], 1.0 - options.size, TESTS, options.seed);
        found.push(Alternative {
            what,
            runs: [n, n],
            minutes: 2.0 * n as f64 * other.minutes_a_run(),
            sigma: other.sigma(),
            half_width: expected.first().map(|e| e.half_width),
            least: planned.least_of(sought, power),
        });
    }
    found.push(Alternative {
        what: "one direction only".to_owned(),
        runs: [2 * n, 0],
        minutes: 2.0 * n as f64 * setting.minutes_a_run(),
        sigma: setting.sigma(),
        half_width: None,
        least: vec![None; sought.len()],
    });
    Ok(found)
}

/// The same shape with its lengths times a factor; `None` where it has no lengths, or they would leave their bounds.
fn resized(path: &Path, factor: f64) -> Option<Path> {
    let is_length = |index: usize| path.shape().parameters.get(index).is_none_or(|p| p.unit == "m");
    let values: Vec<f64> =
        path.values().iter().enumerate().map(|(i, v)| if is_length(i) { v * factor } else { *v }).collect();
    (values != path.values()).then(|| Path::new(path.shape(), &values, path.speed).ok()).flatten()
}

/// The extended test on top of the regular one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtendedTest {
    /// Bumps on the first leg of each run.
    pub bumps: f64,
    /// Runs with bumps a direction.
    pub runs: usize,
    /// How much longer it takes \[min\].
    pub minutes: f64,
    /// Average absolute orientation error, Eq. (5), mean over simulated tests \[rad\].
    pub orientation: f64,
    /// Mean of half the width of its interval \[rad\].
    pub half_width: f64,
}

/// What n + n runs with bumps would say of the robot's susceptibility, over simulated tests; return errors being normal.
pub fn extended_test(setting: &Setting, n: usize, bumps: f64, options: &Options) -> Result<ExtendedTest, PlanError> {
    let turned = turned_by_bumps(setting, bumps)?;
    let root = setting.covariance.cholesky().map_or(Matrix3::zeros(), |c| c.l());
    let (mut orientations, mut widths) = (0.0, 0.0);
    for test in 0..u64::from(TESTS) {
        let mut stream = Stream::new(options.seed, EXTENDED, test);
        let mut of = |turned: [f64; 2]| {
            Direction::BOTH.map(|direction| {
                let mean = setting.means[direction as usize];
                let heading = mean.heading.map(|heading| heading + turned[direction as usize]);
                drawn(&ReturnError { heading, ..mean }, &root, direction, n, &mut stream)
            })
        };
        let (regular, bumped) = (of([0.0; 2]), of(turned));
        let [regular, bumped] = [&regular, &bumped].map(|runs| runs.each_ref().map(Vec::as_slice));
        if let Some(scored) = Extended::new(bumped, regular, 1.0 - options.size) {
            orientations += scored.orientation(Convention::Mean);
            widths += scored.interval(Convention::Mean).map_or(0.0, |i| 0.5 * (i.high - i.low));
        }
    }
    let count = f64::from(TESTS);
    Ok(ExtendedTest {
        bumps,
        runs: n,
        minutes: 2.0 * n as f64 * setting.minutes_a_run(),
        orientation: orientations / count,
        half_width: widths / count,
    })
}

/// Return heading that the bumps alone bring about \[rad\], clockwise and counter-clockwise.
fn turned_by_bumps(setting: &Setting, bumps: f64) -> Result<[f64; 2], PlanError> {
    let robot = setting.robot();
    let mut model = Model::new(robot);
    if let Some(part) = setting.truth.parts().iter().find(|part| part.effect.name() == "placed_bumps") {
        model.add("placed_bumps")?.values.clone_from(&part.values);
    }
    model.set("placed_bumps", "count", bumps)?;
    let mut simulator = Simulator::new(robot, &setting.path, Odometry::Continuous, Phase::Edge)?;
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, 0, 0);
    Ok(Direction::BOTH.map(|d| simulator.run(&mut truth, d, TestKind::Bumps).heading.unwrap_or(0.0)))
}
