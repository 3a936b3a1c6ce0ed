//! `umbmark inspect`: what a dataset holds, whether it is any good, and what it can determine.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use serde_json::{Map, Value, json};
use umbmark_core::dataset::{
    Dataset, Group, Inspection, LogFacts, MovesFound, ReferenceFacts, RunTopics, Wheels, WheelsFound,
};
use umbmark_core::drive::Robot;
use umbmark_core::path::Direction;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::prose::hanging;
use crate::table::table;
use crate::terminal::{plan, sparkline};
use crate::verb::convert::{alignment_json, clock_json, clocks_table};

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load()?;
    let inspection = data.inspect();
    if session.json() {
        session.print_json(&document(&arguments.data.data, &data, &inspection))?;
    } else {
        let text = text(&data, &inspection, session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

fn direction_name(direction: Option<Direction>) -> &'static str {
    direction.map_or("none", Direction::name)
}

fn text(data: &Dataset, inspection: &Inspection, terminal: bool) -> String {
    let mut text = String::new();
    match &data.robot {
        Some(robot) => text += &hanging("robot", 8, &robot_line(robot)),
        None => text += &hanging("robot", 8, "not known: no robot.toml beside the data"),
    }
    match &data.path {
        Some(path) => text += &hanging("path", 8, &path_line(path)),
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
    text +=
        &inspection.logs.iter().find_map(|log| Some(picture(log, log.moves.as_ref()?, terminal))).unwrap_or_default();
    if !data.topics.is_empty() {
        text += &format!("\n{}\n", topics_table(&data.topics));
    }
    if !data.clocks.is_empty() {
        text += &format!("\nclocks set by the motion while reading\n\n{}\n", clocks_table(&data.clocks));
    }
    text += "\nis it any good?\n";
    for check in &inspection.checks {
        let mark = if check.ok { "ok" } else { "LOOK" };
        text += &hanging(&format!("  {mark:<6}{}", check.name), 32, &check.found);
        text += &hanging("", 32, &format!("good: {}", check.good));
    }
    text += "\nwhat can it determine?\n";
    text += &hanging("  rank", 32, &format!("{} of 3 combinations of E_d, E_b and E_s", inspection.rank));
    for answer in &inspection.determined {
        let mark = if answer.yes { "yes" } else { "no" };
        text += &hanging(&format!("  {mark:<6}{}", answer.quantity), 32, answer.because);
    }
    if !inspection.warnings.is_empty() {
        text += "\nnoticed while reading\n";
        for warning in &inspection.warnings {
            text += &hanging("  -", 4, warning);
        }
    }
    text
}

/// A log seen from above, and its speed over the time.
fn picture(log: &LogFacts, moves: &MovesFound, terminal: bool) -> String {
    const WIDE: usize = 60;
    const HIGH: usize = 16;
    let (seen, scale) = plan(&moves.computed, &moves.measured, WIDE, HIGH);
    let key = if moves.measured.is_empty() { "" } else { ", o measured, 8 both" };
    let most = moves.speed.iter().copied().fold(0.0, f64::max);
    let lines = seen.lines().map(|line| format!("  {line}")).map(|line| line.trim_end().to_owned() + "\n");
    format!(
        "\n{} from above: . by ticks{key}; a character is {:.0} mm wide\n{}\n{} speed of the faster wheel over {:.0} s, up to {most:.2} m/s\n  {}\n",
        log.name,
        1e3 * scale,
        lines.collect::<String>(),
        log.name,
        log.duration,
        sparkline(&moves.speed, WIDE, terminal)
    )
}

fn robot_line(robot: &Robot) -> String {
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
            log.name.clone(),
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
        vec![topics.run.clone(), topics.wheels.clone(), reference]
    });
    table(&["topics", "wheels", "reference"], rows)
}

fn topics_json(topics: &RunTopics) -> Value {
    json!({ "run": topics.run, "wheels": topics.wheels, "reference": topics.reference })
}

