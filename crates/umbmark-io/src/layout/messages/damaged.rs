//! Good files of messages with random damage, read as the command reads them.

use super::{Survey, Topics};
use crate::mutated_input::damage;
use std::io::{Seek, Write};
use umbmark_core::dataset::TickLog;
use umbmark_core::drive::Robot;
use umbmark_core::random::Stream;

/// Inputs of a layer; `share` of them where it is slow. `UMBMARK_MUTATIONS` sets how many.
pub(in crate::layout) fn rounds(share: u64) -> u64 {
    let wish = std::env::var("UMBMARK_MUTATIONS").ok().and_then(|text| text.parse().ok());
    wish.unwrap_or(20_000) / share
}

/// The log in a file of these bytes; what is wrong with it.
pub(in crate::layout) fn read(bytes: &[u8]) -> Result<TickLog, String> {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    read_file(file.path(), &Topics::default(), &Robot::labmate())
}

/// The log in a file. What is read is finite, and in the order of time.
pub(in crate::layout) fn read_file(file: &std::path::Path, wish: &Topics, robot: &Robot) -> Result<TickLog, String> {
    let read = Survey::open(file)
        .and_then(|survey| survey.read(wish, Some(robot), &mut Vec::new()))
        .and_then(|reading| reading.into_log(Some(robot), &mut Vec::new()));
    let log = read.map_err(|error| error.to_string())?;
    assert!(log.time.iter().chain(&log.left).chain(&log.right).all(|value| value.is_finite()));
    assert!(log.reference.iter().all(|pose| pose.x.is_finite() && pose.sample < log.time.len()));
    assert!(log.time.windows(2).all(|pair| pair[0] < pair[1]));
    Ok(log)
}

/// A file that is to be damaged.
pub(in crate::layout) struct Damaged<'b> {
    pub good: &'b [u8],
    /// Of the random numbers.
    pub purpose: u64,
    pub share: u64,
}

impl Damaged<'_> {
    /// Reads it with many kinds of damage; some of them leave it readable, and some do not.
    pub fn read_all(&self, robot: &Robot) {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        let mut stream = Stream::new(7, self.purpose, 0);
        let mut fine = 0;
        assert!(read(self.good).is_ok(), "the undamaged file is good");
        let rounds = rounds(self.share);
        for round in 0..rounds {
            let bytes =
                if round % 3 == 0 { exaggerated(self.good, &mut stream) } else { damage(self.good, &mut stream) };
            let handle = file.as_file_mut();
            handle.set_len(0).unwrap();
            handle.rewind().unwrap();
            handle.write_all(&bytes).unwrap();
            fine += u64::from(read_file(file.path(), &Topics::default(), robot).is_ok());
        }
        assert!(fine > 0 && fine < rounds, "{fine}: damage too heavy or too light to tell anything");
    }
}

/// A file with one number of 4 or 8 bytes that is as large or as odd as a length can be.
pub(in crate::layout) fn exaggerated(good: &[u8], stream: &mut Stream) -> Vec<u8> {
    const LENGTHS: [u64; 8] = [0, 1, 1 << 20, 1 << 31, 1 << 40, 1 << 63, u64::MAX - 9, u64::MAX];
    let mut bytes = good.to_vec();
    let mut below = |n: usize| ((stream.uniform() * n as f64) as usize).min(n - 1);
    let (at, width) = (below(bytes.len() - 8), [4, 8][below(2)]);
    bytes[at..at + width].copy_from_slice(&LENGTHS[below(LENGTHS.len())].to_le_bytes()[..width]);
    bytes
}
