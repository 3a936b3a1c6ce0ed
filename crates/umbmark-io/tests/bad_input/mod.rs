//! Reader of `cases.txt`: input that cannot be used, and what is said of it.

use std::path::Path;
use umbmark_core::drive::DriveKind;
use umbmark_core::path::SHAPES;

const ROBOT: &str = "[robot]\nwheelbase_m = 0.340\nwheel_diameter_m = 0.150\nticks_per_revolution = 2000\n";
const RETURNS: &str = "direction,run,ex_m,ey_m\ncw,1,0.1,0.2\n";

/// A folder with files, and what is said of it.
#[derive(Default)]
pub struct Case {
    pub name: String,
    pub files: Vec<(String, Vec<u8>)>,
    /// What is loaded: the folder (empty) or a file of it.
    pub load: String,
    pub says: String,
}

impl Case {
    /// Writes the files of the case.
    pub fn write(&self, folder: &Path) {
        for (name, bytes) in &self.files {
            let file = folder.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(&file, bytes).unwrap();
        }
    }

    /// `text` without the path of the folder.
    pub fn without_folder(&self, text: &str, folder: &Path) -> String {
        let folder = folder.display().to_string();
        text.replace(&format!("{folder}/"), "").replace(&folder, "FOLDER")
    }
}

/// Every case.
pub fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in include_str!("cases.txt").lines() {
        if let Some(name) = line.strip_prefix("# ") {
            assert!(cases.iter().all(|case| case.name != name), "{name} stands twice");
            cases.push(Case { name: name.to_owned(), ..Case::default() });
        }
        let Some(case) = cases.last_mut() else { continue };
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        match word {
            "with" => case.files.push(good(rest)),
            "file" => case.files.push((rest.to_owned(), Vec::new())),
            "|" => {
                let bytes = &mut case.files.last_mut().unwrap().1;
                bytes.extend(unescaped(rest));
                bytes.push(b'\n');
            }
            "load" => case.load = rest.to_owned(),
            "says" => case.says = with_lists(rest),
            _ => assert!(line.is_empty() || word == "#", "what is {line:?}?"),
        }
    }
    cases
}

/// What is said, with all names in place of what stands for them.
fn with_lists(says: &str) -> String {
    let shapes: Vec<&str> = SHAPES.iter().map(|shape| shape.name).collect();
    let drives: Vec<&str> = DriveKind::ALL.iter().map(|kind| kind.name()).collect();
    says.replace("{shapes}", &shapes.join(", ")).replace("{drives}", &drives.join(", "))
}

fn good(name: &str) -> (String, Vec<u8>) {
    let (file, text) = match name {
        "robot" => ("robot.toml", ROBOT.to_owned()),
        "counter" => ("robot.toml", format!("{ROBOT}counter_bits = 16\n")),
        "returns" => ("returns.csv", RETURNS.to_owned()),
        other => panic!("there is no good file {other:?}"),
    };
    (file.to_owned(), text.into_bytes())
}

fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((first, others)) = rest.split_first() {
        rest = others;
        match (first, others.first()) {
            (b'\\', Some(b't')) => bytes.push(b'\t'),
            (b'\\', Some(b'r')) => bytes.push(b'\r'),
            (b'\\', Some(b'x')) => {
                bytes.push(u8::from_str_radix(std::str::from_utf8(&others[1..3]).unwrap(), 16).unwrap());
                rest = &others[3..];
                continue;
            }
            _ => {
                bytes.push(*first);
                continue;
            }
        }
        rest = &others[1..];
    }
    bytes
}
