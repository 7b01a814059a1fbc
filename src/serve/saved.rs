//! A run in its folder: the newest checkpoint, and the log as far as it goes. Another program may be writing both.

use std::fs;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use super::{Progress, Source};
use crate::error::Result;
use crate::training::checkpoint::{Checkpoint, RunFolder};
use crate::training::model::Model;
use crate::training::run::LogPoint;
use crate::training::sound;

/// A run's folder, read when somebody asks.
pub(crate) struct Saved {
    folder: RunFolder,
    /// The checkpoint that the model has: when it was written, and its step.
    has: Mutex<(Option<SystemTime>, u64)>,
}

impl Saved {
    /// A folder whose checkpoint of this step has been loaded.
    pub(crate) fn new(folder: RunFolder, step: u64) -> Self {
        let written = written(&folder);
        Saved { folder, has: Mutex::new((written, step)) }
    }
}

/// When the checkpoint was written.
fn written(folder: &RunFolder) -> Option<SystemTime> {
    fs::metadata(folder.file("checkpoint.npz")).and_then(|about| about.modified()).ok()
}

impl Source for Saved {
    fn progress(&self) -> Result<Progress> {
        let log: Vec<LogPoint> = self.folder.read_log()?;
        let (_, loaded) = *self.has.lock().unwrap_or_else(PoisonError::into_inner);
        let step = log.last().map_or(loaded, |point| point.step.max(loaded));
        Ok(Progress { step, live: false, left: None, log })
    }

    fn newest(&self, model: &mut dyn Model) -> Result<u64> {
        let mut has = self.has.lock().unwrap_or_else(PoisonError::into_inner);
        let written = written(&self.folder);
        if written != has.0 {
            let Checkpoint { state, step, .. } = self.folder.load()?;
            let file = self.folder.file("checkpoint.npz").display().to_string();
            sound::restore(model, &state, step, &file)?;
            *has = (written, step);
        }
        Ok(has.1)
    }
}
