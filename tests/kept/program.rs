//! Runs of the program, and what they leave.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The program with these arguments.
pub(crate) fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nerf-oracle"));
    command.args(args);
    command
}

/// Its standard error, where it ends with `code`.
pub(crate) fn ends(code: i32, args: &[&str]) -> String {
    told(code, &command(args).output().expect("the program starts"), &format!("{args:?}"))
}

/// The standard error of a program that ended with `code`.
pub(crate) fn told(code: i32, output: &Output, what: &str) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{what}: {said}");
    assert!(!said.contains("panicked"), "{what}: {said}");
    said
}

/// How often what is random is tried.
pub(crate) fn times() -> Option<u64> {
    std::env::var("NERF_ORACLE_KILLS").ok().map(|n| n.parse().expect("a number"))
}

/// All files below a folder, but for the lock.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if !path.ends_with(".lock") {
            found.insert(path.clone(), fs::read(&path).expect("a file"));
        }
    }
    found
}

/// What a run has come to: its files by name, without what depends on the clock.
#[derive(PartialEq)]
pub(crate) struct Kept(BTreeMap<String, Vec<u8>>);

impl Kept {
    /// Of a run's folder. Pictures and curve as they are; of the checkpoint, the log and the page's table everything but seconds.
    pub(crate) fn of(run: &Path) -> Kept {
        let mut kept = BTreeMap::new();
        for (path, bytes) in files(run) {
            let name = path.strip_prefix(run).expect("below the run").display().to_string();
            match name.as_str() {
                "checkpoint.npz" => {
                    let arrays = nerf_oracle::files::npz::read(&path).expect("a whole checkpoint");
                    let timeless = arrays.into_iter().filter(|(name, _)| name != "seconds");
                    kept.extend(timeless.map(|(array, values)| (format!("{name} {array}"), bits(&values))));
                }
                "log.jsonl" => {
                    kept.insert(
                        name,
                        String::from_utf8(bytes).expect("text").lines().flat_map(timeless).collect(),
                    );
                }
                "run.json" => {}
                "index.html" => {
                    let text = String::from_utf8(bytes).expect("text");
                    kept.insert(name, text.lines().flat_map(without_seconds).collect());
                }
                _ => drop(kept.insert(name, bytes)),
            }
        }
        Kept(kept)
    }

    /// Fails where the other has other bits.
    pub(crate) fn assert_same(&self, other: &Kept, what: &str) {
        for name in self.0.keys().chain(other.0.keys()) {
            assert!(self.0.get(name) == other.0.get(name), "{what}: {name} isn't what it would have been");
        }
    }
}

fn bits(array: &nerf_oracle::files::npz::Array) -> Vec<u8> {
    // f64 holds every value exactly; its bits tell -0 from 0 and one NaN from another.
    let shape = array.shape().iter().flat_map(|n| n.to_le_bytes());
    shape.chain(array.to_f64().iter().flat_map(|x| x.to_bits().to_le_bytes())).collect()
}

fn timeless(line: &str) -> Vec<u8> {
    let mut object: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
    object.as_object_mut().expect("an object").remove("seconds");
    format!("{object}\n").into_bytes()
}

/// A line of a page; of a row of the table of steps all but its second cell, which is seconds.
fn without_seconds(line: &str) -> Vec<u8> {
    let mut cells: Vec<&str> = line.split("</td>").collect();
    if line.starts_with("<tr><td>") && cells.len() == 5 {
        cells.remove(1);
    }
    format!("{}\n", cells.join("</td>")).into_bytes()
}
