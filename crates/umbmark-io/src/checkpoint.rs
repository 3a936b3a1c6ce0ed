//! Long studies written down now and then, taken up again, and put together from shards.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::Existing;
use crate::lock::{Held, Lock};
use crate::whole_file::{FileError, WholeFile, in_words};
use umbmark_core::monte_carlo::{Ensemble, MergeError, Shard, Study, Sweep, SweepPoint};
use umbmark_core::result;

/// What is done where the file of a checkpoint is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// Leave it, and begin nothing.
    Refuse,
    /// Begin anew and put the new one in its place.
    Replace,
    /// Go on with it.
    Resume,
}

/// Where a long study is written down, and how often.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The file.
    pub file: PathBuf,
    /// Time between two writes.
    pub every: Duration,
    /// What is done where it is there already.
    pub found: Found,
}

/// A study written down: what it is, and what is known of it so far.
#[derive(Debug, Serialize, Deserialize)]
pub struct Written {
    /// Its seed.
    pub seed: u64,
    /// What it is.
    pub study: result::Study,
    /// What is done.
    pub ensemble: Ensemble,
}

/// A sweep as far as it is done.
#[derive(Serialize, Deserialize)]
struct WrittenSweep {
    sweep: String,
    points: Vec<SweepPoint>,
}

/// Why a study is not taken up, or not written down.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file exists, and the caller did not say what to do with it.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// It is a device, a pipe or a folder, from which nothing can be gone on with.
    #[error("{} is not a regular file, and it is read again; name another", .0.display())]
    NotRegular(PathBuf),
    /// Another process writes it.
    #[error(
        "{} is written by {} at this moment; wait for it, or name another file",
        file.display(),
        process.map_or("another process".to_owned(), |process| format!("process {process}"))
    )]
    InUse {
        /// The file.
        file: PathBuf,
        /// The number of the process, if it is known.
        process: Option<u32>,
    },
    /// It cannot be read.
    #[error("cannot read {}: {}", file.display(), in_words(error, "there is no such file"))]
    Read {
        /// The file.
        file: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// It was changed or cut off after it was written.
    #[error(
        "{} is damaged: {damage}; give another copy of it, or move it away and begin anew",
        file.display()
    )]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What differs from what its first line announces.
        damage: Damage,
    },
    /// Something else stands in it.
    #[error("{} is no checkpoint of a {what} by this version of umbmark: {error}", file.display())]
    Other {
        /// The file.
        file: PathBuf,
        /// What it should be of.
        what: &'static str,
        /// Why.
        error: serde_json::Error,
    },
    /// It is of something else than what is to be done.
    #[error("{} is of another {what}; give the robot, path, seed and number of trials that it was begun with", file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
        /// Study or sweep.
        what: &'static str,
    },
    /// Nothing to merge.
    #[error("there is no file to merge; give one or more checkpoints of one study")]
    Nothing,
    /// It belongs to none of those before it.
    #[error("cannot merge {} with what comes before it: {error}", file.display())]
    Merge {
        /// The file.
        file: PathBuf,
        /// Why.
        error: MergeError,
    },
    /// It cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// How the content of a checkpoint differs from what its first line announces.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Damage {
    /// Its format is of a later version.
    #[error("it has format {0}, and this version of umbmark reads formats up to {FORMAT}")]
    Format(u64),
    /// It was cut off, or something was added.
    #[error("it has {there} bytes after its first line, which announces {announced}")]
    Length {
        /// Bytes that are there.
        there: u64,
        /// Bytes that were written.
        announced: u64,
    },
    /// It was changed.
    #[error("its checksum is {there:08x}, its first line announces {announced:08x}")]
    Checksum {
        /// Of what is there.
        there: u32,
        /// Of what was written.
        announced: u32,
    },
}

/// The format of checkpoints. The first had no line before its content.
const FORMAT: u64 = 2;

/// The first line of a checkpoint.
#[derive(Serialize, Deserialize)]
struct Announced {
    umbmark_checkpoint: u64,
    bytes: u64,
    crc32: u32,
}

/// Content with the line before it that says how long it is and what its checksum is.
pub(crate) fn framed(content: &impl Serialize) -> Result<String, serde_json::Error> {
    let content = serde_json::to_string(content)? + "\n";
    let crc32 = crc32fast::hash(content.as_bytes());
    let line = Announced { umbmark_checkpoint: FORMAT, bytes: content.len() as u64, crc32 };
    Ok(serde_json::to_string(&line)? + "\n" + &content)
}

