//! Tests of the whole, one program: a file here is a module. `allocation.rs` counts what is allocated, and stands alone.

#![allow(clippy::unwrap_used)]

mod cross_table;
mod diagnose_real;
mod drives;
mod embedded;
mod formula;
mod fuzz_targets;
mod monte_carlo;
mod omni_real;
mod paper;
mod references;
mod rollers;
mod rooms;
mod steered;
mod tracks;

/// A file that no `mod` line names would not be run.
#[test]
fn every_file_of_tests_is_a_module() {
    let top = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    for folder in ["tests", "crates/umbmark-cli/tests", "crates/umbmark-io/tests"] {
        let main = std::fs::read_to_string(top.join(folder).join("main.rs")).unwrap();
        for entry in std::fs::read_dir(top.join(folder)).unwrap() {
            let file = entry.unwrap().file_name().into_string().unwrap();
            let Some(name) = file.strip_suffix(".rs") else { continue };
            let listed =
                main.lines().any(|line| [format!("mod {name};"), format!("mod r#{name};")].contains(&line.to_owned()));
            assert!(listed || ["main", "lib", "allocation"].contains(&name), "{folder}/{file} is no module of main.rs");
        }
    }
}
