//! `umbmark export`: a model becomes files of other programs, or one clear error and no file.

use std::path::Path;
use std::process::Command;
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::effect::Model;
use umbmark_io::ModelFile;
use umbmark_io::export::TARGETS;

/// Exit code, stdout and stderr.
fn said(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut umbmark = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    let output = umbmark.args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// A folder with models of a robot on a sloping floor, of a synchro drive, and of nobody, and a URDF.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut model = Model::new(&Robot::labmate());
    model.set("wheelbase", "e_b", 0.99).unwrap();
    model.set("floor_slope", "slide_x_m_per_rad", 0.5).unwrap();
    let synchro = Model::new(&Robot { drive: DriveKind::Synchro.usual(), ..Robot::labmate() });
    for (name, text) in [
        ("model.toml", ModelFile::new(model).text()),
        ("synchro.toml", ModelFile::new(synchro).text()),
        ("nobody.toml", "[[effect]]\nname = \"wheelbase\"\ne_b = 0.99\n".to_owned()),
        ("bot.urdf", "<robot name=\"bot\"/>\n".to_owned()),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn each_target_is_written_and_what_it_cannot_hold_is_said_on_stderr() {
    let folder = folder();
    for target in TARGETS.iter().filter(|target| !["amcl", "urdf", "embedded", "embedded_rust"].contains(&target.name))
    {
        let export = ["export", "model.toml", "--to", target.name, "-o", "out"];
        let (code, out, errors) = said(folder.path(), &export);
        assert_eq!((code, out.as_str()), (Some(0), "wrote out\n"), "{}: {errors}", target.name);
        assert!(errors.contains("note: not corrected by this file: floor_slope ("), "{}: {errors}", target.name);
        let first = std::fs::read_to_string(folder.path().join("out")).unwrap();
        assert!(first.contains("E_b 0.99"), "{first}");
        let (code, _, errors) = said(folder.path(), &export);
        assert_eq!((code, errors.as_str()), (Some(1), "error: out exists already; --force replaces it\n"));
        let (code, json, _) = said(folder.path(), &[&export[..], &["--force", "--json"]].concat());
        let document: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((code, &document["target"]), (Some(0), &target.name.into()));
        assert!(
            document["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains("floor_slope"))
        );
        std::fs::remove_file(folder.path().join("out")).unwrap();
    }
}

#[test]
fn what_cannot_be_written_gets_one_error_and_no_file() {
    let folder = folder();
    for (model, rest, code, sentence) in [
        ("nobody.toml", "--to c", 1, "nobody.toml:1: the file has no robot; add a table [robot] as in robot.toml"),
        (
            "synchro.toml",
            "--to ros2_control",
            1,
            "ros2_control has no synchro drive; toml and c hold the numbers of every drive",
        ),
        ("model.toml", "--to amcl", 1, "amcl: no covariances: the model has no [noise]; learn or fit it on tick logs"),
        ("model.toml", "--to urdf", 1, "urdf: the file to edit is missing; give it with --urdf FILE"),
        ("model.toml", "--to urdf --urdf no.urdf", 1, "no.urdf: cannot be read: there is no such file"),
        (
            "model.toml",
            "--to urdf --urdf bot.urdf",
            1,
            "bot.urdf:1: the joints of the left and the right wheel are not clear among none; name the joints of both wheels, on one link, with --joints LEFT,RIGHT",
        ),
        ("model.toml", "--to ros2_control --speed nan", 2, "must be finite"),
        ("model.toml", "--to ros2_control --rate 0", 2, "must be between 0.1 and 100000 Hz"),
        (
            "model.toml",
            "--to urdf --urdf bot.urdf --joints left",
            2,
            "must be the names of two joints with a comma between them",
        ),
        ("model.toml", "--to ros2", 2, "ros2_control"),
    ] {
        let arguments = [&["export", model, "-o", "out"], &rest.split(' ').collect::<Vec<_>>()[..]].concat();
        let (exit, out, errors) = said(folder.path(), &arguments);
        assert_eq!((exit, out.as_str()), (Some(code), ""), "{rest}: {errors}");
        assert!(errors.contains(sentence), "{rest}: {errors}");
        assert!(!folder.path().join("out").exists(), "{rest}");
    }
}
