//! What is done with any bytes: nothing of it may panic, hang, or give a number that is not finite.
//!
//! Each target says whether the bytes were good for something, so that a test can tell whether its damage is too heavy. `cargo fuzz`
//! runs them for long; `tests/fuzz_targets.rs` runs the same code for a second on a stable toolchain.

use std::path::Path;
use umbmark_core::calibrate;
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Formula, Model, Target};
use umbmark_core::path::Direction;
use umbmark_core::replay::Track;
use umbmark_core::score::score_dataset;
use umbmark_io::checkpoint::Written;
use umbmark_io::{ModelFile, RobotFile, Topics, Words, contents, load};

/// A robot and its ten returns, written by hand.
pub const TAPE: [&str; 2] =
    [include_str!("../../examples/tape/robot.toml"), include_str!("../../examples/tape/returns.csv")];

/// Endings of files of logs. The first byte chooses one, the others are the file.
pub const ENDINGS: [&str; 8] = ["csv", "mcap", "bag", "db3", "txt", "tum", "csv.gz", "yaml"];

/// A log, a sheet or a track of any layout, beside a robot: read, looked at, and its contents listed.
pub fn readers(bytes: &[u8]) -> bool {
    let Some((first, bytes)) = bytes.split_first() else { return false };
    let folder = tempfile::tempdir().expect("a folder for one file");
    let file = folder.path().join(format!("cw_01.{}", ENDINGS[usize::from(*first) % ENDINGS.len()]));
    write(&file, bytes);
    write(&folder.path().join("robot.toml"), TAPE[0].as_bytes());
    let _ = contents(&file, &Topics::default(), &Words::PLAIN);
    let Ok(data) = load(&file) else { return false };
    for log in data.runs.iter().filter_map(|run| run.log.as_ref()) {
        assert!(log.left.iter().chain(&log.right).chain(&log.time).all(|value| value.is_finite()));
        assert!(log.reference.iter().all(|pose| pose.x.is_finite() && pose.y.is_finite()));
    }
    let _ = data.inspect();
    true
}

/// A robot.toml.
pub fn robots(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(RobotFile { robot, path, .. }) = RobotFile::parse("file", text) else { return false };
    let path_is_finite = path.is_none_or(|path| path.length().is_finite());
    assert!(robot.metres_per_tick().left > 0.0 && path_is_finite);
    true
}

/// A model.toml, of its own robot and of another.
pub fn models(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let read = |robot: Option<&Robot>| match ModelFile::parse("file", text, robot) {
        Ok(file) => {
            assert!(file.model.values().all(f64::is_finite));
            true
        }
        Err(_) => false,
    };
    read(None) | read(Some(&Robot::labmate()))
}

/// A formula of two parameters, compiled, and driven round a square where it is finite there.
pub fn formulas(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(formula) = Formula::new("mine", Target::HeadingPerMetre, text, &["a", "b"]) else { return false };
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    if model.add_formula(formula, &[0.01, 0.02]).is_err() {
        return false;
    }
    let track = Track::in_pieces(&umbmark_core::path::Path::umbmark(), Direction::Cw, &robot);
    if track.check(&model).is_ok() {
        let end = track.end(&model.chain());
        assert!(end.x.is_finite() && end.y.is_finite() && end.heading.is_finite(), "{text:?}: {end:?}");
    }
    true
}

/// A checkpoint of a study, read, merged with itself, and written again.
pub fn checkpoints(bytes: &[u8]) -> bool {
    let folder = tempfile::tempdir().expect("a folder for one file");
    let file = folder.path().join("study.json");
    write(&file, bytes);
    let _ = Written::merged(&[file.clone(), file.clone()]);
    let Ok(written) = Written::load(&file) else { return false };
    let text = written.text().expect("what was read can be written");
    write(&file, text.as_bytes());
    let again = Written::load(&file).expect("what was written can be read");
    assert_eq!(again.text().expect("it can be written again"), text);
    true
}

/// The tape's robot and returns, each of three numbers of them multiplied or taken out: scored, calibrated and looked at. Three bytes an
/// action: which file, which number in it, and what is done with it.
pub fn datasets(bytes: &[u8]) -> bool {
    let mut texts = TAPE.map(str::to_owned);
    for action in bytes.chunks_exact(3).take(3) {
        let text = &mut texts[usize::from(action[0]) % 2];
        change(text, usize::from(action[1]), action[2]);
    }
    let folder = tempfile::tempdir().expect("a folder for two files");
    for (name, text) in ["robot.toml", "returns.csv"].iter().zip(&texts) {
        write(&folder.path().join(name), text.as_bytes());
    }
    let Ok(data) = load(folder.path()) else { return false };
    let _ = data.inspect();
    if let Ok(score) = score_dataset(&data, 0.95) {
        assert!(score.summary.e_max_sys().is_none_or(f64::is_finite), "{texts:?}");
    }
    let calibrated = calibrate::calibrate(&data, &calibrate::Options::default());
    calibrated.is_ok()
}

/// Multiplies the number at a place of a text by a power of ten, changes its sign, or takes it out.
fn change(text: &mut String, place: usize, how: u8) {
    let is_of_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let numbers: Vec<(usize, usize)> = text
        .split(|c| !is_of_number(c))
        .filter(|part| part.parse::<f64>().is_ok())
        .map(|part| (part.as_ptr() as usize - text.as_ptr() as usize, part.len()))
        .collect();
    let Some((at, length)) = numbers.get(place % numbers.len().max(1)).copied() else { return };
    let number: f64 = text[at..at + length].parse().unwrap_or(0.0);
    let new = match how {
        0..=200 => format!("{:e}", number * 10f64.powi(i32::from(how) - 100)),
        201..=230 => format!("{}", -number),
        _ => String::new(),
    };
    text.replace_range(at..at + length, &new);
}

fn write(file: &Path, bytes: &[u8]) {
    std::fs::write(file, bytes).expect("the folder was made for it");
}
