//! Runs put together from return rows and logs.

use super::RobotFile;
use super::alike::told_once;
use super::closures::{Closure, Marks, closures};
use super::column_names::Renaming;
use super::error::{At, DatasetError, LineProblem};
use super::filled_in::drop_filled_in;
use super::label::{self, Named};
use super::layout::csv::{Measured, ReturnRow};
use super::recording::Recording;
use super::stale::drop_stale;
use super::start_frame::move_to_start;
use super::template::is_untouched;
use std::collections::BTreeMap;
use umbmark_core::dataset::NoRobot;
use umbmark_core::dataset::ReferenceFrame;
use umbmark_core::dataset::{Dataset, Run, RunClock, RunTopics, TickLog};
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::effect::TestKind;
use umbmark_core::geometry::wrap;
use umbmark_core::path::{Direction, Path};
use umbmark_core::run::StartKnown;
use umbmark_core::run::dead_reckoning::{EndPose, computed_end, computed_poses, return_error, standing_at_start};
use umbmark_core::run::{PoseRow, ReferenceTrack, ReturnError, place};
use umbmark_core::synchronise::{Alignment, synchronise};

/// A log that turns by less than this has no direction \[rad\].
const LEAST_TURN: f64 = 0.5;

/// Said where nobody has filled in the robot.toml of the template.
const UNTOUCHED: &str =
    "robot.toml still has the numbers of the example that it began as: give those of your robot, and its name";

/// A dataset in the making.
pub(super) struct Assembly {
    robot: Option<Robot>,
    path: Option<Path>,
    reference_frame: ReferenceFrame,
    /// What the columns of its tables are called.
    pub columns: Renaming,
    runs: Vec<Run>,
    /// The place of each test, direction and number among the runs.
    index: BTreeMap<(TestKind, Option<Direction>, u32), usize>,
    /// Where each run comes from.
    places: Vec<String>,
    has_returns: bool,
    /// Runs whose absolute end pose is known and whose computed one follows from their log: place among the runs, pose, file and line.
    awaited: BTreeMap<usize, (PoseRow, String, usize)>,
    /// Places of marks that robots are driven onto.
    pub marks: Marks,
    clocks: Vec<RunClock>,
    pub topics: Vec<RunTopics>,
    pub warnings: Vec<String>,
}

/// Poses with a clock of their own, and the file they were in.
pub(super) struct Tracked {
    pub file: String,
    pub track: ReferenceTrack,
}

impl Assembly {
    pub fn new(file: Option<RobotFile>) -> Assembly {
        let reference_frame = file.as_ref().map(|file| file.reference).unwrap_or_default();
        let columns = Renaming::by(file.as_ref().map(|file| file.columns.clone()).unwrap_or_default());
        let (robot, path) = file.map_or((None, None), |file| (Some(file.robot), file.path));
        let (runs, places) = (Vec::new(), Vec::new());
        let untouched = robot.as_ref().is_some_and(is_untouched);
        let warnings = if untouched { vec![UNTOUCHED.to_owned()] } else { Vec::new() };
        let (index, clocks, topics) = (BTreeMap::new(), Vec::new(), Vec::new());
        let (has_returns, awaited, marks) = (false, BTreeMap::new(), Marks::new());
        Assembly {
            robot,
            path,
            reference_frame,
            columns,
            runs,
            index,
            places,
            has_returns,
            awaited,
            marks,
            clocks,
            topics,
            warnings,
        }
    }

    /// The nominal robot, where it is known.
    pub fn robot(&self) -> Option<&Robot> {
        self.robot.as_ref()
    }

    /// Adds the rows of a return sheet; they come before the logs.
    pub fn add_returns(&mut self, file: &str, rows: &[ReturnRow]) -> Result<(), DatasetError> {
        self.has_returns = true;
        for row in rows {
            let test = row.test.unwrap_or(TestKind::Systematic);
            let name = label::label(test, row.direction, row.number);
            let (number, direction) = (row.number, row.direction);
            let returned = match row.measured {
                Measured::Error(error) => Some(error),
                Measured::Absolute(end) => {
                    self.awaited.insert(self.runs.len(), (end, file.to_owned(), row.line));
                    None
                }
            };
            self.push(Run { name, number, direction, test, log: None, returned }, file, row.line)?;
        }
        Ok(())
    }

