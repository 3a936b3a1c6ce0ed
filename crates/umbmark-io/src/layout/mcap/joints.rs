//! The two drive wheels among the joints of a robot.

use super::fields::{Fields, Names};
use super::problem::listed;
use crate::error::quoted;

/// The joints of the left and the right wheel.
pub(super) struct Joints {
    /// As the user named them, or as they were found.
    chosen: Option<[String; 2]>,
    /// The names of the last message, and where the wheels are among them.
    last: Names,
    places: Option<[usize; 2]>,
    /// The names of the first message, for those who look for the wheels in vain.
    first: String,
    /// Which joints may be meant, where that is left open.
    open: Option<String>,
}

impl Joints {
    pub fn new(chosen: Option<(&str, &str)>) -> Joints {
        let chosen = chosen.map(|(left, right)| [left.to_owned(), right.to_owned()]);
        Joints { chosen, last: Names::default(), places: None, first: String::new(), open: None }
    }

    /// The positions of the wheels, where the message has them.
    pub fn positions(&mut self, fields: &Fields) -> Result<Option<[f64; 2]>, String> {
        if fields.names != self.last {
            self.last = fields.names.clone();
            self.places = self.find(&fields.names);
        }
        let Some(places) = self.places else { return Ok(None) };
        match places.map(|place| fields.values.get(place).copied()) {
            [Some(left), Some(right)] => Ok(Some([left, right])),
            _ if fields.values.is_empty() => Ok(None),
            _ => Err(format!("has {} positions for {} joints", fields.values.len(), fields.names.iter().count())),
        }
    }

    /// What the wheels are called.
    pub fn names(&self) -> [String; 2] {
        self.chosen.clone().unwrap_or_else(|| ["left", "right"].map(str::to_owned))
    }

    /// Says why no message had the positions of both wheels.
    pub fn missing(&self) -> String {
        if let Some(open) = &self.open {
            return format!("more than one joint may be a wheel: {open}");
        }
        let wanted = match &self.chosen {
            Some([left, right]) => format!("joints {} and {}", quoted(left), quoted(right)),
            None => "a joint of the left and one of the right wheel".to_owned(),
        };
        format!("no message has positions of {wanted}; its joints are {}", self.first)
    }

    fn find(&mut self, names: &Names) -> Option<[usize; 2]> {
        if self.first.is_empty() {
            self.first = listed(names.iter().map(quoted));
        }
        let place = |name: &str| names.iter().position(|n| n == name);
        if let Some([left, right]) = &self.chosen {
            return place(left).zip(place(right)).map(|(left, right)| [left, right]);
        }
        let (left, right) = (candidates(names, Side::Left), candidates(names, Side::Right));
        if left.is_empty() || right.is_empty() {
            return None;
        }
        let ([left], [right]) = (&left[..], &right[..]) else {
            let sides = [left, right].map(|side| listed(side.into_iter().map(quoted)));
            self.open.get_or_insert(format!("left may be {}; right may be {}", sides[0], sides[1]));
            return None;
        };
        self.chosen = Some([(*left).to_owned(), (*right).to_owned()]);
        place(left).zip(place(right)).map(|(left, right)| [left, right])
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// The joints whose names say that they are on a side; only wheels, where some of them say that they are wheels.
fn candidates(names: &Names, side: Side) -> Vec<&str> {
    let on_side: Vec<&str> = names.iter().filter(|name| side_of(name) == Some(side)).collect();
    let wheels: Vec<&str> = on_side.iter().copied().filter(|name| name.to_lowercase().contains("wheel")).collect();
    if wheels.is_empty() { on_side } else { wheels }
}

/// The side that a name says: by the word left or right in it, or by l or r as a word of its own.
fn side_of(name: &str) -> Option<Side> {
    let name = name.to_lowercase();
    let word = |word: &str| name.split(|c: char| !c.is_ascii_alphanumeric()).any(|part| part == word);
    match (name.contains("left"), name.contains("right")) {
        (true, false) => Some(Side::Left),
        (false, true) => Some(Side::Right),
        (true, true) => None,
        (false, false) => match (word("l"), word("r")) {
            (true, false) => Some(Side::Left),
            (false, true) => Some(Side::Right),
            _ => None,
        },
    }
}
