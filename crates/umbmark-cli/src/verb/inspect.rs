//! `umbmark inspect`: what a dataset holds, whether it is any good, and what it can determine.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::dataset::{Dataset, RunTopics};
use umbmark_core::drive::Robot;
use umbmark_core::inspect::{Determined, Group, Inspection, LogContents, LogFacts, MovesFound};
use umbmark_core::path::Direction;
use umbmark_core::result;
use umbmark_io::{DatasetError, Topics};

use crate::Session;
use crate::contents_report::contents_text;
use crate::data_arguments::DataArguments;
use crate::prose::{hanging, shortened};
use crate::setup_report::{disturbances_text, doubts_text, faults_text, mounting_text, returns_text};
use crate::table::{table, with_precision_of};
use crate::terminal::{plan, sparkline};
use crate::verb::convert::clocks_table;
use crate::words::WORDS;

/// So much of a name stands in a table of 80 columns; --json has all of it.
const LONGEST_NAME: usize = 26;
/// The same of a topic.
const LONGEST_TOPIC: usize = 24;

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    arguments.data.say_needs(session)?;
    let read = arguments.data.read();
    let contents = contents(&arguments.data, &read)?;
    // Logs alone do not make a dataset before their robot is known.
    let (data, problem) = match read {
        Ok(data) => (data, None),
        Err(error) if contents.is_empty() => return Err(error.into()),
        Err(error) => (Dataset::default(), Some(error)),
    };
    let inspection = data.inspect();
    if session.json() {
        let place = arguments.data.named();
        session.print_json(&result::Inspection::new(&place, &data, &inspection, &contents))?;
        return Ok(ExitCode::SUCCESS);
    }
    let of_dataset = problem.is_none().then(|| text(&data, &inspection, session.on_terminal()));
    let parts =
        [contents_text(&contents), of_dataset.unwrap_or_default(), next_text(&arguments.data.places, &contents)?];
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    write!(session.out(), "{}", parts.join("\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// What the logs of a place hold whose robot is not known; nothing for return sheets.
fn contents(data: &DataArguments, read: &Result<Dataset, DatasetError>) -> Result<Vec<LogContents>, DatasetError> {
    let topics = data.topics();
    let of_all = || {
        let all = data.places.iter().map(|place| umbmark_io::contents(place, &topics, &WORDS));
        Ok(all.collect::<Result<Vec<_>, DatasetError>>()?.concat())
    };
    match read {
        Ok(data) if data.robot.is_some() || data.runs.iter().all(|run| run.log.is_none()) => Ok(Vec::new()),
        Ok(_) => of_all(),
        // A topic that was named and is not there is a mistake of the command.
        Err(DatasetError::Messages { .. }) if topics != Topics::default() => Ok(Vec::new()),
        // What the reader of the dataset says is nearer to the data than what that of its contents says.
        Err(_) => Ok(of_all().unwrap_or_default()),
    }
}

/// How to go on from logs whose robot is not known.
fn next_text(places: &[PathBuf], contents: &[LogContents]) -> anyhow::Result<String> {
    if contents.iter().all(|log| log.wheels.is_err()) {
        return Ok(String::new());
    }
    // A robot.toml is proposed from one place, and holds for the others.
    let place = places.first().map_or_else(Default::default, |place| place.to_string_lossy());
    let place = shlex::try_quote(&place)?;
    Ok(format!("next\n  umbmark init my_robot --logs {place}\n")
        + &hanging("", 6, "proposes a robot.toml for these logs; without one they say nothing in metres"))
}

fn direction_name(direction: Option<Direction>) -> &'static str {
    direction.map_or("none", Direction::name)
}

/// What the dataset holds, whether it is any good, and what it can determine.
pub fn text(data: &Dataset, inspection: &Inspection, terminal: bool) -> String {
    // What has to be mended first stands first.
    let mut text = inspection
        .setup
        .as_ref()
        .map_or(String::new(), |setup| faults_text(setup) + &doubts_text(setup) + &returns_text(setup));
    if !text.is_empty() {
        text += "\n";
    }
    match &data.robot {
        Some(robot) => text += &hanging("robot", 8, &robot_line(robot)),
        None => text += &hanging("robot", 8, "not known: no robot.toml beside the data"),
    }
    match &data.path {
        Some(path) => text += &hanging("path", 8, &path_line(path)),
        None if data.drives_other_paths() => {
            text += &hanging("path", 8, "not one: the datasets drive different paths");
        }
        None => text += &hanging("path", 8, "not known: no [path] in robot.toml"),
    }
    text += "\n";
    text += &runs_table(&inspection.groups);
    text += "\n";
    if !inspection.logs.is_empty() {
        text += "\n";
        text += &logs_table(&inspection.logs);
        text += "\n";
    }
    if let Some(line) = disagreement_line(&inspection.logs) {
        text += "\n";
        text += &hanging("slip", 8, &line);
    }
    text +=
        &inspection.logs.iter().find_map(|log| Some(picture(log, log.moves.as_ref()?, terminal))).unwrap_or_default();
    if !data.topics.is_empty() {
        text += &format!("\n{}\n", topics_table(&data.topics));
    }
    if !data.clocks.is_empty() {
        text += &format!("\nclocks, aligned from the motion while reading\n\n{}\n", clocks_table(&data.clocks));
    }
    let found = inspection.setup.as_ref().map(|setup| mounting_text(setup) + &disturbances_text(setup));
    if let Some(found) = found.filter(|found| !found.is_empty()) {
        text += &format!("\n{found}");
    }
    text += "\nis the data good?\n";
    for check in &inspection.checks {
        let mark = if check.ok { "ok" } else { "LOOK" };
        text += &hanging(&format!("  {mark:<6}{}", check.name), 32, &check.found);
        text += &hanging("", 32, &format!("good: {}", check.good));
    }
    text += "\nwhat can it determine?\n";
    let of = match inspection.determined.first() {
        Some(first) if first.quantity != "E_d" => "these three",
        _ => "E_d, E_b and E_s",
    };
    text += &hanging("  rank", 32, &format!("{} of 3 combinations of {of}", inspection.rank));
    for answer in &inspection.determined {
        let mark = if answer.yes { "yes" } else { "no" };
        text += &hanging(&format!("  {mark:<6}{}", answer.quantity), 32, &told(answer));
    }
    if !inspection.warnings.is_empty() {
        text += "\nnoticed while reading\n";
        for warning in &inspection.warnings {
            text += &hanging("  -", 4, warning);
        }
    }
    text
}

/// Why a quantity can be determined or not, and its standard error beside its usual size, in per cent.
fn told(answer: &Determined) -> String {
    let Some(usual) = answer.usual else { return answer.because.into() };
    let percent = |share: f64| with_precision_of(100.0 * share, 100.0 * share);
    match answer.std_error {
        Some(error) => {
            format!("{}; standard error {} %, usual size {} %", answer.because, percent(error), percent(usual))
        }
        None => answer.because.into(),
    }
}

/// A log seen from above, and its speed over the time.
fn picture(log: &LogFacts, moves: &MovesFound, terminal: bool) -> String {
    const WIDE: usize = 60;
    const HIGH: usize = 16;
    let (seen, scale) = plan(&moves.computed, &moves.measured, WIDE, HIGH);
    let key = if moves.measured.is_empty() { "" } else { ", o measured, 8 both" };
    let most = moves.speed.iter().copied().fold(0.0, f64::max);
    let name = shortened(&log.name, LONGEST_NAME);
    let lines = seen.lines().map(|line| format!("  {line}")).map(|line| line.trim_end().to_owned() + "\n");
    let above = format!("{name} from above: . by ticks{key}; a character is {:.0} mm wide", 1e3 * scale);
    let speed = format!("{name} speed of the faster wheel over {:.0} s, up to {most:.2} m/s", log.duration);
    format!(
        "\n{}{}\n{}  {}\n",
        hanging("", 0, &above),
        lines.collect::<String>(),
        hanging("", 0, &speed),
        sparkline(&moves.speed, WIDE, terminal)
    )
}

/// What four wheels with rollers disagree on, over all logs.
fn disagreement_line(logs: &[LogFacts]) -> Option<String> {
    let of: Vec<(f64, f64)> = logs.iter().filter_map(|log| Some((log.disagreement?, log.length?))).collect();
    let length = of.iter().map(|(_, length)| length).sum::<f64>();
    (length > 0.0).then(|| {
        let apart = of.iter().map(|(share, length)| share * length).sum::<f64>() / length;
        format!(
            "the wheels disagree by {:.1} mm for each metre of way: as much slips at least, as the counters alone show",
            1e3 * apart
        )
    })
}

fn robot_line(robot: &Robot) -> String {
    if !robot.drive.kind().has_axle_wheels() {
        let kind = robot.drive.kind();
        let numbers =
            kind.parameters().iter().zip(robot.drive.values()).map(|(p, value)| format!("{} {value}", p.name));
        let numbers = numbers.collect::<Vec<_>>().join(", ");
        let ticks = robot.encoder.ticks_per_revolution();
        return format!("{}: {}, {numbers}, {ticks} ticks per revolution", robot.name, kind.name());
    }
    let (left, right) = (robot.drive.wheel_diameter_left(), robot.drive.wheel_diameter_right());
    let wheels = if left == right { format!("wheels {left} m") } else { format!("wheels {left} (left) and {right} m") };
    let encoder = &robot.encoder;
    let bits = encoder.counter_bits().map(|bits| format!(", counters of {bits} bits")).unwrap_or_default();
    let (name, base, ticks) = (&robot.name, robot.drive.wheelbase(), encoder.ticks_per_revolution());
    format!("{name}: wheelbase {base} m, {wheels}, {ticks} ticks per revolution{bits}")
}

fn path_line(path: &umbmark_core::path::Path) -> String {
    let shape = path.shape();
    let named = shape.parameters.iter().zip(path.values());
    let mut sizes: Vec<String> = named.map(|(p, value)| format!("{} {value}", p.name)).collect();
    if shape.parameters.is_empty() {
        sizes.push(format!("{} points", path.values().len() / 2));
    }
    format!("{}, {}, {:.2} m long", shape.name, sizes.join(", "), path.length())
}

fn runs_table(groups: &[Group]) -> String {
    let rows = groups.iter().map(|group| {
        let counts = [group.runs, group.returns, group.headings, group.logs].map(|n| n.to_string());
        let name = format!("{} {}", group.test.name(), direction_name(group.direction));
        std::iter::once(name).chain(counts).collect()
    });
    table(&["test, direction", "runs", "returns", "headings", "logs"], rows)
}

fn logs_table(logs: &[LogFacts]) -> String {
    let rows = logs.iter().map(|log| {
        let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".into());
        let reference = log.reference.as_ref();
        vec![
            shortened(&log.name, LONGEST_NAME),
            log.rows.to_string(),
            format!("{:.1}", log.duration),
            format!("{:.1}", log.rate),
            or_dash(log.length.map(|length| format!("{length:.3}"))),
            or_dash(log.heading.map(|heading| format!("{:+.1}", heading.to_degrees()))),
            or_dash(reference.map(|r| r.poses.to_string())),
            or_dash(reference.map(|r| format!("{:.1}", r.rate))),
        ]
    });
    let header = ["log; m and deg by its ticks", "rows", "s", "Hz", "m", "deg", "poses", "Hz"];
    table(&header, rows)
}

fn topics_table(topics: &[RunTopics]) -> String {
    let rows = topics.iter().map(|topics| {
        let reference = topics.reference.clone().unwrap_or_else(|| "-".into());
        vec![
            shortened(&topics.run, LONGEST_NAME),
            shortened(&topics.wheels, LONGEST_TOPIC),
            shortened(&reference, LONGEST_TOPIC),
        ]
    });
    table(&["topics", "wheels", "reference"], rows)
}
