//! Python's classes of results, written from the structs that `--json` prints.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_classes` writes them anew.

use std::path::Path;

use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};
use snapbox::{Data, assert_data_eq};
use umbmark_core::result;

/// Columns of the module.
const WIDTH: usize = 100;

/// Words that Python keeps for itself.
const KEYWORDS: [&str; 2] = ["class", "from"];

/// Results in place of which Python has objects of the extension.
const OF_THE_EXTENSION: [&str; 1] = ["Model"];

const HEAD: &str = r#""""Results as the command prints them, typed: written from the core's, not by hand.

``SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_classes`` writes them anew.
"""

from __future__ import annotations
"#;

/// The schemas of results by name, and the names of those that are whole documents.
struct Schemas {
    all: Map<String, Value>,
    documents: Vec<&'static str>,
}

#[test]
fn python_has_the_classes_of_the_results() {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let documents = result::describe(&mut generator);
    generator.subschema_for::<result::Effect>();
    let schemas = Schemas { all: generator.take_definitions(true), documents };
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../umbmark-py/python/umbmark/_documents.py");
    assert_data_eq!(module(&schemas), Data::read_from(&place, None).raw());
}

fn module(schemas: &Schemas) -> String {
    let written = schemas.all.iter().filter(|(name, _)| !OF_THE_EXTENSION.contains(&name.as_str()));
    let classes: String = written.map(|(name, schema)| class(name, schema, schemas)).collect();
    let uses = |word: &str| classes.contains(word);
    let of_base: Vec<&str> = ["Interval", "Record", "Result"].into_iter().filter(|name| uses(name)).collect();
    let mut imports = format!("from umbmark._result import {}\n", of_base.join(", "));
    imports += &format!("from umbmark._umbmark import {}\n", OF_THE_EXTENSION.join(", "));
    let others = [
        (uses("Any"), "from typing import Any\n\n"),
        (uses("msgspec."), "import msgspec\n"),
        (uses("UNSET"), "from msgspec import UNSET, UnsetType\n"),
    ];
    let others: String = others.into_iter().filter(|(used, _)| *used).map(|(_, line)| line).collect();
    let others = if others.is_empty() { others } else { format!("{}\n\n", others.trim_end()) };
    format!("{HEAD}\n{others}{imports}{classes}")
}

fn class(name: &str, schema: &Value, schemas: &Schemas) -> String {
    let required: Vec<&str> = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let fields: Vec<Field> = schema["properties"]
        .as_object()
        .unwrap_or_else(|| panic!("{name} is no object"))
        .iter()
        .map(|(key, schema)| Field { key, schema, always: required.contains(&key.as_str()) })
        .collect();
    let base = if schemas.documents.contains(&name) { "Result" } else { "Record" };
    // What may be left out has a default, and stands before what has none.
    let keywords = if fields.iter().all(|field| field.always) { "" } else { ", kw_only=True" };
    let mut text = format!("\n\nclass {name}({base}, frozen=True{keywords}):\n");
    let about = paragraphs(description(name, schema), 4);
    text += &format!("    \"\"\"{}\n\n    Attributes\n    ----------\n", about.trim_start());
    for field in &fields {
        let about = paragraphs(description(field.key, field.schema), 8);
        text += &format!("    {} : {}\n{about}\n", field.name(), field.annotation().replace(" | ", " or "));
    }
    text += "    \"\"\"\n\n";
    fields.iter().for_each(|field| text += &field.line());
    text
}

struct Field<'a> {
    key: &'a str,
    schema: &'a Value,
    /// Whether every document has it.
    always: bool,
}

impl Field<'_> {
    fn name(&self) -> String {
        format!("{}{}", self.key, if KEYWORDS.contains(&self.key) { "_" } else { "" })
    }

    fn annotation(&self) -> String {
        let own = annotation(self.schema);
        if self.always { own } else { format!("{} | UnsetType", own.trim_end_matches(" | None")) }
    }

    fn line(&self) -> String {
        let (name, key) = (self.name(), self.key);
        let value = match (name == key, self.always) {
            (true, true) => String::new(),
            (true, false) => " = UNSET".to_owned(),
            (false, true) => format!(" = msgspec.field(name=\"{key}\")"),
            (false, false) => format!(" = msgspec.field(name=\"{key}\", default=UNSET)"),
        };
        format!("    {name}: {}{value}\n", self.annotation())
    }
}

/// Python's type of what a schema allows.
fn annotation(schema: &Value) -> String {
    if let Some(reference) = schema["$ref"].as_str() {
        return reference.rsplit('/').next().unwrap().to_owned();
    }
    if let Some(any) = schema["anyOf"].as_array() {
        return any.iter().map(annotation).collect::<Vec<_>>().join(" | ");
    }
    match &schema["type"] {
        Value::Array(types) => {
            let one = |kind: &Value| of_type(kind.as_str().unwrap(), schema);
            types.iter().map(one).collect::<Vec<_>>().join(" | ")
        }
        Value::String(kind) => of_type(kind, schema),
        _ => "Any".to_owned(),
    }
}

fn of_type(kind: &str, schema: &Value) -> String {
    match kind {
        "string" => "str".to_owned(),
        "integer" => "int".to_owned(),
        "number" => "float".to_owned(),
        "boolean" => "bool".to_owned(),
        "null" => "None".to_owned(),
        "array" => tuple(schema),
        "object" => format!("dict[str, {}]", annotation(&schema["additionalProperties"])),
        _ => panic!("no class of Python for a {kind}"),
    }
}

fn tuple(schema: &Value) -> String {
    let item = annotation(&schema["items"]);
    let inner = match (schema["prefixItems"].as_array(), schema["minItems"].as_u64()) {
        (Some(items), _) => items.iter().map(annotation).collect::<Vec<_>>().join(", "),
        (None, Some(count)) => vec![item; count as usize].join(", "),
        (None, None) => format!("{item}, ..."),
    };
    if inner == "float, float" { "Interval".to_owned() } else { format!("tuple[{inner}]") }
}

/// The documentation of a struct or a field, as Python's names have it.
fn description<'a>(name: &str, schema: &'a Value) -> &'a str {
    schema["description"].as_str().unwrap_or_else(|| panic!("{name} is not documented"))
}

/// Paragraphs indented and wrapped, in the words of Python.
fn paragraphs(text: &str, indent: usize) -> String {
    let in_python = |word: &str| {
        let word = word.replace('`', "``");
        match word.strip_prefix("null") {
            Some(rest) if !rest.starts_with(char::is_alphanumeric) => format!("None{rest}"),
            _ => word,
        }
    };
    let wrapped = |paragraph: &str| {
        let mut lines = vec![String::new()];
        for word in paragraph.split_whitespace().map(in_python) {
            // A docstring's first line begins with its quotes.
            let room = WIDTH - indent - if lines.len() == 1 && indent == 4 { 3 } else { 0 };
            let line = lines.last_mut().unwrap();
            if line.is_empty() {
                line.push_str(&word);
            } else if line.len() + 1 + word.len() <= room {
                *line += &format!(" {word}");
            } else {
                lines.push(word);
            }
        }
        lines.iter().map(|line| format!("{}{line}", " ".repeat(indent))).collect::<Vec<_>>().join("\n")
    };
    text.split("\n\n").map(wrapped).collect::<Vec<_>>().join("\n\n")
}
