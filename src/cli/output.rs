//! What goes to stdout: a table for people, or one JSON object.

use serde_json::Value;

/// Prints the object if `json`, otherwise the text. A closed pipe (`| head`) is no error.
pub(super) fn print(json: bool, object: &Value, text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = if json { writeln!(out, "{object}") } else { write!(out, "{text}") };
}

/// A figure in dB, or a dash where it wasn't measured.
pub(super) fn decibels(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{v:.2}"))
}