    /// The robot's drive; differential where there is no robot.
    pub fn kind(&self) -> DriveKind {
        self.robot.as_ref().map_or_else(DriveKind::default, |robot| robot.drive.kind())
    }

    /// Adds the recording of a file that is called `stem`, with the poses that a tracking system saw of it, where there are some.
    pub fn add_recording(
        &mut self,
        recording: Recording,
        tracked: Option<Tracked>,
        stem: &str,
        named: Named,
        end: EndPose,
    ) -> Result<(), DatasetError> {
        let file = recording.file.clone();
        let bits = self.robot.as_ref().and_then(|robot| robot.encoder.counter_bits());
        let (log, marked) = recording.into_log(self.robot.as_ref(), bits, &mut self.warnings)?;
        if marked.is_empty() || !log.reference.is_empty() || tracked.is_some() {
            if !marked.is_empty() {
                self.warnings.push(format!("{file}: poses were measured on the way, so the column mark is not used"));
            }
            return self.add_log(file, log, tracked, stem, named, end);
        }
        self.add_closures(&file, &log, &marked, stem, named)
    }

    /// Adds the drives of a log from a mark to a mark, each as a run.
    fn add_closures(
        &mut self,
        file: &str,
        log: &TickLog,
        marked: &[(usize, String)],
        stem: &str,
        named: Named,
    ) -> Result<(), DatasetError> {
        let found = closures(log, marked, &self.marks);
        if found.is_empty() {
            self.warnings.push(format!(
                "{file}: no drive begins and ends on a mark whose place is known: drive onto the same mark again, or write the places of the marks in marks.csv"
            ));
            return self.add_log(file.to_owned(), log.clone(), None, stem, named, EndPose::Last);
        }
        let several = found.len() > 1;
        for (index, Closure { log, end }) in found.into_iter().enumerate() {
            let returned = self.robot.as_ref().and_then(|robot| returned_to(&end, &log, robot));
            let turned = self.robot.as_ref().map_or(0.0, |robot| computed_end(&log, robot).1);
            let direction = self.direction(file, named, turned);
            let test = named.test.unwrap_or(TestKind::Systematic);
            let number = named.number.filter(|_| !several).unwrap_or_else(|| self.next_number(test, direction));
            let name = if several { format!("{stem}, drive {}", index + 1) } else { stem.to_owned() };
            self.push(Run { name, number, direction, test, log: Some(log), returned }, file, 1)?;
        }
        Ok(())
    }

