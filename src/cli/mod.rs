//! The command line: one file a subcommand.

use std::ffi::OsString;
use std::process::ExitCode;

/// Parses `args`, runs the subcommand, prints an error if there is one. 0: all good; 1: a check failed; 2: usage, input or I/O.
pub fn main(_args: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(2)
}
