//! What goes to stdout, a table for people or one JSON object, and to stderr. The program's only writer to either: output that gets lost
//! is exit code 2, never a panic, and never 0.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::shown::{json_escaped, lines, shown};

/// Exit code of a program whose reader has closed the pipe (`| head`): what a shell says of one that SIGPIPE ended.
pub(super) const CLOSED: u8 = 141;

/// Whether anything that was to go to stderr didn't arrive.
static LOST: AtomicBool = AtomicBool::new(false);

/// Prints the object if `json`, otherwise the text.
///
/// # Errors
/// Where stdout doesn't take it: a full disk, a closed pipe.
pub(super) fn print(json: bool, object: &Value, text: &str) -> Result<()> {
    let text = if json { json_line(object) } else { lines(text).into_owned() };
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|source| Error::Io {
        path: "stdout".into(),
        action: "can't be written",
        source,
        remedy: "Send it where there is space left.".into(),
    })
}

/// An object as `--json` prints it.
pub(super) fn json_line(object: &Value) -> String {
    json_escaped(&object.to_string()).into_owned() + "\n"
}

/// A line on stderr. A run goes on where nobody can read it any more, but doesn't end with exit code 0: [`lost`].
pub(super) fn say(line: &str) {
    let mut out = io::stderr().lock();
    if writeln!(out, "{}", shown(line)).is_err() {
        LOST.store(true, Ordering::Relaxed);
    }
}

/// Whether a line of [`say`] was lost.
pub(super) fn lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

/// Whether an error is a reader of stdout that wants no more: other tools end silently then.
pub(super) fn closed(error: &Error) -> bool {
    matches!(error, Error::Io { path, source, .. }
        if path == Path::new("stdout") && source.kind() == io::ErrorKind::BrokenPipe)
}

/// A figure in dB, or a dash where it wasn't measured.
pub(super) fn decibels(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{v:.2}"))
}
