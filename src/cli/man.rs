//! `man [COMMAND]`.

use std::process::ExitCode;

use clap::CommandFactory;
use serde_json::json;

use super::{Cli, output};
use crate::error::{Error, Result};

/// Print the manual page of this program, or of one of its commands, for `man -l -`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// A command; the whole program without one.
    pub command: Option<String>,
}

/// Runs `man`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let mut program = Cli::command();
    // Options that all commands have are added to each.
    program.build();
    let command = match &args.command {
        None => program,
        Some(name) => {
            let found = program.find_subcommand(name).cloned();
            let found =
                found.ok_or_else(|| Error::usage("COMMAND", name, "one that `nerf-oracle help` shows"))?;
            let full = format!("{}-{name}", env!("CARGO_PKG_NAME"));
            found.display_name(full)
        }
    };
    let mut page = vec![];
    clap_mangen::Man::new(command).render(&mut page).expect("memory takes what it is given");
    let page = String::from_utf8_lossy(&page);
    output::print(json, &json!({"command": args.command, "page": page}), &page)?;
    Ok(ExitCode::SUCCESS)
}
