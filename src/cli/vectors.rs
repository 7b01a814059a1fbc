//! `vectors`: writes the cases with what should come out, or checks some that were kept.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use super::output;
use crate::convention::profiles;
use crate::error::Result;
use crate::files::layout::Layout;
use crate::vectors::{Outcome, Release, verify};

/// Write frozen vectors: cases with the expected outputs and how far off they may be, to check against without this program. Or check some
/// that were written.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Components whose name or folder contains this (all where absent).
    #[arg(default_value = "", conflicts_with = "verify")]
    filter: String,
    /// The folder to write, which must be empty or new.
    #[arg(long, value_name = "DIR", required_unless_present = "verify", conflicts_with = "verify")]
    out: Option<PathBuf>,
    /// The conventions (cs180, nerf2020, ...).
    #[arg(long, default_value = "cs180", conflicts_with = "verify")]
    profile: String,
    /// How the arrays lie in files: npz; or raw, which needs no zip: a folder a case, with little-endian numbers and an index as text.
    #[arg(long, default_value_t, conflicts_with = "verify")]
    layout: Layout,
    /// Check a folder of vectors instead: that its files are those whose sums it has, and that they are what would be written today.
    #[arg(long, value_name = "DIR")]
    verify: Option<PathBuf>,
}

/// Runs it. 1 where kept vectors differ.
///
/// # Errors
/// An unknown filter or profile, a folder that can't be written, or that holds no vectors.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    match (&args.verify, &args.out) {
        (Some(kept), _) => check(kept, json),
        (None, Some(out)) => write(args, out, json),
        (None, None) => unreachable!("one of them is required"),
    }
}

fn write(args: &Args, out: &Path, json: bool) -> Result<ExitCode> {
    let release = Release::new(&args.filter, profiles::find(&args.profile)?, args.layout)?;
    let bytes = release.write(out)?;
    let cases = &release.index.cases;
    let valid = cases.iter().filter(|case| case.result == Outcome::Valid).count();
    let (rows, left_out) = (release.index.rows.len(), &release.index.left_out);
    let object = json!({
        "out": out, "rows": rows, "cases": cases.len(), "valid": valid, "bytes": bytes, "left_out": left_out,
    });
    let (invalid, megabytes) = (cases.len() - valid, bytes as f64 / 1e6);
    let mut text = format!(
        "{valid} cases and {invalid} wrong answers of {rows} rows in {} ({megabytes:.1} MB)\n",
        out.display()
    );
    text.extend(left_out.iter().map(|(name, why)| format!("left out: {name}: {why}\n")));
    output::print(json, &object, &text)?;
    Ok(ExitCode::SUCCESS)
}

fn check(kept: &Path, json: bool) -> Result<ExitCode> {
    let found = verify(kept)?;
    let differences = &found.differences;
    let object = json!({
        "files": found.files, "cases": found.cases, "version": found.version, "differences": differences,
    });
    let mut text: String = differences.iter().map(|line| format!("{line}\n")).collect();
    text += &match differences.len() {
        0 => format!(
            "{} cases in {} files: whole, and what would be written today\n",
            found.cases, found.files
        ),
        n => format!("{n} differences\n"),
    };
    output::print(json, &object, &text)?;
    Ok(if differences.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
