//! A run's folder: `run.json`, `checkpoint.npz`, `log.jsonl`, pictures and a curve. One process at a time writes to it.

use std::fs;
use std::path::{Path, PathBuf};

use ndarray::{ArrayD, IxDyn};
use serde_json::{Map, Value};

use super::identity::{CONTENT, Identity, RUN};
use super::sound;
use crate::error::{Error, Input, Result};
use crate::files::lock::{self, Lock};
use crate::files::{self, json, npz};

const SETTINGS: &str = "run.json";
const CHECKPOINT: &str = "checkpoint.npz";
pub(super) const LOG: &str = "log.jsonl";
const VIEWS: &str = "views";

/// The version of run folders: readers refuse other versions.
pub const VERSION: i64 = 1;

/// What a folder has that holds a run.
const SIGNS: [&str; 3] = [SETTINGS, CHECKPOINT, LOG];

/// A run after a step.
#[derive(Debug)]
pub struct Checkpoint<State = npz::Arrays> {
    /// The model's arrays by name, and the loop's; as they come where they are written.
    pub state: State,
    /// The step.
    pub step: u64,
    /// Of wall clock so far.
    pub seconds: f64,
    /// Points with forward and backward so far.
    pub samples: u64,
}

/// The folder of a run.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Absent in runs of before this version, which can be read.
    identity: Option<Identity>,
    /// Held while this process writes here; also of a folder that it has moved aside, so that nobody who waited for that one takes
    /// it for this one.
    locks: Vec<Lock>,
}

impl RunFolder {
    /// Makes the folder for a new run, and locks it. One that holds a run is moved aside whole where `overwrite` says so.
    ///
    /// # Errors
    /// Where it holds a run otherwise, another process is at work in it, or it can't be written.
    pub fn begin(path: &Path, identity: Identity, overwrite: bool) -> Result<Self> {
        let mut locks = vec![];
        loop {
            files::make_folder(path)?;
            locks.push(Lock::new(path)?);
            let Some(sign) = SIGNS.iter().find(|sign| path.join(sign).exists()) else { break };
            if !overwrite {
                return Err(Error::input(Input {
                    file: path.display(),
                    field: "folder",
                    found: format!("a run's {sign}"),
                    expected: "a folder without a run",
                    remedy: "Go on with that run by `resume`, move it aside by `overwrite`, or choose another folder.",
                }));
            }
            if cfg!(windows) {
                // A folder with an open file in it isn't renamed there.
                locks.clear();
            }
            files::move_aside(path)?;
        }
        remove_partial(path);
        Ok(RunFolder { path: path.to_path_buf(), identity: Some(identity), locks })
    }

    /// Opens and locks the folder of a run that is to go on.
    ///
    /// # Errors
    /// As [`Self::open`], and where another process is at work in it or it can't be written.
    pub fn resume(path: &Path, identity: Identity) -> Result<Self> {
        check_there(path)?;
        let locks = vec![Lock::new(path)?];
        remove_partial(path);
        Ok(RunFolder { path: path.to_path_buf(), identity: Some(identity), locks })
    }

    /// Whether a run was begun here and stopped before it had written anything.
    pub fn is_untouched(path: &Path) -> bool {
        path.join(lock::NAME).exists() && !SIGNS.iter().any(|sign| path.join(sign).exists())
    }

    /// Opens the folder of a run for reading.
    ///
    /// # Errors
    /// Where there is no `run.json` in it.
    pub fn open(path: &Path) -> Result<Self> {
        check_there(path)?;
        let mut folder = RunFolder { path: path.to_path_buf(), identity: None, locks: vec![] };
        folder.identity = Identity::of_settings(&folder.settings()?);
        Ok(folder)
    }

