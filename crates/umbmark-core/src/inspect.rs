//! What a dataset holds, whether it is any good, and what it can determine.
//!
//! [`Dataset::inspect`] measures; nothing here changes or fits anything.

mod contents;
mod determine;
mod log_facts;
mod moves;
mod together;
mod wheels;

use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::geometry::{Pose2, wrap};
use crate::path::{Direction, Path};
use crate::prose::counted;
use crate::reference::{KINDS, Kind};
use crate::run::dead_reckoning::{EndPose, computed_end, return_error};
use crate::run::{Mended, ReturnError, Run};
use crate::setup::{Fault, Mounting, SIDES, Setup};
use crate::stats::Measured;

pub use contents::{LogContents, LogPart, ReferenceFound, WheelUnit, WheelsFound, steps_per_turn, usual_rate};
pub use determine::Determined;
pub use log_facts::{Coverage, LogFacts, ReferenceFacts};
pub use moves::MovesFound;
pub(crate) use moves::{Done, MoveDone, moves_of};
pub use wheels::Wheels;

/// The findings on a dataset.
#[derive(Clone, Debug)]
pub struct Inspection {
    /// Runs of each test and direction.
    pub groups: Vec<Group>,
    /// Each log, in the order of the runs.
    pub logs: Vec<LogFacts>,
    /// What the motion says of columns, clocks, the place of the tracked body, wrong poses and jumps; `None` without a robot.
    pub setup: Option<Setup>,
    /// Each figure with what good looks like.
    pub checks: Vec<Check>,
    /// What the data can say of the robot.
    pub determined: Vec<Determined>,
    /// How many combinations of E_d, E_b and E_s the poses show, of three.
    pub rank: usize,
    /// What the reader noticed and mended; what it noticed in many runs is one sentence.
    pub warnings: Vec<String>,
}

/// The runs of one test and direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The test.
    pub test: TestKind,
    /// Sense of driving.
    pub direction: Option<Direction>,
    /// How many runs.
    pub runs: usize,
    /// How many of them have a return error.
    pub returns: usize,
    /// How many of them have a return heading.
    pub headings: usize,
    /// How many of them have a log.
    pub logs: usize,
}

/// A check: what was found, and what is good.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What was looked at.
    pub name: &'static str,
    /// What was found, with its unit.
    pub found: String,
    /// What would be good.
    pub good: &'static str,
    /// Whether it is good.
    pub ok: bool,
}

impl Dataset {
    /// Looks at everything in the dataset.
    pub fn inspect(&self) -> Inspection {
        let (robot, path) = (self.robot.as_ref(), self.path.as_ref());
        let setup = robot.map(|robot| Setup::of(&self.runs, robot, path));
        let of_log = |run| LogFacts::of(run, robot, path, setup.as_ref());
        let logs: Vec<LogFacts> = self.runs.iter().filter_map(of_log).collect();
        let groups = groups(&self.runs);
        let mut checks = vec![runs_check(&groups)];
        checks.extend(headings_check(&groups));
        checks.extend(log_checks(&logs, path, setup.as_ref().zip(robot)));
        // A robot that is driven onto marks is not watched on the way, and need not be.
        if !logs.is_empty() && self.runs.iter().filter(|run| run.log.is_some()).all(ends_on_marks) {
            checks.retain(|check| check.name != "reference");
        }
        checks.extend(kind_checks(&self.runs));
        checks.extend(gyro_check(&self.runs));
        // Where a track was put into a log, its rows are those of two clocks.
        if !self.clocks.is_empty() {
            checks.retain(|check| check.name != "jitter");
        }
        checks.extend(mended_checks(&logs, self.robot.as_ref()));
        if let Some(robot) = &self.robot {
            checks.extend(sheet_check(&self.runs, robot));
        }
        let (determined, rank) = determine::determine(&groups, &self.runs, robot, path, setup.as_ref());
        Inspection { groups, logs, setup, checks, determined, rank, warnings: together::merged(&self.warnings) }
    }
}

