//! What must be known of an experiment before its errors can be attributed to the robot.
//!
//! Which column is which wheel and how it counts; how the headings of the reference are counted; the delay of its time stamps and the rate
//! of its clock; where on the robot the tracked body sits; which poses are wrong and where the track jumps. All of it follows from the
//! motion alone, robustly and in all runs at once, before any model is fitted:
//!
//! 1. the delay at which the sizes of both motions correlate best (`clock`);
//! 2. the reading of columns and headings under which both motions agree (`agreement`), with robust weights for the windows;
//! 3. delay and rate of the clock run by run, and everything else again with these;
//! 4. wrong poses and jumps, found together (`disturbances`), beside a delay or a filter of the reference (`smoothed`), and jumps that last
//!    (`stretches`).
//!
//! Where the clocks of the runs differ, a fit begins with each run laid on its own (`own_clocks`).
//!
//! Return errors are examined separately (`returns`): runs far from the others, and columns in another unit.

mod agreement;
mod by_positions;
mod cheapest;
mod clock;
mod copies;
mod counts_factor;
mod differing;
mod disturbances;
mod edges;
mod faults;
mod increments;
mod low_pass;
mod misread;
mod notices;
mod one_counter;
mod one_way;
mod one_wheel;
mod own_clocks;
mod returns;
mod shared;
mod sightings;
mod smoothed;
mod stretches;
mod suspicion;
mod windows;

use crate::drive::Robot;
use crate::effect::TestKind;
use crate::geometry::wrap;
use crate::path::Path;
use crate::run::resolution::hidden;
use crate::run::{Run, TickLog};
use crate::stats::Measured;
use crate::stats::robust;
use agreement::{Agreement, Beside, Reading};
use clock::Late;
use disturbances::Found;
use sightings::unrecorded;
use windows::{Rolled, Window, usual_step, windows};

pub use counts_factor::CountsFactor;
pub use faults::Fault;
pub use misread::{Misread, Written};
pub use notices::TOLD;
pub use one_wheel::Column;
pub use returns::{Coordinate, Deviant, OutlyingReturn, Returned};
pub use suspicion::Suspicion;

/// Number of rounds; each fits the clocks to the agreement of all runs, and then the agreement with these clocks.
const ROUNDS: usize = 3;
/// Minimum number of windows in all runs together.
const FEWEST: usize = 20;
/// Number of parts of the data whose scatter gives the standard errors.
const PARTS: usize = 8;

/// How the measured poses relate to the wheels, over all runs.
///
/// ```text
/// taken = stamp - (delay + rate (t - middle)),   t the time of the stamp since the run began
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Age of a pose at its time stamp, in the middle of a run \[s\].
    pub delay: Measured,
    /// Time from the beginning of a run to its middle, on average \[s\].
    pub middle: f64,
    /// Change of the delay per second \[s/s\]; `None` where the runs are too short.
    pub rate: Option<Measured>,
    /// Where the tracked point lies ahead of the centre of the axle \[m\]; `None` if rotations or headings do not determine it.
    pub ahead: Option<Measured>,
    /// Where it lies to the left \[m\].
    pub left: Option<Measured>,
    /// Heading of the tracked body less that of the robot \[rad\]; `None` if driving or headings do not determine it.
    pub yaw: Option<Measured>,
    /// Way by the reference over way by the wheels; `None` where nothing is driven.
    pub scale: Option<Measured>,
    /// Turns by the reference over turns by the wheels; `None` where nothing is turned.
    pub gain: Option<Measured>,
    /// Turning by the reference for each metre ahead \[rad/m\]; `None` where nothing is driven.
    pub drift: Option<Measured>,
    /// Whether the runs turn; if not, exchanged wheels and a mirrored reference look like right ones.
    pub turns: bool,
}

/// What runs cannot show that do not turn.
pub const SIDES: &str = "the runs do not turn, so exchanged wheels and a mirrored reference would look the same";

/// A pose that is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongPose {
    /// Its place among the poses of its log.
    pub pose: usize,
    /// Time since the log began \[s\].
    pub time: f64,
    /// Distance from the place that its neighbours imply \[m\].
    pub moved: f64,
    /// The same \[rad\]; `None` without headings.
    pub turned: Option<f64>,
}