/// The content that a first line announces; all of a file of the first format, which has none.
fn content(text: &[u8]) -> Result<&[u8], Damage> {
    let end = text.iter().position(|byte| *byte == b'\n').map_or(text.len(), |end| end + 1);
    let (line, content) = text.split_at(end);
    let Ok(Announced { umbmark_checkpoint, bytes, crc32 }) = serde_json::from_slice(line) else { return Ok(text) };
    if umbmark_checkpoint > FORMAT {
        return Err(Damage::Format(umbmark_checkpoint));
    }
    if bytes != content.len() as u64 {
        return Err(Damage::Length { there: content.len() as u64, announced: bytes });
    }
    match crc32fast::hash(content) {
        there if there == crc32 => Ok(content),
        there => Err(Damage::Checksum { there, announced: crc32 }),
    }
}

impl Written {
    /// Reads a checkpoint.
    pub fn load(file: &Path) -> Result<Written, CheckpointError> {
        read(file, "study")
    }

    /// Reads checkpoints of one study, shards for instance, and puts them together.
    pub fn merged(files: &[PathBuf]) -> Result<Written, CheckpointError> {
        let (first, rest) = files.split_first().ok_or(CheckpointError::Nothing)?;
        let mut merged = Written::load(first)?;
        for file in rest {
            let other = Written::load(file)?;
            let told = |error| CheckpointError::Merge { file: file.clone(), error };
            merged.ensemble.merge(&other.ensemble).map_err(told)?;
        }
        Ok(merged)
    }

    /// As the text of a file.
    pub fn text(&self) -> Result<String, serde_json::Error> {
        framed(self)
    }
}

impl Checkpoint {
    /// What is known of a shard of a study when it begins: nothing, or what the file has. `told` is what the study is.
    pub fn begin(&self, study: &Study, shard: Shard, told: &result::Study) -> Result<Written, CheckpointError> {
        let new = || Written { seed: study.seed, study: told.clone(), ensemble: Ensemble::new(study, shard) };
        let known: Option<Written> = self.read("study")?;
        match known {
            Some(known) if !known.ensemble.is_of(study, shard) => Err(self.foreign("study or shard")),
            known => Ok(known.unwrap_or_else(new)),
        }
    }

    /// The points of a sweep that are done when it begins.
    pub fn begin_sweep(&self, sweep: &Sweep) -> Result<Vec<SweepPoint>, CheckpointError> {
        let known: Option<WrittenSweep> = self.read("sweep")?;
        let same =
            |known: &WrittenSweep| known.sweep == sweep.identity() && known.points.len() as u64 <= sweep.points();
        match known {
            Some(known) if !same(&known) => Err(self.foreign("sweep")),
            known => Ok(known.map(|known| known.points).unwrap_or_default()),
        }
    }

    /// What the file has, where it is to be gone on with.
    fn read<T: DeserializeOwned>(&self, what: &'static str) -> Result<Option<T>, CheckpointError> {
        let there = std::fs::metadata(&self.file);
        match (there.is_ok(), self.found) {
            _ if there.is_ok_and(|there| !there.is_file()) => Err(CheckpointError::NotRegular(self.file.clone())),
            (true, Found::Refuse) => Err(CheckpointError::Exists(self.file.clone())),
            (true, Found::Resume) => read(&self.file, what).map(Some),
            _ => Ok(None),
        }
    }

    fn foreign(&self, what: &'static str) -> CheckpointError {
        CheckpointError::Foreign { file: self.file.clone(), what }
    }
}

/// Writes down what is done of a study while it runs; without a checkpoint, nothing. No other process writes the file as long as it lives.
#[derive(Debug)]
pub struct Keeper {
    checkpoint: Option<Checkpoint>,
    _lock: Option<Lock>,
    saved: Instant,
}

impl Keeper {
    /// Takes the file for this process, before anything of it is read, and begins to count the time.
    pub fn of(checkpoint: Option<&Checkpoint>) -> Result<Keeper, CheckpointError> {
        let lock = checkpoint.map(|checkpoint| locked(&checkpoint.file));
        Ok(Keeper { checkpoint: checkpoint.cloned(), _lock: lock.transpose()?.flatten(), saved: Instant::now() })
    }