    /// The run's name, and its content's, where it is of this version.
    pub fn known_identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Those of a run that is written to.
    pub(super) fn identity(&self) -> &Identity {
        debug_assert!(!self.locks.is_empty(), "a run that is read alone isn't written to");
        self.identity.as_ref().expect("every run that is begun or resumed has a name")
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes `run.json`.
    pub fn write_settings(&self, settings: &Map<String, Value>) -> Result<()> {
        let text = serde_json::to_string_pretty(settings).expect("plain data");
        files::write(&self.file(SETTINGS), text + "\n")
    }

    /// Reads `run.json`.
    ///
    /// # Errors
    /// Where it isn't a JSON object.
    pub fn settings(&self) -> Result<Map<String, Value>> {
        let path = self.file(SETTINGS);
        json::parse_object(&files::read_text(&path)?).map_err(|e| {
            Error::input(Input {
                file: path.display(),
                field: "JSON",
                found: e,
                expected: "an object as train writes it",
                remedy: "Train the run again.",
            })
        })
    }

    /// Writes a checkpoint, by way of another file, so that a stop in the middle leaves the previous one. The log is on the disk before
    /// it.
    pub(super) fn save(
        &self,
        checkpoint: Checkpoint<impl Iterator<Item = (String, npz::Array)>>,
    ) -> Result<()> {
        let Checkpoint { state, step, seconds, samples } = checkpoint;
        let number = |x| npz::Array::F64(ArrayD::from_elem(IxDyn(&[]), x));
        let whole = |x| npz::Array::I64(ArrayD::from_elem(IxDyn(&[]), x));
        let text = |text: &str| ndarray::Array1::from(text.as_bytes().to_vec()).into();
        let Identity { run, content } = self.identity();
        let own = [
            ("version", whole(VERSION)),
            ("step", whole(step as i64)),
            ("samples", whole(samples as i64)),
            ("seconds", number(seconds)),
            (RUN, text(run)),
            (CONTENT, text(content)),
        ];
        files::sync(&self.file(LOG))?;
        let own = own.into_iter().map(|(name, array)| (name.to_string(), array));
        npz::write_each(&self.file(CHECKPOINT), own.chain(state))
    }

    /// Reads the checkpoint.
    ///
    /// # Errors
    /// Where it is unreadable, of another version or another run's.
    pub fn load(&self) -> Result<Checkpoint> {
        let path = self.file(CHECKPOINT);
        let mut state = npz::read(&path)?;
        let mut number = |name: &str| {
            state.remove(name).and_then(|a| a.to_f64().iter().copied().next()).ok_or_else(|| {
                let remedy = "Train the run again.";
                Error::input(Input {
                    file: path.display(),
                    field: name,
                    found: "no such number",
                    expected: "a checkpoint as train writes it",
                    remedy,
                })
            })
        };
        let (version, step) = (number("version")?, number("step")?);
        if version != VERSION as f64 {
            let remedy = "Train the run again, or use the program that wrote it.";
            return Err(Error::input(Input {
                file: path.display(),
                field: "version",
                found: version,
                expected: VERSION,
                remedy,
            }));
        }
        let (seconds, samples) = (number("seconds")?, number("samples")?);
        sound::counts(step, seconds, samples, &path.display().to_string())?;
        if let Some(identity) = &self.identity {
            // A checkpoint of before this version has neither.
            let mut text = |name: &str| match state.remove(name) {
                Some(npz::Array::U8(text)) => Some(text.iter().copied().map(char::from).collect::<String>()),
                _ => None,
            };
            let (content, run) = (text(CONTENT), text(RUN));
            content.map_or(Ok(()), |content| identity.check_content(&content, path.display()))?;
            run.map_or(Ok(()), |run| identity.check_run(&run, path.display()))?;
        }
        Ok(Checkpoint { state, step: step as u64, seconds, samples: samples as u64 })
    }

    /// Whether the run was stopped before its first checkpoint, and therefore before its first step.
    pub(super) fn is_before_first_checkpoint(&self) -> bool {
        let logged = fs::metadata(self.file(LOG)).is_ok_and(|log| log.len() > 0);
        !self.file(CHECKPOINT).exists() && !logged
    }
}

fn check_there(path: &Path) -> Result<()> {
    if path.join(SETTINGS).is_file() {
        return Ok(());
    }
    Err(Error::input(Input {
        file: path.display(),
        field: SETTINGS,
        found: "no such file",
        expected: "the folder of a run",
        remedy: "Train first, into this folder.",
    }))
}

/// Removes what a killed process left unfinished; the folder is locked.
fn remove_partial(path: &Path) {
    files::remove_partial(path);
    files::remove_partial(&path.join(VIEWS));
}