/// A place where a track jumps, or a few seconds in which robot and wheels disagree: a wheel slipped, the robot was pushed or carried, or
/// the reference lost it.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// The last pose before it, by its place among the poses of its log; what lies between is left out.
    pub from: usize,
    /// The first behind it.
    pub pose: usize,
    /// Time of the former since the log began \[s\].
    pub since: f64,
    /// Time of the latter \[s\].
    pub time: f64,
    /// Motion of the tracked point that the wheels did not make \[m\].
    pub moved: f64,
    /// Rotation that the wheels did not make \[rad\]; `None` without headings.
    pub turned: Option<f64>,
    /// In standard deviations of the motion from pose to pose.
    pub deviations: f64,
    /// How long its log has no rows within it \[s\], where that is longer than usual: the way of the wheels is not known then.
    pub unrecorded: Option<f64>,
}

/// What was found of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSetup {
    /// The run's name.
    pub run: String,
    /// Number of its poses.
    pub poses: usize,
    /// Age of a pose at its time stamp, in the middle of this run \[s\]; `None` if the motion does not determine it.
    pub delay: Option<Measured>,
    /// By how much its time stamps were set back, because the clocks of the runs differ \[s\]; else 0. `delay` is what was left then.
    pub own_clock: f64,
    /// Those that are wrong.
    pub wrong: Vec<WrongPose>,
    /// Where it jumps.
    pub jumps: Vec<Jump>,
    /// Whether its reference tells motion only: then a jump is a step that is wrong, and only this step is lost.
    pub relative: bool,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// Columns that contradict their names: the robot is not judged until these are corrected.
    pub faults: Vec<Fault>,
    /// How the poses relate to the wheels; `None` if they are too few or too far apart.
    pub mounting: Option<Mounting>,
    /// The runs of the regular test that have poses, in the order of the dataset.
    pub runs: Vec<RunSetup>,
    /// Noise of a single pose, each coordinate \[m\] and the heading \[rad\], from the differences of successive poses; usual sizes if
    /// these do not show it.
    pub noise: PoseNoise,
    /// What the return errors of all runs, also those with bumps, show by themselves.
    pub returned: Returned,
    /// What makes the ticks, or the tracks as a whole, suspicious.
    pub doubts: Vec<Suspicion>,
}

/// Noise of a single pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNoise {
    /// Each coordinate \[m\].
    pub position: f64,
    /// \[rad\]
    pub heading: f64,
}

impl Default for PoseNoise {
    /// That of motion capture.
    fn default() -> Self {
        PoseNoise { position: 5e-4, heading: 5e-4 }
    }
}

/// A run with its windows.
struct Seen<'a> {
    run: &'a Run,
    log: &'a TickLog,
    rolled: Rolled<'a>,
    windows: Vec<Window>,
    late: Late,
}

impl Setup {
    /// Examines all runs of the regular test that have ticks and poses, and the return errors of all runs. `path`: the commanded path, if
    /// it is known.
    pub fn of(runs: &[Run], robot: &Robot, path: Option<&Path>) -> Setup {
        let mut setup = Setup::of_tracks(runs, robot);
        setup.faults.extend(copies::found(runs));
        // Return errors follow from the tracks and have the same faults.
        if setup.is_sound() {
            setup.returned = Returned::of(runs, robot, path);
        }
        if setup.is_sound() && setup.returned.faults.is_empty() && setup.outlying().next().is_none() {
            setup.doubts.extend(path.and_then(|path| Misread::of(runs, robot, path)).map(Suspicion::Misread));
        }
        if setup.is_sound() && setup.mounting.is_none() {
            setup.doubts.extend(path.and_then(|path| counts_factor::by_path(runs, robot, path)));
        }
        setup
    }

