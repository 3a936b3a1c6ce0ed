//! Messages of ROS, decoded by a plan that is made of their schema once.
//!
//! A plan steps over what is not wanted and ends behind the last field that is. Every length is bounded by the bytes that
//! are left, and nothing is allocated for what a message only claims to hold.

use super::fields::{Fields, Layout, Number, Slot, Wanted, same_field};
use super::message_type::Encoding;
use super::schema::{Count, Field, FieldType, Primitive, Schema};
use super::wire::{Broken, Packed, Wire};
use re_cdr::{BigEndian, CdrReader, LittleEndian};

/// Definitions in definitions, at most so deep.
const DEEPEST: usize = 32;
/// Steps of a plan, at most.
const LONGEST: usize = 4096;

/// A step through a message.
#[derive(Clone, Debug)]
enum Instruction {
    /// Numbers of a size, `count` of them.
    Skip {
        size: usize,
        count: usize,
    },
    SkipText,
    /// A list of numbers of a size.
    SkipList {
        size: usize,
    },
    Number(Primitive, Number),
    Text(Slot),
    Names,
    Values(Primitive),
    /// Something that is there `count` times, or as often as the message says.
    Repeat {
        count: Option<usize>,
        steps: Box<[Instruction]>,
    },
    /// The list whose elements are messages of their own.
    Each(Box<[Instruction]>),
    /// What nobody can step over.
    Wall(&'static str),
}

/// How to decode the messages of a topic.
#[derive(Clone, Debug)]
pub(in crate::layout) struct Plan {
    encoding: Encoding,
    steps: Box<[Instruction]>,
}

impl Plan {
    /// A plan that finds what is wanted in messages of ROS 2 (CDR) or of ROS 1.
    pub fn new(encoding: Encoding, schema: &Schema, layout: &Layout) -> Result<Plan, String> {
        let packed = encoding == Encoding::Ros1;
        let mut compiler = Compiler { schema, layout, packed, found: vec![false; layout.wanted.len()], steps: 0 };
        let mut steps = compiler.message(&schema.root, Some(""), 0)?;
        let missing = layout.wanted.iter().zip(&compiler.found).find(|(wanted, found)| wanted.needed && !**found);
        if let Some((wanted, _)) = missing {
            return Err(format!("its type has no field {}", wanted.path));
        }
        shorten(&mut steps);
        match wall(&steps) {
            Some(what) => Err(format!("its type has {what} before what is wanted, which cannot be read")),
            None => Ok(Plan { encoding, steps: steps.into() }),
        }
    }

    /// Decodes a message, and visits it, or each message of its list.
    pub fn read<E>(
        &self,
        data: &[u8],
        fields: &mut Fields,
        visit: &mut dyn FnMut(&Fields) -> Result<(), E>,
    ) -> Result<Result<(), E>, String> {
        fields.clear();
        let mut run = Run { fields, visit, single: true, failed: None };
        let end = match (self.encoding, data) {
            (Encoding::Ros1, _) => run.all(&self.steps, &mut Packed::new(data)),
            (_, [0, 0, _, _, body @ ..]) => run.all(&self.steps, &mut CdrReader::<BigEndian>::new(body)),
            (_, [0, 1, _, _, body @ ..]) => run.all(&self.steps, &mut CdrReader::<LittleEndian>::new(body)),
            (_, [_, kind, _, _, ..]) => {
                return Err(format!("is encoded in CDR of kind {kind:#04x}, where 0 and 1 can be read"));
            }
            _ => return Err("is shorter than the header of CDR".to_owned()),
        };
        match (end, run.failed) {
            (_, Some(error)) => Ok(Err(error)),
            (Err(Broken::Text), None) => Err("has a name that is not UTF-8".to_owned()),
            (Err(Broken::Short), None) => Err("ends before its type does".to_owned()),
            (Ok(()), None) if run.single => Ok(visit(fields)),
            (Ok(()), None) => Ok(Ok(())),
        }
    }
}

struct Compiler<'s> {
    schema: &'s Schema,
    layout: &'s Layout,
    /// Whether it is ROS 1, which puts nothing between fields.
    packed: bool,
    found: Vec<bool>,
    steps: usize,
}

