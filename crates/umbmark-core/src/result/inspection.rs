//! `inspect`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Clock, Measured, PathFacts, RobotFacts, Setup};
use crate::dataset::{Dataset, RunTopics};
use crate::inspect::{self, Wheels};
use crate::path::Direction;

/// Numbers of runs of one test and direction, and what these contain.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Group {
    /// "systematic" or "bumps".
    pub test: &'static str,
    /// "cw" or "ccw"; null for runs of neither.
    pub direction: Option<&'static str>,
    /// Number of runs.
    pub runs: usize,
    /// How many of them have a return error.
    pub returns: usize,
    /// How many of these have a heading.
    pub headings: usize,
    /// How many of the runs have a log.
    pub logs: usize,
}

impl From<&inspect::Group> for Group {
    fn from(group: &inspect::Group) -> Self {
        Group {
            test: group.test.name(),
            direction: group.direction.map(Direction::name),
            runs: group.runs,
            returns: group.returns,
            headings: group.headings,
            logs: group.logs,
        }
    }
}

/// Number of defects of a log that were corrected while it was read.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Mended {
    /// Counters that rolled over.
    pub roll_overs: usize,
    /// Counters that restarted.
    pub resets: usize,
    /// Rows that were out of order.
    pub rows_out_of_order: usize,
    /// Duplicate rows.
    pub rows_repeated: usize,
    /// Poses repeated from the previous row.
    pub stale_poses: usize,
    /// Poses that were filled in between measured ones.
    pub filled_in_poses: usize,
}

/// Whether the motion of the poses confirms the names of the wheels.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WheelFacts {
    /// Whether it does.
    pub as_named: bool,
    /// Whether left and right are exchanged.
    pub exchanged: bool,
    /// Whether the left one counts backward.
    pub left_backward: bool,
    /// Whether the right one counts backward.
    pub right_backward: bool,
}

impl From<Wheels> for WheelFacts {
    fn from(wheels: Wheels) -> Self {
        let (exchanged, left_backward, right_backward) = match wheels {
            Wheels::AsGiven => (false, false, false),
            Wheels::Otherwise { exchanged, left_backward, right_backward } => {
                (exchanged, left_backward, right_backward)
            }
        };
        WheelFacts { as_named: wheels == Wheels::AsGiven, exchanged, left_backward, right_backward }
    }
}

/// What was driven, by the ticks.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Moves {
    /// Shape of the path; null if it has no name.
    pub shape: Option<&'static str>,
    /// The path in words.
    pub described: String,
    /// Number of straight legs.
    pub legs: usize,
    /// Number of turns on the spot.
    pub turns: usize,
    /// Number of arcs.
    pub arcs: usize,
    /// Number of stops.
    pub stops: usize,
}

impl From<&inspect::MovesFound> for Moves {
    fn from(moves: &inspect::MovesFound) -> Self {
        Moves {
            shape: moves.shape,
            described: moves.described.clone(),
            legs: moves.legs,
            turns: moves.turns,
            arcs: moves.arcs,
            stops: moves.stops,
        }
    }
}

/// The absolute poses of a log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReferenceFacts {
    /// Number of poses.
    pub poses: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Poses per second.
    pub rate_hz: f64,
    /// Where along the path they lie, in words.
    pub coverage: String,
    /// The longest time without one, in s.
    pub longest_gap_s: f64,
    /// Noise of a coordinate, in m; null if the poses do not determine it.
    pub noise_m: Option<f64>,
    /// Noise of a heading, in rad; null if the poses do not determine it.
    pub heading_noise_rad: Option<f64>,
}

impl From<&inspect::ReferenceFacts> for ReferenceFacts {
    fn from(reference: &inspect::ReferenceFacts) -> Self {
        ReferenceFacts {
            poses: reference.poses,
            headings: reference.headings,
            rate_hz: reference.rate,
            coverage: reference.coverage.to_string(),
            longest_gap_s: reference.longest_gap,
            noise_m: reference.noise,
            heading_noise_rad: reference.heading_noise,
        }
    }
}

