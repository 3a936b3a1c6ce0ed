//! Datasets that were measured, or made by another simulator: read as they are, where they are there.

use std::io::Write;
use std::path::{Path, PathBuf};
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

/// A folder of the data beside the project, or a notice that it is not there.
fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    // Past the harness, which keeps what a passing test prints to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
    None
}

fn folders(path: &Path) -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

#[test]
fn return_errors_of_real_squares_have_the_largest_size_that_their_authors_published() {
    let Some(folder) = shared("optiodom") else { return };
    let published = std::fs::read_to_string(folder.join("published_diff-UMBmark.csv")).unwrap();
    let mut sets = 0;
    for line in published.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        let Some(set) = cells[0].rsplit('/').next().filter(|_| cells[0].starts_with("diff/square")) else { continue };
        let path = folder.join("raw/square").join(set);
        if !path.is_dir() {
            continue;
        }
        let data = umbmark_io::load(&path).unwrap();
        let largest = data.runs.iter().map(|run| run.returned.unwrap()).map(|e| e.x.hypot(e.y)).fold(0.0, f64::max);
        let expected: f64 = cells[6].parse().unwrap();
        assert!((largest - expected).abs() < 1e-6, "{set}: {largest} {expected}");
        let robot = data.nominal_robot().unwrap();
        assert_eq!(robot.drive.wheelbase(), cells[1].parse::<f64>().unwrap());
        assert_eq!(robot.encoder.ticks_per_revolution(), 64.0 * 43.7);
        let both = Direction::BOTH.map(|direction| data.returns(TestKind::Systematic, direction).count());
        assert_eq!(both, [data.runs.len() / 2; 2], "{set}");
        assert_eq!(data.path.unwrap().values(), [cells[16].parse::<f64>().unwrap()]);
        sets += 1;
    }
    assert_eq!(sets, 6);
}

#[test]
fn every_optiodom_set_is_read_with_directions_as_its_readme_says() {
    let Some(folder) = shared("optiodom/raw") else { return };
    for set in folders(&folder.join("circular")).iter().chain(&folders(&folder.join("square"))) {
        let data = umbmark_io::load(set).unwrap();
        assert!(data.warnings.is_empty(), "{set:?}: {:?}", data.warnings);
        assert!(data.runs.iter().all(|run| run.direction.is_some()));
    }
    for set in folders(&folder.join("ivanjko")) {
        let data = umbmark_io::load(&set).unwrap();
        let third = data.runs.len() / 3;
        for direction in [None, Some(Direction::Cw), Some(Direction::Ccw)] {
            assert_eq!(data.runs.iter().filter(|run| run.direction == direction).count(), third, "{set:?}");
        }
    }
}

#[test]
fn made_datasets_are_read_with_matching_logs_and_returns() {
    let Some(folder) = shared("made") else { return };
    for path in folders(&folder) {
        let data = umbmark_io::load(&path).unwrap();
        assert!(data.warnings.is_empty(), "{path:?}: {:?}", data.warnings);
        assert!(data.runs.iter().all(|run| run.log.is_some() && run.returned.is_some() && run.direction.is_some()));
        let sheet = umbmark_io::load(path.join("returns.csv")).unwrap();
        let log = umbmark_io::load(path.join("runs/cw_01.csv")).unwrap();
        for run in &data.runs {
            let row = sheet.runs.iter().find(|r| r.direction == run.direction && r.number == run.number).unwrap();
            assert_eq!(row.returned, run.returned);
        }
        let from_log = log.runs[0].returned.unwrap();
        let from_sheet = data.runs.iter().find(|run| run.name == "cw_01").unwrap().returned.unwrap();
        assert!((from_log.x - from_sheet.x).hypot(from_log.y - from_sheet.y) < 5e-3);
        assert!((from_log.heading.unwrap() - from_sheet.heading.unwrap()).abs() < 5e-3);
    }
}