    /// The same of the tracks alone, without what return errors show.
    pub(crate) fn of_tracks(runs: &[Run], robot: &Robot) -> Setup {
        let wheelbase = robot.drive.wheelbase();
        let regular = runs.iter().filter(|run| run.test == TestKind::Systematic);
        let with_poses =
            regular.filter_map(|run| run.log.as_ref().filter(|log| !log.reference.is_empty()).map(|log| (run, log)));
        let mut seen: Vec<Seen> = with_poses
            .map(|(run, log)| {
                let (rolled, windows) = (Rolled::new(log, robot), windows(log));
                let late = clock::guess(&windows, &rolled, wheelbase);
                Seen { run, log, rolled, windows, late }
            })
            .collect();
        let named = |seen: &Seen| RunSetup {
            run: seen.run.name.clone(),
            poses: seen.log.reference.len(),
            relative: seen.log.relative,
            ..RunSetup::default()
        };
        if seen.iter().map(|seen| seen.windows.len()).sum::<usize>() < FEWEST {
            return Setup { runs: seen.iter().map(named).collect(), ..Setup::default() };
        }
        let standing = standing(&seen).or_else(|| {
            let alone = |seen: &Seen| clock::beside(&seen.windows, &seen.rolled, &seen.late);
            one_way::counted_up(&seen.iter().map(|seen| (seen.log, alone(seen))).collect::<Vec<_>>(), robot)
        });
        if let Some(fault) = standing {
            let fault = increments::found(&seen, robot).unwrap_or(fault);
            return Setup { faults: vec![fault], runs: seen.iter().map(named).collect(), ..Setup::default() };
        }
        let pooled = |seen: &[Seen]| -> Vec<Beside> {
            seen.iter().flat_map(|seen| clock::beside(&seen.windows, &seen.rolled, &seen.late)).collect()
        };
        let all = pooled(&seen);
        let (faults, reading) = faults::look(&all, robot);
        let given = Agreement::without_drift(&all, reading, wheelbase);
        let disagrees = (0..2).any(|k| given.shown[k] && given.misfits[k] > faults::DOUBTFUL);
        let of_columns = || {
            let counter = if disagrees { one_counter::found(&seen, robot) } else { None };
            counter.or_else(|| one_wheel::found(&seen, robot))
        };
        if Fault::heading_factor(&faults) == 1.0
            && let Some(fault) = of_columns()
        {
            return Setup { faults: vec![fault], runs: seen.iter().map(named).collect(), ..Setup::default() };
        }
        let alone = |seen: &Seen| clock::beside(&seen.windows, &seen.rolled, &seen.late);
        let by_run: Vec<(&str, Vec<Beside>)> = seen.iter().map(|seen| (seen.run.name.as_str(), alone(seen))).collect();
        let mut faults = differing::faults(&by_run, (&faults, reading), robot).unwrap_or(faults);
        if faults.iter().any(|fault| matches!(fault, Fault::OtherMotion { .. })) {
            faults = increments::found(&seen, robot).map_or(faults, |fault| vec![fault]);
        }
        if faults == [Fault::PositionsExchanged] {
            faults.extend(faults::sizes(&Agreement::without_drift(&pooled(&seen), reading, wheelbase), robot));
        }
        if !faults.is_empty() {
            return Setup { faults, runs: seen.iter().map(named).collect(), ..Setup::default() };
        }
        let courses = !has_headings(&seen);
        let agreed = |windows: &[Beside]| agreed(windows, reading, wheelbase, courses);
        let mut agreement = agreed(&pooled(&seen));
        for _ in 0..ROUNDS {
            for seen in &mut seen {
                seen.late = clock::refined(&seen.windows, &seen.rolled, &seen.late, (&agreement, reading, wheelbase));
            }
            agreement = agreed(&pooled(&seen));
        }
        let mounting = mounting(&seen, &agreement, agreed);
        let faults = faults::sizes(&agreement, robot);
        if !faults.is_empty() {
            return Setup { faults, runs: seen.iter().map(named).collect(), ..Setup::default() };
        }
        if !agreement.is_credible() {
            let vague = Suspicion::LittleAgreement { misfit: agreement.misfit };
            let doubts = agreement.is_vague().then_some(vague).into_iter().collect();
            return Setup { runs: seen.iter().map(named).collect(), doubts, ..Setup::default() };
        }
        let doubled = CountsFactor::of(&agreement, robot).filter(CountsFactor::is_double);
        let scene = (robot, &agreement, reading);
        let (found, noise) = smoothed::search(&seen, scene, agreed, mounting.delay.value);
        let runs = seen.iter().zip(found).map(|(seen, found)| RunSetup { ..told(named(seen), seen, found) }).collect();
        let sizes = other_turns(&seen, &agreement).or_else(|| unequal_wheels(robot, &mounting));
        let doubts = doubled.map(Suspicion::Doubled).into_iter().chain(sizes).collect();
        Setup { faults, mounting: Some(mounting), runs, noise, doubts, returned: Returned::default() }
    }

