//! `completions SHELL`.

use std::process::ExitCode;

use clap::CommandFactory;
use clap_complete::Shell;
use serde_json::json;

use super::{Cli, output};
use crate::error::Result;

/// Print a shell's completions of this program: `source <(nerf-oracle completions bash)`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// Which shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Runs `completions`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let mut script = vec![];
    clap_complete::generate(args.shell, &mut Cli::command(), env!("CARGO_PKG_NAME"), &mut script);
    let script = String::from_utf8_lossy(&script);
    output::print(json, &json!({"shell": args.shell.to_string(), "script": script}), &script)?;
    Ok(ExitCode::SUCCESS)
}
