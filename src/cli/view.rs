//! `view RUN`.

use std::net::IpAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use serde_json::json;

use super::evaluate::{Trained, open};
use super::options::{Backend, host, threads};
use super::signals::Signals;
use super::{live, output};
use crate::error::{Error, Input, Result};
use crate::parallel;
use crate::serve::{Port, Saved, Shown};
use crate::training::checkpoint::RunFolder;

/// Show a run on a page of this machine: its curve, its views, and new ones wherever one drags to; until Ctrl-C.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The folder of a run, which may be training.
    pub run: PathBuf,
    /// The page's port; 0: any that is free.
    #[arg(long, default_value = live::PORT)]
    pub port: u16,
    /// The page's address. Any but this machine's own (127.0.0.1) shows the run to whoever reaches it.
    #[arg(long, value_name = "ADDRESS", default_value = live::HOST, value_parser = host)]
    pub host: IpAddr,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
    /// Which path computes.
    #[arg(long, value_enum, default_value_t = Backend::Fast)]
    pub backend: Backend,
}

/// How often it is looked whether to end.
const LOOK: Duration = Duration::from_millis(50);

/// Runs `view`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let folder = RunFolder::open(&args.run)?;
    if !folder.file("checkpoint.npz").exists() {
        return Err(Error::input(Input {
            file: args.run.display(),
            field: "checkpoint.npz",
            found: "no such file",
            expected: "a run that has been saved at least once",
            remedy: "Where it has just begun, try again in some seconds; train --serve shows it from its first step.",
        }));
    }
    let port = Port::take(args.host, args.port, "port")?;
    let Trained { scene, model, step } =
        parallel::on_threads(args.threads, || open(&args.run, args.backend, false))?;
    let shown = Shown {
        scene: Arc::new(scene),
        folder: args.run.clone(),
        source: Arc::new(Saved::new(folder, step)),
    };
    let signals = Signals::listen();
    let url = port.url();
    live::say_where(&port);
    let _server =
        port.serve(shown, Box::new(|| Ok(model)), args.threads.unwrap_or_else(parallel::threads))?;
    if json {
        output::print(json, &json!({"url": url, "run": args.run.display().to_string(), "step": step}), "")?;
    }
    loop {
        if let Some(signal) = signals.heard() {
            return Ok(signal.end("the run is as it was"));
        }
        thread::sleep(LOOK);
    }
}
