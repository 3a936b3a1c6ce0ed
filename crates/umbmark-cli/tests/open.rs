//! The workbench: who is answered, what is kept, and that its numbers are those of the verbs.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// A server that ends with the test.
struct Server {
    child: Child,
    host: String,
    token: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A status and what was answered.
struct Answer(u16, String);

impl Answer {
    fn json(&self) -> Value {
        assert_eq!(self.0, 200, "{}", self.1);
        serde_json::from_str(&self.1).unwrap()
    }

    fn error(&self) -> String {
        assert!(self.0 >= 400, "{}", self.1);
        serde_json::from_str::<Value>(&self.1).unwrap()["error"].as_str().unwrap().to_owned()
    }
}

impl Server {
    fn of(folder: &Path, words: &[&str]) -> Server {
        let mut child = Command::new(env!("CARGO_BIN_EXE_umbmark"))
            .args(["open", "--no-browser"])
            .args(words)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let rest = line.trim().strip_prefix("http://").unwrap_or_else(|| panic!("no address: {line}"));
        let (host, token) = rest.trim_end_matches('/').split_once('/').unwrap();
        assert!(host.starts_with("127.0.0.1:"), "{line}");
        Server { child, host: host.to_owned(), token: token.to_owned() }
    }

    /// Asks with these lines of a head.
    fn raw(&self, first: &str, head: &str, body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let head = format!("{first} HTTP/1.1\r\n{head}Connection: close\r\nContent-Length: {}\r\n\r\n", body.len());
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(body).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let text = String::from_utf8(answer).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        Answer(head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    fn ask(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        self.raw(&format!("{method} /{}/{path}", self.token), &format!("Host: {}\r\n", self.host), body)
    }

    fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, b"")
    }

    fn post(&self, path: &str, body: &Value) -> Answer {
        self.ask("POST", path, body.to_string().as_bytes())
    }

    fn act(&self, act: &Value) -> Value {
        self.post("api/act", act).json()
    }

    /// Long work, until it is done.
    fn job(&self, kind: &str) -> Value {
        self.job_seen(kind, |_| ())
    }

