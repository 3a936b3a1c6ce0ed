//! Calibrations of real robots: the squares of OptiOdom (Sousa et al. 2022) against their authors' own result sheet.

use std::io::Write;
use std::path::{Path, PathBuf};
use umbmark_core::calibrate::{
    Calibration, ClosedForm, Correction, Estimate, Method, Options, RadiusWheelbase, Ratio, calibrate,
};
use umbmark_core::drive::Robot;
use umbmark_core::evidence::Level;

/// The folder, or a notice that it is not there.
fn optiodom() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/optiodom");
    if path.is_dir() {
        return Some(path);
    }
    // Past the harness, which keeps what a passing test prints to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
    None
}

/// One row of `published_diff-UMBmark.csv`: nominal b, D_R, D_L, max final error; the same after.
struct Published {
    set: String,
    before: [f64; 4],
    after: [f64; 4],
}

fn published(folder: &Path) -> Vec<Published> {
    let text = std::fs::read_to_string(folder.join("published_diff-UMBmark.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let set = cells[0].strip_prefix("diff/square/")?.split('/').next()?.to_owned();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let [before, after] = [1, 8].map(|i| [number(i), number(i + 1), number(i + 2), number(i + 5)]);
        Some(Published { set, before, after })
    };
    text.lines().filter_map(row).collect()
}

fn calibrated(folder: &Path, set: &str) -> (Robot, Calibration) {
    let data = umbmark_io::load(folder.join("raw/square").join(set)).unwrap();
    // The authors put the corrected wheelbase into the rotation radius.
    let options = Options { radius_wheelbase: RadiusWheelbase::Corrected, ..Options::default() };
    let calibration = calibrate(&data, &options).unwrap();
    (data.robot.unwrap(), calibration)
}

fn lengths(robot: &Robot, correction: &Correction) -> [f64; 3] {
    let drive = correction.apply(robot).unwrap().drive;
    [drive.wheelbase(), drive.wheel_diameter_right(), drive.wheel_diameter_left()]
}

/// The authors print micrometres.
const PRINTED: f64 = 1e-6;

#[test]
fn the_closed_form_from_x_reproduces_what_the_authors_published_for_every_square() {
    let Some(folder) = optiodom() else { return };
    let rows: Vec<Published> =
        published(&folder).into_iter().filter(|row| folder.join("raw/square").join(&row.set).is_dir()).collect();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let (robot, calibration) = calibrated(&folder, &row.set);
        let estimate = calibration.estimate(Method::ClosedForm(ClosedForm::X)).unwrap();
        let replayed = [estimate.replayed_before.unwrap(), estimate.replayed_after.unwrap()];
        for ((correction, replay), expected) in
            [Correction::NONE, estimate.correction].iter().zip(replayed).zip([row.before, row.after])
        {
            let [b, right, left] = lengths(&robot, correction);
            for (value, expected) in [b, right, left, replay.largest].into_iter().zip(expected) {
                assert!((value - expected).abs() < PRINTED, "{}: {value} {expected}", row.set);
            }
        }
    }
}

#[test]
fn the_corrections_are_the_published_ones_with_the_nominal_wheelbase_in_the_radius_too() {
    let Some(folder) = optiodom() else { return };
    for row in published(&folder).into_iter().filter(|row| folder.join("raw/square").join(&row.set).is_dir()) {
        let data = umbmark_io::load(folder.join("raw/square").join(&row.set)).unwrap();
        let calibration = calibrate(&data, &Options::default()).unwrap();
        let estimate = calibration.estimate(Method::ClosedForm(ClosedForm::X)).unwrap();
        let found = lengths(data.robot.as_ref().unwrap(), &estimate.correction);
        for (value, expected) in found.into_iter().zip(row.after) {
            assert!((value - expected).abs() < PRINTED, "{}: {value} {expected}", row.set);
        }
    }
}

/// Sets driven with nominal (b, D) of (0.200, 0.084), (0.205, 0.085) and (0.200, 0.084) m: the same robot.
#[test]
fn the_exact_fit_finds_the_same_wheelbase_whatever_the_controller_believed() {
    let Some(folder) = optiodom() else { return };
    let exact = |set: &str| -> (Robot, Estimate) {
        let (robot, calibration) = calibrated(&folder, set);
        assert_eq!(calibration.level, Level::Tracks);
        // The camera lost the heading for some poses of two runs.
        let lost = |warning: &String| warning.starts_with("3 of 18") && warning.contains(" poses of run ");
        assert!(calibration.warnings.iter().all(lost), "{:?}", calibration.warnings);
        (robot, calibration.estimate(Method::Exact).unwrap().clone())
    };
    let sets = ["230620202042", "230620202258", "230620202317"].map(exact);
    assert_eq!(sets[1].0.drive.wheelbase(), 0.205);
    let wheelbases = sets.each_ref().map(|(robot, e)| lengths(robot, &e.correction)[0]);
    for b in wheelbases {
        assert!((b / wheelbases[0] - 1.0).abs() < 1.5e-3, "{wheelbases:?}");
    }
    // The scale error that end poses cannot show is many standard errors from none in each.
    for (_, estimate) in &sets {
        let z = (estimate.correction.e_s - 1.0) / estimate.std_error(Ratio::Scale).unwrap();
        assert!(z < -3.0, "{z}");
    }
    // Without it, the closed form of the second set is off by the scale.
    let (robot, calibration) = calibrated(&folder, "230620202258");
    let [b, ..] = lengths(&robot, &calibration.estimate(Method::ClosedForm(ClosedForm::X)).unwrap().correction);
    assert!((b / wheelbases[1] - 1.0) > 0.01);
}

#[test]
fn every_method_lowers_the_error_of_every_square() {
    let Some(folder) = optiodom() else { return };
    for row in published(&folder).iter().filter(|row| folder.join("raw/square").join(&row.set).is_dir()) {
        let (_, calibration) = calibrated(&folder, &row.set);
        assert_eq!(calibration.estimates.len(), 5);
        for e in &calibration.estimates {
            let (before, after) = (e.e_max_sys_before.unwrap(), e.e_max_sys_after.unwrap());
            let replayed = e.replayed_after.unwrap().e_max_sys.unwrap();
            assert!(after < 0.65 * before && replayed < 0.65 * before, "{} {:?}: {before} {after}", row.set, e.method);
            assert!((after - replayed).abs() < 0.03 * before, "{} {:?}: {after} {replayed}", row.set, e.method);
        }
    }
}