/// A log: its rows, and what its ticks and poses show.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogFacts {
    /// Name of its run.
    pub name: String,
    /// "cw" or "ccw"; null for neither.
    pub direction: Option<&'static str>,
    /// Number of rows.
    pub rows: usize,
    /// Time from the first row to the last, in s.
    pub duration_s: f64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Relative scatter of the time between rows.
    pub jitter: f64,
    /// The longest time without a row, in s.
    pub longest_gap_s: f64,
    /// Number of gaps.
    pub gaps: usize,
    /// Defects that were corrected while it was read.
    pub mended: Mended,
    /// Length of the way by the ticks, in m; null without a nominal robot.
    pub length_m: Option<f64>,
    /// What the wheels disagree on, in m for each m of way: slip that shows without a reference; null where fewer than four wheels with rollers are
    /// counted.
    pub disagreement_m_per_m: Option<f64>,
    /// Heading at the end by the ticks, in rad; null without a nominal robot.
    pub heading_rad: Option<f64>,
    /// Its difference from the commanded heading, in rad; null if the path is not known.
    pub heading_off_rad: Option<f64>,
    /// Whether the names of the wheels are right; null if the poses do not show it.
    pub wheels: Option<WheelFacts>,
    /// What was driven; null without a nominal robot.
    pub moves: Option<Moves>,
    /// Age of a pose at its time stamp in the middle of the run, in s; null if the motion does not determine it.
    pub delay_s: Option<Measured>,
    /// Its absolute poses; null where it has none.
    pub reference: Option<ReferenceFacts>,
}

impl From<&inspect::LogFacts> for LogFacts {
    fn from(log: &inspect::LogFacts) -> Self {
        LogFacts {
            name: log.name.clone(),
            direction: log.direction.map(Direction::name),
            rows: log.rows,
            duration_s: log.duration,
            rate_hz: log.rate,
            jitter: log.jitter,
            longest_gap_s: log.longest_gap,
            gaps: log.gaps,
            mended: Mended {
                roll_overs: log.mended.roll_overs,
                resets: log.mended.resets,
                rows_out_of_order: log.mended.late,
                rows_repeated: log.mended.repeated,
                stale_poses: log.mended.stale,
                filled_in_poses: log.mended.filled_in,
            },
            length_m: log.length,
            disagreement_m_per_m: log.disagreement,
            heading_rad: log.heading,
            heading_off_rad: log.heading_off,
            wheels: log.wheels.map(WheelFacts::from),
            moves: log.moves.as_ref().map(Moves::from),
            delay_s: log.delay.as_ref().map(Measured::from),
            reference: log.reference.as_ref().map(ReferenceFacts::from),
        }
    }
}

/// Where the log of a run was found in an MCAP file or a bag.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Topics {
    /// Name of the run.
    pub run: String,
    /// Topic of the wheels.
    pub wheels: String,
    /// Topic of the reference; null without one.
    pub reference: Option<String>,
}

/// A check: what was found, and what is good.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Check {
    /// What is checked.
    pub name: String,
    /// What was found.
    pub found: String,
    /// What would be good.
    pub good: String,
    /// Whether it is good.
    pub ok: bool,
}

/// Whether the data determines a quantity, and why.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Determined {
    /// The quantity.
    pub quantity: String,
    /// Whether the data determines it.
    pub yes: bool,
    /// Expected relative standard error with noise of the usual size; null if the data does not determine the quantity or it is not a value
    /// of the robot.
    pub std_error: Option<f64>,
    /// Usual relative size of the error in robots; null if it is not a value of the robot.
    pub usual_size: Option<f64>,
    /// The reason, or what would help.
    pub because: String,
}

/// A topic or a column of a log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogPart {
    /// Its name.
    pub name: String,
    /// The type of its messages; of a column the range of its numbers, or "text".
    pub kind: String,
    /// Messages, or cells that hold something; null if the file does not say it.
    pub count: Option<u64>,
    /// Messages or cells per second; null for fewer than two.
    pub rate_hz: Option<f64>,
    /// What it would be used for: "time", "wheels" or "reference"; null if it would not be used.
    pub used: Option<&'static str>,
}

/// What tells how the wheels turned.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WheelsFound {
    /// The topic and its fields, or the columns.
    pub source: String,
    /// "counts", "joint positions" or "odometry".
    pub unit: &'static str,
    /// Number of readings.
    pub readings: usize,
    /// Readings per second.
    pub rate_hz: f64,
    /// Steps per turn of joint positions; null for counts, and if no step shows.
    pub ticks_per_revolution: Option<f64>,
    /// Width of counters that are seen to roll over; null if none is.
    pub counter_bits: Option<u32>,
}

/// What tells where the robot was.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReferenceFound {
    /// The topic, or the columns.
    pub source: String,
    /// Number of poses.
    pub poses: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Poses per second; null for fewer than two.
    pub rate_hz: Option<f64>,
}

