//! The two drive wheels among the joints of a robot, by their names.

/// The side of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// Left of the heading.
    Left,
    /// Right of the heading.
    Right,
}

/// The joints whose names say that they are on a side; only wheels, where some of them say that they are wheels.
pub fn candidates<'a>(names: impl Iterator<Item = &'a str>, side: Side) -> Vec<&'a str> {
    let on_side: Vec<&str> = names.filter(|name| side_of(name) == Some(side)).collect();
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
