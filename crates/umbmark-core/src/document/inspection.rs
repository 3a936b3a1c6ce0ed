//! `inspect`.

use super::clock::clock;
use super::nominal::{path, robot};
use super::setup::measured;
use crate::dataset::{Dataset, RunTopics};
use crate::inspect::{Group, Inspection, LogFacts, MovesFound, ReferenceFacts, Wheels};
use crate::path::Direction;
use serde_json::{Value, json};

fn topics_json(topics: &RunTopics) -> Value {
    json!({ "run": topics.run, "wheels": topics.wheels, "reference": topics.reference })
}

/// What a dataset read from `place` holds.
pub fn inspection(place: &str, data: &Dataset, found: &Inspection) -> Value {
    let groups: Vec<Value> = found.groups.iter().map(group_json).collect();
    let logs: Vec<Value> = found.logs.iter().map(log_json).collect();
    let checks = found
        .checks
        .iter()
        .map(|check| json!({ "name": check.name, "found": check.found, "good": check.good, "ok": check.ok }));
    let determined = found.determined.iter().map(|answer| {
        json!({
            "quantity": answer.quantity,
            "yes": answer.yes,
            "std_error": answer.std_error,
            "usual_size": answer.usual,
            "because": answer.because,
        })
    });
    json!({
        "data": place,
        "robot": data.robot.as_ref().map(robot),
        "path": data.path.as_ref().map(path),
        "groups": groups,
        "logs": logs,
        "clocks": data.clocks.iter().map(clock).collect::<Vec<Value>>(),
        "topics": data.topics.iter().map(topics_json).collect::<Vec<Value>>(),
        "checks": checks.collect::<Vec<Value>>(),
        "determined": determined.collect::<Vec<Value>>(),
        "rank": found.rank,
        "setup": found.setup.as_ref().map(super::setup::setup),
        "warnings": found.warnings,
        "version": crate::VERSION,
    })
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
        "wheels": log.wheels.map(wheels_json),
        "moves": log.moves.as_ref().map(moves_json),
        "delay_s": log.delay.as_ref().map(measured),
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

fn wheels_json(wheels: Wheels) -> Value {
    let (exchanged, left, right) = match wheels {
        Wheels::AsGiven => (false, false, false),
        Wheels::Otherwise { exchanged, left_backward, right_backward } => (exchanged, left_backward, right_backward),
    };
    json!({
        "as_named": wheels == Wheels::AsGiven,
        "exchanged": exchanged,
        "left_backward": left,
        "right_backward": right,
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
