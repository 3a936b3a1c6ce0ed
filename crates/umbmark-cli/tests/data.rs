//! The verbs that look at data and prepare it: their output, to the letter.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli` writes the golden files anew.

#[path = "../../umbmark-io/tests/bad_input/mod.rs"]
mod bad_input;

use snapbox::{assert_data_eq, file};
use std::path::Path;
use std::process::{Command, Output};

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output of a command that succeeds and says nothing else.
fn said(arguments: &[&str]) -> String {
    let output = umbmark(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data"), arguments);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that fails and prints nothing.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn fits_the_terminal(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

#[test]
fn inspect_of_a_return_sheet() {
    let text = said(&["inspect", "tape"]);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/inspect_tape.txt"]);
}

#[test]
fn inspect_of_tracked_logs() {
    let text = said(&["inspect", "tracked"]);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/inspect_tracked.txt"]);
}

#[test]
fn inspect_of_a_single_sheet_without_robot() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sheet.csv"), "direction,run,ex_mm,ey_mm,who\ncw,1,10,20,Ann\n").unwrap();
    let output = umbmark(folder.path(), &["inspect", "sheet.csv"]);
    assert_data_eq!(String::from_utf8(output.stdout).unwrap(), file!["golden/inspect_sheet.txt"]);
}

#[test]
fn inspect_as_json() {
    let text = said(&["inspect", "tracked", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["robot"]["wheelbase_m"], 0.34);
    assert_eq!(document["logs"][0]["wheels"]["as_named"], true);
    assert_data_eq!(text, file!["golden/inspect_tracked.json"]);
}

#[test]
fn convert_says_what_it_wrote_and_what_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let out = |name: &str| place.path().join(name).display().to_string();
    let convert = |to: &str| said(&["convert", "tracked", "-o", &out(to), "--to", to]).replace(&out(to), "OUT");
    assert_data_eq!(convert("optiodom"), file!["golden/convert_optiodom.txt"]);
    assert_data_eq!(convert("csv"), "wrote 2 runs to OUT as csv\n\nwhat is lost\n  - nothing\n");
    for to in ["tum", "returns"] {
        fits_the_terminal(&convert(to));
    }
    let again = refused(Path::new(env!("CARGO_MANIFEST_DIR")), &["convert", "tests/data/tracked", "-o", &out("csv")]);
    assert!(again.ends_with("is there already; choose another folder, or say --force to replace it\n"), "{again}");
    // The same runs in the own layout, by way of OptiOdom's.
    let back = said(&["convert", &out("optiodom"), "-o", &out("back"), "--json"]);
    let document: serde_json::Value = serde_json::from_str(&back).unwrap();
    assert_eq!((&document["runs"], &document["lost"]), (&2.into(), &serde_json::json!([])));
}

#[test]
fn convert_sets_the_clock_of_a_track_and_tells_it() {
    let place = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/tracked");
    let folder = place.path().join("two_clocks");
    for part in ["runs", "reference"] {
        std::fs::create_dir_all(folder.join(part)).unwrap();
    }
    std::fs::copy(data.join("robot.toml"), folder.join("robot.toml")).unwrap();
    for name in ["cw_01.csv", "ccw_01.csv"] {
        // The log's own poses, taken out and given another clock.
        let text = std::fs::read_to_string(data.join("runs").join(name)).unwrap();
        let (mut ticks, mut track) =
            ("t_s,ticks_left,ticks_right\n".to_owned(), "t_s,x_ref_m,y_ref_m,theta_ref_rad\n".to_owned());
        // The track sees two seconds of rest before the ticks begin.
        track += &(1..5).rev().map(|i| format!("{},0,0,0\n", 40.0 - 0.49 * f64::from(i))).collect::<String>();
        for line in text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
            let cells: Vec<&str> = line.split(',').collect();
            ticks += &format!("{},{},{}\n", cells[0], cells[1], cells[2]);
            if cells.get(3).is_some_and(|x| !x.is_empty()) {
                let time = 40.0 + 0.98 * cells[0].parse::<f64>().unwrap();
                track += &format!("{time},{}\n", cells[3..].join(","));
            }
        }
        std::fs::write(folder.join("runs").join(name), ticks).unwrap();
        std::fs::write(folder.join("reference").join(name), track).unwrap();
    }
    let (from, out) = (folder.display().to_string(), place.path().join("one_clock").display().to_string());
    let text = said(&["convert", &from, "-o", &out, "--json"]);
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    for clock in document["clocks"].as_array().unwrap() {
        let near = |key: &str, truth: f64, limit: f64| {
            let value = clock[key]["value"].as_f64().unwrap();
            assert!((value - truth).abs() < limit, "{key}: {value}");
        };
        near("offset_s", 40.0, 0.05);
        near("rate", 0.98, 2e-3);
    }
    assert_eq!(document["clocks"].as_array().unwrap().len(), 2);
    let told = said(&["inspect", &from]);
    fits_the_terminal(&told);
    assert!(told.contains("clocks, aligned from the motion while reading"), "{told}");
}

