//! MCAP logs of real runs, held against the same runs in CSV, where they are there.

use std::io::Write;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, TickLog};
use umbmark_io::{DatasetError, Topics};

const ROBOT: &str = "[robot]\nwheelbase_m = 0.2\nwheel_diameter_m = 0.084\nticks_per_revolution = 2796.8\n";

/// A folder of the data beside the project, or a notice that it is not there.
fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    // Past the harness, which keeps what a passing test prints to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
    None
}

/// A sample read with the robot beside it.
fn sample(name: &str, topics: &Topics) -> Option<Result<Dataset, DatasetError>> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, std::fs::read(shared("mcap_samples")?.join(name)).unwrap()).unwrap();
    Some(umbmark_io::load_with(file, topics))
}

fn csv(run: usize) -> Option<TickLog> {
    let set = shared("optiodom")?.join("raw/square/231220200029");
    let data = umbmark_io::load(set.join(format!("231220200029_run-{run:02}.csv"))).unwrap();
    data.runs[0].log.clone()
}

fn topics(ticks: &str) -> Topics {
    Topics { ticks: (!ticks.is_empty()).then(|| ticks.to_owned()), reference: None }
}

/// Largest difference of ticks, and of poses.
fn differences(a: &TickLog, b: &TickLog) -> [f64; 2] {
    assert_eq!((a.time.len(), a.reference.len()), (b.time.len(), b.reference.len()));
    for (i, (a, b)) in a.time.iter().zip(&b.time).enumerate() {
        // The CSV has rounding of a sum in its times.
        assert!((a - b).abs() < 1e-6, "{i}: {a} {b}");
    }
    let largest = |pairs: &mut dyn Iterator<Item = (f64, f64)>| pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let pairs = |a: &[f64], b: &[f64]| a.iter().copied().zip(b.iter().copied()).collect::<Vec<_>>();
    let ticks = largest(&mut pairs(&a.left, &b.left).into_iter().chain(pairs(&a.right, &b.right)));
    let poses = a.reference.iter().zip(&b.reference).flat_map(|(a, b)| {
        assert_eq!(a.sample, b.sample);
        let turn = umbmark_core::geometry::wrap(a.heading.unwrap() - b.heading.unwrap());
        [(a.x, b.x), (a.y, b.y), (turn, 0.0)]
    });
    [ticks, largest(&mut poses.collect::<Vec<_>>().into_iter())]
}

#[test]
fn every_packing_encoding_and_source_of_wheels_gives_the_ticks_and_poses_of_the_csv() {
    let cases = [
        ("optiodom_square_cw_run01_zstd.mcap", 1, "", 0.0),
        ("optiodom_square_cw_run03_none.mcap", 3, "", 0.0),
        ("optiodom_square_ccw_run04_lz4.mcap", 4, "", 0.0),
        ("optiodom_square_cw_run01_foxglove_json.mcap", 1, "", 0.0),
        ("optiodom_square_cw_run01_zstd.mcap", 1, "/wheel_ticks:right,left", 0.0),
        ("optiodom_square_cw_run01_zstd.mcap", 1, "/joint_states:wheel_left_joint,wheel_right_joint", 0.0),
        // Wheel travel that went through a pose and back.
        ("optiodom_square_cw_run01_zstd.mcap", 1, "/odom", 1e-6),
    ];
    for (name, run, ticks, tolerance) in cases {
        let (Some(data), Some(csv)) = (sample(name, &topics(ticks)), csv(run)) else { return };
        let data = data.unwrap();
        let log = data.runs[0].log.as_ref().unwrap();
        let [ticks_off, poses_off] = differences(log, &csv);
        assert!(ticks_off <= tolerance, "{name} {ticks}: {ticks_off} ticks");
        assert!(poses_off < 1e-12, "{name} {ticks}: {poses_off}");
        assert_eq!(data.warnings, Vec::<String>::new(), "{name} {ticks}");
    }
}

#[test]
fn logs_of_other_robots_are_refused_with_what_they_hold() {
    let said = |name: &str| {
        let folder = shared("mcap_samples")?.join("crate_mcap");
        let file = folder.join(name);
        Some(umbmark_io::load(&file).unwrap_err().to_string().replace(&format!("{}/", folder.display()), ""))
    };
    let Some(ros_1) = said("compressed.mcap") else { return };
    assert!(ros_1.contains("no topic holds wheel counts") && ros_1.contains("/tf (tf2_msgs/TFMessage)"), "{ros_1}");
    for name in ["uncompressed.mcap", "zstd_chunk_with_padding.mcap", "chunk_not_closed.mcap"] {
        let said = said(name).unwrap();
        assert!(said.contains("no topic") || said.contains("cannot be read"), "{said}");
    }
}
