//! `judge`: compares answers with the truth.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use super::output;
use crate::error::{Error, Result};
use crate::files;
use crate::judge::{Verdict, exchange, judging, large};

mod judged;

/// Judge answers: right or wrong, component by component, and what the mistake probably is.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// The folder that `cases` wrote.
    cases: PathBuf,
    /// The folder of answers: one npz a case, or a folder of bare numbers, at the same relative path; in answers.json what the candidate takes, where that isn't all.
    answers: PathBuf,
    /// How far off exp, log, sin and cos may be, in ULP of the type.
    #[arg(long, default_value_t = judging::EXP_ULP)]
    exp_ulp: f64,
    /// Count this verdict as a pass, once for each: `imprecise`, the right formula with more digits lost than its arithmetic costs; `edge`, right but for cases that few programs ever meet (no samples, an infinite density).
    #[arg(long, value_name = "VERDICT", value_parser = ["imprecise", "edge"])]
    allow: Vec<String>,
    /// Write a page to look at, and to send: DIR/index.html.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs it. 0: something passed and nothing failed; 1: something failed, is unproved, imprecise or wrong in edge cases; 2: nothing was answered.
///
/// # Errors
/// Folders that can't be read, or that hold something else than cases and answers.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    if !(args.exp_ulp >= 0.5 && args.exp_ulp <= 1e6) {
        return Err(Error::usage("--exp-ulp", args.exp_ulp, "a number from 0.5 to 1e6"));
    }
    if let Some(out) = &args.out {
        files::check_writable(out)?;
    }
    let mut pictures = BTreeMap::new();
    let report = if exchange::read_manifest(&args.cases)?.tier.is_some() {
        large::files::judged(large::files::read(&args.cases)?, &args.answers, args.exp_ulp)?
    } else {
        let exam = exchange::declared(exchange::read_exam(&args.cases)?, &args.answers)?;
        let answers = exchange::read_answers(&exam, &args.answers)?;
        let report = judging::judge_answers(&exam, &answers, args.exp_ulp);
        if args.out.is_some() {
            pictures = judged::pictures(&exam, &answers, &report, args.exp_ulp);
        }
        report
    };
    if let Some(out) = &args.out {
        files::make_folder(out)?;
        files::write(&out.join("index.html"), judged::page(&report, &pictures))?;
    }
    output::print(json, &report.json(), &report.to_string())?;
    let allowed = |verdict: &Verdict| args.allow.contains(&verdict.to_string());
    let allowed: Vec<Verdict> = [Verdict::Imprecise, Verdict::Edge].into_iter().filter(allowed).collect();
    Ok(ExitCode::from(report.exit_code_allowing(&allowed)))
}