#[test]
fn the_list_of_effects_names_each_entry_of_the_catalogue() {
    let text = said(&["effects"]);
    fits_the_terminal(&text);
    let document: serde_json::Value = serde_json::from_str(&said(&["effects", "--json"])).unwrap();
    let entries = document["effects"].as_array().unwrap();
    assert_eq!(entries.len(), umbmark_core::effect::CATALOGUE.len());
    for entry in entries {
        let name = entry["name"].as_str().unwrap();
        assert!(text.contains(&format!("\n  {name} ")), "{name}");
        fits_the_terminal(&said(&["effects", name]));
    }
    let variables = document["formula_variables"].as_array().unwrap();
    let (_, own) = text.split_once("variables").unwrap();
    assert_eq!(variables.len(), umbmark_core::effect::Formula::variables().len());
    for variable in variables {
        let name = variable["name"].as_str().unwrap();
        assert!(own.split([' ', ',', '\n']).any(|word| word == name), "{name}");
        // The files' table has them all.
        let files = include_str!("../../../docs/files.md");
        assert!(files.lines().any(|line| line.starts_with("| ") && line.contains(&format!("`{name}`"))), "{name}");
    }
}

#[test]
fn an_effect_explained() {
    assert_data_eq!(said(&["effects", "placed_bumps"]), file!["golden/effect_placed_bumps.txt"]);
    assert_data_eq!(said(&["effects", "caster_kick"]), file!["golden/effect_caster_kick.txt"]);
    assert_data_eq!(said(&["effects", "wheel_diameter_ratio", "--json"]), file!["golden/effect_ratio.json"]);
}

#[test]
fn the_model_file_of_an_explanation_is_one() {
    for entry in umbmark_core::effect::CATALOGUE {
        let text = said(&["effects", entry.about.name]);
        let model = text.split("in a model.toml\n").nth(1).unwrap();
        let robot = umbmark_core::drive::Robot::labmate();
        let file = umbmark_io::ModelFile::parse("model.toml", model, Some(&robot)).unwrap();
        assert_eq!(file.model.parts()[0].effect, *entry);
    }
}

#[test]
fn an_effect_that_is_none_is_told_its_neighbour() {
    let said = refused(Path::new("."), &["effects", "wheel_base"]);
    assert_eq!(said, "error: there is no effect \"wheel_base\"; did you mean \"wheelbase\"?\n");
}

#[test]
fn init_writes_two_files_once() {
    let folder = tempfile::tempdir().unwrap();
    let output = umbmark(folder.path(), &["init", "mine"]);
    assert_eq!(output.status.code(), Some(0));
    assert_data_eq!(String::from_utf8(output.stdout).unwrap(), file!["golden/init.txt"]);
    let read = |name: &str| std::fs::read_to_string(folder.path().join("mine").join(name)).unwrap();
    assert_data_eq!(read("robot.toml"), file!["golden/init_robot.toml"]);
    assert_data_eq!(read("returns.csv"), file!["golden/init_returns.csv"]);
    assert_eq!(
        refused(folder.path(), &["init", "mine"]),
        "error: mine/returns.csv: is there already; choose another folder, or say --force to replace it\n"
    );
    assert_eq!(umbmark(folder.path(), &["init", "mine", "--force"]).status.code(), Some(0));
    assert_eq!(
        refused(folder.path(), &["inspect", "mine"]),
        "error: mine/returns.csv: there are no rows; add the measurements, one a line\n"
    );
}

#[test]
fn bad_input_is_told_on_stderr_with_exit_code_1_and_nothing_on_stdout() {
    for case in bad_input::cases() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("folder");
        std::fs::create_dir(&folder).unwrap();
        case.write(&folder);
        let path = if case.load.is_empty() { folder.clone() } else { folder.join(&case.load) };
        let said = refused(place.path(), &["inspect", &path.display().to_string()]);
        assert_eq!(case.without_folder(&said, &folder), format!("error: {}\n", case.says), "{}", case.name);
    }
}