    /// Writes a study down where it is time.
    pub fn look(&mut self, seed: u64, study: &result::Study, known: &Ensemble) -> Result<(), CheckpointError> {
        if self.is_due() { self.keep(seed, study, known) } else { Ok(()) }
    }

    /// Writes a study down.
    pub fn keep(&mut self, seed: u64, study: &result::Study, ensemble: &Ensemble) -> Result<(), CheckpointError> {
        #[derive(Serialize)]
        struct Borrowed<'a> {
            seed: u64,
            study: &'a result::Study,
            ensemble: &'a Ensemble,
        }
        self.write(&Borrowed { seed, study, ensemble })
    }

    /// Writes the points of a sweep down where it is time.
    pub fn look_at(&mut self, sweep: &Sweep, points: &[SweepPoint]) -> Result<(), CheckpointError> {
        if self.is_due() { self.keep_points(sweep, points) } else { Ok(()) }
    }

    /// Writes the points of a sweep down.
    pub fn keep_points(&mut self, sweep: &Sweep, points: &[SweepPoint]) -> Result<(), CheckpointError> {
        #[derive(Serialize)]
        struct Borrowed<'a> {
            sweep: String,
            points: &'a [SweepPoint],
        }
        self.write(&Borrowed { sweep: sweep.identity(), points })
    }

    fn is_due(&self) -> bool {
        self.checkpoint.as_ref().is_some_and(|checkpoint| self.saved.elapsed() >= checkpoint.every)
    }

    fn write(&mut self, content: &impl Serialize) -> Result<(), CheckpointError> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(()) };
        write(&checkpoint.file, content)?;
        self.saved = Instant::now();
        Ok(())
    }
}

fn read<T: DeserializeOwned>(file: &Path, what: &'static str) -> Result<T, CheckpointError> {
    read_from(file, what, false)
}

/// Reads what has a first line with its checksum, and refuses files of the first format, which have none.
pub(crate) fn read_framed<T: DeserializeOwned>(file: &Path, what: &'static str) -> Result<T, CheckpointError> {
    read_from(file, what, true)
}

fn read_from<T: DeserializeOwned>(file: &Path, what: &'static str, framed: bool) -> Result<T, CheckpointError> {
    let text = std::fs::read(file);
    let text = text.map_err(|error| CheckpointError::Read { file: file.to_owned(), error })?;
    let content = content(&text).map_err(|damage| CheckpointError::Damaged { file: file.to_owned(), damage })?;
    let read = match framed && content.len() == text.len() {
        true => Err(serde::de::Error::custom("its first line does not announce one")),
        false => serde_json::from_slice(content),
    };
    read.map_err(|error| CheckpointError::Other { file: file.to_owned(), what, error })
}

/// Takes a file for this process, until the lock is dropped.
pub(crate) fn locked(file: &Path) -> Result<Option<Lock>, CheckpointError> {
    Lock::of(file).map_err(|Held { process }| CheckpointError::InUse { file: file.to_owned(), process })
}

