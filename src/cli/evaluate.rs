//! `evaluate RUN`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{Value, json};

use super::options::{Backend, threads};
use super::recipe::{build, load_scene};
use super::run_page::Evaluated;
use super::{output, progress, recorded};
use crate::error::{Error, Input, Result};
use crate::evaluation::{self, Scores};
use crate::files;
use crate::parallel;
use crate::report::table;
use crate::scene::Scene;
use crate::training::checkpoint::{Checkpoint, RunFolder};
use crate::training::model::Model;
use crate::training::sound;

/// Options of `evaluate`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The folder of a run.
    pub run: PathBuf,
    /// Which frames.
    #[arg(long, value_enum, default_value_t = Split::Val)]
    pub split: Split,
    /// Write a page of all views beside their photographs: DIR/index.html.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
    /// Which path computes.
    #[arg(long, value_enum, default_value_t = Backend::Fast)]
    pub backend: Backend,
}

/// A split of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Split {
    /// Validation frames.
    Val,
    /// Test frames.
    Test,
}

/// A trained model with its scene.
pub(super) struct Trained {
    /// The scene it was trained on.
    pub scene: Scene,
    /// The model with the checkpoint's parameters.
    pub model: Box<dyn Model>,
    /// The step of the checkpoint.
    pub step: u64,
}

/// Opens a run: its scene, its model, its checkpoint.
pub(super) fn open(run: &std::path::Path, backend: Backend, test_images: bool) -> Result<Trained> {
    let folder = RunFolder::open(run)?;
    let mut settings = folder.settings()?;
    let file = folder.file("run.json").display().to_string();
    recorded::check(&settings, &file)?;
    settings.insert("backend".into(), json!(backend));
    let scene = load_scene(&settings, test_images, &file).map_err(|error| recorded::named(error, &file))?;
    let mut model = build(&settings, &scene).map_err(|error| recorded::named(error, &file))?;
    recorded::check_same(&settings, &scene, &*model, &file)?;
    // Later: what was edited in run.json is named by its field.
    if let Some(known) = folder.known_identity() {
        known.check_content(&scene.digest(), &file)?;
    }
    let Checkpoint { state, step, .. } = folder.load()?;
    sound::restore(&mut *model, &state, step, &folder.file("checkpoint.npz").display().to_string())?;
    Ok(Trained { scene, model, step })
}

/// Runs `evaluate`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        args.out.as_deref().map_or(Ok(()), files::check_writable)?;
        let trained = open(&args.run, args.backend, args.split == Split::Test)?;
        let frames = match args.split {
            Split::Val => &trained.scene.val,
            Split::Test => &trained.scene.test,
        };
        let with_image = frames.iter().filter(|frame| frame.image.is_some()).count();
        if with_image == 0 {
            let split = format!("{:?} split", args.split).to_lowercase();
            let remedy = "Use --split val, or a scene with photographs in that split.";
            return Err(Error::input(Input {
                file: &trained.scene.name,
                field: split,
                found: "no photographs",
                expected: "at least one",
                remedy,
            }));
        }
        let bar = progress::bar(Some(with_image as u64), "evaluate");
        let background = trained.scene.background.map(|b| b as f32);
        let mut page = args.out.as_deref().map(Evaluated::new).transpose()?;
        let scores = evaluation::evaluate(&*trained.model, frames, background, true, |frame, view| {
            bar.inc(1);
            page.as_mut().map_or(Ok(()), |page| page.add(frame, &view.rgb))
        })?;
        bar.finish_and_clear();
        page.map_or(Ok(()), |page| page.finish(&scores, &trained.scene, trained.step))?;
        output::print(json, &object(&scores, trained.step), &text(&scores))?;
        Ok(ExitCode::SUCCESS)
    })
}

fn object(scores: &Scores, step: u64) -> Value {
    let mut object = serde_json::to_value(scores).expect("plain data");
    object["step"] = step.into();
    object
}

fn text(scores: &Scores) -> String {
    let ssim = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.4}"));
    let row = |name: &str, psnr: f64, s: Option<f64>| vec![name.to_string(), format!("{psnr:.2}"), ssim(s)];
    let mut rows: Vec<_> = scores.views.iter().map(|v| row(&v.name, v.psnr, v.ssim)).collect();
    rows.push(row("mean of the views", scores.psnr, scores.ssim));
    rows.push(row("pooled error", scores.psnr_pooled, None));
    table::text(&["view", "PSNR dB", "SSIM"], &rows)
}