    /// The same, and what is told of it meanwhile.
    fn job_seen(&self, kind: &str, mut seen: impl FnMut(&Value)) -> Value {
        self.post(&format!("api/job?kind={kind}"), &json!({})).json();
        let began = Instant::now();
        loop {
            let told = self.get("api/state?since=").json();
            seen(&told["job"]);
            if told["job"]["running"] == false {
                assert_eq!(told["job"]["error"], Value::Null);
                return told;
            }
            assert!(began.elapsed() < Duration::from_secs(300), "{kind} does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Drops files, and says what is answered when they are opened.
    fn drop_files(&self, name: &str, files: &[(&str, &[u8])]) -> Answer {
        let folder =
            self.post(&format!("api/drop?name={name}"), &json!({})).json()["folder"].as_str().unwrap().to_owned();
        let folder = folder.replace(' ', "%20");
        for (name, bytes) in files {
            self.ask("POST", &format!("api/file?to={folder}&name={name}"), bytes).json();
        }
        self.post(&format!("api/open?folder={folder}"), &json!({}))
    }
}

fn data(name: &str) -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    if name == "hidden" { own.join("../../examples/hidden") } else { own.join("tests/data").join(name) }
}

/// A folder with a copy of some data.
fn place(name: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let to = place.path().join(name);
    for folder in ["", "runs"] {
        let Ok(entries) = std::fs::read_dir(data(name).join(folder)) else { continue };
        std::fs::create_dir_all(to.join(folder)).unwrap();
        for entry in entries.map(Result::unwrap).filter(|entry| entry.path().is_file()) {
            std::fs::copy(entry.path(), to.join(folder).join(entry.file_name())).unwrap();
        }
    }
    place
}

fn umbmark(folder: &Path, words: &str) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_umbmark")).args(words.split(' ')).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{words}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn only_pages_that_it_sent_itself_are_answered_and_none_without_the_token() {
    let place = place("slope");
    let server = Server::of(place.path(), &["slope"]);
    assert_eq!(server.get("api/state").0, 200);
    let (host, own) = (format!("Host: {}\r\n", server.host), format!("GET /{}/api/state", server.token));
    for first in ["GET /api/state", "GET /", "GET /00000000000000000000000000000000/api/state", "GET /../api/state"] {
        assert!(server.raw(first, &host, b"").error().contains("token"), "{first}");
    }
    for wrong in ["Host: evil.example\r\n", "", "Host: 127.0.0.1:1\r\n"] {
        assert_eq!(server.raw(&own, wrong, b"").0, 421, "{wrong}");
    }
    for wrong in ["Origin: http://evil.example", "Origin: null", "Sec-Fetch-Site: cross-site"] {
        assert!(server.raw(&own, &format!("{host}{wrong}\r\n"), b"").error().contains("another page"), "{wrong}");
    }
    assert_eq!(server.ask("PUT", "api/act", b"").0, 405);
    for path in
        ["../Cargo.toml", "..%2F..%2Fetc%2Fpasswd", "front/app.js", "api/../app.js", "etc/passwd", ".workbench.json"]
    {
        assert_eq!(server.get(path).0, 404, "{path}");
    }
    for name in [
        "../out.csv",
        "..%2Fout.csv",
        "a/../../out.csv",
        "%2Fetc%2Fout.csv",
        ".workbench.json",
        "a%00b",
        "..%5Cout.csv",
    ] {
        let folder = server.post("api/drop?name=a", &json!({})).json()["folder"].as_str().unwrap().replace(' ', "%20");
        let told = server.ask("POST", &format!("api/file?to={folder}&name={name}"), b"x").error();
        assert!(told.contains("no name of a file"), "{name}: {told}");
        assert_eq!(server.ask("POST", &format!("api/file?to={name}&name=a.csv"), b"x").0, 422, "{name}");
        assert_eq!(server.post(&format!("api/open?folder={name}"), &json!({})).0, 422, "{name}");
    }
    let written: Vec<_> = std::fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(written.len(), 2, "{written:?}");
}

/// The fits, the steps, the diagnosis, the report and the models are those of the verbs, to the last digit.
#[test]
fn every_number_is_that_of_the_verbs_to_the_last_digit() {
    let place = place("hidden");
    let server = Server::of(place.path(), &["hidden"]);
    let inspected = parsed(&umbmark(place.path(), "inspect hidden --json"));
    assert_eq!(server.get("api/inspection").json(), inspected);
    // Until the runs are ready for fits, the error of the nominal robot is not known; a change waits for it.
    let nominal = |bench: &Value| bench["state"]["steps"][0]["errors"]["heldout_rmse_m"].clone();
    let told = server.get("api/state").json()["bench"].clone();
    assert!(told["preparing"] == true || !nominal(&told).is_null(), "{told}");
    // By hand.
    let begun = nominal(&server.act(&json!({ "act": "first" }))["bench"]);
    server.act(&json!({ "act": "add", "effect": "floor_slope_yaw" }));
    let told = server.job("fit");
    let words = "fit hidden --add scale --add floor_slope_yaw -o by_hand.toml --json";
    let fitted = parsed(&umbmark(place.path(), words));
    let by_hand = std::fs::read_to_string(place.path().join("by_hand.toml")).unwrap();
    assert_eq!(server.get("api/model.toml").1, by_hand);
    assert_eq!(told["bench"]["fitted"], fitted);
    server.act(&json!({ "act": "accept" }));
    let found = server.job("diagnose")["bench"]["found"]["diagnosis"].clone();
    assert_eq!(found, parsed(&umbmark(place.path(), "diagnose hidden --model by_hand.toml --json")));
    let by_hand = server.get("api/state").json()["bench"]["state"]["steps"][1].clone();
    // By the loop, whose steps are seen one after the other.
    let mut seen = Vec::new();
    let told = server.job_seen("learn", |job| seen.push(job["steps"].as_array().unwrap().len()));
    assert!(seen.is_sorted() && seen.iter().any(|steps| *steps < 5) && seen.last() == Some(&5), "{seen:?}");
    let learnt = parsed(&umbmark(place.path(), "learn hidden -o learnt.toml --json"));
    assert_eq!(server.get("api/model.toml").1, std::fs::read_to_string(place.path().join("learnt.toml")).unwrap());
    assert_eq!(told["bench"]["found"]["learnt"], learnt);
    let (ours, theirs) = (&told["bench"]["state"]["steps"], &learnt["steps"]);
    assert_eq!(ours.as_array().unwrap().len(), theirs.as_array().unwrap().len());
    for (ours, theirs) in ours.as_array().unwrap().iter().zip(theirs.as_array().unwrap()) {
        for key in ["rmse_m", "heading_rmse_rad", "heldout_rmse_m", "heldout_heading_rmse_rad", "aicc"] {
            assert_eq!(ours["errors"][key], theirs[key], "{key}");
        }
        assert_eq!(ours["p_adjusted"], theirs["p_adjusted"]);
    }
    assert_eq!(begun, theirs[0]["heldout_rmse_m"]);
    for (reached, theirs) in told["job"]["steps"].as_array().unwrap().iter().zip(theirs.as_array().unwrap()) {
        for key in ["added", "p_adjusted", "heldout_rmse_m"] {
            assert_eq!(reached[key], theirs[key], "{key}");
        }
    }
    // The effect that was added by hand leaves the error that learn says, but for where the fit began.
    let left = |step: &Value| step["errors"]["heldout_rmse_m"].as_f64().unwrap();
    assert!((left(&by_hand) / left(&ours[4]) - 1.0).abs() < 1e-5, "{by_hand} {}", ours[4]);
    // What is taken away.
    umbmark(place.path(), "export learnt.toml --to ros2_control -o robot.yaml");
    let exported = std::fs::read_to_string(place.path().join("robot.yaml")).unwrap();
    assert_eq!(server.get("api/export?to=ros2_control").1, exported);
    let commands = server.get("api/commands").json()["commands"].clone();
    assert_eq!(commands[1], "umbmark learn hidden -o model.toml");
}

#[test]
fn the_report_is_that_of_the_verb_and_the_cloud_is_that_of_mc() {
    let place = place("slope");
    let server = Server::of(place.path(), &["slope"]);
    server.act(&json!({ "act": "first" }));
    server.job("fit");
    std::fs::write(place.path().join("model.toml"), server.get("api/model.toml").1).unwrap();
    server.job("report");
    umbmark(place.path(), "report slope --model model.toml");
    let theirs = std::fs::read_to_string(place.path().join("report.html")).unwrap();
    // The verb names the file of the model among those that it read.
    let until = |page: &str| page.split("id=\"provenance\"").next().unwrap().to_owned();
    let ours = server.get("api/report.html").1;
    assert!(until(&ours) == until(&theirs) && ours.len() > 1_000_000);
    let asked = json!({ "e_d": 1.002, "e_b": 1.01, "noise": 0.001, "side": 4.0, "runs": 5, "trials": 500, "seed": 3 });
    let cloud = server.post("api/cloud", &asked).json();
    let command = cloud["command"].as_str().unwrap().strip_prefix("umbmark ").unwrap();
    let theirs = parsed(&umbmark(place.path(), &format!("{command} --json")));
    assert_eq!((&cloud["result"]["metrics"], &cloud["result"]["effects"]), (&theirs["metrics"], &theirs["effects"]));
}

/// Models of which all figures are asked for.
const ROUNDS: u32 = 2;

/// They share what they are made of, and the threads that work it out.
#[test]
fn all_figures_are_answered_when_they_are_asked_for_at_once() {
    let place = place("slope");
    let server = Server::of(place.path(), &["slope", "--threads", "2"]);
    server.act(&json!({ "act": "first" }));
    let names: Vec<String> = server.get("api/catalogue").json()["figures"]
        .as_array()
        .unwrap()
        .iter()
        .map(|figure| figure["name"].as_str().unwrap().to_owned())
        .collect();
    assert!(names.len() > 10, "{names:?}");
    // Each round has another model, of which nothing is known yet.
    for round in 1..=ROUNDS {
        let value = 1.0 + 1e-4 * f64::from(round);
        server.act(&json!({ "act": "set", "effect": "wheelbase", "parameter": "e_b", "value": value }));
        let answered = |name: &String| {
            let mut stream = TcpStream::connect(&server.host).unwrap();
            stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
            let path = format!("/{}/api/figure?name={name}", server.token);
            let head = format!("GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", server.host);
            stream.write_all(head.as_bytes()).unwrap();
            let mut answer = Vec::new();
            stream.read_to_end(&mut answer).is_ok() && answer.starts_with(b"HTTP/1.1 200")
        };
        let wrong: Vec<&String> = std::thread::scope(|scope| {
            let asked: Vec<_> = names.iter().map(|name| (name, scope.spawn(|| answered(name)))).collect();
            asked.into_iter().filter_map(|(name, answer)| (!answer.join().unwrap()).then_some(name)).collect()
        });
        assert!(wrong.is_empty(), "round {round}: {wrong:?}");
    }
}

#[test]
fn a_killed_server_leaves_the_work_and_the_next_one_goes_on_with_it() {
    let place = place("slope");
    let mut server = Server::of(place.path(), &["slope", "--threads", "1"]);
    server.act(&json!({ "act": "first" }));
    server.job("fit");
    server.act(&json!({ "act": "accept" }));
    server.act(&json!({ "act": "set", "effect": "wheelbase", "parameter": "e_b", "value": 1.01 }));
    server.act(&json!({ "act": "hide", "runs": ["cw_1", "nobody"] }));
    let before = server.get("api/state").json()["bench"].clone();
    server.child.kill().unwrap();
    server.child.wait().unwrap();
    let next = Server::of(place.path(), &["slope"]);
    let after = next.get("api/state").json()["bench"].clone();
    assert_eq!(before["state"], after["state"]);
    assert!(after["state"]["draft"].is_object() && after["state"]["steps"].as_array().unwrap().len() == 2);
    assert!(next.token != server.token);
    // The file of the work is no part of the data.
    assert!(umbmark(place.path(), "score slope").contains("E_max,sys"));
    // A file that is no such document is not taken for the work, and is left alone.
    drop(next);
    let file = place.path().join("slope/.workbench.json");
    std::fs::write(&file, "{\"version\": 1").unwrap();
    let words = ["open", "slope", "--no-browser"];
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark")).args(words).current_dir(place.path()).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && told.contains(".workbench.json") && told.contains("move it away"), "{told}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "{\"version\": 1");
}

#[test]
fn files_that_are_dropped_are_opened_and_bad_ones_are_refused_while_the_work_before_is_kept() {
    let place = tempfile::tempdir().unwrap();
    let server = Server::of(place.path(), &[]);
    assert!(server.get("api/paths").error().contains("drop a log"));
    let told = server.drop_files("noise", &[("noise.csv", b"\xff\xfe\x00rubbish")]).error();
    assert!(told.contains("noise.csv"), "{told}");
    assert_eq!(server.get("api/state").json()["key"], "empty");
    let of = |name: &str| std::fs::read(data("slope").join(name)).unwrap();
    let (robot, returns) = (of("robot.toml"), of("returns.csv"));
    server.drop_files("slope", &[("slope/robot.toml", &robot), ("slope/returns.csv", &returns)]).json();
    let opened = server.get("api/state").json();
    assert_eq!(opened["bench"]["state"]["steps"][0]["words"], "nominal robot");
    let broken = String::from_utf8(returns).unwrap().replace("ccw,1,", "ccw,one,");
    let told = server.drop_files("broken", &[("robot.toml", &robot), ("returns.csv", broken.as_bytes())]).error();
    assert!(told.contains("returns.csv:") && told.contains("one"), "{told}");
    assert_eq!(server.get("api/state").json()["key"], opened["key"]);
    // Logs that say nothing of their robot ask for its plate.
    let log = std::fs::read(data("tracked").join("runs/cw_01.csv")).unwrap();
    let asked = server.drop_files("log", &[("cw_01.csv", &log)]).json();
    let numbers = asked["waiting"]["numbers"].as_array().unwrap();
    assert!(numbers.iter().any(|number| number["name"] == "wheelbase_m"), "{asked}");
    let incomplete = server.post("api/plate", &json!({ "numbers": [["wheelbase_m", 0.3]] })).error();
    assert!(incomplete.contains("Still missing: wheel_diameter_m"), "{incomplete}");
    assert!(server.post("api/plate", &json!({ "numbers": [["wheelbase_m", -1.0]] })).error().contains("must be"));
    let plate =
        json!({ "numbers": [["wheelbase_m", 0.3], ["wheel_diameter_m", 0.1], ["ticks_per_revolution", 2000.0]] });
    server.post("api/plate", &plate).json();
    assert_eq!(server.get("api/inspection").json()["robot"]["wheelbase_m"], 0.3);
}

#[test]
fn what_cannot_be_done_is_said_in_a_sentence_and_changes_nothing() {
    let place = place("slope");
    let server = Server::of(place.path(), &["slope"]);
    let before = server.get("api/state").json()["bench"]["state"].clone();
    for (act, why) in [
        (json!({ "act": "add", "effect": "wheelbas" }), "did you mean \"wheelbase\""),
        (json!({ "act": "set", "effect": "wheelbase", "parameter": "e_b", "value": 1.0 }), "has no wheelbase"),
        (json!({ "act": "goto", "step": 9 }), "no step 9"),
        (json!({ "act": "undo" }), "nothing to undo"),
        (json!({ "act": "accept" }), "no draft"),
        (json!({ "act": "fly" }), "not understood"),
        (
            json!({ "act": "formula", "name": "a", "acts_on": "turn_scale", "formula": "sin(speed)", "parameters": {} }),
            "column 5",
        ),
    ] {
        let told = server.post("api/act", &act).error();
        assert!(told.contains(why), "{told}");
    }
    let job = server.post("api/job?kind=fit", &json!({}));
    assert_eq!(job.0, 200);
    std::thread::sleep(Duration::from_millis(300));
    assert!(
        server.get("api/state").json()["job"]["error"].as_str().unwrap().contains("No number of the model is free")
    );
    assert!(server.post("api/job?kind=dance", &json!({})).error().contains("dance"));
    assert_eq!(server.get("api/state").json()["bench"]["state"], before);
    // A port that is taken.
    let port = server.host.split_once(':').unwrap().1.to_owned();
    let words = ["open", "slope", "--no-browser", "--port", &port];
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark")).args(words).current_dir(place.path()).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && told.contains(&format!("port {port}")), "{told}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_even_while_it_learns() {
    let place = place("hidden");
    let mut server = Server::of(place.path(), &["hidden"]);
    server.post("api/job?kind=learn", &json!({})).json();
    Command::new("kill").args(["-INT", &server.child.id().to_string()]).status().unwrap();
    let began = Instant::now();
    let status = server.child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert!(began.elapsed() < Duration::from_secs(10));
}