/// The topics or columns of a log whose robot is not known, and which of them would be read.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogContents {
    /// The file.
    pub file: String,
    /// "csv", "mcap", "rosbag" or "rosbag2".
    pub layout: &'static str,
    /// Time from the first message or row to the last, in s; null if the file does not say it.
    pub duration_s: Option<f64>,
    /// Its topics or columns.
    pub parts: Vec<LogPart>,
    /// The wheels; null if there are none that can be read.
    pub wheels: Option<WheelsFound>,
    /// The absolute poses; null if there are none that can be read.
    pub reference: Option<ReferenceFound>,
    /// Why wheels or poses cannot be read, a sentence each.
    pub problems: Vec<String>,
    /// What was noticed in it, a sentence each.
    pub notes: Vec<String>,
}

impl From<&inspect::LogContents> for LogContents {
    fn from(log: &inspect::LogContents) -> Self {
        let part = |part: &inspect::LogPart| LogPart {
            name: part.name.clone(),
            kind: part.kind.clone(),
            count: part.count,
            rate_hz: part.rate,
            used: part.used,
        };
        let wheels = |wheels: &inspect::WheelsFound| WheelsFound {
            source: wheels.source.clone(),
            unit: wheels.unit.name(),
            readings: wheels.readings,
            rate_hz: wheels.rate,
            ticks_per_revolution: wheels.ticks_per_revolution,
            counter_bits: wheels.counter_bits,
        };
        let reference = |reference: &inspect::ReferenceFound| ReferenceFound {
            source: reference.source.clone(),
            poses: reference.poses,
            headings: reference.headings,
            rate_hz: reference.rate,
        };
        let problems = log.wheels.as_ref().err().into_iter().chain(log.reference.as_ref().err());
        LogContents {
            file: log.file.clone(),
            layout: log.layout,
            duration_s: log.duration,
            parts: log.parts.iter().map(part).collect(),
            wheels: log.wheels.as_ref().ok().map(wheels),
            reference: log.reference.as_ref().ok().and_then(Option::as_ref).map(reference),
            problems: problems.cloned().collect(),
            notes: log.notes.clone(),
        }
    }
}

/// The findings on a dataset.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Inspection {
    /// Where it was read from.
    pub data: String,
    /// The nominal robot; null where it is not known.
    pub robot: Option<RobotFacts>,
    /// The path; null where it is not known.
    pub path: Option<PathFacts>,
    /// The runs.
    pub groups: Vec<Group>,
    /// Each log.
    pub logs: Vec<LogFacts>,
    /// Clocks that were set.
    pub clocks: Vec<Clock>,
    /// Topics that were read.
    pub topics: Vec<Topics>,
    /// Topics or columns of each log, if the nominal robot is not known; empty if it is.
    pub contents: Vec<LogContents>,
    /// Checks of the quality of the data.
    pub checks: Vec<Check>,
    /// What it can determine of the robot.
    pub determined: Vec<Determined>,
    /// Number of combinations of E_d, E_b and E_s that it determines.
    pub rank: usize,
    /// Findings about the runs from their motion and return errors; null without a robot.
    pub setup: Option<Setup>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Inspection {
    /// What a dataset read from `place` holds, and the logs there if its robot is not known.
    pub fn new(
        place: &str,
        data: &Dataset,
        found: &inspect::Inspection,
        contents: &[inspect::LogContents],
    ) -> Inspection {
        let topics = |topics: &RunTopics| Topics {
            run: topics.run.clone(),
            wheels: topics.wheels.clone(),
            reference: topics.reference.clone(),
        };
        let check = |check: &inspect::Check| Check {
            name: check.name.to_string(),
            found: check.found.clone(),
            good: check.good.to_string(),
            ok: check.ok,
        };
        let determined = |answer: &inspect::Determined| Determined {
            quantity: answer.quantity.to_string(),
            yes: answer.yes,
            std_error: answer.std_error,
            usual_size: answer.usual,
            because: answer.because.to_string(),
        };
        Inspection {
            data: place.to_owned(),
            robot: data.robot.as_ref().map(RobotFacts::from),
            path: data.path.as_ref().map(PathFacts::from),
            groups: found.groups.iter().map(Group::from).collect(),
            logs: found.logs.iter().map(LogFacts::from).collect(),
            clocks: data.clocks.iter().map(Clock::from).collect(),
            topics: data.topics.iter().map(topics).collect(),
            contents: contents.iter().map(LogContents::from).collect(),
            checks: found.checks.iter().map(check).collect(),
            determined: found.determined.iter().map(determined).collect(),
            rank: found.rank,
            setup: found.setup.as_ref().map(Setup::from),
            warnings: found.warnings.clone(),
            version: crate::VERSION,
        }
    }
}
