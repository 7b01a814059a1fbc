//! The command line: one file a subcommand. People's tables go to stdout, with `--json` one JSON object instead; progress and
//! warnings go to stderr. Exit 0: all good; 1: a check failed; 2: usage, input or I/O; 130, 143: stopped by SIGINT, SIGTERM; 141, silently:
//! stdout's reader has closed it.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::Result;

mod bench;
mod cases;
mod check;
mod completions;
mod demo;
mod evaluate;
mod explain;
mod export;
mod fit_image;
mod grade;
mod import;
mod inspect;
mod judge;
mod list;
mod live;
mod man;
mod matrix;
mod merge;
mod options;
mod output;
mod paint;
mod parts;
mod progress;
mod recipe;
mod recorded;
mod render;
mod run_page;
mod shard;
mod signals;
mod spelling;
mod sweep_image;
mod train;
mod vectors;
mod view;

/// The reference that NeRF implementations are checked against.
#[derive(Parser)]
#[command(version, about, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// One JSON object on stdout instead of text for people.
    #[arg(long, global = true)]
    json: bool,
    /// No progress and no notes on stderr; errors and warnings still.
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Train a small network on a built-in scene, check the fast path, write pictures, a film and a page.
    Demo(demo::Args),
    /// Fit a 2D network to an image.
    FitImage(fit_image::Args),
    /// Fit an image with every combination of levels, widths and learning rates.
    SweepImage(sweep_image::Args),
    /// Train a scene.
    Train(train::Args),
    /// Measure a trained run against photographs.
    Evaluate(evaluate::Args),
    /// Render a film or frames of a trained run.
    Render(render::Args),
    View(view::Args),
    /// Show a scene's cameras, rays and samples from outside, as numbers and as a picture.
    Inspect(inspect::Args),
    /// Make a run of another program's weights, by a mapping of their names.
    Import(import::Args),
    /// Write a run's weights for other programs.
    Export(export::Args),
    /// Put the parts of --shard together, as one process would have written them.
    Merge(merge::Args),
    List(list::Args),
    Explain(explain::Args),
    Check(check::Args),
    Cases(cases::Args),
    Judge(judge::Args),
    Vectors(vectors::Args),
    Grade(grade::Args),
    Bench(bench::Args),
    Matrix(matrix::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// Parses `args`, runs the subcommand, prints an error if there is one, and returns the exit code.
pub fn main(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(e) => {
            // Help and version are no errors, and go to stdout; everything else is exit code 2.
            return match e.print() {
                Ok(()) => ExitCode::from(u8::try_from(e.exit_code()).unwrap_or(2)),
                Err(lost) if !e.use_stderr() && lost.kind() == ErrorKind::BrokenPipe => output::CLOSED.into(),
                Err(_) => ExitCode::from(2),
            };
        }
    };
    match run(&cli) {
        Err(error) if output::closed(&error) => output::CLOSED.into(),
        Err(error) => {
            output::say(&format!("error: {}", spelling::error(&error)));
            ExitCode::from(2)
        }
        Ok(_) if output::lost() => ExitCode::from(2),
        Ok(code) => code,
    }
}

fn run(cli: &Cli) -> Result<ExitCode> {
    if cli.quiet {
        output::be_quiet();
    }
    match &cli.command {
        Command::Demo(args) => demo::run(args, cli.json),
        Command::FitImage(args) => fit_image::run(args, cli.json),
        Command::SweepImage(args) => sweep_image::run(args, cli.json),
        Command::Train(args) => train::run(args, cli.json),
        Command::Evaluate(args) => evaluate::run(args, cli.json),
        Command::Render(args) => render::run(args, cli.json),
        Command::View(args) => view::run(args, cli.json),
        Command::Inspect(args) => inspect::run(args, cli.json),
        Command::Import(args) => import::run(args, cli.json),
        Command::Export(args) => export::run(args, cli.json),
        Command::Merge(args) => merge::run(args, cli.json),
        Command::List(args) => list::run(args, cli.json),
        Command::Explain(args) => explain::run(args, cli.json),
        Command::Check(args) => check::run(args, cli.json),
        Command::Cases(args) => cases::run(args, cli.json),
        Command::Judge(args) => judge::run(args, cli.json),
        Command::Vectors(args) => vectors::run(args, cli.json),
        Command::Grade(args) => grade::run(args, cli.json),
        Command::Bench(args) => bench::run(args, cli.json),
        Command::Matrix(args) => matrix::run(args, cli.json),
        Command::Completions(args) => completions::run(args, cli.json),
        Command::Man(args) => man::run(args, cli.json),
    }
}
