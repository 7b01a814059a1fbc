//! `fit-image IMAGE --out DIR`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use image::imageops::FilterType;
use ndarray::Array3;
use serde_json::{Value, json};

use super::options::{Backend, at_most, none_or, positive, positive_number, steps, threads};
use super::signals::Signals;
use super::{output, progress, recipe};
use crate::error::{Error, Input, Result};
use crate::files::{self, picture};
use crate::limits::{self, LAYERS, LEVELS, SIDE, WIDTH};
use crate::parallel;
use crate::report::page::Page;
use crate::report::{curve, sheet, table};
use crate::scene::{self, digest};
use crate::training::checkpoint::RunFolder;
use crate::training::fit::FitRun;
use crate::training::identity::Identity;
use crate::training::image::{FitSettings, LogPoint};

/// Options of `fit-image`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// A PNG, JPEG or GIF, or builtin:card.
    pub image: String,
    /// The output folder.
    #[arg(long)]
    pub out: PathBuf,
    /// Longest side; the picture is reduced to it (Lanczos3), never enlarged.
    #[arg(long, value_parser = at_most::<SIDE>)]
    pub size: Option<usize>,
    /// Steps.
    #[arg(long, default_value_t = 1000, value_parser = steps)]
    pub steps: usize,
    /// Pixels per step.
    #[arg(long, default_value_t = 10_000, value_parser = positive)]
    pub batch: usize,
    /// Bands of the encoding.
    #[arg(long, default_value_t = 10, value_parser = none_or::<LEVELS>)]
    pub levels: usize,
    /// Width of the hidden layers.
    #[arg(long, default_value_t = 256, value_parser = at_most::<WIDTH>)]
    pub width: usize,
    /// Number of hidden layers.
    #[arg(long, default_value_t = 3, value_parser = at_most::<LAYERS>)]
    pub layers: usize,
    /// Learning rate.
    #[arg(long, default_value_t = 5e-3, value_parser = positive_number)]
    pub lr: f64,
    /// Seed of parameters and pixels.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
    /// Which path computes.
    #[arg(long, value_enum, default_value_t = Backend::Fast)]
    pub backend: Backend,
    /// Go on from the folder's checkpoint.
    #[arg(long)]
    pub resume: bool,
    /// Move a run that is in the folder aside, to OUT.old-1 or the next free number, instead of refusing.
    #[arg(long, conflicts_with = "resume")]
    pub overwrite: bool,
}

/// What `--resume` may not change.
const KEPT: [&str; 9] = ["image", "size", "batch", "levels", "width", "layers", "lr", "seed", "backend"];

/// Runs `fit-image`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        files::check_writable(&args.out)?;
        let target = load(&args.image, args.size)?;
        let settings = settings(args);
        fits(&target, &[&settings], settings.steps as f64 / 100.0)?;
        let signals = Signals::listen();
        let folder = open(args, &target)?;
        let (log, failure) = fit(args, &target, &settings, &folder, &signals)?;
        if let Some(found) = failure {
            let (file, remedy) = (args.image.clone(), "Lower --lr or --levels.");
            let expected = "finite numbers";
            return Err(Error::input(Input { file, field: "fit", found, expected, remedy }));
        }
        let stopped = signals.heard();
        if stopped.is_none() {
            write_sheet(&folder, &target, &log)?;
        }
        write_curve(&folder, &log)?;
        write_page(&folder, &args.image, &log, stopped.is_none())?;
        let (h, w, _) = target.dim();
        let object = json!({
            "out": args.out.display().to_string(), "width": w, "height": h, "settings": settings, "log": log,
        });
        output::print(json, &object, &text(&log, &args.out))?;
        Ok(stopped.map_or(ExitCode::SUCCESS, |signal| signal.end("--resume goes on from here")))
    })
}

/// The folder of a new fit, or of the one to resume, with its settings written.
fn open(args: &Args, target: &Array3<f32>) -> Result<RunFolder> {
    let recipe = json!({
        "image": args.image, "size": args.size, "batch": args.batch, "levels": args.levels, "width": args.width,
        "layers": args.layers, "lr": args.lr, "seed": args.seed, "backend": args.backend,
    });
    let Value::Object(mut recipe) = recipe else { unreachable!("an object literal") };
    let content = digest::of_picture(target);
    let mut determining = recipe.clone();
    // The content says which picture it is, wherever it lies.
    determining.retain(|name, _| name != "image" && name != "size");
    let identity = Identity::new(&determining, content);
    let folder = if args.resume && !RunFolder::is_untouched(&args.out) {
        let folder = RunFolder::resume(&args.out, identity.clone())?;
        let file = folder.file("run.json").display().to_string();
        let before = folder.settings()?;
        recipe::check_kept(&KEPT, &before, &recipe, &file)?;
        Identity::of_settings(&before)
            .map_or(Ok(()), |known| known.check_content(&identity.content, &file))?;
        folder
    } else {
        RunFolder::begin(&args.out, identity.clone(), args.overwrite)?
    };
    recipe.insert("steps".into(), args.steps.into());
    recipe.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    recipe.extend(identity.settings());
    folder.write_settings(&recipe)?;
    picture::write_png(&folder.file("target.png"), target.view())?;
    Ok(folder)
}

