//! The two drive wheels among the joints of a robot.

use super::fields::{Fields, Names};
use super::problem::listed;
use crate::error::quoted;
use crate::wheel_names::{Side, candidates};

/// The joints of the left and the right wheel.
pub(in crate::layout) struct Joints {
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
        let (left, right) = (candidates(names.iter(), Side::Left), candidates(names.iter(), Side::Right));
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