fn document(place: &Path, data: &Dataset, inspection: &Inspection) -> Value {
    let groups: Vec<Value> = inspection.groups.iter().map(group_json).collect();
    let logs: Vec<Value> = inspection.logs.iter().map(log_json).collect();
    let checks = inspection
        .checks
        .iter()
        .map(|check| json!({ "name": check.name, "found": check.found, "good": check.good, "ok": check.ok }));
    let determined = inspection
        .determined
        .iter()
        .map(|answer| json!({ "quantity": answer.quantity, "yes": answer.yes, "because": answer.because }));
    json!({
        "data": place.display().to_string(),
        "robot": data.robot.as_ref().map(robot_json),
        "path": data.path.as_ref().map(path_json),
        "groups": groups,
        "logs": logs,
        "clocks": data.clocks.iter().map(clock_json).collect::<Vec<Value>>(),
        "topics": data.topics.iter().map(topics_json).collect::<Vec<Value>>(),
        "checks": checks.collect::<Vec<Value>>(),
        "determined": determined.collect::<Vec<Value>>(),
        "rank": inspection.rank,
        "warnings": inspection.warnings,
        "version": umbmark_core::VERSION,
    })
}

fn robot_json(robot: &Robot) -> Value {
    json!({
        "name": robot.name,
        "wheelbase_m": robot.drive.wheelbase(),
        "wheel_diameter_left_m": robot.drive.wheel_diameter_left(),
        "wheel_diameter_right_m": robot.drive.wheel_diameter_right(),
        "ticks_per_revolution": robot.encoder.ticks_per_revolution(),
        "encoder_rate_hz": robot.encoder.rate(),
        "counter_bits": robot.encoder.counter_bits(),
    })
}

fn path_json(path: &umbmark_core::path::Path) -> Value {
    let shape = path.shape();
    let mut sizes: Map<String, Value> =
        shape.parameters.iter().zip(path.values()).map(|(p, value)| (p.name.to_owned(), json!(value))).collect();
    if shape.parameters.is_empty() {
        sizes.insert("points_m".into(), json!(path.values().chunks(2).collect::<Vec<_>>()));
    }
    json!({ "shape": shape.name, "sizes": sizes, "length_m": path.length() })
}

fn group_json(group: &Group) -> Value {
    json!({
        "test": group.test.name(),
        "direction": group.direction.map(Direction::name),
        "runs": group.runs,
        "returns": group.returns,
        "headings": group.headings,
        "logs": group.logs,
    })
}

fn log_json(log: &LogFacts) -> Value {
    json!({
        "name": log.name,
        "direction": log.direction.map(Direction::name),
        "rows": log.rows,
        "duration_s": log.duration,
        "rate_hz": log.rate,
        "jitter": log.jitter,
        "longest_gap_s": log.longest_gap,
        "gaps": log.gaps,
        "mended": {
            "roll_overs": log.mended.roll_overs,
            "resets": log.mended.resets,
            "rows_out_of_order": log.mended.late,
            "rows_repeated": log.mended.repeated,
            "stale_poses": log.mended.stale,
        },
        "length_m": log.length,
        "heading_rad": log.heading,
        "heading_off_rad": log.heading_off,
        "wheels": log.wheels.as_ref().map(wheels_json),
        "moves": log.moves.as_ref().map(moves_json),
        "alignment": log.alignment.as_ref().map(alignment_json),
        "reference": log.reference.as_ref().map(reference_json),
    })
}

fn moves_json(moves: &MovesFound) -> Value {
    json!({
        "shape": moves.shape,
        "described": moves.described,
        "legs": moves.legs,
        "turns": moves.turns,
        "arcs": moves.arcs,
        "stops": moves.stops,
    })
}

fn wheels_json(found: &WheelsFound) -> Value {
    let (exchanged, left, right) = match found.wheels {
        Wheels::AsGiven => (false, false, false),
        Wheels::Otherwise { exchanged, left_backward, right_backward } => (exchanged, left_backward, right_backward),
    };
    json!({
        "as_named": found.wheels == Wheels::AsGiven,
        "exchanged": exchanged,
        "left_backward": left,
        "right_backward": right,
        "misfit_m": found.misfit.map(|(given, _)| given),
        "best_misfit_m": found.misfit.map(|(_, best)| best),
    })
}

fn reference_json(reference: &ReferenceFacts) -> Value {
    json!({
        "poses": reference.poses,
        "headings": reference.headings,
        "rate_hz": reference.rate,
        "coverage": reference.coverage.to_string(),
        "longest_gap_s": reference.longest_gap,
        "noise_m": reference.noise,
        "heading_noise_rad": reference.heading_noise,
    })
}
