//! A run's folder: `run.json`, `checkpoint.npz`, `log.jsonl`, `psnr.svg`, `views/`.

use std::path::{Path, PathBuf};

use ndarray::{ArrayD, IxDyn};
use serde_json::{Map, Value};

use super::sound;
use crate::error::{Error, Input, Result};
use crate::files::{self, json, npz};

/// The version of run folders: readers refuse other versions.
pub const VERSION: i64 = 1;

/// The folder of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFolder(PathBuf);

impl RunFolder {
    /// Makes the folder for a new run.
    pub fn create(path: &Path) -> Result<Self> {
        files::make_folder(&path.join("views"))?;
        Ok(RunFolder(path.to_path_buf()))
    }

    /// The folder of a run that exists.
    ///
    /// # Errors
    /// Where there is no `run.json` in it.
    pub fn open(path: &Path) -> Result<Self> {
        let run = path.join("run.json");
        if !run.is_file() {
            return Err(Error::input(Input {
                file: path.display(),
                field: "run.json",
                found: "no such file",
                expected: "the folder of a run",
                remedy: "Train first, into this folder.",
            }));
        }
        Ok(RunFolder(path.to_path_buf()))
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes `run.json`.
    pub fn write_settings(&self, settings: &Map<String, Value>) -> Result<()> {
        let text = serde_json::to_string_pretty(settings).expect("plain data");
        files::write(&self.file("run.json"), text + "\n")
    }

    /// Reads `run.json`.
    ///
    /// # Errors
    /// Where it isn't a JSON object.
    pub fn settings(&self) -> Result<Map<String, Value>> {
        let path = self.file("run.json");
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

    /// Writes the model's state after `step`, to a temporary file first, so that a stop in the middle leaves the previous checkpoint
    /// intact.
    pub fn save(&self, mut state: npz::Arrays, step: u64, seconds: f64, samples: u64) -> Result<()> {
        let number = |x| npz::Array::F64(ArrayD::from_elem(IxDyn(&[]), x));
        let whole = |x| npz::Array::I64(ArrayD::from_elem(IxDyn(&[]), x));
        state.insert("version".into(), whole(VERSION));
        state.insert("step".into(), whole(step as i64));
        state.insert("samples".into(), whole(samples as i64));
        state.insert("seconds".into(), number(seconds));
        npz::write(&self.file("checkpoint.npz"), &state, false)
    }

    /// Reads the checkpoint: the model's state, the step after which it was written, seconds and samples so far.
    ///
    /// # Errors
    /// Where it is unreadable or of another version.
    pub fn load(&self) -> Result<(npz::Arrays, u64, f64, u64)> {
        let path = self.file("checkpoint.npz");
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
        Ok((state, step as u64, seconds, samples as u64))
    }
}