pub(crate) fn write(file: &Path, content: &impl Serialize) -> Result<(), CheckpointError> {
    let failed = |error: serde_json::Error| FileError::Write { file: file.to_owned(), error: error.into() };
    Ok(WholeFile::write(file, Existing::Replace, framed(content).map_err(failed)?.as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use std::sync::atomic::AtomicBool;
    use umbmark_core::drive::Robot;
    use umbmark_core::effect::Model;
    use umbmark_core::monte_carlo::{Axis, Quantity};
    use umbmark_core::result::{NoiseFree, Told};

    fn told(study: &Study) -> result::Study {
        result::Study::new(study, &NoiseFree::of(study).unwrap(), &Told::default())
    }

    fn study(seed: u64) -> Study {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        Study { runs: [1, 1], ..Study::new(model, 20_000, seed) }
    }

    fn checkpoint(folder: &tempfile::TempDir, found: Found) -> Checkpoint {
        Checkpoint { file: folder.path().join("study.json"), every: Duration::ZERO, found }
    }

    #[test]
    fn a_study_that_was_broken_off_goes_on_to_the_same_bits() {
        let folder = tempfile::tempdir().unwrap();
        let study = study(3);
        let told = told(&study);
        let (anew, resumed) = (checkpoint(&folder, Found::Refuse), checkpoint(&folder, Found::Resume));
        let mut keeper = Keeper::of(Some(&anew)).unwrap();
        assert!(matches!(Keeper::of(Some(&resumed)), Err(CheckpointError::InUse { process: Some(_), .. })));
        let mut known = anew.begin(&study, Shard::WHOLE, &told).unwrap();
        let stop = AtomicBool::new(false);
        let first = |batch: &umbmark_core::monte_carlo::Batch| {
            keeper.look(study.seed, &told, batch.ensemble).unwrap();
            ControlFlow::Break(())
        };
        study.resume(&mut known.ensemble, &stop, first).unwrap();
        let mut known = resumed.begin(&study, Shard::WHOLE, &told).unwrap();
        assert_eq!(known.ensemble.trials(), umbmark_core::monte_carlo::BATCH);
        study.resume(&mut known.ensemble, &stop, |_| ControlFlow::Continue(())).unwrap();
        let whole = study.run(|_| ControlFlow::Continue(())).unwrap();
        assert_eq!(serde_json::to_string(&known.ensemble).unwrap(), serde_json::to_string(&whole).unwrap());
    }

    #[test]
    fn what_is_there_is_neither_lost_nor_taken_for_another_study() {
        let folder = tempfile::tempdir().unwrap();
        let of = |found, seed| checkpoint(&folder, found).begin(&study(seed), Shard::WHOLE, &told(&study(seed)));
        let known = of(Found::Resume, 3).unwrap();
        std::fs::write(folder.path().join("study.json"), known.text().unwrap()).unwrap();
        assert!(matches!(of(Found::Refuse, 3), Err(CheckpointError::Exists(_))));
        assert!(matches!(of(Found::Resume, 4), Err(CheckpointError::Foreign { .. })));
        assert!(of(Found::Replace, 4).is_ok());
        std::fs::write(folder.path().join("study.json"), "{}").unwrap();
        assert!(matches!(of(Found::Resume, 3), Err(CheckpointError::Other { .. })));
        assert!(matches!(Written::merged(&[]), Err(CheckpointError::Nothing)));
    }

    #[test]
    fn the_points_of_a_sweep_that_are_done_are_known_again() {
        let folder = tempfile::tempdir().unwrap();
        let study = Study { trials: 2, ..study(3) };
        let axis = |count| {
            let quantity = Quantity::find("eb", &study).unwrap();
            Sweep::new(&study, &[Axis { quantity, first: 0.99, last: 1.01, count }]).unwrap()
        };
        let (sweep, at) = (axis(5), checkpoint(&folder, Found::Resume));
        let mut points = at.begin_sweep(&sweep).unwrap();
        assert!(points.is_empty());
        let stop = AtomicBool::new(false);
        let some = |more: Vec<SweepPoint>| {
            points.extend(more.into_iter().take(2));
            ControlFlow::Break(())
        };
        sweep.run(0, &stop, some).unwrap();
        Keeper::of(Some(&at)).unwrap().keep_points(&sweep, &points).unwrap();
        assert_eq!(at.begin_sweep(&sweep).unwrap(), points);
        assert!(matches!(at.begin_sweep(&axis(6)), Err(CheckpointError::Foreign { what: "sweep", .. })));
    }

    /// Every byte of the content changed by itself, the file cut at every place, a later format, and a file of the first format.
    #[test]
    fn a_checkpoint_that_was_changed_or_cut_off_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("study.json");
        let of = |text: &[u8]| {
            std::fs::write(&file, text).unwrap();
            Written::load(&file)
        };
        let written = Written { seed: 3, study: told(&study(3)), ensemble: Ensemble::new(&study(3), Shard::WHOLE) };
        let good = written.text().unwrap().into_bytes();
        let line = good.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        assert_eq!(of(&good).unwrap().text().unwrap().into_bytes(), good);
        assert!(of(&good[line..]).is_ok(), "the first format has no first line");
        for at in line..good.len() {
            let mut changed = good.clone();
            changed[at] ^= 1;
            let damage = of(&changed).map(|_| ()).unwrap_err();
            assert!(
                matches!(damage, CheckpointError::Damaged { damage: Damage::Checksum { .. }, .. }),
                "{at}: {damage}"
            );
        }
        for end in 0..good.len() {
            assert!(of(&good[..end]).is_err(), "{end}");
        }
        let later = String::from_utf8(good).unwrap().replacen("checkpoint\":2", "checkpoint\":3", 1);
        let error = of(later.as_bytes()).map(|_| ()).unwrap_err();
        assert!(matches!(error, CheckpointError::Damaged { damage: Damage::Format(3), .. }), "{error}");
    }
}
