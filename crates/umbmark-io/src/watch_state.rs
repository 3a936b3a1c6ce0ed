//! What is known of a robot that is watched, in a file between two looks.

use std::path::{Path, PathBuf};

use crate::checkpoint::{self, CheckpointError};
use crate::lock::Lock;
use umbmark_core::drift::{DriftError, Record};

/// Why the state of a watch is not read, or not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// It is not read or written, as any checkpoint is not.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// It says what no state says.
    #[error("{} is no state of a watch: {error}; give another copy of it, or move it away and begin anew", file.display())]
    Impossible {
        /// The file.
        file: PathBuf,
        /// What.
        error: DriftError,
    },
}

/// The file in which a watch is kept. No other process writes it as long as this lives; who is killed leaves the old or the new state.
#[derive(Debug)]
pub struct WatchState {
    file: PathBuf,
    /// What stands in it.
    there: Option<Record>,
    _lock: Option<Lock>,
}

impl WatchState {
    /// Takes a file for this process, and reads what stands in it, if it exists.
    ///
    /// # Errors
    /// [`StateError`] if another process has it, and for anything in it but a state that was written by [`WatchState::keep`].
    pub fn open(file: &Path) -> Result<WatchState, StateError> {
        let there = std::fs::metadata(file);
        if there.is_ok_and(|there| !there.is_file()) {
            return Err(CheckpointError::NotRegular(file.to_owned()).into());
        }
        let lock = checkpoint::locked(file)?;
        let there = match checkpoint::read_framed(file, "watch") {
            Ok(Written { watch }) => {
                Some(Record::checked(watch).map_err(|error| StateError::Impossible { file: file.to_owned(), error })?)
            }
            Err(CheckpointError::Read { error, .. }) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => return Err(error.into()),
        };
        Ok(WatchState { file: file.to_owned(), there, _lock: lock })
    }

    /// What stands in the file; `None` where there is none yet.
    pub fn record(&self) -> Option<&Record> {
        self.there.as_ref()
    }

    /// Writes a record down, beside the file and renamed; where it stands there already, nothing.
    ///
    /// # Errors
    /// [`StateError::Checkpoint`].
    pub fn keep(&mut self, record: &Record) -> Result<(), StateError> {
        if self.there.as_ref() == Some(record) {
            return Ok(());
        }
        checkpoint::write(&self.file, &Written { watch: record })?;
        self.there = Some(record.clone());
        Ok(())
    }
}

/// The content of the file: the key tells it from other checkpoints.
#[derive(serde::Serialize, serde::Deserialize)]
struct Written<R> {
    watch: R,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::framed;
    use umbmark_core::dataset::{Dataset, ReturnError, Run};
    use umbmark_core::drift::Rate;
    use umbmark_core::path::{Direction, Path as Course};
    use umbmark_core::{drive::Robot, effect::TestKind};

    fn record(runs: u32) -> Record {
        let run = |number: u32| Run {
            name: format!("run {number}"),
            number,
            direction: Some(Direction::BOTH[number as usize % 2]),
            test: TestKind::Systematic,
            log: None,
            returned: Some(ReturnError { x: 0.1 / f64::from(number + 3), y: 0.02, heading: None }),
        };
        let (robot, path) = (Some(Robot::labmate()), Some(Course::umbmark()));
        let data = Dataset { robot, path, runs: (0..runs).map(run).collect(), ..Dataset::default() };
        let mut record = Record::new(&data, Rate::default()).unwrap();
        record.add(&data).unwrap();
        record
    }

    #[test]
    fn a_state_is_read_as_it_was_written_and_has_one_writer() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("robot.watch.json");
        let mut state = WatchState::open(&file).unwrap();
        assert!(state.record().is_none() && !file.exists());
        assert!(matches!(WatchState::open(&file), Err(StateError::Checkpoint(CheckpointError::InUse { .. }))));
        state.keep(&record(7)).unwrap();
        drop(state);
        let mut state = WatchState::open(&file).unwrap();
        assert_eq!(state.record(), Some(&record(7)));
        let written = || std::fs::metadata(&file).unwrap().modified().unwrap();
        let before = written();
        state.keep(&record(7)).unwrap();
        assert_eq!(written(), before, "what stands there already is not written again");
        state.keep(&record(8)).unwrap();
        drop(state);
        assert_eq!(WatchState::open(&file).unwrap().record().unwrap().runs.len(), 8);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(matches!(WatchState::open(folder.path()), Err(StateError::Checkpoint(CheckpointError::NotRegular(_)))));
    }

    /// Every byte of the content changed by itself, the file cut at every place, no first line, another document, and numbers that no state has.
    #[test]
    fn a_state_that_was_changed_cut_off_or_forged_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("robot.watch.json");
        WatchState::open(&file).unwrap().keep(&record(3)).unwrap();
        let good = std::fs::read(&file).unwrap();
        let line = good.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        let of = |text: &[u8]| {
            std::fs::write(&file, text).unwrap();
            WatchState::open(&file).map(drop)
        };
        for at in line..good.len() {
            let mut changed = good.clone();
            changed[at] ^= 1;
            let refused = of(&changed);
            assert!(
                matches!(refused, Err(StateError::Checkpoint(CheckpointError::Damaged { .. }))),
                "{at}: {refused:?}"
            );
        }
        for end in 0..good.len() {
            assert!(of(&good[..end]).is_err(), "{end}");
        }
        assert!(matches!(of(&good[line..]), Err(StateError::Checkpoint(CheckpointError::Other { .. }))));
        assert!(matches!(
            of(framed(&7).unwrap().as_bytes()),
            Err(StateError::Checkpoint(CheckpointError::Other { .. }))
        ));
        let forged = |forge: &dyn Fn(&mut Record)| {
            let mut record = record(3);
            forge(&mut record);
            of(framed(&Written { watch: record }).unwrap().as_bytes())
        };
        assert!(forged(&|_| {}).is_ok());
        assert!(matches!(forged(&|record| record.begins = 4), Err(StateError::Impossible { .. })));
        assert!(matches!(forged(&|record| record.runs[1].x_m = 1e300), Err(StateError::Impossible { .. })));
        assert!(matches!(forged(&|record| record.rate.runs_per_month = 0), Err(StateError::Impossible { .. })));
        assert!(matches!(
            forged(&|record| record.runs[1].y_m = f64::NAN),
            Err(StateError::Checkpoint(CheckpointError::Other { .. }))
        ));
        assert!(of(&good).is_ok());
    }
}
