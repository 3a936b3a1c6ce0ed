//! What is wanted of a message, whatever it is encoded in.

/// A number that a message may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Number {
    /// Stamp, whole part \[s\].
    Seconds,
    /// Stamp, the rest \[ns\].
    Nanoseconds,
    /// Position \[m\].
    X,
    Y,
    /// Orientation, a unit quaternion.
    Qx,
    Qy,
    Qz,
    Qw,
    /// \[m/s\]
    Speed,
    /// \[rad/s\]
    TurnRate,
    /// Counts.
    Left,
    Right,
}

/// How many there are.
const NUMBERS: usize = 12;

/// A place in [`Fields`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Slot {
    Number(Number),
    /// Name of the frame in which a pose is given.
    Frame,
    /// Name of the frame whose pose it is.
    Child,
    /// A list of names.
    Names,
    /// A list of numbers.
    Values,
}

/// A field of a message, by its path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Wanted {
    pub path: String,
    pub slot: Slot,
    /// Whether the message is of no use without it.
    pub needed: bool,
}

/// What is wanted of a type of message.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::layout) struct Layout {
    /// The list whose elements are messages of their own, where there is one.
    pub each: Option<&'static str>,
    pub wanted: Vec<Wanted>,
}

impl Layout {
    /// Adds a field that must be there.
    pub fn need(mut self, path: &str, slot: Slot) -> Layout {
        self.wanted.push(Wanted { path: path.to_owned(), slot, needed: true });
        self
    }

    /// Adds the two parts of a stamp, which may be missing.
    pub fn stamp(mut self, path: &str) -> Layout {
        for (part, number) in [("sec", Number::Seconds), ("nanosec", Number::Nanoseconds)] {
            let slot = Slot::Number(number);
            self.wanted.push(Wanted { path: format!("{path}.{part}"), slot, needed: false });
        }
        self
    }

    /// Adds a pose in the plane.
    pub fn pose(mut self, position: &str, orientation: &str) -> Layout {
        use Number::{Qw, Qx, Qy, Qz, X, Y};
        for (path, number) in [("x", X), ("y", Y)] {
            self = self.need(&format!("{position}.{path}"), Slot::Number(number));
        }
        for (path, number) in [("x", Qx), ("y", Qy), ("z", Qz), ("w", Qw)] {
            self = self.need(&format!("{orientation}.{path}"), Slot::Number(number));
        }
        self
    }
}

/// The fields of one message that were wanted.
#[derive(Clone, Debug, Default)]
pub(in crate::layout) struct Fields {
    numbers: [f64; NUMBERS],
    pub frame: String,
    pub child: String,
    pub names: Names,
    pub values: Vec<f64>,
}

impl Fields {
    /// A number of the message; zero where it holds none.
    pub fn number(&self, number: Number) -> f64 {
        self.numbers[number as usize]
    }

    pub fn set(&mut self, number: Number, value: f64) {
        self.numbers[number as usize] = value;
    }

    /// The text that a slot holds.
    pub fn set_text(&mut self, slot: Slot, text: &str) {
        let place = if slot == Slot::Child { &mut self.child } else { &mut self.frame };
        place.clear();
        place.push_str(text);
    }

    pub fn clear(&mut self) {
        self.numbers = [0.0; NUMBERS];
        self.frame.clear();
        self.child.clear();
        self.names.clear();
        self.values.clear();
    }

    /// The stamp \[ns\], where the message has one that is not zero.
    pub fn stamp(&self) -> Option<i64> {
        let (seconds, nanoseconds) = (self.number(Number::Seconds), self.number(Number::Nanoseconds));
        let inside = seconds.abs() < 9e9 && (0.0..1e9).contains(&nanoseconds);
        Some(seconds as i64 * 1_000_000_000 + nanoseconds as i64).filter(|stamp| inside && *stamp != 0)
    }
}

/// A list of names in one piece of memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::layout) struct Names {
    text: String,
    ends: Vec<usize>,
}

impl Names {
    pub fn clear(&mut self) {
        self.text.clear();
        self.ends.clear();
    }

    pub fn push(&mut self, name: &str) {
        self.text.push_str(name);
        self.ends.push(self.text.len());
    }

    pub fn iter(&self) -> impl Iterator<Item = &str> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| &self.text[start..*end])
    }
}

/// Whether a field called `name` is the one called `wanted`; parts of stamps have several names.
pub(in crate::layout) fn same_field(name: &str, wanted: &str) -> bool {
    const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
    const NANOSECONDS: [&str; 4] = ["nanosec", "nsec", "nsecs", "nanos"];
    name == wanted
        || SECONDS.contains(&wanted) && SECONDS.contains(&name)
        || NANOSECONDS.contains(&wanted) && NANOSECONDS.contains(&name)
}