    /// Whether the tracks are free of faults, so that the robot can be judged.
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }

    /// All faults, of the tracks and of the return errors.
    pub fn all_faults(&self) -> impl Iterator<Item = &Fault> {
        self.faults.iter().chain(&self.returned.faults)
    }

    /// Regular runs whose return error is far from the others.
    pub fn outlying(&self) -> impl Iterator<Item = &OutlyingReturn> {
        self.returned.outlying.iter().filter(|run| run.test == TestKind::Systematic)
    }

    /// Reasons to doubt the return errors of the regular runs: outlying ones, and jumps of the tracks that end in them.
    pub(crate) fn suspicions(&self, runs: &[Run]) -> Vec<Suspicion> {
        let returned = |name: &str| runs.iter().any(|run| run.name == name && run.returned.is_some());
        let jumps = self.runs.iter().filter(|run| returned(&run.run));
        let jumped = jumps.filter_map(|run| {
            let (run, jump) = (run.run.clone(), run.jumps.first()?.clone());
            Some(Suspicion::JumpBeforeReturn { run, jump })
        });
        let of_returns = self.outlying().cloned().map(Suspicion::OutlyingReturn).chain(jumped);
        self.doubts.iter().cloned().chain(of_returns).collect()
    }

    /// Reasons to doubt the tracks of the regular runs.
    pub(crate) fn suspicions_of_tracks(&self, robot: &Robot) -> Vec<Suspicion> {
        self.doubts.iter().cloned().chain(self.tail_first(robot)).chain(self.many_jumps()).collect()
    }

    /// The suspicion that too many poses jump or are wrong for an accident.
    fn many_jumps(&self) -> Option<Suspicion> {
        let poses: usize = self.runs.iter().map(|run| run.poses).sum();
        let lost = |run: &RunSetup| run.jumps.len() + (0..run.poses).filter(|pose| run.is_lost(*pose)).count();
        let count = self.runs.iter().map(lost).sum();
        (count as f64 > ACCIDENTS * poses as f64).then_some(Suspicion::ManyJumps { count, poses })
    }

    /// The suspicion that the tracked body faces backward, or that the wheels are exchanged and both count backward: both cause the same
    /// motion.
    pub(crate) fn tail_first(&self, robot: &Robot) -> Option<Suspicion> {
        let yaw = self.mounting?.yaw?.value;
        let half = robot.drive.kind().has_axle_wheels() && wrap(yaw - std::f64::consts::PI).abs() < HALF_TURN;
        half.then_some(Suspicion::TailFirst { yaw })
    }

    /// What was found of a run.
    pub fn of_run(&self, name: &str) -> Option<&RunSetup> {
        self.runs.iter().find(|run| run.run == name)
    }

    /// Number of jumps in all runs, and of wrong poses.
    pub fn disturbances(&self) -> [usize; 2] {
        let count = |of: fn(&RunSetup) -> usize| self.runs.iter().map(of).sum();
        [count(|run| run.jumps.len()), count(|run| run.wrong.len())]
    }

    /// Jumps at which a track starts anew: those of references that tell more than motion.
    pub fn jumps(&self) -> impl Iterator<Item = (&RunSetup, &Jump)> + Clone {
        let absolute = self.runs.iter().filter(|run| !run.relative);
        absolute.flat_map(|run| run.jumps.iter().map(move |jump| (run, jump)))
    }
}

/// Distance from the beginning of a run at which the reference surely moves \[m\]. Wheels stand that roll less than this in a run \[m\], and
/// less than this share of that distance.
const MOVES: f64 = 0.3;
const STANDS: (f64, f64) = (0.1, 0.01);
/// A heading within this of half a turn is that of a body that faces backward \[rad\].
const HALF_TURN: f64 = 0.05;
/// Turns by headings alone that are so many times those by the wheels, or the inverse, are not those of a wheelbase that was mismeasured.
const OTHER_TURNS: f64 = 1.3;
/// Wheels of one robot do not differ by this factor, or the inverse, from what its maker says.
const OTHER_WHEELS: f64 = 1.5;
/// Standard errors beyond which it is no chance.
const SURELY: f64 = 4.0;
/// If more than this share of all poses jump or are wrong, these are no accidents.
const ACCIDENTS: f64 = 0.1;

impl Jump {
    /// Whether a pose is within it.
    pub(crate) fn holds(&self, pose: usize) -> bool {
        self.from < pose && pose < self.pose
    }
}

impl RunSetup {
    /// Whether a pose is wrong or within a jump.
    pub(crate) fn is_lost(&self, pose: usize) -> bool {
        self.wrong.iter().any(|wrong| wrong.pose == pose) || self.jumps.iter().any(|jump| jump.holds(pose))
    }
}

