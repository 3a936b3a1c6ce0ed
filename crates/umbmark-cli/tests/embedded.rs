//! `umbmark export --to embedded`: a program in C that includes the table gives the poses of `umbmark apply`, to every digit.

#![allow(clippy::print_stdout)]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::likelihood::Noise;
use umbmark_io::ModelFile;

const TOP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn model(effects: &[(&str, &str, f64)]) -> String {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in effects {
        model.set(effect, parameter, *value).unwrap();
    }
    ModelFile { noise: Some(Noise::default()), ..ModelFile::new(model) }.text()
}

/// A drive with legs, arcs, turns on the spot and stops at 50 Hz.
fn log() -> String {
    let mut text = "t_s,ticks_left,ticks_right\n".to_owned();
    let (mut left, mut right) = (0.0, 0.0);
    for row in 0..1500 {
        let [l, r] = [[30.0, 30.0], [-12.0, 12.0], [30.0, 22.0], [0.0, 0.0], [-20.0, -21.5]][row / 60 % 5];
        (left, right) = (left + l, right + r);
        writeln!(text, "{:.2},{},{}", row as f64 * 0.02, f64::floor(left), f64::floor(right)).unwrap();
    }
    text
}

fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|why| panic!("{command:?}: {why}"));
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    done(Command::new(env!("CARGO_BIN_EXE_umbmark")).args(arguments).current_dir(folder))
}

/// Builds the static library beside the command that is tested.
fn library() -> PathBuf {
    let target = Path::new(env!("CARGO_BIN_EXE_umbmark")).parent().unwrap().parent().unwrap();
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["build", "--release", "--offline", "-p", "umbmark-odometry-c", "--target-dir"])
        .arg(target)
        .current_dir(TOP);
    done(&mut cargo);
    target.join("release/libumbmark_odometry_c.a")
}

/// The numbers of each row.
fn rows(text: &str) -> Vec<Vec<u64>> {
    let is_row = |line: &&str| line.starts_with(|first: char| first.is_ascii_digit());
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse::<f64>().unwrap().to_bits()).collect();
    text.lines().filter(is_row).map(numbers).collect()
}

#[test]
fn the_example_in_c_prints_what_apply_writes() {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("skipped: there is no C compiler cc");
        return;
    }
    let library = library();
    let crates = Path::new(TOP).join("crates/umbmark-odometry-c");
    for (name, effects) in [
        ("plain", &[("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("scale", "e_s", 1.003)][..]),
        (
            "six",
            &[
                ("wheel_diameter_ratio", "e_d", 1.002),
                ("wheelbase", "e_b", 0.99),
                ("crab", "angle_rad", 0.004),
                ("turn_slip", "share", 0.01),
                ("speed_slip", "s_per_m", 0.01),
                ("floor_slope", "drift_x", 0.004),
            ][..],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("model.toml"), model(effects)).unwrap();
        std::fs::write(folder.path().join("log.csv"), log()).unwrap();
        let start = ["--start", "0.5,-1.25,0.3"];
        umbmark(folder.path(), &[&["apply", "log.csv", "--model", "model.toml", "-o", "out.csv"], &start[..]].concat());
        let export = ["export", "model.toml", "--to", "embedded", "-o", "model.h"];
        let said = umbmark(folder.path(), &[&export, &start[..]].concat());
        let late = String::from_utf8_lossy(&said.stderr).contains("speed_slip, turn_slip, floor_slope");
        assert_eq!(late, name == "six");
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I.", "-I"]).arg(crates.join("include"));
        cc.arg(crates.join("examples/drive.c")).arg(&library).args(["-lm", "-lpthread", "-ldl", "-o", "drive"]);
        done(cc.current_dir(folder.path()));
        let log = std::fs::File::open(folder.path().join("log.csv")).unwrap();
        let printed = done(Command::new(folder.path().join("drive")).stdin(Stdio::from(log)));
        let printed = rows(&String::from_utf8(printed.stdout).unwrap());
        let applied = rows(&std::fs::read_to_string(folder.path().join("out.csv")).unwrap());
        let same: Vec<&Vec<u64>> =
            applied.iter().filter(|row| printed.iter().any(|other| other[0] == row[0])).collect();
        assert_eq!(printed.iter().collect::<Vec<_>>(), same, "{name}");
        assert_eq!((applied.len(), applied[0].len()), (1500, 10));
        // The last readings become final together.
        assert!(printed.len() >= 1497 && printed.last() == applied.last(), "{name}: {}", printed.len());
        assert!((f64::from_bits(applied[1499][1]) - 0.5).abs() > 0.1);
        let edited = std::fs::read_to_string(folder.path().join("model.h"))
            .unwrap()
            .replace("    1.0, /* version", "    9.0, /* version");
        std::fs::write(folder.path().join("model.h"), edited).unwrap();
        done(cc.current_dir(folder.path()));
        let refused = Command::new(folder.path().join("drive")).stdin(Stdio::null()).output().unwrap();
        let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(1) && errors.contains("another version"), "{errors}");
    }
}

#[test]
fn the_table_in_rust_has_the_numbers_of_that_in_c_and_a_formula_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = model(&[("wheelbase", "e_b", 0.99), ("floor_slope", "drift_x", 0.004)]);
    std::fs::write(folder.path().join("model.toml"), &text).unwrap();
    let numbers = |to: &str, file: &str| {
        umbmark(folder.path(), &["export", "model.toml", "--to", to, "-o", file]);
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        let numbers = text.lines().filter(|line| line.starts_with("    ")).flat_map(|line| {
            let code = line.split("/").next().unwrap();
            code.split(',').map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect::<Vec<_>>()
        });
        numbers.collect::<Vec<_>>()
    };
    let [c, rust] = [numbers("embedded", "model.h"), numbers("embedded_rust", "model.rs")];
    assert_eq!(c, rust);
    let parsed: Vec<f64> = c.iter().map(|number| number.parse().unwrap()).collect();
    let table = umbmark_odometry::Table::read(&parsed).unwrap();
    assert_eq!(table.steps().map(|step| step.law.name).collect::<Vec<_>>(), ["wheelbase", "floor_slope"]);
    let own = text
        + "\n[[effect]]\nname = \"draught\"\nacts_on = \"sideways_per_metre\"\nformula = \"k * speed\"\nparameters = { k = 0.01 }\n";
    std::fs::write(folder.path().join("own.toml"), own).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark"))
        .args(["export", "own.toml", "--to", "embedded", "-o", "own.h"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let said =
        "error: embedded: draught is a formula, and only effects of the catalogue that act on motion can be compiled (";
    assert!(output.status.code() == Some(1) && errors.replace('\n', " ").contains(said), "{errors}");
    assert!(!folder.path().join("own.h").exists());
}
