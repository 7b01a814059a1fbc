//! `bench [FILTER] --out DIR`: speed against error of every component's variants.

use std::path::PathBuf;
use std::process::ExitCode;

use super::evaluate::open;
use super::options::{Backend, at_most, threads};
use super::output;
use crate::bench::{self, Options, nerf_step, page, suites, systems};
use crate::error::{Error, Result};
use crate::files;
use crate::limits::ROUNDS;
use crate::parallel;

/// Measure speed against error: variants are checked, timed, and their errors measured.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Components whose name contains this (all where absent); `dense`: the share of the machine's peak that dense layers reach.
    #[arg(default_value = "")]
    filter: String,
    /// Where table.txt, bench.json and index.html go.
    #[arg(long)]
    out: PathBuf,
    /// A program that takes part in every round: it prints one JSON object, as tools/bench_torch.py --rounds 1 does.
    #[arg(long, value_name = "COMMAND")]
    peer: Option<String>,
    /// A trained run, for the whole-system rows.
    #[arg(long)]
    run: Option<PathBuf>,
    /// Rounds, at least 5.
    #[arg(long, default_value_t = 7, value_parser = at_most::<ROUNDS>)]
    rounds: usize,
    /// A quarter of the work, 5 rounds, a smaller calibration (which is said: a ceiling from it isn't one of 4096^3).
    #[arg(long)]
    quick: bool,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
}

/// Runs it. 1 if a variant exceeds its tolerance.
///
/// # Errors
/// A filter that no component matches, a run that can't be read, a peer that fails.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_writable(&args.out)?;
    if args.rounds < 5 {
        return Err(Error::usage("--rounds", args.rounds, "at least 5"));
    }
    let wanted = |name: &str| name.contains(&args.filter);
    let suites: Vec<_> = suites::SUITES.iter().copied().filter(|s| wanted(s.component)).collect();
    let scalings: Vec<_> = suites::scalings().into_iter().filter(|s| wanted(s.component)).collect();
    let (whole, steps) = (wanted("system"), wanted("nerf_step"));
    let layers = if wanted("dense") { suites::DENSE } else { &[] };
    if suites.is_empty() && scalings.is_empty() && layers.is_empty() && !whole && !steps {
        let names: Vec<&str> =
            suites::SUITES.iter().map(|s| s.component).chain(["dense", "system", "nerf_step"]).collect();
        return Err(Error::usage("FILTER", &args.filter, format!("a part of: {}", names.join(", "))));
    }
    if suites.is_empty() && layers.is_empty() && (whole || steps) && args.run.is_none() {
        return Err(Error::usage("FILTER", &args.filter, "--run RUN beside it, the folder of a trained run"));
    }
    // Opened first: an unreadable folder must show before minutes of measuring.
    let run = args.run.as_deref().filter(|_| whole || steps);
    let mut trained = run.map(|run| open(run, Backend::Fast, false)).transpose()?;
    let folder = || args.run.as_deref().map_or_else(String::new, |run| run.display().to_string());
    let system = trained.as_mut().map(|trained| {
        let system = systems::of(&mut *trained.model).map(|system| (system, &trained.scene));
        system.ok_or_else(|| {
            Error::usage("--run", folder(), "a run of one field: compact, or nerf without --fine")
        })
    });
    let system = system.transpose()?;
    let options = Options {
        rounds: if args.quick { 5 } else { args.rounds },
        least: if args.quick { 1e-3 } else { 5e-3 },
        quick: args.quick,
        peer: args.peer.clone(),
    };
    let mut report = parallel::on_threads(args.threads, || {
        bench::run(&suites, &scalings, layers, &options, output::note)
    })?;
    if let Some((mut system, scene)) = system.filter(|_| whole) {
        let rows = || bench::system::rows(&mut *system, scene, &options, output::note);
        let (rows, scaling) = parallel::on_threads(args.threads, rows)?;
        report.system = rows;
        report.scaling.extend(scaling);
        report.stamp();
    }
    let (mut object, mut text) = (report.json(), report.text());
    if let Some(trained) = trained.as_mut().filter(|_| steps) {
        let compare = || nerf_step::compare(&mut *trained.model, &trained.scene, options.rounds);
        let step = parallel::on_threads(args.threads, compare)?;
        if step.is_none() && suites.is_empty() && layers.is_empty() && !whole {
            return Err(Error::usage(
                "--run",
                folder(),
                "a run of --model nerf without --fine: nerf_step compares its steps",
            ));
        }
        if let Some(step) = step {
            text += &step["text"].as_str().map_or_else(String::new, |line| format!("\n{line}\n"));
            object["nerf_step"] = step;
        }
    }
    files::write(&args.out.join("table.txt"), &text)?;
    files::write(
        &args.out.join("bench.json"),
        serde_json::to_string_pretty(&object).expect("plain data") + "\n",
    )?;
    files::write(&args.out.join("index.html"), page::page(&report))?;
    output::print(json, &object, &text)?;
    Ok(if report.refused() == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
