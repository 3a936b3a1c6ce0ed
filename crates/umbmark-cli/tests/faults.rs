//! Every verb that writes, killed, told to end, with a full disk and with a closed pipe: what stands under a name is the old file or the new
//! one, whole, and nothing else is left but by a kill.
//!
//! Set `UMBMARK_FAULTS=1000` for a thousand rounds of random moments in place of one.

#![cfg(unix)]
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A command, what it writes, and whether that stands there before.
struct Writing {
    words: &'static str,
    place: &'static str,
    replaces: bool,
    /// What is done until it is told to end is written too.
    writes_part: bool,
    /// Files that are given their names one after the other, each of them whole.
    one_by_one: bool,
}

const fn writes(words: &'static str, place: &'static str) -> Writing {
    Writing { words, place, replaces: false, writes_part: false, one_by_one: false }
}

const fn replaces(words: &'static str, place: &'static str) -> Writing {
    Writing { words, place, replaces: true, writes_part: false, one_by_one: false }
}

const WRITINGS: [Writing; 16] = [
    Writing { writes_part: true, ..replaces("mc -n 400 --out new.csv --force", "new.csv") },
    Writing { writes_part: true, ..replaces("mc -n 400 --checkpoint new.json --force", "new.json") },
    Writing { writes_part: true, ..replaces("mc --sweep eb=0.99:1.01:5 -n 20 -o new.csv --force", "new.csv") },
    replaces("merge part.json -o new.json --force", "new.json"),
    writes("simulate --runs 2 --reference-rate 2 --encoder-rate 5 -o new", "new"),
    writes("simulate --runs 1 --reference-rate 2 --encoder-rate 5 -o new.mcap", "new.mcap"),
    replaces("calibrate tape --export-toml new.toml --force", "new.toml"),
    replaces("fit tape -o new.toml --force", "new.toml"),
    replaces("learn tape -o new.toml --force", "new.toml"),
    replaces("export model.toml --to c -o new.h --force", "new.h"),
    Writing { one_by_one: true, ..writes("apply fresh_day --model model.toml -o new", "new") },
    Writing { writes_part: true, ..replaces("report tape -n 100 -o new.html --force", "new.html") },
    replaces("plot return_errors tape -o new.svg --force", "new.svg"),
    writes("convert fresh_day -o new", "new"),
    writes("init new", "new"),
    writes("watch tape --state new.json", "new.json"),
];

const OLD: &[u8] = b"what stood there before";

/// A place with all that the commands read.
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for data in ["tape", "fresh_day"] {
        copy(&examples.join(data), &place.path().join(data));
    }
    for words in ["fit tape -o model.toml", "mc -n 20 --checkpoint part.json"] {
        let output = command(place.path(), words).output().unwrap();
        assert!(output.status.success(), "{words}: {output:?}");
    }
    place
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to);
        } else {
            std::fs::copy(entry.path(), to).unwrap();
        }
    }
}

fn command(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    command.args(words.split(' ')).current_dir(folder).stdin(Stdio::null());
    command
}

/// Every file of a folder by its path in it.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                all.insert(path.strip_prefix(folder).unwrap().to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// One command in one place, put back to what it was before each fault.
struct Bench {
    writing: &'static Writing,
    folder: tempfile::TempDir,
    /// All files before, and those that the undisturbed command adds or replaces.
    before: BTreeMap<PathBuf, Vec<u8>>,
    whole: BTreeMap<PathBuf, Vec<u8>>,
    /// How long that took.
    time: Duration,
}

impl Bench {
    fn new(writing: &'static Writing, inputs: &Path) -> Bench {
        let folder = tempfile::tempdir().unwrap();
        copy(inputs, folder.path());
        if writing.replaces {
            std::fs::write(folder.path().join(writing.place), OLD).unwrap();
        }
        let before = files(folder.path());
        let began = Instant::now();
        let output = command(folder.path(), writing.words).output().unwrap();
        assert!(output.status.success(), "{}: {output:?}", writing.words);
        let time = began.elapsed();
        let mut whole = files(folder.path());
        whole.retain(|path, bytes| before.get(path) != Some(bytes));
        let is_place = |path: &PathBuf| path.starts_with(writing.place);
        assert!(!whole.is_empty() && whole.keys().all(is_place), "{}: {:?}", writing.words, whole.keys());
        let bench = Bench { writing, folder, before, whole, time };
        bench.restore();
        bench
    }