/// The fault that the wheels stand while the reference moves: in most runs it comes far from where it began, and in none do they roll.
fn standing(seen: &[Seen]) -> Option<Fault> {
    let mut rolled = 0.0;
    let mut ways = Vec::new();
    for seen in seen.iter().filter(|seen| !seen.windows.is_empty()) {
        let windows = seen.windows.iter().map(|window| seen.rolled.between(window.from, window.to));
        let most = windows.map(|rolling| rolling.travel[0].abs().max(rolling.travel[1].abs()).max(rolling.aside.abs()));
        // Windows overlap by half.
        rolled += 0.5 * most.sum::<f64>();
        let first = &seen.log.reference[0];
        let from_first = seen.log.reference.iter().map(|pose| libm::hypot(pose.x - first.x, pose.y - first.y));
        // Farther away than one pose in ten: a few wrong poses do not count.
        ways.push(robust::quantile(from_first, 0.9));
    }
    let each = rolled / ways.len().max(1) as f64;
    let moved = robust::median(ways.into_iter());
    (moved > MOVES && each < STANDS.0.min(STANDS.1 * moved)).then_some(Fault::Standing { rolled, moved })
}

/// The findings of a run with times.
fn told(mut run: RunSetup, seen: &Seen, found: Found) -> RunSetup {
    let time = |pose: usize| seen.log.time[seen.log.reference[pose].sample] - seen.log.time[0];
    let wrong =
        |w: disturbances::Wrong| WrongPose { pose: w.pose, time: time(w.pose), moved: w.moved, turned: w.turned };
    run.wrong = found.wrong.into_iter().map(wrong).collect();
    let sample = |pose: usize| seen.log.reference[pose].sample;
    let usual = usual_step(&seen.log.time);
    let jump = |leap: disturbances::Leap| Jump {
        from: leap.from,
        pose: leap.pose,
        since: time(leap.from),
        time: time(leap.pose),
        moved: leap.moved,
        turned: leap.turned,
        deviations: leap.deviations,
        unrecorded: unrecorded(&seen.log.time[sample(leap.from)..=sample(leap.pose)], usual),
    };
    run.jumps = found.jumps.into_iter().map(jump).collect();
    run.delay = seen.late.measured();
    run
}

/// Variances of a pose \[m², rad²\] that whole counts make; those of the run where they are largest.
fn counted(seen: &[Seen], wheelbase: f64) -> [f64; 2] {
    let of_runs = seen.iter().map(|seen| hidden(seen.rolled.counts, [1.0; 2], wheelbase));
    of_runs.fold([0.0; 2], |most, of_run| [0, 1].map(|k| f64::max(most[k], of_run[k])))
}

/// Whether every pose of every run has a heading.
fn has_headings(seen: &[Seen]) -> bool {
    seen.iter().all(|seen| seen.log.reference.iter().all(|pose| pose.heading.is_some()))
}

/// The agreement of some windows. Positions alone show no turn on the spot: where their courses turn by chance only, they determine distances
/// and the clock, and turns are taken from the wheels.
fn agreed(windows: &[Beside], reading: Reading, wheelbase: f64, courses: bool) -> Agreement {
    let agreement = Agreement::of(windows, reading, wheelbase);
    if courses && agreement.shown[0] && !agreement.turns_are_credible() {
        return Agreement { turn: [1.0, 0.0], shown: [true, false], ..agreement };
    }
    agreement
}

/// The suspicion that the robot's sizes are far off, where nothing but headings could show it.
fn other_turns(seen: &[Seen], agreement: &Agreement) -> Option<Suspicion> {
    let ratio = agreement.turn[0];
    let headings_only = seen.iter().all(|seen| seen.log.headings_only);
    let within = (1.0 / OTHER_TURNS..=OTHER_TURNS).contains(&ratio);
    (headings_only && agreement.shown[1] && !within).then_some(Suspicion::OtherTurns { ratio })
}

/// The suspicion that the wheels are counted differently: E_d by the rotation that goes with the way, far from 1 by more than chance. On arcs
/// of one curvature it is not told from E_b, and its parts scatter.
fn unequal_wheels(robot: &Robot, mounting: &Mounting) -> Option<Suspicion> {
    let (gain, drift) = mounting.gain.zip(mounting.drift)?;
    let ratio = |turns: f64, by_way: f64| {
        // The wheels' way differs by 2 q of its mean; E_b cancels.
        let q = 0.5 * by_way * robot.drive.wheelbase() / turns;
        (1.0 + q) / (1.0 - q)
    };
    let ends = |of: Measured| [-SURELY, SURELY].map(|times| of.value + times * of.std_error);
    let corners = ends(gain).map(|turns| ends(drift).map(|by_way| ratio(turns, by_way)));
    let all = |is: &dyn Fn(f64) -> bool| corners.iter().flatten().all(|corner| *corner > 0.0 && is(*corner));
    let beyond = all(&|corner| corner > OTHER_WHEELS) || all(&|corner| corner < 1.0 / OTHER_WHEELS);
    let told = robot.drive.kind().has_axle_wheels() && beyond;
    told.then(|| Suspicion::UnequalWheels { ratio: ratio(gain.value, drift.value) })
}