impl Compiler<'_> {
    /// The steps of a definition; `path` is where it is, or nothing where no field of it can be wanted.
    fn message(&mut self, name: &str, path: Option<&str>, depth: usize) -> Result<Vec<Instruction>, String> {
        const TIME: [&str; 2] = ["builtin_interfaces/Time", "builtin_interfaces/Duration"];
        if depth > DEEPEST {
            return Err(format!("its schema is deeper than {DEEPEST} types in each other"));
        }
        let part = |name: &str, primitive| Field {
            name: name.to_owned(),
            kind: FieldType::Primitive(primitive),
            count: Count::One,
        };
        let time = [part("sec", Primitive::I32), part("nanosec", Primitive::U32)];
        let fields = match self.schema.fields(name) {
            Some(fields) => fields,
            None if TIME.contains(&name) => &time,
            None => return Err(format!("its schema does not define {}", crate::error::quoted(name))),
        };
        let mut steps = Vec::new();
        for field in fields {
            let path =
                path.map(|path| if path.is_empty() { field.name.clone() } else { format!("{path}.{}", field.name) });
            let step = self.field(field, path.as_deref(), depth)?;
            self.steps += step.len();
            if self.steps > LONGEST {
                return Err(format!("its schema has more than {LONGEST} fields"));
            }
            steps.extend(step);
        }
        // A definition without fields takes a byte of CDR.
        Ok(if fields.is_empty() && !self.packed { vec![Instruction::Skip { size: 1, count: 1 }] } else { steps })
    }

    fn field(&mut self, field: &Field, path: Option<&str>, depth: usize) -> Result<Vec<Instruction>, String> {
        let slot = path.and_then(|path| self.slot(path));
        let each = self.layout.each.filter(|each| Some(*each) == path && field.count == Count::Any);
        Ok(match (&field.kind, field.count, slot) {
            (FieldType::Primitive(primitive), Count::One, Some(Slot::Number(number))) => {
                vec![Instruction::Number(*primitive, number)]
            }
            (FieldType::Primitive(primitive), Count::Any, Some(Slot::Values)) => vec![Instruction::Values(*primitive)],
            (FieldType::Text, Count::One, Some(slot @ (Slot::Frame | Slot::Child))) => vec![Instruction::Text(slot)],
            (FieldType::Text, Count::Any, Some(Slot::Names)) => vec![Instruction::Names],
            (.., Some(_)) => return Err(format!("its field {} has another type than it should", path.unwrap_or(""))),
            (FieldType::Primitive(primitive), Count::Any, None) => {
                vec![Instruction::SkipList { size: primitive.size() }]
            }
            (FieldType::Primitive(primitive), Count::One, None) => {
                vec![Instruction::Skip { size: primitive.size(), count: 1 }]
            }
            (FieldType::Primitive(primitive), Count::Exactly(count), None) => {
                vec![Instruction::Skip { size: primitive.size(), count }]
            }
            (FieldType::Text, count, None) => repeated(count, vec![Instruction::SkipText]),
            (FieldType::WideText, ..) => vec![Instruction::Wall("wide text")],
            (FieldType::Message(name), ..) if each.is_some() => {
                vec![Instruction::Each(self.message(name, path, depth + 1)?.into())]
            }
            (FieldType::Message(name), Count::One, None) => self.message(name, path, depth + 1)?,
            (FieldType::Message(name), count, None) => repeated(count, self.message(name, None, depth + 1)?),
        })
    }

    /// The slot that a field goes to.
    fn slot(&mut self, path: &str) -> Option<Slot> {
        let inside = match self.layout.each {
            Some(each) => path.strip_prefix(each)?.strip_prefix('.')?,
            None => path,
        };
        let fits = |wanted: &Wanted| match (inside.rsplit_once('.'), wanted.path.rsplit_once('.')) {
            (Some((a, last)), Some((b, wanted))) => a == b && same_field(last, wanted),
            _ => inside == wanted.path,
        };
        let place = self.layout.wanted.iter().position(fits)?;
        self.found[place] = true;
        Some(self.layout.wanted[place].slot)
    }
}

