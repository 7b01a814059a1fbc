//! `check`: the harness's check of itself.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use super::output;
use crate::error::{Error, Result};
use crate::files;
use crate::proof::selfcheck::{self, Row};
use crate::proof::{catalogue, tables};

/// Check the reference's bounds against honest machines and the catalogue of mistakes.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Components whose name or folder contains this (all where absent).
    #[arg(default_value = "")]
    filter: String,
    /// Write the catalogue of conventions and mistakes to this file instead.
    #[arg(long, value_name = "FILE")]
    catalogue: Option<PathBuf>,
    /// Write the tables of the bounds (their sharpness, and the mistakes below them) to this file instead.
    #[arg(long, value_name = "FILE")]
    tables: Option<PathBuf>,
}

/// Runs it. 1 where something fails.
///
/// # Errors
/// A filter that no component matches.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    // Before anything is computed.
    for path in [&args.catalogue, &args.tables].into_iter().flatten() {
        files::check_replaceable(path)?;
    }
    if let Some(path) = &args.catalogue {
        files::write(path, catalogue::page())?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(path) = &args.tables {
        files::write(path, tables::page())?;
        return Ok(ExitCode::SUCCESS);
    }
    let rows = selfcheck::run(&args.filter);
    if rows.is_empty() {
        return Err(Error::usage("FILTER", &args.filter, "a part of a name that `nerf-oracle list` shows"));
    }
    let mut text = format!(
        "{:<24}{:<9}{:<6}{:>7}{:>10}{:>10}{:>8}{:>8}  verdict\n",
        "component", "kind", "dtype", "cases", "machines", "rejected", "zero", "caught"
    );
    for row in &rows {
        let verdict = if row.pass() { "pass" } else { "FAIL" };
        let zero = if row.zero_fails { "fails" } else { "PASSES" };
        text += &format!(
            "{:<24}{:<9}{:<6}{:>7}{:>10}{:>10}{:>8}{:>8}  {verdict}\n",
            row.name,
            row.kind,
            row.dtype,
            row.cases,
            row.evaluations,
            row.rejected,
            zero,
            format!("{}/{}", row.caught, row.mistakes)
        );
        if !row.missed.is_empty() {
            text += &format!("    below the bound: {}\n", row.missed_names().join(", "));
        }
    }
    let failed = rows.iter().filter(|row| !row.pass()).count();
    text += &format!("{} rows, {failed} failed\n", rows.len());
    let object = json!({ "rows": rows.iter().map(Row::json).collect::<Vec<_>>(), "failed": failed });
    output::print(json, &object, &text)?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
