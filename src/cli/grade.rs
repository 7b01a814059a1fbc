//! `grade`: a class, by a rubric.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use super::options::threads;
use super::signals::Signals;
use super::{output, progress};
use crate::error::Result;
use crate::files;
use crate::grading::class::{self, Settings};
use crate::grading::rubric::Rubric;
use crate::grading::tables;
use crate::parallel;

/// What the rubric holds, for the help.
const RUBRIC: &str = r#"The rubric is JSON:
  {"schema": "nerf-oracle/rubric/1", "title": "Project 5", "dtype": "f32", "profile": "cs180",
   "timeout_s": 60, "memory_mib": 4096, "output_mib": 16,
   "rows": [{"component": "volume_render", "direction": "forward", "points": 10}]}
dtype (f32) and profile (none: conventions are found) are those of `cases`, exp_ulp (4) that of `judge`. The limits are those of a
submission's process; where a row makes it stop, the rows behind it are asked in a new one.
A row has a component and its direction (forward, the default, or vjp), points, and where you want them:
  points_if_imprecise             the right formula, with more digits lost than its arithmetic costs
  points_if_only_edge_cases_fail  all other cases are right
  edge_cases                      which those are: "one sample", a hazard ("VR9"), a case's id; by default those that `list` calls so
  outputs                         outputs that have to be answered; by default any one will do
  function, parameters            Python: "name" or "file.py:name" (default: the row's name; with _vjp for a gradient of its own);
                                  {"step_size": "step"}, the function's parameter and the contract's name for it
A submission holds either answers, in the layout that `judge` reads, or Python files with these functions.
DIR gets index.html (yours), pages/NAME.html (the students'), grades.csv, grades.json, junit.xml, and marks/, by which a submission that
hasn't changed isn't graded again."#;

/// Grade a class: every sub-folder is a submission, answers or Python; a table, a page each, CSV and JUnit XML.
#[derive(clap::Args, Debug)]
#[command(after_long_help = RUBRIC)]
pub(super) struct Args {
    /// The folder whose sub-folders are the submissions.
    submissions: PathBuf,
    /// What is asked and what it is worth (JSON; see below).
    #[arg(long, value_name = "FILE")]
    rubric: PathBuf,
    /// The folder for everything that is written.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The Python that runs submissions, with numpy; each in a process of its own, within the rubric's limits.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: String,
    /// Say on the students' pages how to fix what is wrong.
    #[arg(long)]
    reveal: bool,
    /// Grade submissions again that haven't changed.
    #[arg(long)]
    again: bool,
    /// Submissions at once; all cores by default.
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
}

/// Runs it. 0: every submission has its row, whatever its marks.
///
/// # Errors
/// A rubric that can't be used, folders that can't be read or written, no Python for those who need it.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let rubric = Rubric::read(&args.rubric)?;
    files::check_writable(&args.out)?;
    let settings = Settings {
        submissions: &args.submissions,
        out: &args.out,
        python: &args.python,
        again: args.again,
        reveal: args.reveal,
    };
    let signals = Signals::listen();
    let bar = progress::bar(None, "graded");
    let done = |n: usize, all: usize| {
        bar.set_length(all as u64);
        bar.inc(n as u64);
    };
    let class = parallel::on_threads(args.threads, || {
        class::grade(&rubric, &settings, || signals.heard().is_some(), done)
    })?;
    bar.finish_and_clear();
    let Some(class) = class else {
        let signal = signals.heard().expect("nothing else stops it");
        return Ok(signal.end("what was graded is kept: the same command goes on from there"));
    };
    class.about.iter().for_each(|line| output::say(line));
    let mut object = tables::object(&class.entries, &rubric);
    (object["new"], object["about"]) = (json!(class.new), json!(class.about));
    let mut text = tables::text(&class.entries, &rubric);
    let index = args.out.join("index.html");
    text +=
        &format!("\n{} submissions, {} graded now: {}\n", class.entries.len(), class.new, index.display());
    output::print(json, &object, &text)?;
    Ok(ExitCode::SUCCESS)
}