fn groups(runs: &[Run]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for run in runs {
        let same = |group: &Group| (group.test, group.direction) == (run.test, run.direction);
        let place = groups.iter().position(same).unwrap_or_else(|| {
            let (test, direction) = (run.test, run.direction);
            groups.push(Group { test, direction, runs: 0, returns: 0, headings: 0, logs: 0 });
            groups.len() - 1
        });
        let group = &mut groups[place];
        group.runs += 1;
        group.returns += usize::from(run.returned.is_some());
        group.headings += usize::from(run.returned.is_some_and(|error| error.heading.is_some()));
        group.logs += usize::from(run.log.is_some());
    }
    groups
}

fn runs_check(groups: &[Group]) -> Check {
    let count = |direction| {
        let of = groups.iter().filter(|g| g.test == TestKind::Systematic && g.direction == Some(direction));
        of.map(|g| g.runs).sum::<usize>()
    };
    let [cw, ccw] = Direction::BOTH.map(count);
    Check {
        name: "runs",
        found: format!("{cw} cw, {ccw} ccw"),
        good: "5 or more each way; fewer than 3 do not show the scatter",
        ok: cw.min(ccw) >= 5,
    }
}

fn headings_check(groups: &[Group]) -> Option<Check> {
    let (returns, headings) = groups.iter().fold((0, 0), |(r, h), g| (r + g.returns, h + g.headings));
    (returns > 0).then(|| Check {
        name: "return headings",
        found: format!("{headings} of {returns} measured"),
        good: "all: headings give an independent estimate of the same ratios",
        ok: headings == returns,
    })
}

