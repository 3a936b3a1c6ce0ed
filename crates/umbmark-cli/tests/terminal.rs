//! What a terminal of 80 columns shows: every verb's text, on the examples and on data with awkward names.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

const WIDTH: usize = 80;

/// A folder with copies of the data that the commands below name.
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let examples = own.join("../../examples");
    for data in ["slope", "tracked"] {
        copy(&own.join("tests/data").join(data), &place.path().join(data), &str::to_owned);
    }
    for data in ["tape", "fresh_day"] {
        copy(&examples.join(data), &place.path().join(data), &str::to_owned);
    }
    std::fs::copy(examples.join("tolerances.toml"), place.path().join("tolerances.toml")).unwrap();
    // Logs that are named as a recorder names them.
    let long = |name: &str| format!("rosbag2_of_the_second_robot_in_the_large_hall_2026_11_02-10_31_{name}");
    copy(&place.path().join("tracked"), &place.path().join("long"), &long);
    copy(&place.path().join("long/runs"), &place.path().join("logs"), &str::to_owned);
    place
}

fn copy(from: &Path, to: &Path, of_run: &dyn Fn(&str) -> String) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path: PathBuf = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        match path.is_dir() {
            true => copy(&path, &to.join(name), of_run),
            false if from.ends_with("runs") => std::fs::copy(&path, to.join(of_run(&name))).map(drop).unwrap(),
            false => std::fs::copy(&path, to.join(name)).map(drop).unwrap(),
        }
    }
}

/// The commands, in an order in which what one writes is there for the next.
const COMMANDS: &[&str] = &[
    "mc -n 200 --slope-x 0.002 --checkpoint study.json",
    "mc -n 20 --sweep ed=1:1.002:3 --sweep eb=0.99:1.01:9",
    "merge study.json",
    "simulate -o one --runs 1 --side 1 --encoder-rate 20 --reference-rate 10",
    "inspect one",
    "compare one --verbose",
    "changed tape tape",
    "changed tracked fresh_day",
    "changed slope tape",
    "simulate -o tile --reference-rate 0",
    "simulate -o carpet_of_the_long_corridor --reference-rate 0 --eb 1.01",
    "conditions tile carpet_of_the_long_corridor",
    "survey tape tile carpet_of_the_long_corridor",
    "watch tape --verbose",
    "watch tape --state robot.watch.json --restart cw_02",
    "watch slope --check",
    "convert one -o one_mcap --to mcap",
    "inspect one_mcap",
    "paper -n 20",
    "inspect slope",
    "inspect tape",
    "inspect tracked",
    "inspect long",
    "inspect logs",
    "score slope",
    "score tape",
    "calibrate slope",
    "calibrate tape",
    "solve tape -o model.toml --verbose",
    "compare slope",
    "compare slope --verbose",
    "compare long",
    "compare long --verbose",
    "compare fresh_day --model model.toml --verbose",
    "diagnose slope",
    "diagnose slope --verbose",
    "diagnose long --verbose",
    "plan",
    "plan tape --draws 99",
    "plan --separate wheelbase turn_slip",
    "fit tape --add wheelbase -o fitted.toml",
    "learn slope -o learnt.toml",
    "export learnt.toml --to toml -o new.toml",
    "apply tracked/runs/cw_01.csv --model fitted.toml -o corrected.csv --force",
    "sensitivity -n 256 --vary ed=normal:1:0.001 --vary eb=normal:1:0.003 --noise-free",
    "tolerance tolerances.toml -n 500",
    "report tape -o page.html",
    "plot return_errors tape -o figure.svg",
    "init filled_in_by_hand",
    "init from_logs --logs logs",
    "init from_plate --logs logs --wheelbase 0.34 --wheel-diameter 0.15",
    "effects",
    "effects floor_slope_yaw",
    "effects centripetal_load",
];

/// Verbs without text for people: scripts for shells, a manual page, and a server, which goes on.
const EXCEPTED: [&str; 2] = ["completions", "open"];

/// Words for more than one thing, which never follow a 1.
const SEVERAL: [&str; 20] = [
    "runs", "pairs", "poses", "models", "laws", "points", "legs", "turns", "stops", "logs", "rows", "trials",
    "effects", "tests", "drives", "headings", "lines", "readings", "robots", "steps",
];

#[test]
fn every_verb_keeps_to_80_columns_has_no_minus_zero_and_counts_as_people_do() {
    let place = place();
    let mut wrong = Vec::new();
    for command in COMMANDS {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.extend(["--seed", "7"]);
        let output =
            Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(place.path()).args(&arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 3)), "{command}: {said}");
        let text = String::from_utf8(output.stdout).unwrap();
        for line in text.lines() {
            if line.chars().count() > WIDTH {
                wrong.push(format!("{command}: {} columns: {line}", line.chars().count()));
            }
            let words: Vec<&str> = line.split([' ', '(', ',', ')', ';']).filter(|word| !word.is_empty()).collect();
            let zero = |word: &&&str| word.starts_with("-0") && word.trim_end_matches('%').parse() == Ok(0.0);
            wrong.extend(words.iter().find(zero).map(|_| format!("{command}: minus zero: {line}")));
            let one = |pair: &&[&str]| pair[0] == "1" && SEVERAL.contains(&pair[1].trim_end_matches(['.', ':']));
            wrong.extend(words.windows(2).find(one).map(|pair| format!("{command}: {pair:?}: {line}")));
            if line.contains("(s)") {
                wrong.push(format!("{command}: (s): {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_verb_is_among_the_commands() {
    let asked: BTreeSet<&str> = COMMANDS.iter().filter_map(|command| command.split(' ').next()).collect();
    for verb in umbmark_cli::command().get_subcommands() {
        assert!(asked.contains(verb.get_name()) || EXCEPTED.contains(&verb.get_name()), "{}", verb.get_name());
    }
}

/// The verdict stands in the first lines, and the tables behind it are there for whoever wants them.
#[test]
fn long_answers_are_short_until_their_tables_are_wanted() {
    let place = place();
    let lines = |command: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_umbmark"))
            .current_dir(place.path())
            .args(command.split(' '))
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect::<Vec<_>>()
    };
    for (command, most) in [("compare fresh_day", 60), ("diagnose fresh_day", 50), ("diagnose slope", 50)] {
        let short = lines(command);
        let long = lines(&format!("{command} --verbose"));
        assert!(short.len() <= most && long.len() > short.len() + 10, "{command}: {} of {}", short.len(), long.len());
        assert!(
            short.last().unwrap().len() > 3 && short.join(" ").contains("--verbose prints the tables"),
            "{short:?}"
        );
        assert!(!long.join(" ").contains("--verbose prints the tables"));
        let verdict = if command.starts_with("compare") { "explains" } else { "verdict" };
        assert!(short[..4].iter().any(|line| line.contains(verdict)), "{short:?}");
    }
}
