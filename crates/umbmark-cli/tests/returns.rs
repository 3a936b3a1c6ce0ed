//! A typing error in a sheet of returns, and its unit, in all that uses them.

use std::path::Path;
use std::process::{Command, Output};

const SHEET: &str = "direction,run,ex_mm,ey_mm,etheta_deg
cw,1,-205,-187,-3.1
cw,2,-188,-203,-2.7
cw,3,-197,2010,-3.3
cw,4,-211,-195,-2.9
cw,5,-193,-214,-3.4
ccw,1,21,12,1.2
ccw,2,9,-18,0.8
ccw,3,-3,-21,1.4
ccw,4,14,4,1.1
ccw,5,-8,-9,0.9
";

/// A folder with the sheet, changed.
fn folder(change: impl Fn(&str) -> String) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/labmate/robot.toml");
    std::fs::copy(robot, folder.path().join("robot.toml")).unwrap();
    std::fs::write(folder.path().join("returns.csv"), change(SHEET)).unwrap();
    folder
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Exit code and all that was printed, on one line.
fn said(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let Output { status, stdout, stderr } = umbmark(folder, arguments);
    let text = String::from_utf8(stderr).unwrap() + &String::from_utf8(stdout).unwrap();
    (status.code().unwrap(), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

const TOLD: &str = "return error of run cw_03 lies 2.2";

#[test]
fn a_typing_error_is_named_first_and_nothing_is_written_from_it() {
    let folder = folder(str::to_owned);
    let place = folder.path();
    let (code, text) = said(place, &["inspect", "."]);
    assert!(code == 0 && text.starts_with("RETURN") && text.contains(TOLD), "{text}");
    let (code, text) = said(place, &["score", "."]);
    assert!(code == 0 && text.starts_with("warning: ") && text.contains("The return error of run cw_03"), "{text}");
    for verb in ["diagnose", "compare"] {
        let (code, text) = said(place, &[verb, ".", "--check"]);
        assert!(code == 3 && text.contains(TOLD), "{verb}: {text}");
    }
    let (code, text) = said(place, &["learn", ".", "-o", "model.toml"]);
    assert!(code == 1 && text.contains(TOLD) && text.contains("was not written"), "{text}");
    let (code, text) = said(place, &["calibrate", ".", "--export-toml", "new.toml"]);
    assert!(code == 1 && text.contains("lengths are in doubt") && !place.join("new.toml").exists(), "{text}");
    let (code, text) = said(place, &["calibrate", ".", "--export-toml", "new.toml", "--force"]);
    assert!(code == 0 && place.join("new.toml").exists(), "{text}");
    let json = umbmark(place, &["calibrate", ".", "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["setup"]["returns"][0]["run"], "cw_03");
    assert_eq!(json["setup"]["returns"][0]["deviants"][0]["coordinate"], "y");
    let (code, text) = said(place, &["report", ".", "--trials", "100"]);
    assert!(code == 0 && text.contains("LOOK") && text.contains("The return error of run cw_03"), "{text}");
    let page = std::fs::read_to_string(place.join("report.html")).unwrap();
    let first = page.find("LOOK FIRST").unwrap();
    assert!(first < page.find("class=\"tiles\"").unwrap() && page[first..first + 200].contains("cw_<wbr>03"));
}

#[test]
fn millimetres_in_columns_of_metres_are_refused_with_their_names() {
    let folder = folder(|sheet| sheet.replace("ex_mm,ey_mm", "ex_m,ey_m").replace("2010", "-201"));
    let place = folder.path();
    let (code, text) = said(place, &["inspect", "."]);
    assert!(code == 0 && text.starts_with("FAULT the return errors are in mm") && text.contains("ex_mm"), "{text}");
    let (code, text) = said(place, &["calibrate", "."]);
    assert!(code == 1 && text.contains("the robot cannot be judged yet"), "{text}");
    let (code, text) = said(place, &["diagnose", ".", "--check"]);
    assert!(code == 3 && text.contains("the return errors are in mm"), "{text}");
    let (code, text) = said(place, &["compare", ".", "--check"]);
    assert!(code == 3 && text.contains("the return errors are in mm"), "{text}");
}
