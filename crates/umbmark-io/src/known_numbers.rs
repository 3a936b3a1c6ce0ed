//! Numbers of a robot that another file says, such as a URDF.

/// Numbers of a robot from one source, such as a URDF.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownNumbers {
    /// The robot's name, where the source has one.
    pub name: Option<String>,
    /// The numbers.
    pub numbers: Vec<KnownNumber>,
    file: String,
}

/// A number of a robot, and where it is from.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownNumber {
    /// Its key in robot.toml.
    pub key: &'static str,
    /// Its value, in the unit of the key.
    pub value: f64,
    /// Where it is from, in words.
    pub source: String,
}

impl KnownNumbers {
    /// None yet, from a file; an empty name stands for the command line.
    pub fn of(file: &str) -> KnownNumbers {
        KnownNumbers { file: file.to_owned(), ..KnownNumbers::default() }
    }

    /// Adds a number, which is `what` in the file.
    pub fn push(&mut self, key: &'static str, value: f64, what: &str) {
        let source = if self.file.is_empty() { what.to_owned() } else { format!("{what} in {}", self.file) };
        self.numbers.push(KnownNumber { key, value, source });
    }

    pub(super) fn get(&self, keys: &[&str]) -> Option<&KnownNumber> {
        self.numbers.iter().find(|number| keys.contains(&number.key))
    }
}
