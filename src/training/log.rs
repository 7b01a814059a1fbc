//! `log.jsonl`: an object a line, one for each measurement, each with the run that it belongs to.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};

use super::checkpoint::{LOG, RunFolder};
use super::identity::RUN;
use crate::error::{Error, Input, Result};
use crate::files;

/// What every line has.
#[derive(Deserialize)]
struct Head {
    step: u64,
    /// Absent in lines of before this version.
    run_id: Option<String>,
}

/// Decibels as JSON has them, which has no word for infinite ones: null is a perfect picture.
pub(super) fn decibels<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
}

impl RunFolder {
    /// Begins an empty log.
    pub(super) fn begin_log(&self) -> Result<()> {
        files::write(&self.file(LOG), "")
    }

    /// Adds a line.
    pub(super) fn log(&self, point: &impl Serialize) -> Result<()> {
        let mut line = serde_json::to_value(point).expect("plain data");
        line[RUN] = self.identity().run.as_str().into();
        files::append(&self.file(LOG), format!("{line}\n"))
    }

    /// The measurements so far, of a run that another process may be writing: a line that isn't whole yet counts as not written.
    ///
    /// # Errors
    /// Where the log can't be read.
    pub(crate) fn read_log<Point: DeserializeOwned>(&self) -> Result<Vec<Point>> {
        let path = self.file(LOG);
        if !path.exists() {
            return Ok(vec![]);
        }
        let text = files::read_text(&path)?;
        Ok(text.lines().map_while(|line| serde_json::from_str(line).ok()).collect())
    }

    /// The measurements up to `step`. Later lines belong to steps that will be done again: they are taken off the file.
    ///
    /// # Errors
    /// Where a line isn't one of this run's log.
    pub(super) fn log_until<Point: DeserializeOwned>(&self, step: u64) -> Result<Vec<Point>> {
        let path = self.file(LOG);
        let text = files::read_text(&path)?;
        // A last line without its end was being written when the run was stopped: its step will be done again.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let (mut points, mut kept) = (vec![], String::new());
        for (n, line) in whole.lines().enumerate() {
            let wrong = |error: serde_json::Error| {
                Error::input(Input {
                    file: path.display(),
                    field: format!("line {}", n + 1),
                    found: error,
                    expected: "an object as train writes it",
                    remedy: "Delete the line, or train from the start without `resume`.",
                })
            };
            let head: Head = serde_json::from_str(line).map_err(wrong)?;
            if let Some(run) = &head.run_id {
                self.identity().check_run(run, format!("{}, line {}", path.display(), n + 1))?;
            }
            if head.step <= step {
                points.push(serde_json::from_str(line).map_err(wrong)?);
                kept += line;
                kept.push('\n');
            }
        }
        if kept != text {
            files::write(&path, kept)?;
        }
        Ok(points)
    }
}