/// The log, and why the fit was given up, if it was.
fn fit(
    args: &Args,
    target: &Array3<f32>,
    settings: &FitSettings,
    folder: &RunFolder,
    signals: &Signals,
) -> Result<(Vec<LogPoint>, Option<String>)> {
    let mut run = FitRun::new(target, settings, folder);
    if args.resume {
        run.resume()?;
    }
    let bar = progress::bar(Some(settings.steps), "fit");
    run.go(
        || signals.heard().is_some(),
        |point, fitted| picture::write_png(&folder.file(&name(point)), fitted.view()),
        |step, loss| {
            bar.set_position(step);
            bar.set_message(format!("loss {loss:.5}"));
        },
        |cost, every| bar.suspend(|| progress::say_slow(cost, every)),
    )?;
    bar.finish_and_clear();
    Ok((run.log, run.failure))
}

/// The file of a point's picture.
fn name(point: &LogPoint) -> String {
    format!("step_{:04}.png", point.step)
}

/// All pictures of the log, the target last: read again, as some may be from before the fit was resumed.
fn write_sheet(folder: &RunFolder, target: &Array3<f32>, log: &[LogPoint]) -> Result<()> {
    let read = |point: &LogPoint| picture::read(&folder.file(&name(point)));
    let mut pictures = log.iter().map(read).collect::<Result<Vec<_>>>()?;
    pictures.push(target.clone());
    let pictures: Vec<_> = pictures.iter().map(|fitted| picture::to_rgb(fitted.view())).collect();
    picture::write_rgb(&folder.file("contact_sheet.png"), &sheet::contact_sheet(&pictures, 4))
}

fn settings(args: &Args) -> FitSettings {
    FitSettings {
        steps: args.steps as u64,
        batch: args.batch,
        levels: args.levels,
        width: args.width,
        layers: args.layers,
        lr: args.lr,
        seed: args.seed,
        reference: args.backend == Backend::Reference,
    }
}

/// That fits of a picture, one after the other, fit into memory with the pictures that they keep.
pub(super) fn fits(target: &Array3<f32>, all: &[&FitSettings], kept: f64) -> Result<()> {
    let (h, w, _) = target.dim();
    let largest = |of: &dyn Fn(&FitSettings) -> f64| all.iter().map(|s| of(s)).fold(0.0, f64::max);
    let parameters = largest(&|s| (s.width * (s.width * s.layers + 4 * s.levels + 8)) as f64);
    let pixels = (h * w) as f64 * (limits::VIEW_PIXEL + limits::KEPT_PIXEL * kept);
    let bytes = limits::PARAMETER * parameters + limits::STEP_SAMPLE * largest(&|s| s.batch as f64) + pixels;
    let what = format!("fits of {w}x{h} pixels that keep {kept:.0} pictures");
    limits::fits(what, bytes, "Lower `size`, `steps`, `batch`, `width` or `layers`.")
}

/// A picture by path or `builtin:card`, its longest side reduced to `size`.
pub(super) fn load(image: &str, size: Option<usize>) -> Result<Array3<f32>> {
    if image == "builtin:card" {
        let side = size.unwrap_or(256) as f64;
        limits::fits(image, limits::VIEW_PIXEL * side * side, "Lower `size`.")?;
        return Ok(scene::card(size.unwrap_or(256)));
    }
    let target = picture::read(Path::new(image))?;
    let (h, w, _) = target.dim();
    let Some(size) = size.filter(|&size| size < h.max(w)) else { return Ok(target) };
    let shrink = |side: usize| ((side * size) as f64 / h.max(w) as f64).round().max(1.0) as u32;
    let pixels = image::Rgb32FImage::from_raw(w as u32, h as u32, target.iter().copied().collect());
    let pixels = pixels.expect("three channels a pixel");
    let small = image::imageops::resize(&pixels, shrink(w), shrink(h), FilterType::Lanczos3);
    let shape = (small.height() as usize, small.width() as usize, 3);
    let small = Array3::from_shape_vec(shape, small.into_raw()).expect("three channels a pixel");
    // Lanczos overshoots at edges.
    Ok(small.mapv(|x| x.clamp(0.0, 1.0)))
}

fn write_curve(folder: &RunFolder, log: &[LogPoint]) -> Result<()> {
    let points = log.iter().map(|p| (p.step as f64, p.psnr)).collect();
    let series = [curve::Series { name: "whole picture".into(), points }];
    curve::write(&folder.file("psnr.svg"), "PSNR of the fitted picture", "step", "dB", &series)
}

/// `index.html`: figures, curve, pictures; the sheet is of a fit that has ended.
fn write_page(folder: &RunFolder, image: &str, log: &[LogPoint], sheet: bool) -> Result<()> {
    let mut page = Page::new("A fitted picture", &format!("A field of two dimensions, fitted to {image}."));
    page.table(&HEADER, &log.iter().map(cells).collect::<Vec<_>>());
    page.heading("Fit").picture("psnr.svg", "PSNR of the whole picture over steps", 720);
    if sheet {
        page.heading("Pictures").picture(
            "contact_sheet.png",
            "the steps in order, the picture itself last",
            960,
        );
    }
    files::write(&folder.file("index.html"), page.finish())
}

const HEADER: [&str; 4] = ["step", "seconds", "loss", "PSNR dB"];

fn cells(p: &LogPoint) -> Vec<String> {
    vec![p.step.to_string(), format!("{:.1}", p.seconds), format!("{:.6}", p.loss), format!("{:.2}", p.psnr)]
}

fn text(log: &[LogPoint], out: &Path) -> String {
    let rows: Vec<_> = log.iter().map(cells).collect();
    table::text(&HEADER, &rows) + &format!("{}\n", out.display())
}
