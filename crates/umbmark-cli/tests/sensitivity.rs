//! `umbmark sensitivity`, `tolerance` and `mc --sweep` as their users meet them.

use serde_json::Value;
use snapbox::cmd::{Command, OutputAssert, cargo_bin};
use snapbox::str;

fn umbmark(arguments: &[&str]) -> OutputAssert {
    Command::new(cargo_bin!("umbmark")).args(arguments).assert()
}

fn stdout(arguments: &[&str]) -> String {
    String::from_utf8(umbmark(arguments).success().get_output().stdout.clone()).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(&[arguments, &["--json"]].concat())).unwrap()
}

const VARIED: [&str; 5] = ["sensitivity", "--vary", "ed=normal:1:0.001", "--vary", "eb=normal:1:0.003"];

#[test]
fn the_table_names_the_share_of_every_parameter_and_the_document_has_its_keys() {
    let exact = [&VARIED[..], &["--noise-free", "-n", "1024", "--second-order"]].concat();
    umbmark(&exact).success().stderr_eq(str![""]).stdout_eq(str![[r#"
Sobol indices from 1024 base points, 6144 tests (exact kinematics, without noise)
TRC LabMate, square
  ed  1 ± 0.001
  eb  1 ± 0.003
  assumed: wheel diameter 0.150 m and 2000 ticks per revolution where not given
  assumed: wheel noise k = 0.001 m^0.5 (--wheel-noise 0 for none)

E_max,sys: mean [..] mm, standard deviation [..] mm

 share of the variance [..]
 ed [..]
 eb [..]
share of interactions: [..]

 interaction of pairs [..]
 ed x eb [..]

 T of every metric [..]
 E_max,sys [..]
 centroid cw, x [..]
 centroid cw, y [..]
 centroid ccw, x [..]
 centroid ccw, y [..]
 return heading cw [..]
 return heading ccw [..]

seed 1, umbmark [..]

"#]]);
    let document = json(&exact);
    let heading = &document["metrics"]["return_heading_cw_rad"];
    // To first order the cw heading is 2π(E_b - 1) + 16 m (E_d - 1)/b: variances 3.55e-4 and 2.21e-3.
    let (e_b, e_d) = (0.018_850_f64.powi(2), (16e-3_f64 / 0.34).powi(2));
    let first = heading["first"]["wheel_diameter_ratio.e_d"]["value"].as_f64().unwrap();
    assert!((first - e_d / (e_d + e_b)).abs() < 0.01, "{first}");
    let interval = heading["first"]["wheel_diameter_ratio.e_d"]["interval"].as_array().unwrap();
    assert!(interval[0].as_f64().unwrap() <= first && first <= interval[1].as_f64().unwrap());
    assert_eq!(document["method"], "sobol");
    assert_eq!(document["metrics"]["e_max_sys_m"]["second"][0]["of"][1], "wheelbase.e_b");
    assert_eq!(document["parameters"][1]["distribution"]["sd"], 0.003);
    assert_eq!((&document["evaluations"], &document["partial"]), (&6144.into(), &false.into()));
}

#[test]
fn noise_is_a_parameter_of_its_own_and_threads_change_nothing() {
    let study = [&VARIED[..], &["--wheel-noise", "0.001", "--wheel-noise-sd", "0.0002", "-n", "256"]].concat();
    let on = |threads| json(&[&study[..], &["--threads", threads]].concat());
    let one = on("1");
    assert!(one == on("2") && one == on("8"));
    let total = |metric: &str, name: &str| one["metrics"][metric]["total"][name]["value"].as_f64().unwrap();
    assert!(total("sigma_m", "noise") > 0.2 && total("sigma_m", "wheel_noise.k_sqrt_m") > 0.2);
    assert!(total("e_max_sys_m", "wheel_diameter_ratio.e_d") > 0.6);
    let text = stdout(&study);
    assert!(!text.contains("NaN") && text.contains(" noise "), "{text}");
}

#[test]
fn every_method_answers_for_robot_encoder_path_and_runs() {
    let varied = [
        "sensitivity",
        "--vary",
        "ticks-per-revolution=loguniform:200:5000",
        "--vary",
        "side=uniform:2:5",
        "--vary",
        "runs=uniform:2:8",
        "--vary",
        "speed=triangular:0.1:0.2:0.4",
        "--vary",
        "bumps=uniform:5:15",
        "--vary",
        "bump-height=uniform:0.005:0.01",
        "--vary",
        "encoder-rate=uniform:20:100",
    ];
    let with = |more: &[&str]| json(&[&varied[..], more].concat());
    let bumps = |document: &Value, of: &str, name: &str| {
        document["metrics"]["nonsys_orientation_rad"][of][name]["value"].as_f64().unwrap()
    };
    let screened = with(&["--method", "morris", "--trajectories", "20"]);
    assert!(bumps(&screened, "mu_star", "placed_bumps.count") > bumps(&screened, "mu_star", "path.speed_m_s"));
    let local = with(&["--method", "local", "--trials", "20"]);
    // The orientation error is the number of bumps times what one of them turns: 10 of 7.5 mm.
    let one = bumps(&local, "per_unit", "placed_bumps.count");
    assert!((0.004..0.01).contains(&one), "{one}");
    let shares = with(&["-n", "64"]);
    assert_eq!(shares["parameters"].as_array().unwrap().len(), 7);
    assert!(bumps(&shares, "total", "placed_bumps.count") > 0.1);
}

#[test]
fn files_and_correlations_are_used_and_flags_override_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parameters.toml");
    let text = "[[parameter]]\nname = \"ed\"\nmean = 1.0\nsd = 0.001\n[[parameter]]\nname = \"eb\"\nmin = 0.99\n\
                max = 1.01\n[[correlation]]\nof = [\"ed\", \"eb\"]\nvalue = 0.6\n";
    std::fs::write(&file, text).unwrap();
    let name = file.to_str().unwrap();
    let study = ["sensitivity", "--parameters", name, "--vary", "eb=normal:1:0.002", "--noise-free", "-n", "256"];
    let document = json(&study);
    assert_eq!(document["parameters"][1]["distribution"]["mean"], 1.0);
    assert_eq!(document["correlations"][0]["value"], 0.6);
    let text = stdout(&study);
    assert!(text.contains("S includes the share of correlated parameters") && !text.contains("interactions"), "{text}");
    umbmark(&[&study[..], &["--second-order"]].concat()).code(1).stderr_eq(str![[r#"
error: the index of a pair is defined for independent parameters only; leave the correlations out, or ask for Sobol indices without it

"#]]);
}

#[test]
fn unusable_arguments_get_one_clear_error_and_exit_one() {
    let vary = |text| vec!["sensitivity", "--vary", text];
    for (arguments, message) in [
        (vec!["sensitivity"], "error: no parameter varies; give parameters and distributions, as in [..]\n"),
        (vary("edd=normal:1:0.1"), "error: --vary: there is no parameter \"edd\"; did you mean \"ed\"?\n"),
        (vary("ed=normal:9:0.1"), "error: --vary ed: e_d must be between 0.5 and 2, got 9\n"),
        (vary("bump-profile=uniform:0:1"), "error: --vary: profile is one of cable, edge: it cannot be varied\n"),
        (
            [vary("ed=normal:1:0.1"), vec!["-n", "100"]].concat(),
            "error: base points must be a power of two from 32 to 2^30, got 100\n",
        ),
        (
            [vary("ed=normal:1:0.1"), vec!["--metric", "sigma"]].concat(),
            "error: there is no metric \"sigma\"; there are e_max_sys_m, sigma_m, [..]\n",
        ),
        (
            [vary("ed=normal:1:0.1"), vec!["--correlate", "ed,eb=0.3"]].concat(),
            "error: --correlate: eb does not vary; give it a distribution with --vary\n",
        ),
        ([vary("radius=uniform:1:2"), vec![]].concat(), "error: radius_m is not a size of a square\n"),
        (vec!["mc", "--sweep", "ed=1:1.1:0"], "error: --sweep: a sweep has between 1 and 10000000 points, got 0\n"),
        (vec!["tolerance", "no.toml"], "error: no.toml: cannot be read: there is no such file or folder\n"),
    ] {
        umbmark(&arguments).code(1).stdout_eq(str![""]).stderr_eq(message);
    }
    umbmark(&vary("ed=gauss:1:2")).code(2).stdout_eq(str![""]);
    umbmark(&["mc", "--sweep", "ed=1:2"]).code(2).stdout_eq(str![""]);
}

const SWEEP: [&str; 9] = ["mc", "--sweep", "ed=1.000:1.004:5", "--sweep", "eb=0.99:1.01:11", "-n", "40", "--seed", "3"];

#[test]
fn a_sweep_is_a_tidy_table_a_map_and_a_document_of_the_studies_at_its_points() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.csv");
    let text = stdout(&[&SWEEP[..], &["-o", file.to_str().unwrap()]].concat());
    assert!(text.contains("ed 1.004 |") && text.contains("eb 0.99"), "{text}");
    let csv = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 56);
    assert!(lines[0].starts_with("wheel_diameter_ratio.e_d,wheelbase.e_b,trials,e_max_sys_m.mean,"), "{}", lines[0]);
    assert!(lines.iter().all(|line| line.split(',').count() == lines[0].split(',').count()));
    let document = json(&SWEEP);
    let point = &document["points"][32];
    assert_eq!(point["values"], serde_json::json!([1.002, 1.01]));
    let alone = json(&["mc", "--ed", "1.002", "--eb", "1.01", "-n", "40", "--seed", "3"]);
    for metric in ["e_max_sys_m", "return_heading_ccw_rad"] {
        for key in ["mean", "std_dev", "std_error"] {
            assert_eq!(point["metrics"][metric][key], alone["metrics"][metric][key], "{metric} {key}");
        }
    }
    let cells: Vec<f64> = lines[33].split(',').map(|cell| cell.parse().unwrap()).collect();
    assert_eq!(Some(cells[3]), alone["metrics"]["e_max_sys_m"]["mean"].as_f64());
}

#[test]
fn a_sweep_goes_on_where_its_checkpoint_ends() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.json");
    let checkpoint = ["--checkpoint", file.to_str().unwrap()];
    let whole = json(&[&SWEEP[..], &checkpoint].concat());
    // A checkpoint of the first 20 points, one mean with a mark to be known by, as the first format has it: without the line of the checksum.
    let text = std::fs::read_to_string(&file).unwrap();
    let mut written: Value = serde_json::from_str(text.split_once('\n').unwrap().1).unwrap();
    let points = written["points"].as_array_mut().unwrap();
    points.truncate(20);
    points[7]["metrics"][0]["mean"] = Value::from(12.5);
    std::fs::write(&file, written.to_string()).unwrap();
    let mut resumed = json(&[&SWEEP[..], &checkpoint, &["--resume"]].concat());
    assert_eq!(resumed["points"][7]["metrics"]["e_max_sys_m"]["mean"], 12.5, "it did not take what was done");
    resumed["points"][7] = whole["points"][7].clone();
    assert_eq!(resumed, whole);
    umbmark(&[&SWEEP[..7], &checkpoint, &["--resume", "--seed", "4"]].concat()).code(1).stderr_eq(str![[r#"
error: [..]sweep.json is of another sweep; give the robot, path, seed and number of trials that it was begun with

"#]]);
    umbmark(&[&SWEEP[..], &checkpoint].concat()).code(1).stderr_eq(str![[r#"
error: [..]sweep.json exists already; --resume continues it, --force begins anew

"#]]);
}

/// The example of the documentation: what is bought keeps the target, and nothing cheaper does.
#[test]
fn the_cheapest_tolerances_of_the_example_keep_the_target() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/tolerances.toml");
    let study = ["tolerance", file, "-n", "4000", "--target", "50mm", "--share", "0.95"];
    let document = json(&study);
    let cheapest = &document["cheapest"];
    assert!(cheapest["share_within"]["interval"][0].as_f64().unwrap() >= 0.95, "{cheapest}");
    assert!(cheapest["quantile"]["value"].as_f64().unwrap() <= 0.05);
    assert!(document["now"]["share_within"]["value"].as_f64().unwrap() < 0.5);
    assert!(cheapest["cost"].as_f64().unwrap() <= document["last"]["cost"].as_f64().unwrap());
    let text = stdout(&study);
    assert!(text.contains("Buy: ") && text.contains("all at last grade"), "{text}");
    let hopeless = stdout(&["tolerance", file, "-n", "1000", "--target", "1mm"]);
    assert!(hopeless.contains("None of the 27 choices certainly keeps the target"), "{hopeless}");
    umbmark(&["tolerance", file, "--target", "2deg"]).code(1).stderr_eq(str![[r#"
error: --target: e_max_sys_m needs a length, as in 50mm

"#]]);
}
