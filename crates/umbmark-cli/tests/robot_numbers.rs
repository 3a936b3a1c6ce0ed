//! A robot's and a path's numbers are described once: file, flag, sweep and constructor refuse the same values in the same
//! words. What Python's `Robot` refuses is what the file refuses.

use snapbox::cmd::{Command, cargo_bin};
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{Quantity, Study};
use umbmark_core::path::Path;
use umbmark_io::RobotFile;

fn said_by_mc(arguments: &[String]) -> String {
    let assert = Command::new(cargo_bin!("umbmark")).args(["mc", "-n", "1"]).args(arguments).assert().code(1);
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

fn said_by_file(key: &str, value: f64) -> String {
    let file = RobotFile::new(Robot::labmate(), Some(Path::umbmark())).text();
    let line = format!("{key} = {value:?}");
    let mut found = 0;
    let lines: Vec<&str> = file
        .lines()
        .map(|old| {
            let this = old.split(' ').next() == Some(key);
            found += usize::from(this);
            if this { line.as_str() } else { old }
        })
        .collect();
    assert_eq!(found, 1, "{key} in {file}");
    RobotFile::parse("robot.toml", &lines.join("\n")).unwrap_err().to_string()
}

#[test]
fn every_edge_refuses_the_same_values_of_a_robots_and_a_paths_numbers_in_the_same_words() {
    let study = Study::new(Model::new(&Robot::labmate()), 1, 1);
    for flag in [
        "wheelbase",
        "wheel-diameter",
        "ticks-per-revolution",
        "encoder-rate",
        "side",
        "speed",
        "acceleration",
        "pause",
    ] {
        let quantity = Quantity::find(flag, &study).unwrap();
        let (key, (low, high)) = (quantity.parameter().name, quantity.parameter().bounds);
        for value in [low - 1e-3 * (1.0 + low), -1.0, 1.5 * high] {
            let refused = said_by_file(key, value);
            let refused = refused.split_once(": ").unwrap().1;
            assert!(refused.starts_with(&format!("{key} must be between ")), "{refused}");
            let sentence = refused.rsplit_once(", got ").unwrap().0;
            let set = quantity.set(&mut study.clone(), value).unwrap_err().to_string();
            assert!(set.starts_with(sentence), "{flag} {value}: {set}");
            let flagged = said_by_mc(&[format!("--{flag}={value}")]);
            assert!(flagged.contains(sentence), "--{flag} {value}: {flagged}");
            let swept = said_by_mc(&["--sweep".into(), format!("{flag}={value}:{value}:1")]);
            assert!(swept.contains(sentence), "--sweep {flag} {value}: {swept}");
        }
    }
}
