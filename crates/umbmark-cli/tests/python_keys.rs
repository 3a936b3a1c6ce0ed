//! What Python's type checkers know of robots, paths and effects, written from the descriptions that files are read by.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_keys` writes it anew.

use std::path::Path;

use snapbox::{Data, assert_data_eq};
use umbmark_core::drive::DriveKind;
use umbmark_core::effect::{CATALOGUE, Target};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{SHAPES, SpeedProfile};
use umbmark_io::RobotFile;

const HEAD: &str = r#""""The keys that robots, paths and effects take, for static checks: written from the core's.

``SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_keys`` writes them anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

from numpy.typing import ArrayLike

"#;

const ROBOT: &str = "Keys of ``[robot]`` in a robot.toml; which of them a robot has depends on its drive.";
const MOTION: &str = "Keys of ``[path]`` in a robot.toml that every path has: how it is driven.";
const PATH: &str = "Keys of ``[path]`` in a robot.toml; which of them a path has depends on its shape.";
const EFFECT: &str = "Keys of ``[[effect]]`` in a model.toml; which of them an effect has the catalogue says.";

/// Keys of every effect, and of one's own.
const OF_EVERY_EFFECT: [(&str, &str); 5] = [
    ("acts_on", "ActsOn"),
    ("formula", "str | Callable[..., Any]"),
    ("parameters", "Mapping[str, Drawn]"),
    ("free", "bool"),
    ("fixed", "Sequence[str]"),
];

#[test]
fn python_has_the_keys_of_the_files() {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../umbmark-py/python/umbmark/_keys.py");
    assert_data_eq!(module(), Data::read_from(&place, None).raw());
}

fn module() -> String {
    let mut text = HEAD.to_owned();
    text += &words("Drive", DriveKind::ALL.iter().map(|kind| kind.name()));
    text += &words("Shape", SHAPES.iter().map(|shape| shape.name));
    text += "# An effect of the catalogue; those of one's own have other names.\n";
    text += &words("EffectName", CATALOGUE.iter().map(|entry| entry.about.name));
    text += &words("ActsOn", Target::ALL.map(Target::name));
    text += "# A number, or what it is drawn from: {\"mean\": .., \"sd\": ..}, {\"min\": .., \"max\": ..}.\n";
    text += "Drawn: TypeAlias = float | Mapping[str, float]\n";
    text += &keys("RobotKeys(TypedDict", ROBOT, robot_keys());
    text += &keys("MotionKeys(TypedDict", MOTION, SpeedProfile::PARAMETERS.iter().map(or_none));
    let points = ("points_m".to_owned(), "ArrayLike | Sequence[Sequence[float]] | None".to_owned());
    let of_shapes = SHAPES.iter().flat_map(|shape| shape.parameters).map(or_none);
    text += &keys("PathKeys(MotionKeys", PATH, of_shapes.chain([points]));
    let of_every = OF_EVERY_EFFECT.map(|(key, kind)| (key.to_owned(), kind.to_owned()));
    let of_effects = CATALOGUE.iter().flat_map(|entry| entry.about.parameters);
    let drawn = of_effects.map(|p| (p.name.to_owned(), of_choice(p).unwrap_or_else(|| "Drawn".to_owned())));
    text += &keys("EffectKeys(TypedDict", EFFECT, of_every.into_iter().chain(drawn));
    text
}

/// A type of a few words.
fn words<'a>(name: &str, words: impl IntoIterator<Item = &'a str>) -> String {
    let lines: String = words.into_iter().map(|word| format!("    \"{word}\",\n")).collect();
    format!("{name}: TypeAlias = Literal[\n{lines}]\n")
}

/// A class of keys and their types, each once.
fn keys(class: &str, about: &str, keys: impl IntoIterator<Item = (String, String)>) -> String {
    let mut lines: Vec<String> = Vec::new();
    for (key, kind) in keys {
        let line = format!("    {key}: {kind}\n");
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    format!("\n\nclass {class}, total=False):\n    \"\"\"{about}\"\"\"\n\n{}", lines.concat())
}

fn robot_keys() -> Vec<(String, String)> {
    let parameter = |key: &str| {
        let of_drives = DriveKind::ALL.iter().flat_map(|kind| kind.parameters());
        of_drives.copied().find(|parameter| parameter.name == key)
    };
    let kind = |key: &str| match key {
        "name" => "str".to_owned(),
        "drive" => "Drive".to_owned(),
        "encoder_rate_hz" => "float | Literal[\"every tick\"]".to_owned(),
        "counter_bits" => "int".to_owned(),
        "wheels_exchanged" => "bool".to_owned(),
        _ if key.ends_with("_counts_backward") => "bool".to_owned(),
        _ => parameter(key).as_ref().and_then(of_choice).unwrap_or_else(|| "float".to_owned()),
    };
    let all = DriveKind::ALL.iter().flat_map(|kind| RobotFile::keys(*kind));
    all.map(|key| {
        let kind = format!("{} | None", kind(&key));
        (key, kind)
    })
    .collect()
}

/// The type of a parameter that stands for words.
fn of_choice(parameter: &Parameter) -> Option<String> {
    let words: Vec<String> = parameter.choices().iter().map(|word| format!("\"{word}\"")).collect();
    (!words.is_empty()).then(|| format!("Literal[{}]", words.join(", ")))
}

fn or_none(parameter: &Parameter) -> (String, String) {
    (parameter.name.to_owned(), "float | None".to_owned())
}