fn worst(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

/// What looks the same as wheels that are named rightly, where the headings of the reference are half a turn off.
const EITHER_WAY: &str = "the tracked headings are half a turn off, and wheels that are exchanged and both count backward would look the same";

fn log_checks(logs: &[LogFacts], path: Option<&Path>, known: Option<(&Setup, &Robot)>) -> Vec<Check> {
    let mut checks = Vec::new();
    let mut add = |name, found: Option<String>, good, ok| {
        checks.extend(found.map(|found| Check { name, found, good, ok }));
    };
    let slowest = logs.iter().map(|log| log.rate).reduce(f64::min);
    add("sampling rate", slowest.map(|r| format!("{r:.1} Hz")), "20 Hz or more", slowest.is_some_and(|r| r >= 19.5));
    let jitter = worst(logs.iter().map(|log| log.jitter));
    let steady = jitter.is_some_and(|j| j <= 0.2);
    add("jitter", jitter.map(|j| format!("{:.0} %", 100.0 * j)), "20 % of the period or less", steady);
    let gap = worst(logs.iter().map(|log| log.longest_gap * log.rate));
    let whole = gap.is_some_and(|g| g <= 5.0);
    let gaps: usize = logs.iter().map(|log| log.gaps).sum();
    add(
        "longest gap",
        gap.map(|g| format!("{g:.1} periods; {gaps} longer than 5")),
        "5 periods or less: no rows are missing",
        whole,
    );
    if let Some(nominal) = path.map(Path::length).filter(|length| *length > 0.0) {
        let off = worst(logs.iter().filter_map(|log| Some((log.length? / nominal - 1.0).abs())));
        let near = off.is_some_and(|off| off <= 0.02);
        add("length by ticks", off.map(|o| format!("{:.1} % off the path", 100.0 * o)), "2 % or less", near);
    }
    let turn = worst(logs.iter().filter_map(|log| log.heading_off).map(f64::abs));
    let round = turn.is_some_and(|turn| turn <= 5f64.to_radians());
    let found = turn.map(|turn| format!("{:.1} deg off the path", turn.to_degrees()));
    add("heading by ticks", found, "5 deg or less: the robot drives by these ticks", round);
    let wheels = logs.iter().filter_map(|log| log.wheels).max_by_key(|wheels| *wheels != Wheels::AsGiven);
    let sound = wheels == Some(Wheels::AsGiven);
    let same = |log: &&LogFacts| log.wheels == wheels;
    let of_these: Vec<&str> = logs.iter().filter(same).map(|log| log.name.as_str()).collect();
    let where_it_is = match of_these.as_slice() {
        these if sound || these.len() == logs.len() => String::new(),
        [first, .., last] => format!(", in {} logs from {first} to {last}", of_these.len()),
        these => format!(", in {}", these.concat()),
    };
    let straight = known.and_then(|(setup, _)| setup.mounting).is_some_and(|mounting| !mounting.turns);
    let half_turn = known.is_some_and(|(setup, robot)| setup.tail_first(robot).is_some());
    let unseen = match sound {
        true if half_turn => format!("; {EITHER_WAY}"),
        true if straight => format!("; {SIDES}"),
        _ => String::new(),
    };
    let found = wheels.map(|wheels| format!("{wheels}{where_it_is}{unseen}"));
    add("wheels", found, "as named, both counting up when driving forward", sound && !half_turn);
    checks.extend(shape_check(logs, path));
    checks.extend(reference_checks(logs));
    checks.extend(known.map(|(setup, _)| mounting_checks(logs, setup)).unwrap_or_default());
    checks
}

/// What had to be mended in the counts and the rows of all logs.
fn mended_checks(logs: &[LogFacts], robot: Option<&Robot>) -> Vec<Check> {
    if logs.is_empty() {
        return Vec::new();
    }
    let sum = |of: fn(&Mended) -> usize| logs.iter().map(|log| of(&log.mended)).sum::<usize>();
    let (roll_overs, resets) = (sum(|m| m.roll_overs), sum(|m| m.resets));
    let (late, repeated) = (sum(|m| m.late), sum(|m| m.repeated));
    let (stale, filled_in) = (sum(|m| m.stale), sum(|m| m.filled_in));
    let repaired = late + repeated + stale + filled_in;
    let width = robot.and_then(|robot| robot.encoder.counter_bits());
    vec![
        Check {
            name: "counter roll-overs",
            found: match width {
                Some(bits) => format!("{roll_overs} of counters of {bits} bits, undone"),
                None => "none".into(),
            },
            good: "any number, with counter_bits in robot.toml",
            ok: true,
        },
        Check {
            name: "counter resets",
            found: if resets == 0 { "none".into() } else { format!("{resets}, counted on from zero") },
            good: "none: the travel around a reset is lost",
            ok: resets == 0,
        },
        Check {
            name: "rows and poses repaired",
            found: match (repaired, filled_in) {
                (0, _) => "none".into(),
                (_, 0) => format!("{late} out of order, {repeated} repeated, {stale} stale poses"),
                _ => format!("{late} out of order, {repeated} repeated, {stale} stale poses, {filled_in} filled in"),
            },
            good: "none: a logger or tracker that keeps up",
            ok: repaired == 0,
        },
    ]
}

/// The shape of the first log that has another one than the path, else of the first.
fn shape_check(logs: &[LogFacts], path: Option<&Path>) -> Option<Check> {
    let moves = || logs.iter().filter_map(|log| log.moves.as_ref());
    let told = path.map(|path| path.shape().name).filter(|name| *name != "waypoints");
    let differs = |moves: &&MovesFound| told.is_some() && moves.shape != told;
    let found = moves().find(differs).or_else(|| moves().next())?;
    let MovesFound { described, stops, .. } = found;
    Some(Check {
        name: "path by ticks",
        found: format!("{described}; {} on the way", counted(*stops, "stop")),
        good: "the shape that [path] in robot.toml has",
        ok: !differs(&found),
    })
}

/// Least rate of a gyro \[Hz\], with room for jitter.
const GYRO_RATE: f64 = 45.0;
/// A delay that is not known better than this \[s\] is not told.
const VAGUE_DELAY: f64 = 0.25;
/// One clock: poses are late by no more than this \[s\], and their clock is fast by no more than this \[s/s\].
const ONE_CLOCK: (f64, f64) = (0.020, 1e-3);

/// Clock and place of the poses, as all runs agree.
fn mounting_checks(logs: &[LogFacts], setup: &Setup) -> Vec<Check> {
    let Some(mounting) = &setup.mounting else {
        let tracked = logs.iter().any(|log| log.reference.as_ref().is_some_and(|r| r.coverage == Coverage::Track));
        return tracked.then(|| clock_unknown(setup)).into_iter().collect();
    };
    let shown =
        |m: &Measured, scale: f64| format!("{:+.1} ± {:.1}", scale * m.value, scale * (m.interval.high - m.value));
    let within = |m: &Measured, limit: f64| m.value.abs() <= limit || m.interval.contains(0.0);
    let mut checks = vec![clock_check(mounting, logs, (&shown, &within))];
    if let (Some(ahead), Some(left)) = (&mounting.ahead, &mounting.left) {
        checks.push(Check {
            name: "tracked point",
            found: format!("{} mm ahead, {} mm left of the axle's centre (95 %)", shown(ahead, 1e3), shown(left, 1e3)),
            good: "within 5 mm of the centre of the axle",
            ok: within(ahead, 5e-3) && within(left, 5e-3),
        });
    }
    if let Some(yaw) = &mounting.yaw {
        checks.push(Check {
            name: "tracked heading",
            found: format!("turned by {} deg (95 %)", shown(yaw, 1f64.to_degrees())),
            good: "0.5 deg or less: x of the tracked body points forward",
            ok: within(yaw, 0.5f64.to_radians()),
        });
    }
    checks
}

const GOOD_CLOCK: &str = "within 20 ms and 1000 ppm: one clock; else convert from files with both clocks";

/// How a quantity is shown in a unit, and whether it is within a limit.
type Told<'a> = (&'a dyn Fn(&Measured, f64) -> String, &'a dyn Fn(&Measured, f64) -> bool);

fn clock_check(mounting: &Mounting, logs: &[LogFacts], (shown, within): Told) -> Check {
    let Mounting { delay, rate, .. } = mounting;
    let half = delay.interval.high - delay.value;
    if !(half <= VAGUE_DELAY) {
        let uniform = || "unknown: the motion is too uniform, or agrees too little".into();
        let found = clocks_of_logs(logs).unwrap_or_else(uniform);
        return Check { name: "clock of the poses", found, good: GOOD_CLOCK, ok: false };
    }
    let mut found = format!("{} ms late", shown(delay, 1e3));
    found += &rate.map_or(String::new(), |rate| format!(", {} ppm fast", shown(&rate, 1e6)));
    found += " (95 %)";
    let mut ok = within(delay, ONE_CLOCK.0) && rate.is_none_or(|rate| within(&rate, ONE_CLOCK.1));
    // A recording may have a clock of its own.
    let off = |own: &Measured| own.less(delay.value);
    let others = logs.iter().filter_map(|log| Some((log, log.delay.filter(|own| !within(&off(own), ONE_CLOCK.0))?)));
    let farthest = others.max_by(|a, b| off(&a.1).value.abs().total_cmp(&off(&b.1).value.abs()));
    if let Some((log, own)) = farthest {
        found += &format!("; {} by {} ms", log.name, shown(&own, 1e3));
        ok = false;
    }
    Check { name: "clock of the poses", found, good: GOOD_CLOCK, ok }
}

/// From where to where the delays of the logs reach, where they differ.
fn clocks_of_logs(logs: &[LogFacts]) -> Option<String> {
    let is_known = |own: &Measured| own.interval.high - own.value <= VAGUE_DELAY;
    let known = || logs.iter().filter_map(|log| Some((&log.name, log.delay.filter(is_known)?)));
    let by_value = |a: &(&String, Measured), b: &(&String, Measured)| a.1.value.total_cmp(&b.1.value);
    let ((early, least), (late, most)) = (known().min_by(by_value)?, known().max_by(by_value)?);
    let differ = least.interval.high < most.interval.low;
    let told = |own: &Measured| format!("{:+.0} ms late", 1e3 * own.value);
    differ.then(|| format!("differs from log to log: {} in {early}, {} in {late}", told(&least), told(&most)))
}

/// Without agreement of both motions nothing is said of the clock.
fn clock_unknown(setup: &Setup) -> Check {
    let unlike = |fault: &Fault| matches!(fault, Fault::OtherMotion { .. });
    let found = match setup.faults.is_empty() || setup.faults.iter().any(unlike) {
        true => "unknown: poses and wheels do not move alike",
        false => "unknown until the faults are corrected",
    };
    Check { name: "clock of the poses", found: found.into(), good: GOOD_CLOCK, ok: false }
}

fn reference_checks(logs: &[LogFacts]) -> Vec<Check> {
    let references: Vec<&ReferenceFacts> = logs.iter().filter_map(|log| log.reference.as_ref()).collect();
    let mut checks = Vec::new();
    if logs.is_empty() {
        return checks;
    }
    let coverage = references.iter().map(|r| r.coverage).min();
    checks.push(Check {
        name: "reference",
        found: match coverage {
            Some(coverage) => format!("{coverage}, in {} of {} logs", references.len(), logs.len()),
            None => "none".into(),
        },
        good: "a track, or a pose at every stop",
        ok: references.len() == logs.len() && coverage >= Some(Coverage::OnTheWay),
    });
    if let Some(noise) = worst(references.iter().filter_map(|r| r.noise)) {
        checks.push(Check {
            name: "noise of the position",
            found: format!("{:.2} mm while standing", 1e3 * noise),
            good: "2 mm or less",
            ok: noise <= 2e-3,
        });
    }
    if let Some(noise) = worst(references.iter().filter_map(|r| r.heading_noise)) {
        checks.push(Check {
            name: "noise of the heading",
            found: format!("{:.2} mrad while standing", 1e3 * noise),
            good: "2 mrad or less",
            ok: noise <= 2e-3,
        });
    }
    checks
}

/// Whether nothing was measured of a run but where it ended.
fn ends_on_marks(run: &Run) -> bool {
    Kind::of(run).is_some_and(|kind| kind.is_at_ends())
}

/// Logs whose reference tells less than poses, with what it shows.
fn kind_checks(runs: &[Run]) -> impl Iterator<Item = Check> + '_ {
    let logs = || runs.iter().filter(|run| run.log.is_some());
    let all = logs().count();
    KINDS.iter().filter(|kind| kind.name != "pose").filter_map(move |kind| {
        let count = logs().filter(|run| Kind::of(run) == Some(*kind)).count();
        let found = format!("{}, in {count} of {all} logs", kind.name);
        (count > 0).then_some(Check { name: "kind of reference", found, good: kind.shows, ok: true })
    })
}