    /// Adds the ticks of a file that is called `stem`, with the poses in it or those of a track.
    pub fn add_log(
        &mut self,
        file: String,
        mut log: TickLog,
        tracked: Option<Tracked>,
        stem: &str,
        named: Named,
        end: EndPose,
    ) -> Result<(), DatasetError> {
        self.reference_frame.mend(&mut log.reference);
        if let Some(mut tracked) = tracked {
            self.reference_frame.mend_track(&mut tracked.track);
            self.set_clock(&mut log, tracked, stem)?;
        }
        log.relative |= self.reference_frame.drifting && !log.reference.is_empty();
        if log.relative && log.reference.iter().any(|pose| pose.heading.is_none()) {
            // Without the heading at its beginning, nobody knows where a step leads.
            let remedy = "a track that drifts (drifting = true in [reference]) needs a heading with every pose".into();
            let column = "theta_ref_rad".into();
            return Err(At::new(file, 1).refuse(LineProblem::MissingColumn { column, remedy }));
        }
        if !log.relative {
            if let Some(robot) = self.robot.as_ref().filter(|_| !log.headings_only) {
                drop_stale(&file, &mut log, robot, &mut self.warnings);
                drop_filled_in(&file, &mut log, &mut self.warnings);
            }
            move_to_start(&file, &mut log, self.robot.as_ref(), &mut self.warnings)?;
        }
        if let Some(bias) = self.robot.as_ref().and_then(|robot| log.place_headings(robot)) {
            let (rate, rested) = (bias.rate.to_degrees(), bias.rested);
            let how = if rested > 0.0 { format!("in {rested:.0} s of rest") } else { "beside the wheels".to_owned() };
            self.warnings.push(format!("{file}: the heading turns by {rate:.3} deg/s {how}: taken out"));
        }
        let (computed, turned) = self.robot.as_ref().map_or((None, 0.0), |robot| computed_end(&log, robot));
        let measured = log.start.known != StartKnown::OnTheWay && !log.relative && !log.headings_only;
        let returned = computed.filter(|_| measured).and_then(|computed| return_error(&log, &computed, end));
        let direction = self.direction(&file, named, turned);
        if let Some(row) = self.row_of(named, direction) {
            return self.attach(row, log, stem, &file);
        }
        if self.has_returns {
            let follows = if returned.is_some() { "follows from its log" } else { "is not known" };
            self.warnings.push(format!("{file}: has no row in the return sheet; its return error {follows}"));
        }
        let test = named.test.unwrap_or(TestKind::Systematic);
        // The last number of a name that says no direction may be the second at which a recorder began.
        let is_free = |number: &u32| !self.index.contains_key(&(test, direction, *number));
        let number = named.number.filter(|number| named.direction.is_some() || is_free(number));
        let number = number.unwrap_or_else(|| self.next_number(test, direction));
        let run = Run { name: stem.to_owned(), number, direction, test, log: Some(log), returned };
        self.push(run, &file, 1)
    }

    /// Sets the clock of a track by the motion, and puts its poses into the log.
    fn set_clock(&mut self, log: &mut TickLog, tracked: Tracked, stem: &str) -> Result<(), DatasetError> {
        let robot = self.robot.as_ref().ok_or(NoRobot)?;
        if !log.reference.is_empty() {
            self.warnings.push(format!("{}: was not used: the log {stem} has poses of its own", tracked.file));
            return Ok(());
        }
        let alignment = attach(&tracked.file, log, &tracked.track, robot, &mut self.warnings)?;
        self.clocks.push(RunClock { run: stem.to_owned(), track: tracked.file, alignment });
        Ok(())
    }

    /// The dataset, its runs in order.
    ///
    /// # Errors
    ///
    /// Where a row of the return sheet has no computed end pose and its run no log.
    pub fn finish(self) -> Result<Dataset, DatasetError> {
        if let Some((_, file, line)) = self.awaited.into_values().next() {
            let remedy = "a return needs the end poses x_abs_m, y_abs_m, x_calc_m, y_calc_m, or the errors ex_m, ey_m, or the log of its \
                          run in runs";
            let column = "x_calc_m".to_owned();
            return Err(At::new(file, line).refuse(LineProblem::MissingColumn { column, remedy: remedy.into() }));
        }
        let columns = self.columns.names();
        let Assembly { robot, path, reference_frame, mut runs, clocks, topics, warnings, .. } = self;
        runs.sort_by_key(|run| (run.test, run.direction, run.number));
        let sessions = Vec::new();
        let conditions = Vec::new();
        let warnings = told_once(warnings);
        Ok(Dataset { robot, path, reference_frame, columns, runs, sessions, conditions, clocks, topics, warnings })
    }

    fn push(&mut self, mut run: Run, file: &str, line: usize) -> Result<(), DatasetError> {
        if let Some(log) = &mut run.log {
            // They grew as rows were read, to up to twice their size.
            [&mut log.time, &mut log.left, &mut log.right].into_iter().for_each(Vec::shrink_to_fit);
            log.reference.shrink_to_fit();
        }
        let key = (run.test, run.direction, run.number);
        if let Some(&first) = self.index.get(&key) {
            return Err(At::new(file, line).refuse(LineProblem::DuplicateRun {
                run: label::spoken(run.test, run.direction, run.number),
                first: self.places[first].clone(),
            }));
        }
        self.index.insert(key, self.runs.len());
        self.runs.push(run);
        self.places.push(format!("{file}:{line}"));
        Ok(())
    }

