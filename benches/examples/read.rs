//! Reads a dataset folder a number of times and prints its rows and poses, for `peers/read_csv.py`; with `--write` writes a
//! folder with one log of so many rows.

use std::path::PathBuf;
use umbmark_benches::logs::{ROBOT, log_text};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, task, folder, number] = &arguments[..] else { return Err("read --write|--read FOLDER NUMBER".into()) };
    let (folder, number) = (PathBuf::from(folder), number.parse::<usize>()?);
    if task == "--write" {
        std::fs::create_dir_all(folder.join("runs"))?;
        std::fs::write(folder.join("robot.toml"), ROBOT)?;
        std::fs::write(folder.join("runs/ccw_01.csv"), log_text(number))?;
        return Ok(());
    }
    for _ in 0..number {
        let data = umbmark_io::load(&folder)?;
        let log = data.runs[0].log.as_ref().ok_or("no log")?;
        print_line(&format!("{} {}", log.time.len(), log.reference.len()));
    }
    Ok(())
}

#[allow(clippy::print_stdout, reason = "a program for a script")]
fn print_line(line: &str) {
    println!("{line}");
}
