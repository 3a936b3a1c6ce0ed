//! The flags of studies that are saved and continued.

use std::path::PathBuf;
use std::time::Duration;

use umbmark_io::checkpoint::{Checkpoint, CheckpointError, Found};

use crate::numbers::number;

/// Where a study is saved.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Long studies")]
pub struct CheckpointFlags {
    /// Regularly save the finished trials to this file, for --resume and `umbmark merge`
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,

    /// Time between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = number, requires = "checkpoint")]
    checkpoint_every: f64,

    /// Continue the study of the checkpoint file, if it exists
    #[arg(long, requires = "checkpoint", conflicts_with = "out")]
    resume: bool,
}

impl CheckpointFlags {
    /// The same for the core; with `force` a file that exists is replaced.
    pub fn checkpoint(&self, force: bool) -> anyhow::Result<Option<Checkpoint>> {
        let found = match (self.resume, force) {
            (true, _) => Found::Resume,
            (false, true) => Found::Replace,
            (false, false) => Found::Refuse,
        };
        let every = Duration::try_from_secs_f64(self.checkpoint_every)
            .map_err(|_| anyhow::anyhow!("--checkpoint-every must be 0 s or more, got {}", self.checkpoint_every))?;
        Ok(self.checkpoint.clone().map(|file| Checkpoint { file, every, found }))
    }
}

/// What to do about a checkpoint that exists.
pub fn with_remedy(error: CheckpointError) -> anyhow::Error {
    match error {
        CheckpointError::Exists(_) => anyhow::anyhow!("{error}; --resume continues it, --force begins anew"),
        error => error.into(),
    }
}
