//! Random damage to good files. `tests/fuzz_targets.rs` of the whole takes it too.

use umbmark_core::random::Stream;

/// Pieces that parsers trip over.
const PIECES: [&str; 20] = [
    ",",
    "\n",
    "\r\n",
    "\"",
    "#",
    "nan",
    "-inf",
    "1e308",
    "-1e-308",
    "9007199254740993",
    "=",
    "[",
    "]]",
    "{",
    "\u{feff}",
    "\0",
    "ä",
    ";",
    "",
    "-0",
];

/// `good` with up to five bytes changed, pieces put in, or parts cut out or doubled.
pub fn damage(good: &[u8], stream: &mut Stream) -> Vec<u8> {
    let mut bytes = good.to_vec();
    let mut below = |n: usize| ((stream.uniform() * n as f64) as usize).min(n.saturating_sub(1));
    for _ in 0..=below(5) {
        let (a, b) = (below(bytes.len() + 1), below(bytes.len() + 1));
        let (a, b) = (a.min(b), a.max(b));
        match below(5) {
            0 if a < bytes.len() => bytes[a] = below(256) as u8,
            1 => drop(bytes.splice(a..a, PIECES[below(PIECES.len())].bytes())),
            2 => drop(bytes.splice(a..b.min(a + 12), PIECES[below(PIECES.len())].bytes())),
            3 => drop(bytes.drain(a..b)),
            _ => {
                let copy = bytes[a..b].to_vec();
                drop(bytes.splice(a..a, copy));
            }
        }
    }
    bytes
}
