//! The Rust side of `peers/mcap_readers.py`: `mcap_log write FOLDER` writes the logs and prints the bytes of their
//! messages, `mcap_log read FILE ROUNDS` prints the CPU seconds of each round of reading one into the dataset type.

use std::io::{self, Write as _};
use std::path::Path;
use std::time::Instant;
use umbmark_benches::mcap_logs::{READ, message_bytes, rewrite, write};

fn main() -> io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut out = io::stdout();
    match &arguments[..] {
        [verb, folder] if verb == "write" => {
            let folder = Path::new(folder);
            let (all, alone) = (folder.join("all.mcap"), folder.join("alone.mcap"));
            write(&all);
            rewrite(&all, &alone, &READ, Some(mcap::Compression::Zstd));
            for file in [all, alone] {
                writeln!(out, "{} {}", file.display(), message_bytes(&file))?;
            }
        }
        [verb, file, rounds] if verb == "read" => {
            for _ in 0..rounds.parse::<u32>().map_err(io::Error::other)? {
                let began = Instant::now();
                let data = umbmark_io::load(file).map_err(io::Error::other)?;
                let log = data.runs[0].log.as_ref();
                let counts = log.map_or((0, 0), |log| (log.time.len(), log.reference.len()));
                writeln!(out, "{} {} {}", began.elapsed().as_secs_f64(), counts.0, counts.1)?;
            }
        }
        _ => return Err(io::Error::other("mcap_log write FOLDER, or mcap_log read FILE ROUNDS")),
    }
    Ok(())
}
