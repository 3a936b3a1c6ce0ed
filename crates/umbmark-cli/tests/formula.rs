//! An effect of the user's own from `simulate` to `fit`, `diagnose` and `compare`, by a `model.toml` alone.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

fn document(folder: &Path, arguments: &[&str]) -> Value {
    let output = umbmark(folder, &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn carpet(k: f64, h0: f64) -> String {
    format!(
        "[[effect]]\nname = \"carpet\"\nacts_on = \"heading_per_metre\"\nformula = \"k * sin(heading - h0)\"\n\
         parameters = {{ k = {k:?}, h0 = {h0:?} }}\nfree = true\n"
    )
}

#[test]
fn a_formula_is_simulated_fitted_written_diagnosed_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    write("truth.toml", &carpet(4e-3, 0.7));
    write("start.toml", &carpet(0.0, 0.5));
    let simulate = ["simulate", "-o", "set", "--model", "truth.toml", "--runs", "3", "--wheel-noise", "5e-5"];
    assert!(umbmark(here, &simulate).status.success());
    let fitted = document(here, &["fit", "set", "--model", "start.toml", "-o", "fitted.toml"]);
    for (estimate, truth) in fitted["fitted"].as_array().unwrap().iter().zip([4e-3, 0.7]) {
        let number = |key: &str| estimate[key].as_f64().unwrap();
        assert!((number("value") - truth).abs() < 4.0 * number("standard_error"), "{estimate}");
        assert!(number("standard_error") < 0.05 * truth, "{estimate}");
    }
    let effect = &fitted["model"]["effect"][0];
    assert_eq!(
        (&effect["acts_on"], &effect["formula"]),
        (&"heading_per_metre".into(), &"k * sin(heading - h0)".into())
    );
    let [k, h0] = ["k", "h0"].map(|name| effect["parameters"][name].as_f64().unwrap());
    // Behind the robot that it was fitted with.
    let written = std::fs::read_to_string(here.join("fitted.toml")).unwrap();
    let (before, noise) = written.split_once("\n[noise]\n").unwrap();
    assert!(before.starts_with("[robot]\n") && before.ends_with(&carpet(k, h0)), "{written}");
    // Last the noise, in the file as in the document.
    for line in noise.lines() {
        let (key, value) = line.split_once(" = ").unwrap();
        assert_eq!(fitted["model"]["noise"][key].as_f64(), Some(value.parse().unwrap()), "{line}");
    }
    assert!(noise.lines().count() == 10 && fitted["model"]["noise"]["forward_m_per_sqrt_m"].as_f64() > Some(0.0));
    let diagnosis = document(here, &["diagnose", "set", "--model", "fitted.toml"]);
    assert_eq!(diagnosis["verdict"], "explained", "{diagnosis}");
    let compared = document(here, &["compare", "set", "--model", "fitted.toml"]);
    assert_eq!(compared["models"][0]["explains"], true, "{compared}");
    let study = document(here, &["mc", "--model", "fitted.toml", "-n", "20"]);
    // 16 k in each direction: 64 mm, less what noise adds.
    let e_max = study["metrics"]["e_max_sys_m"]["mean"].as_f64().unwrap();
    assert!((e_max - 16.0 * 4e-3).abs() < 0.01, "{e_max}");
}

#[test]
fn a_formula_that_is_no_number_on_the_path_is_refused_with_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = carpet(1e-3, 0.5).replace("k * sin(heading - h0)", "k * speed / turn_rate + h0");
    let text = text.replace("heading_per_metre", "forward_scale");
    std::fs::write(folder.path().join("model.toml"), text).unwrap();
    for verb in [&["mc", "-n", "5"][..], &["simulate", "-o", "set"]] {
        let output = umbmark(folder.path(), &[verb, &["--model", "model.toml"]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        let place = "carpet: \"k * speed / turn_rate\", or its derivative, is not finite";
        assert!(said.contains(place) && said.contains("turn_rate = 0 1/s"), "{said}");
    }
}
