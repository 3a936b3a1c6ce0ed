//! Diagnoses of real robots: squares of OptiOdom (Sousa et al. 2022), by their return poses.

use std::io::Write;
use std::path::Path;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Diagnosis, Options, Verdict, base_model, diagnose};

/// A set with its tick logs, or a notice that it is not there. Real logs differ from run to run; the exact test applies all the same.
fn recorded(set: &str) -> Option<Dataset> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/optiodom/raw/square").join(set);
    if !folder.is_dir() {
        // Past the harness, which keeps what a passing test prints to itself.
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", folder.display());
        return None;
    }
    Some(umbmark_io::load(folder).unwrap())
}

fn diagnosis(data: &Dataset) -> Diagnosis {
    diagnose(
        data,
        &base_model(data.robot.as_ref().unwrap()).unwrap(),
        &Options { ends_only: true, ..Options::default() },
    )
    .unwrap()
}

#[test]
fn five_and_five_squares_are_explained_by_e_d_and_e_b() {
    let Some(data) = recorded("230620202317") else { return };
    let found = diagnosis(&data);
    let gof = &found.goodness_of_fit[0];
    assert_eq!(gof.degrees_of_freedom, Some([4.0, 14.0]));
    assert!((gof.statistic - 1.0).abs() < 0.15 && (gof.p - 0.4).abs() < 0.05, "{gof:?}");
    assert_eq!((found.verdict, found.certified), (Verdict::Explained, 0));
    assert!(found.invisible.iter().any(|u| u.effect == "scale"));
}

#[test]
fn three_and_three_squares_of_another_set_are_rejected() {
    let Some(data) = recorded("230620202042") else { return };
    let found = diagnosis(&data);
    let gof = &found.goodness_of_fit[0];
    assert_eq!(gof.degrees_of_freedom, Some([4.0, 6.0]));
    assert!((0.0010..0.0025).contains(&gof.p), "{gof:?}");
    assert_ne!(found.verdict, Verdict::Explained);
    let contrast = |name: &str| found.contrasts.iter().find(|c| c.name == name).unwrap().value;
    assert!((contrast("c1") + 4.9e-3).abs() < 0.3e-3 && (contrast("c4").to_degrees() - 0.35).abs() < 0.03);
}