/// The values on which all runs agree, each with the scatter between parts of the data.
fn mounting(seen: &[Seen], agreement: &Agreement, agreed: impl Fn(&[Beside]) -> Agreement) -> Mounting {
    let with_heading = has_headings(seen);
    let with_position = !seen.iter().any(|seen| seen.log.headings_only);
    let parts = parts(seen, agreed);
    let [way, turns] = agreement.shown;
    let by_parts = |is_shown: bool, value: f64, of: &dyn Fn(&Agreement) -> f64| {
        let others: Vec<f64> =
            parts.iter().filter(|part| part.shown[0] == way && part.shown[1] == turns).map(of).collect();
        let n = others.len() as f64;
        let square = others.iter().map(|other| (other - value).powi(2)).sum::<f64>() / (n * (n - 1.0));
        (is_shown && others.len() > 2).then(|| Measured::of_parts(value, square.sqrt(), others.len()))
    };
    let both = with_heading && with_position;
    let lever = |k: usize| by_parts(turns && both, agreement.lever_on_robot()[k], &|part| part.lever_on_robot()[k]);
    let yaw = agreement.yaw();
    Mounting {
        middle: seen.iter().map(|seen| seen.late.middle - seen.log.time[0]).sum::<f64>() / seen.len().max(1) as f64,
        delay: of_runs(seen, |late| (late.delay, late.covariance[0])).unwrap_or(Measured::of_parts(
            0.0,
            f64::INFINITY,
            2,
        )),
        rate: of_runs(seen, |late| (late.rate, late.covariance[2])),
        ahead: lever(0),
        left: lever(1),
        yaw: by_parts(way && both, yaw, &|part| yaw + wrap(part.yaw() - yaw)),
        scale: by_parts(way && with_position, agreement.scale(), &Agreement::scale),
        gain: by_parts(turns, agreement.turn[0], &|part| part.turn[0]),
        drift: by_parts(way, agreement.turn[1], &|part| part.turn[1]),
        turns,
    }
}

/// A value of the clocks of all runs: their weighted mean, with a standard error from the scatter of the runs.
fn of_runs(seen: &[Seen], of: impl Fn(&Late) -> (f64, f64)) -> Option<Measured> {
    let values: Vec<(f64, f64)> =
        seen.iter().map(|seen| of(&seen.late)).filter(|(_, variance)| *variance > 0.0).collect();
    let n = values.len() as f64;
    let middle = robust::median(values.iter().map(|(value, _)| *value));
    // Neighbouring windows overlap by half.
    let own = 2.0 * robust::median(values.iter().map(|(_, variance)| *variance));
    let between = (robust::DEVIATION * robust::median(values.iter().map(|(value, _)| (value - middle).abs()))).powi(2);
    let weight = |variance: f64| 1.0 / (2.0 * variance + between);
    let near =
        values.iter().filter(|(value, variance)| (value - middle).powi(2) <= 25.0 * (2.0 * variance + between) + 1e-12);
    let (sum, weights) =
        near.fold((0.0, 0.0), |(s, w), (value, variance)| (s + weight(*variance) * value, w + weight(*variance)));
    (weights > 0.0).then(|| Measured::of_parts(sum / weights, (own.max(between) / n).sqrt(), values.len().max(PARTS)))
}

/// The agreement in parts of the data: whole runs if there are enough of them, otherwise sections of runs.
fn parts(seen: &[Seen], agreed: impl Fn(&[Beside]) -> Agreement) -> Vec<Agreement> {
    let cut = PARTS.div_ceil(seen.len().max(1));
    let of = |seen: &Seen| {
        let beside = clock::beside(&seen.windows, &seen.rolled, &seen.late);
        let length = beside.len().div_ceil(cut).max(FEWEST);
        beside.chunks(length).filter(|part| part.len() >= FEWEST).map(&agreed).collect::<Vec<_>>()
    };
    seen.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests;