    /// What the name says, else what the ticks say.
    fn direction(&mut self, file: &str, named: Named, turned: f64) -> Option<Direction> {
        let driven = match turned {
            _ if turned > LEAST_TURN => Some(Direction::Ccw),
            _ if turned < -LEAST_TURN => Some(Direction::Cw),
            _ => None,
        };
        let Some(told) = named.direction else { return driven };
        if let (Some(name), Some(ticks)) = (told, driven)
            && name != ticks
        {
            let (name, ticks) = (name.name(), ticks.name());
            self.warnings.push(format!(
                "{file}: its name says {name}, its ticks turn {ticks}; taken as {name}. Look whether left and right are exchanged"
            ));
        }
        told
    }

    /// The return row that a log belongs to.
    fn row_of(&self, named: Named, direction: Option<Direction>) -> Option<usize> {
        let number = named.number?;
        let of = |test| {
            let place = *self.index.get(&(test, direction, number))?;
            let has_row = self.runs[place].returned.is_some() || self.awaited.contains_key(&place);
            (self.has_returns && has_row).then_some(place)
        };
        match named.test {
            Some(test) => of(test),
            None => of(TestKind::Systematic).or_else(|| of(TestKind::Bumps)),
        }
    }

    fn attach(&mut self, row: usize, log: TickLog, stem: &str, file: &str) -> Result<(), DatasetError> {
        let run = &mut self.runs[row];
        if run.log.is_some() {
            return Err(At::new(file, 1).refuse(LineProblem::DuplicateRun {
                run: label::spoken(run.test, run.direction, run.number),
                first: self.places[row].clone(),
            }));
        }
        if let Some(robot) = &self.robot
            && let Some((end, ..)) = self.awaited.remove(&row)
        {
            run.returned = returned_to(&end, &log, robot);
        }
        run.log = Some(log);
        run.name = stem.to_owned();
        self.places[row] = file.to_owned();
        Ok(())
    }

    fn next_number(&self, test: TestKind, direction: Option<Direction>) -> u32 {
        let of_kind = self.runs.iter().filter(|run| run.test == test && run.direction == direction);
        of_kind.map(|run| run.number).max().map_or(1, |most| most.saturating_add(1))
    }
}

/// The return error of a robot that stands at `end`, seen from where its log begins.
fn returned_to((x, y, heading): &PoseRow, log: &TickLog, robot: &Robot) -> Option<ReturnError> {
    let computed = computed_poses(log, robot).pop()?;
    let heading = heading.map(|heading| wrap(heading - computed.heading));
    Some(ReturnError { x: x - computed.x, y: y - computed.y, heading })
}

/// Puts a track that has its own clock into a log: its poses, those of the axle's centre now, belong to samples of the log.
fn attach(
    file: &str,
    log: &mut TickLog,
    track: &ReferenceTrack,
    robot: &Robot,
    warnings: &mut Vec<String>,
) -> Result<Alignment, DatasetError> {
    let found = synchronise(log, track, robot)
        .map_err(|reason| DatasetError::Clocks { file: file.to_owned(), reason: reason.to_string() })?;
    let times: Vec<f64> = track.time.iter().map(|time| found.tick_time(*time)).collect();
    let dropped = place(log, &times, &found.of_axle(track));
    if standing_at_start(log).is_empty() {
        let reason =
            "it does not see the robot before it moves, so START is not known; record some seconds of rest first";
        return Err(DatasetError::Clocks { file: file.to_owned(), reason: reason.to_owned() });
    }
    let of_axle = if found.yaw.is_some() { ", and its poses turned into those of the axle's centre" } else { "" };
    warnings.push(format!("{file}: its clock was aligned from the motion{of_axle}"));
    if dropped > 0 {
        warnings.push(format!(
            "{file}: {dropped} poses fall into gaps of the ticks, or outside of them, and were left out"
        ));
    }
    Ok(found)
}
