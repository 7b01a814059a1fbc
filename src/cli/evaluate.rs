//! `evaluate RUN`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{Value, json};

use super::options::{Backend, positive, threads};
use super::parts::Merged;
use super::recipe::{build, load_scene};
use super::run_page::Evaluated;
use super::shard::{self, Piece, Shard, exact};
use super::{output, progress, recorded};
use crate::error::{Error, Input, Result};
use crate::evaluation::{self, Scores, ViewScore};
use crate::files;
use crate::parallel;
use crate::report::table;
use crate::scene::{Frame, Scene};
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
    /// Every Nth pixel in both directions alone: much faster, without SSIM.
    #[arg(long, value_parser = positive)]
    pub every: Option<usize>,
    /// I/N: every Nth view from the Ith on, as a part for merge, written to --out.
    #[arg(long, value_name = "I/N", requires = "out")]
    pub shard: Option<Shard>,
    /// Write a page of all views beside their photographs, DIR/index.html; with --shard, the part.
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
        let with_ssim = args.every.is_none_or(|n| n == 1);
        let frames = match args.every {
            Some(n) => thinned(frames, n)?,
            None => frames.iter().filter(|frame| frame.image.is_some()).cloned().collect(),
        };
        let mine =
            frames.iter().enumerate().filter(|(n, _)| shard::has(args.shard, *n)).map(|(_, frame)| frame);
        let paged = args.out.as_deref().filter(|_| args.shard.is_none());
        let mut page = paged.map(Evaluated::new).transpose()?;
        let scores = evaluation::evaluate(&*trained.model, mine, background, with_ssim, |frame, view| {
            bar.inc(1);
            page.as_mut().map_or(Ok(()), |page| page.add(frame, &view.rgb))
        })?;
        bar.finish_and_clear();
        page.map_or(Ok(()), |page| page.finish(&scores, &trained.scene, trained.step))?;
        if let (Some(shard), Some(out)) = (args.shard, &args.out) {
            write_part(args, shard, out, trained.step, frames.len(), &scores)?;
            let (views, out) = (scores.views.len(), out.display().to_string());
            output::print(json, &json!({"out": out, "views": views}), &format!("{out}: {views} views\n"))?;
            return Ok(ExitCode::SUCCESS);
        }
        output::print(json, &object(&scores, trained.step), &text(&scores))?;
        Ok(ExitCode::SUCCESS)
    })
}

/// Every `n`th pixel of frames that have pictures.
fn thinned(frames: &[Frame], n: usize) -> Result<Vec<Frame>> {
    let small = frames.iter().map(|frame| frame.camera.width.min(frame.camera.height)).min().unwrap_or(n);
    if n > small {
        return Err(Error::usage(
            "--every",
            n,
            format!("at most {small}, as the smallest picture has pixels"),
        ));
    }
    Ok(frames.iter().filter(|frame| frame.image.is_some()).map(|frame| frame.thinned(n)).collect())
}

/// A part of the views, with all that determines their scores.
fn write_part(args: &Args, shard: Shard, out: &Path, step: u64, count: usize, scores: &Scores) -> Result<()> {
    let work = json!({
        "command": "evaluate", "version": env!("CARGO_PKG_VERSION"), "step": step,
        "checkpoint": shard::of_file(&args.run.join("checkpoint.npz"))?,
        "backend": args.backend, "split": format!("{:?}", args.split).to_lowercase(), "every": args.every.unwrap_or(1),
    });
    let piece = |(number, view): (usize, &ViewScore)| {
        let ViewScore { name, mse, psnr, ssim } = view;
        let value = json!({"name": name, "mse": exact(*mse), "psnr": exact(*psnr), "ssim": ssim.map(exact)});
        Piece { number, value, picture: None }
    };
    let numbers = (0..count).filter(|n| shard.has(*n));
    shard::write(out, shard, &work, count, numbers.zip(&scores.views).map(piece).collect())
}

/// What `evaluate` prints of all views, from parts.
pub(super) fn merge(whole: &Merged) -> Result<(Value, String)> {
    let view = |(n, value): (usize, &Value)| {
        let name = value["name"].as_str().map(String::from);
        let ssim = if value["ssim"].is_null() { Ok(None) } else { whole.number(n, "ssim").map(Some) };
        let name = name.ok_or_else(|| whole.wrong(n, "name"))?;
        Ok(ViewScore { name, mse: whole.number(n, "mse")?, psnr: whole.number(n, "psnr")?, ssim: ssim? })
    };
    let views = whole.values.iter().enumerate().map(view).collect::<Result<Vec<_>>>()?;
    let scores = evaluation::summary(views);
    Ok((object(&scores, whole.work["step"].as_u64().unwrap_or_default()), text(&scores)))
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