/// How often gyros were read, the slowest of them.
fn gyro_check(runs: &[Run]) -> Option<Check> {
    let of_run = |run: &Run| {
        let log = run.log.as_ref().filter(|log| log.headings_only && log.relative)?;
        let times: Vec<f64> = log.reference.iter().map(|pose| log.time[pose.sample]).collect();
        usual_rate(&times)
    };
    let rate = runs.iter().filter_map(of_run).min_by(f64::total_cmp)?;
    Some(Check {
        name: "rate of the gyro",
        found: format!("{rate:.1} Hz"),
        good: "50 Hz or more: a slower one may miss how turns begin and end",
        ok: rate >= GYRO_RATE,
    })
}

/// Largest difference of the return errors in the sheet and those that follow from logs; errors that were taken from the
/// logs in the first place do not count.
fn sheet_check(runs: &[Run], robot: &Robot) -> Option<Check> {
    let differences = runs.iter().filter_map(|run| {
        let log = run.log.as_ref()?;
        let (computed, returned) = (computed_end(log, robot).0?, run.returned?);
        let [standing, last] = [EndPose::Standing, EndPose::Last].map(|end| return_error(log, &computed, end));
        let ReturnError { x, y, .. } = standing.filter(|_| ![standing, last].contains(&run.returned))?;
        Some(libm::hypot(x - returned.x, y - returned.y))
    });
    let largest = worst(differences)?;
    Some(Check {
        name: "returns against logs",
        found: format!("{:.1} mm apart at most", 1e3 * largest),
        good: "10 mm or less: both describe the same runs",
        ok: largest <= 0.010,
    })
}

/// How far the heading at the end is from the path's own, full turns ignored \[rad\].
fn heading_off(path: &Path, direction: Option<Direction>, end: &Pose2) -> f64 {
    wrap(end.heading - path.end(direction.unwrap_or(Direction::Ccw)).heading)
}

#[cfg(test)]
mod tests;