fn repeated(count: Count, steps: Vec<Instruction>) -> Vec<Instruction> {
    match count {
        Count::One => steps,
        Count::Any => vec![Instruction::Repeat { count: None, steps: steps.into() }],
        Count::Exactly(count) => vec![Instruction::Repeat { count: Some(count), steps: steps.into() }],
    }
}

fn takes(step: &Instruction) -> bool {
    matches!(
        step,
        Instruction::Number(..)
            | Instruction::Text(_)
            | Instruction::Names
            | Instruction::Values(_)
            | Instruction::Each(_)
    )
}

/// Leaves out what comes behind the last field that is wanted, and joins what is stepped over.
fn shorten(steps: &mut Vec<Instruction>) {
    let end = steps.iter().rposition(takes).map_or(0, |last| last + 1);
    steps.truncate(end);
    let mut joined: Vec<Instruction> = Vec::with_capacity(steps.len());
    for step in steps.drain(..) {
        match (joined.last_mut(), &step) {
            (Some(Instruction::Skip { size, count }), Instruction::Skip { size: next, count: more })
                if size == next =>
            {
                *count = count.saturating_add(*more);
            }
            _ => joined.push(step),
        }
    }
    *steps = joined;
}

fn wall(steps: &[Instruction]) -> Option<&'static str> {
    steps.iter().find_map(|step| match step {
        Instruction::Wall(what) => Some(*what),
        Instruction::Each(steps) | Instruction::Repeat { steps, .. } => wall(steps),
        _ => None,
    })
}

struct Run<'r, E> {
    fields: &'r mut Fields,
    visit: &'r mut dyn FnMut(&Fields) -> Result<(), E>,
    /// Whether the message is one and no list of them.
    single: bool,
    failed: Option<E>,
}

impl<E> Run<'_, E> {
    fn all(&mut self, steps: &[Instruction], wire: &mut impl Wire) -> Result<(), Broken> {
        steps.iter().try_for_each(|step| self.step(step, wire))
    }

    /// Does something `count` times, or once where it takes no room: then it may be there any number of times.
    fn repeat<W: Wire>(
        &mut self,
        count: usize,
        wire: &mut W,
        mut once: impl FnMut(&mut Self, &mut W) -> Result<(), Broken>,
    ) -> Result<(), Broken> {
        for _ in 0..count {
            let before = wire.position();
            once(self, wire)?;
            if wire.position() == before {
                break;
            }
        }
        Ok(())
    }

    fn step(&mut self, step: &Instruction, wire: &mut impl Wire) -> Result<(), Broken> {
        match step {
            Instruction::Skip { size, count } => wire.skip(*size, *count),
            Instruction::SkipText => wire.skip_text(),
            Instruction::SkipList { size } => {
                let count = wire.length()?;
                wire.skip(*size, count)
            }
            Instruction::Number(primitive, place) => {
                let value = wire.number(*primitive)?;
                self.fields.set(*place, value);
                Ok(())
            }
            Instruction::Text(slot) => {
                self.fields.set_text(*slot, wire.text()?);
                Ok(())
            }
            Instruction::Names => {
                for _ in 0..wire.length()? {
                    self.fields.names.push(wire.text()?);
                }
                Ok(())
            }
            Instruction::Values(primitive) => {
                for _ in 0..wire.length()? {
                    let value = wire.number(*primitive)?;
                    self.fields.values.push(value);
                }
                Ok(())
            }
            Instruction::Repeat { count, steps } => {
                let count = count.map_or_else(|| wire.length(), Ok)?;
                self.repeat(count, wire, |run, wire| run.all(steps, wire))
            }
            Instruction::Each(steps) => {
                self.single = false;
                let count = wire.length()?;
                self.repeat(count, wire, |run, wire| {
                    run.fields.clear();
                    run.all(steps, wire)?;
                    if run.failed.is_none() {
                        run.failed = (run.visit)(run.fields).err();
                    }
                    Ok(())
                })
            }
            Instruction::Wall(_) => Err(Broken::Short),
        }
    }
}
