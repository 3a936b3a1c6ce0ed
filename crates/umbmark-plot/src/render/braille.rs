//! Characters of two by four dots.

/// Dots of a character, across and down.
pub const ACROSS: usize = 2;
/// See [`ACROSS`].
pub const DOWN: usize = 4;

/// What each dot adds to U+2800, by row and column.
pub const DOTS: [[u32; ACROSS]; DOWN] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// The character with these dots; `blank` without any.
pub fn character(dots: u32, blank: char) -> char {
    if dots == 0 { blank } else { char::from_u32(0x2800 + dots).unwrap_or(blank) }
}
