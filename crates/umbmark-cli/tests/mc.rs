//! `umbmark mc` as its users meet it.

use snapbox::cmd::{Command, OutputAssert, cargo_bin};
use snapbox::str;

fn mc(arguments: &[&str]) -> OutputAssert {
    Command::new(cargo_bin!("umbmark")).arg("mc").args(arguments).assert()
}

fn stdout(arguments: &[&str]) -> String {
    let assert = mc(arguments).success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&stdout(&[arguments, &["--json"]].concat())).unwrap()
}

#[test]
fn the_table_has_every_metric_a_histogram_and_the_seed() {
    mc(&["--ed", "1.002", "--eb", "1.01", "--wheel-noise", "0", "--odometry", "continuous", "-n", "40"])
        .success()
        .stderr_eq(str![""])
        .stdout_eq(str![[r#"
Monte Carlo of UMBmark: 40 trials of 5 cw + 5 ccw runs
TRC LabMate, square (side_m 4)
  wheel_diameter_ratio: e_d 1.002
  wheelbase: e_b 1.01
  wheel_noise: k_sqrt_m 0
  assumed: wheel diameter 0.150 m and 2000 ticks per revolution where not given

metric                        mean    std    std       5 %      50 %      95 %
                                    error    dev
E_max,sys [mm]             447.564  0.000  0.000   447.564   447.564   447.564
sigma (per axis) [mm]        0.000  0.000  0.000     0.000     0.000     0.000
centroid cw, x [mm]       -293.593  0.000  0.000  -293.593  -293.593  -293.593
centroid cw, y [mm]       -337.811  0.000  0.000  -337.811  -337.811  -337.811
centroid ccw, x [mm]        62.942  0.000  0.000    62.942    62.942    62.942
centroid ccw, y [mm]       -60.080  0.000  0.000   -60.080   -60.080   -60.080
return heading cw [deg]      8.898  0.000  0.000     8.898     8.898     8.898
return heading ccw [deg]     1.769  0.000  0.000     1.769     1.769     1.769

E_max,sys without noise: 447.6 mm by exact kinematics, 439.3 mm to first order
[..]
[..]
447.6 mm |######################################## 100.0 %

seed 1, [..] trials/s, umbmark [..]

"#]]);
}

#[test]
fn the_document_has_the_promised_keys_and_nothing_else_on_stdout() {
    let document = json(&["-n", "30", "--bumps", "10", "--seed", "5"]);
    assert_eq!((&document["n"], &document["seed"]), (&30.into(), &5.into()));
    assert!(document["trials_per_s"].as_f64().unwrap() > 0.0);
    for metric in [
        "e_max_sys_m",
        "sigma_m",
        "centroid_cw_x_m",
        "centroid_cw_y_m",
        "centroid_ccw_x_m",
        "centroid_ccw_y_m",
        "return_heading_cw_rad",
        "return_heading_ccw_rad",
        "nonsys_orientation_rad",
    ] {
        let entry = &document["metrics"][metric];
        for key in ["mean", "std_dev", "std_error"] {
            assert!(entry[key].is_number(), "{metric} {key}");
        }
        assert!(entry["quantiles"]["0.05"].as_f64() <= entry["quantiles"]["0.95"].as_f64());
    }
    assert!(json(&["-n", "3"])["metrics"].get("nonsys_orientation_rad").is_none());
}

#[test]
fn a_single_trial_has_null_for_what_it_cannot_know_and_never_nan() {
    let document = json(&["-n", "1"]);
    assert!(document["metrics"]["e_max_sys_m"]["std_error"].is_null());
    let text = stdout(&["-n", "1"]);
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
}

#[test]
fn threads_change_nothing_but_the_time() {
    let plain: &[&str] = &["-n", "3000", "--ed-sd", "0.0005"];
    // In pieces: an effect that depends on the heading, one on the speed, and one drawn anew for each trial.
    let varying: &[&str] =
        &["-n", "600", "--side", "1", "--slope-x", "0.003", "--turn-slip-rate", "0.01", "--backlash-sd", "0.001"];
    for study in [plain, varying] {
        let of = |threads| results(json(&[study, &["--threads", threads]].concat()));
        let one = of("1");
        assert_eq!(one, of("2"));
        assert_eq!(one, of("8"));
    }
}

#[test]
fn effects_that_depend_on_the_way_or_on_the_measurement_move_the_return_as_their_laws_say() {
    let quarter = std::f64::consts::FRAC_PI_2;
    for (flags, metric, expected) in [
        (&["--slope-x", "0.003"][..], "centroid_cw_x_m", 0.048),
        (&["--nap-y", "-0.003"], "centroid_ccw_y_m", -0.048),
        (&["--slope-slide-y", "0.001"], "centroid_cw_y_m", 0.001 * 4.0 * quarter),
        (&["--backlash", "0.001"], "return_heading_ccw_rad", -0.001 / 0.34),
        (&["--turn-slip", "0.005"], "return_heading_ccw_rad", -4.0 * quarter * 0.005),
        (&["--caster-kick", "0.003"], "return_heading_cw_rad", -3.0 * 0.003),
        (&["--leg-kick", "0.003"], "return_heading_cw_rad", 4.0 * 0.003),
        (&["--bump-loss", "0.009"], "return_heading_cw_rad", -0.009 * 4.0 / 0.34),
        (&["--diameter-drift", "0.0001"], "return_heading_ccw_rad", 0.0001 * 8.0 * 16.0 / 0.34),
        (&["--speed-slip-right", "0.01", "--acceleration", "1000"], "return_heading_cw_rad", RIGHT_SLIP),
        (&["--marker-yaw", "0.01"], "return_heading_ccw_rad", 0.01),
        (&["--reference-delay", "0.5"], "centroid_cw_x_m", 0.0),
    ] {
        let study = ["-n", "2", "--runs", "1", "--wheel-noise", "0", "--odometry", "continuous"];
        let found = json(&[&study[..], flags].concat())["metrics"][metric]["mean"].as_f64().unwrap();
        assert!((found - expected).abs() < 2e-5, "{flags:?}: {metric} {found}, expected {expected}");
    }
}

/// At 0.2 m/s throughout a right wheel that slips by 0.01 s/m loses 0.2 % of its way: 16 m and, turning to the right, four
/// quarter turns backward.
const RIGHT_SLIP: f64 = -0.002 * (16.0 - 4.0 * 0.17 * std::f64::consts::FRAC_PI_2) / 0.34;

#[test]
fn every_trial_can_be_written_down_and_no_file_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trials with a space.csv");
    let name = file.to_str().unwrap();
    mc(&["-n", "2500", "--out", name]).success();
    let text = std::fs::read_to_string(&file).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "trial,e_max_sys_m,sigma_m,centroid_cw_x_m,centroid_cw_y_m,centroid_ccw_x_m,centroid_ccw_y_m,\
         return_heading_cw_rad,return_heading_ccw_rad"
    );
    let rows: Vec<&str> = lines.collect();
    assert_eq!((rows.len(), rows[0].split(',').count()), (2500, 9));
    assert!(rows[2499].starts_with("2499,"));
    let mean = rows.iter().map(|row| row.split(',').nth(1).unwrap().parse::<f64>().unwrap()).sum::<f64>() / 2500.0;
    assert!((mean - json(&["-n", "2500"])["metrics"]["e_max_sys_m"]["mean"].as_f64().unwrap()).abs() < 1e-12);

    mc(&["-n", "5", "--out", name]).code(1).stdout_eq(str![""]).stderr_eq(str![[r#"
error: [..]trials with a space.csv exists already; --force replaces it

"#]]);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    mc(&["-n", "5", "--out", name, "--force"]).success();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let nowhere = folder.path().join("no/such/folder.csv");
    mc(&["-n", "5", "--out", nowhere.to_str().unwrap()]).code(1).stderr_eq(str![[r#"
error: cannot write into the folder [..]: there is no such folder; make it first

"#]]);
}

#[test]
fn unusable_arguments_get_one_clear_error_and_exit_one() {
    for (arguments, message) in [
        (&["--ed", "9"][..], "error: --ed: wheel_diameter_ratio: e_d must be between 0.5 and 2, got 9\n"),
        (&["--wheelbase", "-0.34"], "error: --wheelbase: wheelbase_m must be between 0.001 and 100 m, got -0.34\n"),
        (&["--eb-sd", "-1"], "error: --eb-sd: standard deviation of e_b must be finite and 0 or more, got -1\n"),
        (&["--radius", "2"], "error: --radius is not a size of a square\n"),
        (&["-n", "0"], "error: number of trials must be between 1 and 1000000000000, got 0\n"),
        (&["--runs", "0"], "error: number of runs must be between 1 and 20000, got 0\n"),
        (&["--side", "0"], "error: side_m must be between 0.001 and 10000 m, got 0\n"),
        (
            &["--side", "9999", "--ticks-per-revolution", "1e8"],
            "error: the left counter makes 2.122e12 ticks in move 1 of the path; at most 2^30 - 2 are possible\n",
        ),
        (&["--robot", "no.toml"], "error: no.toml: [..]\n"),
    ] {
        mc(arguments).code(1).stdout_eq(str![""]).stderr_eq(message);
    }
}

#[test]
fn wrong_usage_exits_two_and_says_what_is_wrong() {
    mc(&["--ed", "1,002"]).code(2).stderr_eq(str![[r#"
error: invalid value '1,002' for '--ed <X>': write decimals with a point, as in 1.002

For more information, try '--help'.

"#]]);
    mc(&["--eb", "nan"]).code(2);
    mc(&["--wheel-nose", "1"]).code(2).stderr_eq(str![[r#"
error: unexpected argument '--wheel-nose' found

  tip: a similar argument exists: '--wheel-noise'

Usage: umbmark mc --wheel-noise <M^0.5>

For more information, try '--help'.

"#]]);
}

#[test]
fn robot_and_model_files_are_used_and_flags_override_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let robot = write(
        "robot.toml",
        "[robot]\nname = \"tiny\"\nwheelbase_m = 0.2\nwheel_diameter_m = 0.084\nticks_per_revolution = 2796.8\n\
         [path]\nshape = \"square\"\nside_m = 1.0\n",
    );
    let model = write(
        "model.toml",
        "[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.02, sd = 0.001 }\n\
         [[effect]]\nname = \"wheel_diameter_ratio\"\ne_d = 1.01\n",
    );
    let document = json(&["-n", "50", "--robot", &robot, "--model", &model, "--ed", "1.0"]);
    assert_eq!(document["robot"], "tiny");
    assert_eq!(document["path"]["sizes"]["side_m"], 1.0);
    assert_eq!(document["effects"][0]["e_d"], 1.0);
    assert_eq!(document["effects"][1]["e_b"]["sd"], 0.001);
    // To first order E_b alone gives 2√2 L (E_b - 1) π/2.
    let expected = 8.0_f64.sqrt() * 0.02 * std::f64::consts::FRAC_PI_2;
    let mean = document["metrics"]["e_max_sys_m"]["mean"].as_f64().unwrap();
    assert!((mean / expected - 1.0).abs() < 0.05, "{mean} {expected}");
}

#[test]
fn a_uni_directional_test_has_no_e_max_sys_and_hides_what_cancels() {
    let flags = ["--direction", "ccw", "--ed", "1.00203", "--eb", "1.01519", "--wheel-noise", "0", "-n", "20"];
    let document = json(&flags);
    assert!(document["metrics"].get("e_max_sys_m").is_none());
    let mean = |metric: &str| document["metrics"][metric]["mean"].as_f64().unwrap();
    // Fig. 3 of the paper: the ccw square closes, but for the quantisation of the encoders.
    assert!(mean("centroid_ccw_x_m").hypot(mean("centroid_ccw_y_m")) < 3e-3);
    let text = stdout(&flags);
    assert!(text.contains("5 ccw runs, uni-directional") && !text.contains("E_max,sys [mm]"), "{text}");
    assert!(text.contains("Driven both ways, E_max,sys without noise: 543.9 mm by exact kinematics"), "{text}");
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let mut child = std::process::Command::new(cargo_bin!("umbmark"))
        .args(["mc", "-n", "10"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(output.stderr.is_empty(), "{output:?}");
}

/// What a study says, but for the time it took.
fn results(mut document: serde_json::Value) -> serde_json::Value {
    document.as_object_mut().unwrap().remove("trials_per_s");
    document
}

const LONG: [&str; 7] = ["-n", "150000", "--ed-sd", "0.0005", "--seed", "11", "--json"];

#[test]
fn a_study_killed_at_any_moment_goes_on_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("study.json");
    let checkpoint = ["--checkpoint", file.to_str().unwrap(), "--checkpoint-every", "0"];
    let mut child = std::process::Command::new(cargo_bin!("umbmark"))
        .arg("mc")
        .args(LONG)
        .args(checkpoint)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    while !file.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // SIGKILL on Unix: nothing of the program runs after it.
    child.kill().unwrap();
    child.wait().unwrap();
    let merged = Command::new(cargo_bin!("umbmark")).args(["merge", file.to_str().unwrap(), "--json"]).assert();
    let half: serde_json::Value = serde_json::from_slice(&merged.success().get_output().stdout).unwrap();
    let done = half["n"].as_u64().unwrap();
    assert!(done > 0 && done < 150_000, "{done} trials were done when it was killed");
    let resumed = mc(&[&LONG[..], &checkpoint, &["--resume"]].concat()).success();
    let resumed: serde_json::Value = serde_json::from_slice(&resumed.get_output().stdout).unwrap();
    let whole = mc(&LONG).success();
    let whole: serde_json::Value = serde_json::from_slice(&whole.get_output().stdout).unwrap();
    assert_eq!(results(resumed), results(whole));
}

#[test]
fn shards_merge_to_the_bits_of_one_run_and_say_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let name = |i: u32| folder.path().join(format!("{i}.json")).to_str().unwrap().to_owned();
    let study = ["-n", "3000", "--bumps", "10", "--seed", "4"];
    for i in 1..=3 {
        mc(&[&study[..], &["--shard", &format!("{i}/3"), "--checkpoint", &name(i)]].concat()).success();
    }
    let merge = |files: &[&str]| Command::new(cargo_bin!("umbmark")).arg("merge").args(files).arg("--json").assert();
    let of = |assert: OutputAssert| serde_json::from_slice::<serde_json::Value>(&assert.get_output().stdout).unwrap();
    let (one, two, three) = (name(1), name(2), name(3));
    let merged = of(merge(&[&three, &one, &two]).success().stderr_eq(str![""]));
    let mut whole = json(&study);
    whole["trials_per_s"] = serde_json::Value::Null;
    assert_eq!(merged, whole);
    let partial = merge(&[&one, &three]).success().stderr_eq(str![[r#"
missing: trials 1024 to 2047

"#]]);
    assert_eq!(of(partial)["partial"], true);
    merge(&[&one, &one]).code(1).stdout_eq(str![""]).stderr_eq(str![[r#"
error: cannot merge [..]1.json with what comes before it: trials 0 to 1023 are in both

"#]]);
    mc(&["-n", "3000", "--seed", "5", "--checkpoint", &one, "--resume"]).code(1).stderr_eq(str![[r#"
error: [..]1.json is of another study or shard; give the robot, path, seed and number of trials that it was begun with

"#]]);
    mc(&["-n", "3000", "--checkpoint", &one]).code(1).stderr_eq(str![[r#"
error: [..]1.json exists already; --resume continues it, --force begins anew

"#]]);
    std::fs::write(folder.path().join("1.json"), "{}").unwrap();
    merge(&[&one]).code(1).stderr_eq(str![[r#"
error: [..]1.json is no checkpoint of a study by this version of umbmark: missing field [..]

"#]]);
}

#[test]
fn a_study_stops_when_it_is_precise_and_at_the_same_trial_for_any_number_of_threads() {
    let of = |threads| results(json(&["--until-std-error", "0.2mm", "--eb", "1.01", "--threads", threads]));
    let one = of("1");
    assert_eq!(one, of("3"));
    let error = one["metrics"]["e_max_sys_m"]["std_error"].as_f64().unwrap();
    assert!(error <= 0.2e-3 && one["partial"] == false, "{error}");
    mc(&["-n", "500", "--until-std-error", "0.001mm"]).success().stderr_eq(str![[r#"
warning: all trials are done, but the requested standard error is not reached

"#]]);
    mc(&["--until-std-error", "0.1"]).code(2);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_what_is_done_marked_as_partial() {
    let child = std::process::Command::new(cargo_bin!("umbmark"))
        .args(["mc", "-n", "100000000", "--json"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(1500));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["partial"], true);
    let n = document["n"].as_u64().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(message, format!("partial: stopped after {n} of 100000000 trials\n"));
}

#[test]
fn a_robot_of_the_paper_says_what_is_published_and_what_is_assumed_and_flags_override_it() {
    let text = stdout(&["--robot", "trc-labmate-docal", "-n", "300"]);
    for part in [
        "  from the paper: b = 337.2 mm, D_R/D_L = 1.00121 in the odometry (Table I)\n",
        "  assumed: mean wheel diameter 0.150 m and 2000 ticks per revolution\n",
        "Table I, 3. TRC-nomod/docal: E_max,sys 26 mm (above ",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let quiet = json(&["--robot", "trc-labmate-3loop-nocal", "--wheel-noise", "0", "-n", "20"]);
    assert!((quiet["metrics"]["e_max_sys_m"]["mean"].as_f64().unwrap() - 0.417).abs() < 1e-3, "{quiet}");
    assert_eq!(quiet["published"]["e_max_sys_m"], 0.423);
    mc(&["--robot", "trc-labmate-nocall"]).code(1).stdout_eq(str![""]).stderr_eq(
        "error: there is no robot \"trc-labmate-nocall\"; did you mean \"trc-labmate-nocal\"?\n  give a robot.toml, or one of [..]\n",
    );
}
