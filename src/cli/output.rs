//! What goes to stdout, a table for people or one JSON object, and to stderr. The program's only writer to either: output that gets lost
//! is exit code 2, never a panic, and never 0.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::{AutoStream, ColorChoice};
use serde_json::Value;

use super::paint;
use crate::error::{Error, Result};
use crate::shown::{json_escaped, lines, shown};

/// Exit code of a program whose reader has closed the pipe (`| head`): what a shell says of one that SIGPIPE ended.
pub(super) const CLOSED: u8 = 141;

/// Whether anything that was to go to stderr didn't arrive.
static LOST: AtomicBool = AtomicBool::new(false);

/// Whether only what was asked for, errors and warnings are written.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Progress and notes are left out from now on.
pub(super) fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether they are.
pub(super) fn quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints the object if `json`, otherwise the text.
///
/// # Errors
/// Where stdout doesn't take it: a full disk, a closed pipe.
pub(super) fn print(json: bool, object: &Value, text: &str) -> Result<()> {
    let text = if json { json_line(object) } else { lines(text).into_owned() };
    let plain = json || AutoStream::choice(&io::stdout()) == ColorChoice::Never;
    let mut out = io::stdout().lock();
    let written = if plain {
        out.write_all(text.as_bytes())
    } else {
        AutoStream::auto(&mut out).write_all(paint::verdicts(&text).as_bytes())
    };
    written.and_then(|()| out.flush()).map_err(|source| Error::Io {
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
    let plain = AutoStream::choice(&io::stderr()) == ColorChoice::Never;
    let mut out = io::stderr().lock();
    let line = shown(line);
    let written = if plain {
        writeln!(out, "{line}")
    } else {
        writeln!(AutoStream::auto(&mut out), "{}", paint::kind(&line))
    };
    if written.is_err() {
        LOST.store(true, Ordering::Relaxed);
    }
}

/// A line on stderr that nobody misses: what is being done. With `--quiet` there is none.
pub(super) fn note(line: &str) {
    if !quiet() {
        say(line);
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
