//! `cases`: writes the questions as files.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use super::output;
use crate::contract::Dtype;
use crate::convention::profiles;
use crate::error::{Error, Result};
use crate::files;
use crate::files::layout::Layout;
use crate::judge::large::files::{self as large_files, TIER};
use crate::judge::{Exam, LargeExam, exchange};

/// Write the cases that an implementation is judged by: cases.json and, with the inputs alone, one npz a case, or a file of bare numbers an
/// array.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Components whose name or folder contains this (all where absent).
    #[arg(default_value = "")]
    filter: String,
    /// The folder to write.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What the implementation computes in: f64, f32, tf32, bf16 or f16.
    #[arg(long, default_value = "f32")]
    dtype: Dtype,
    /// Pin the conventions (cs180, nerf2020, ...): deviating fails. Without it the judge looks for those that are followed.
    #[arg(long)]
    profile: Option<String>,
    /// How the arrays lie in files: npz; or raw, which needs no zip: a folder a case, with little-endian numbers and an index as text.
    /// Answers may lie either way.
    #[arg(long, default_value_t)]
    layout: Layout,
    /// Small cases, or those of real sizes (large), whose inputs are recipes in cases.json.
    #[arg(long, default_value = "small", value_parser = ["small", TIER])]
    tier: String,
    /// Write the inputs of large cases as npz, too: some hundred megabytes.
    #[arg(long)]
    inputs: bool,
}

/// Runs it.
///
/// # Errors
/// An unknown filter or profile, or a folder that can't be written.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_writable(&args.out)?;
    let profile = args.profile.as_deref().map(profiles::find).transpose()?;
    let large = args.tier == TIER;
    if args.inputs && !large {
        return Err(Error::usage(
            "--inputs",
            "small cases",
            "--tier large: small cases always come with their inputs",
        ));
    }
    if large && args.layout != Layout::Npz {
        return Err(Error::usage(
            "--layout",
            args.layout,
            "npz with --tier large, whose answers may lie either way",
        ));
    }
    let (exam, bytes) = if large {
        let large = LargeExam::new(&args.filter, args.dtype, profile)?;
        let bytes = large_files::write(&large, &args.out, args.inputs)?;
        (large.exam, bytes)
    } else {
        let exam = Exam::new(&args.filter, args.dtype, profile)?;
        let bytes = exchange::write_cases(&exam, &args.out, args.layout)?;
        (exam, bytes)
    };
    let cases: usize = exam.questions.iter().map(|question| question.cases.len()).sum();
    let left_out = &exam.left_out;
    let layout = args.layout.to_string();
    let object =
        json!({ "out": args.out, "cases": cases, "bytes": bytes, "left_out": left_out, "layout": layout });
    let mut text = format!("{cases} cases in {} ({:.1} MB)\n", args.out.display(), bytes as f64 / 1e6);
    if !left_out.is_empty() {
        text += &format!("{} left out, as {} can't hold their inputs:\n", left_out.len(), args.dtype);
        text.extend(left_out.iter().map(|name| format!("  {name}\n")));
    }
    output::print(json, &object, &text)?;
    Ok(ExitCode::SUCCESS)
}
