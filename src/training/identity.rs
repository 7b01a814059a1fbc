//! Which run a file belongs to.
//!
//! A run is named by all that determines it: what is trained, with which settings and seed, on which pictures. As training is
//! deterministic, two runs of one name have the same bits at every step, and files of runs with different names are never mixed.

use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::error::{Error, Input, Result};
use crate::scene::digest::hex;

/// Names in `run.json` and in a checkpoint; a line of the log has the first.
pub(super) const RUN: &str = "run_id";
pub(super) const CONTENT: &str = "content_sha256";

/// A run's name, and that of what it learns from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// 16 hexadecimal digits.
    pub run: String,
    /// SHA-256 of the scene's or the picture's content, 64 hexadecimal digits.
    pub content: String,
}

impl Identity {
    /// Of a run with these settings, on this content.
    pub fn new(settings: &Map<String, Value>, content: String) -> Self {
        let settings = serde_json::to_string(settings).expect("plain data");
        let whole = Sha256::new().chain_update(settings).chain_update(&content).finalize();
        Identity { run: hex(&whole[..8]), content }
    }

    /// What `run.json` says, if it is of this version.
    pub fn of_settings(settings: &Map<String, Value>) -> Option<Self> {
        let text = |name: &str| settings.get(name).and_then(Value::as_str).map(String::from);
        Some(Identity { run: text(RUN)?, content: text(CONTENT)? })
    }

    /// Its fields of `run.json`.
    pub fn settings(&self) -> [(String, Value); 2] {
        [(RUN.into(), self.run.clone().into()), (CONTENT.into(), self.content.clone().into())]
    }

    /// Refuses content that isn't what the run has learned from.
    ///
    /// # Errors
    /// Where `content` is another.
    pub fn check_content(&self, content: &str, file: impl ToString) -> Result<()> {
        check(
            CONTENT,
            content,
            &self.content,
            file,
            "The scene has changed since: bring its pictures and cameras back, or train again.",
        )
    }

    /// Refuses a file of another run.
    pub(super) fn check_run(&self, found: &str, file: impl ToString) -> Result<()> {
        check(
            RUN,
            found,
            &self.run,
            file,
            "This file is another run's: bring this run's own back, or train it again.",
        )
    }
}

fn check(field: &str, found: &str, expected: &str, file: impl ToString, remedy: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Error::input(Input { file, field, found, expected, remedy }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_named_by_what_determines_it() {
        let settings = |seed: u64| serde_json::json!({"seed": seed, "lr": 0.1}).as_object().unwrap().clone();
        let [a, same, seed, content] = [(1, "x"), (1, "x"), (2, "x"), (1, "y")]
            .map(|(n, content)| Identity::new(&settings(n), content.into()));
        assert_eq!(a, same);
        assert!(a.run.len() == 16 && a.run != seed.run && a.run != content.run);
        assert_eq!(Identity::of_settings(&a.settings().into_iter().collect()), Some(a.clone()));
        assert!(a.check_run(&same.run, "f").is_ok() && a.check_content("x", "f").is_ok());
        let refused = a.check_run(&seed.run, "log.jsonl").unwrap_err().to_string();
        assert!(
            refused.contains("log.jsonl: run_id: found") && refused.contains("another run's"),
            "{refused}"
        );
        assert!(a.check_content("y", "f").is_err());
    }
}
