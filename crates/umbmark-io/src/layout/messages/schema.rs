//! Message definitions as ROS 2 writes them (`ros2msg`): one definition, then those that it needs, each behind a line of
//! equals signs and `MSG: package/Type`.
//!
//! Source: <https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html> and the registry of MCAP.

use std::collections::HashMap;

/// A type that is not made of others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Primitive {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Primitive {
    fn of(name: &str) -> Option<Primitive> {
        Some(match name {
            "bool" => Primitive::Bool,
            "int8" => Primitive::I8,
            "byte" | "char" | "uint8" => Primitive::U8,
            "int16" => Primitive::I16,
            "uint16" => Primitive::U16,
            "int32" => Primitive::I32,
            "uint32" => Primitive::U32,
            "int64" => Primitive::I64,
            "uint64" => Primitive::U64,
            "float32" => Primitive::F32,
            "float64" => Primitive::F64,
            _ => return None,
        })
    }

    /// Size and alignment \[byte\].
    pub fn size(self) -> usize {
        match self {
            Primitive::Bool | Primitive::I8 | Primitive::U8 => 1,
            Primitive::I16 | Primitive::U16 => 2,
            Primitive::I32 | Primitive::U32 | Primitive::F32 => 4,
            Primitive::I64 | Primitive::U64 | Primitive::F64 => 8,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Primitive::Bool | Primitive::F32 | Primitive::F64)
    }
}

/// What a field is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) enum FieldType {
    Primitive(Primitive),
    Text,
    /// Text of wide characters, whose width on the wire differs between systems.
    WideText,
    /// Another definition, by its name.
    Message(String),
}

/// How many of it there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Count {
    One,
    Exactly(usize),
    Any,
}

/// A field of a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Field {
    pub name: String,
    pub kind: FieldType,
    pub count: Count,
}

/// The definitions of a schema.
#[derive(Clone, Debug, Default)]
pub(in crate::layout) struct Schema {
    pub root: String,
    messages: HashMap<String, Vec<Field>>,
}

impl Schema {
    /// Reads the definition of `name` and of what it needs.
    pub fn parse(name: &str, text: &[u8]) -> Result<Schema, String> {
        let text = std::str::from_utf8(text).map_err(|_| "its schema is not UTF-8".to_owned())?;
        let root = normal(name);
        let mut schema = Schema { root: root.clone(), messages: HashMap::new() };
        let mut current = (root, Vec::new());
        for line in text.lines() {
            let line = line.trim();
            if let Some(next) = line.strip_prefix("MSG:") {
                let (name, fields) = std::mem::replace(&mut current, (normal(next.trim()), Vec::new()));
                schema.messages.entry(name).or_insert(fields);
            } else if !line.starts_with("===") {
                current.1.extend(field(line, &current.0)?);
            }
        }
        schema.messages.entry(current.0).or_insert(current.1);
        Ok(schema)
    }

    /// The fields of a definition.
    pub fn fields(&self, name: &str) -> Option<&[Field]> {
        self.messages.get(name).map(Vec::as_slice)
    }
}

/// A name without the folder that ROS 2 puts between package and type.
pub(in crate::layout) fn normal(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// The field that a line defines; nothing for comments and constants.
fn field(line: &str, of: &str) -> Result<Option<Field>, String> {
    let line = line.split('#').next().unwrap_or("").trim();
    let mut words = line.split_whitespace();
    let Some(type_name) = words.next() else { return Ok(None) };
    let broken = || format!("its schema has the line {}, which is no field", crate::error::quoted(line));
    let name = words.next().ok_or_else(broken)?;
    if name.contains('=') || words.next().is_some_and(|word| word.starts_with('=')) {
        return Ok(None);
    }
    let (base, count) = match type_name.strip_suffix(']').and_then(|inside| inside.split_once('[')) {
        None if type_name.contains('[') || type_name.contains(']') => return Err(broken()),
        None => (type_name, Count::One),
        Some((base, "")) => (base, Count::Any),
        Some((base, bound)) if bound.starts_with("<=") => (base, Count::Any),
        Some((base, number)) => (base, Count::Exactly(number.parse().map_err(|_| broken())?)),
    };
    let base = base.split("<=").next().unwrap_or(base);
    let sound = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '/');
    if base.is_empty() || !sound(base) || !sound(name) {
        return Err(broken());
    }
    Ok(Some(Field { name: name.to_owned(), kind: kind(base, of), count }))
}

fn kind(base: &str, of: &str) -> FieldType {
    match base {
        "string" => FieldType::Text,
        "wstring" => FieldType::WideText,
        "time" => FieldType::Message("builtin_interfaces/Time".to_owned()),
        "duration" => FieldType::Message("builtin_interfaces/Duration".to_owned()),
        "Header" => FieldType::Message("std_msgs/Header".to_owned()),
        _ => match (Primitive::of(base), base.contains('/'), of.rsplit_once('/')) {
            (Some(primitive), ..) => FieldType::Primitive(primitive),
            (None, false, Some((package, _))) => FieldType::Message(format!("{package}/{base}")),
            _ => FieldType::Message(normal(base)),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_constants_comments_and_bounds_are_told_apart() {
        let text = "# a comment\nint32 A=5\nstring B = \"x # y\"\nint32 number 7 # with default\nstring<=10 name\n\
                    float64[<=5] bounded\nfloat64[36] fixed\nPoint[] points\nHeader header\n\
                    ================\nMSG: demo/msg/Point\nfloat64 x\n";
        let schema = Schema::parse("demo/msg/Thing", text.as_bytes()).unwrap();
        let fields = schema.fields("demo/Thing").unwrap();
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["number", "name", "bounded", "fixed", "points", "header"]);
        assert_eq!(fields[2].count, Count::Any);
        assert_eq!(fields[3].count, Count::Exactly(36));
        assert_eq!(fields[4].kind, FieldType::Message("demo/Point".into()));
        assert_eq!(schema.fields("demo/Point").unwrap().len(), 1);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "float64",
            "float64[ x",
            "float64[-1] x",
            "float64[1e9] x",
            "string c \"\nint32[99999999999999999999] y",
            "a\0b c",
        ] {
            assert!(Schema::parse("demo/Thing", text.as_bytes()).is_err(), "{text:?}");
        }
        assert!(Schema::parse("demo/Thing", b"\xff").is_err());
    }
}