    /// Puts everything back.
    fn restore(&self) {
        for entry in std::fs::read_dir(self.folder.path()).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(self.folder.path()).unwrap();
            let is_known =
                self.before.keys().any(|known| known.starts_with(name)) && name != Path::new(self.writing.place);
            match (is_known, path.is_dir()) {
                (true, _) => {}
                (false, true) => std::fs::remove_dir_all(&path).unwrap(),
                (false, false) => std::fs::remove_file(&path).unwrap(),
            }
        }
        if self.writing.replaces {
            std::fs::write(self.folder.path().join(self.writing.place), OLD).unwrap();
        }
        assert_eq!(files(self.folder.path()), self.before, "{}: an input was changed", self.writing.words);
    }

    /// What stands there after a fault is what was before or the whole, and nothing else but what `left` allows. Whether it is the whole.
    fn is_whole(&self, fault: &str, left: fn(&str) -> bool) -> bool {
        let words = self.writing.words;
        let (mut now, mut changed) = (files(self.folder.path()), BTreeMap::new());
        now.retain(|path, bytes| {
            if path.iter().any(|part| left(part.to_str().unwrap())) {
                return false;
            }
            if path.starts_with(self.writing.place) {
                if self.before.get(path) != Some(bytes) {
                    changed.insert(path.clone(), bytes.clone());
                }
                return self.before.contains_key(path);
            }
            true
        });
        assert!(now.keys().eq(self.before.keys()), "{words} {fault}: other files: {:?}", now.keys());
        // Rows, a document or a page that ends as it should.
        let ends = |bytes: &Vec<u8>| bytes.ends_with(b"\n") || bytes.ends_with(b"</html>");
        let is_part = self.writing.writes_part && changed.len() == 1 && changed.values().all(ends);
        let are_whole = changed.iter().all(|(path, bytes)| self.whole.get(path) == Some(bytes));
        let is_part = is_part || self.writing.one_by_one && are_whole;
        let names = (changed.keys(), self.whole.keys());
        assert!(changed.is_empty() || changed == self.whole || is_part, "{words} {fault}: half of it: {names:?}");
        !changed.is_empty()
    }

    /// A signal after a share of the time that the command takes.
    fn signalled(&self, signal: &str, share: f64) {
        let mut command = command(self.folder.path(), self.writing.words);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(self.time.mul_f64(share));
        Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
        let output = child.wait_with_output().unwrap();
        let fault = format!("{signal} after {share:.3} of its time: {output:?}");
        let is_whole = match signal {
            // What a killed process was writing has a name that says so.
            "-KILL" => self.is_whole(&fault, |name| {
                name.starts_with(".tmp") || name.starts_with(".umbmark-") || name.ends_with(".lock")
            }),
            _ => self.is_whole(&fault, |_| false),
        };
        assert!(output.status.success() <= is_whole, "{}: {fault}: success without a file", self.writing.words);
        if signal != "-KILL" {
            // Before the command catches signals, it ends by them.
            let code = output.status.code();
            assert!(matches!(code, Some(0 | 1 | 130) | None), "{}: {fault}", self.writing.words);
        }
        self.restore();
    }

    /// No file may grow beyond some blocks.
    fn on_a_full_disk(&self, blocks: u32) {
        let words = self.writing.words;
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {words}");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_umbmark")]).current_dir(self.folder.path());
        let output: Output = command.output().unwrap();
        let is_whole = self.is_whole(&format!("on a full disk: {output:?}"), |_| false);
        assert_eq!(output.status.success(), is_whole, "{words} on a full disk: {output:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(is_whole || output.status.code() == Some(1) && said.contains("error: "), "{words}: {output:?}");
        assert!(is_whole || said.contains("new"), "{words} on a full disk names no file: {said}");
        assert!(blocks > 0 || !is_whole, "{words} wrote to a full disk");
        self.restore();
    }

    /// Nobody reads what it prints.
    fn with_a_closed_pipe(&self) {
        let mut command = command(self.folder.path(), self.writing.words);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let is_whole = self.is_whole(&format!("with a closed pipe: {output:?}"), |_| false);
        assert!(output.status.success() && is_whole, "{} with a closed pipe: {output:?}", self.writing.words);
        self.restore();
    }
}

/// Random shares, the same ones in every run of the test.
struct Shares(u64);

impl Iterator for Shares {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Some(((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

#[test]
fn what_a_verb_writes_is_whole_or_as_it_was_whatever_happens() {
    let inputs = place();
    let rounds = std::env::var("UMBMARK_FAULTS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(1);
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        while let Some(writing) = WRITINGS.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
            let bench = Bench::new(writing, inputs.path());
            let mut shares = Shares(writing.words.len() as u64);
            for _ in 0..rounds {
                for signal in ["-KILL", "-TERM", "-INT"] {
                    bench.signalled(signal, 1.1 * shares.next().unwrap());
                }
            }
            for blocks in [0, 1] {
                bench.on_a_full_disk(blocks);
            }
            bench.with_a_closed_pipe();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(work);
        }
    });
}
