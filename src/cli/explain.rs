//! `explain`: everything about a name.

use std::process::ExitCode;

use super::output;
use crate::error::{Error, Result};
use crate::judge::explain::explain;

/// Explain a component, a mistake, a convention, a profile or a hazard (VR9).
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Its name, as `list` prints it, or a hazard's id, as hard cases begin with.
    name: String,
}

/// Runs it.
///
/// # Errors
/// A name that nothing has.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let (object, text) = explain(&args.name).map_err(where_to_look)?;
    output::print(json, &object, &text)?;
    Ok(ExitCode::SUCCESS)
}

/// A name that nothing has: a command shows those that there are.
fn where_to_look(error: Error) -> Error {
    match error {
        Error::Usage { argument, found, expected } => {
            Error::usage(argument, found, format!("{expected}; `nerf-oracle list` shows them all"))
        }
        other => other,
    }
}
