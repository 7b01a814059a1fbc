//! `merge PARTS --out`: the results of `--shard`ed work as one process would have written them.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use super::parts::{REMEDY, whole};
use super::shard::FILE;
use super::{evaluate, output, render, sweep_image};
use crate::error::{Error, Input, Result};
use crate::files;

/// Options of `merge`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The parts' folders, in any order. One that is there twice must be the same; one that was cut off counts as missing.
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,
    /// What the work is for: render's film or folder, sweep-image's folder, or a file for what evaluate --json prints.
    #[arg(long)]
    pub out: PathBuf,
}

/// Runs `merge`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let whole = whole(&args.parts)?;
    let out = args.out.display().to_string();
    match whole.work["command"].as_str() {
        Some("render") => {
            let count = render::merge(&whole, &args.out)?;
            output::print(json, &json!({"out": out, "frames": count}), &format!("{out}: {count} frames\n"))?;
        }
        Some("evaluate") => {
            let (object, text) = evaluate::merge(&whole)?;
            files::write(&args.out, output::json_line(&object))?;
            output::print(json, &object, &text)?;
        }
        Some("sweep-image") => {
            let (object, text) = sweep_image::merge(&whole, &args.out)?;
            output::print(json, &object, &text)?;
        }
        other => {
            let found = other.unwrap_or("no command").to_string();
            let expected = "render, evaluate or sweep-image";
            let (file, remedy) = (args.parts[0].join(FILE).display().to_string(), REMEDY);
            return Err(Error::input(Input { file, field: "work.command", found, expected, remedy }));
        }
    }
    Ok(ExitCode::SUCCESS)
}
