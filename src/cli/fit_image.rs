//! `fit-image IMAGE --out DIR`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use image::imageops::FilterType;
use ndarray::Array3;
use serde_json::json;

use super::options::{Backend, at_most, none_or, positive, positive_number, steps, threads};
use super::{output, progress};
use crate::error::{Error, Input, Result};
use crate::files::{self, picture};
use crate::limits::{self, LAYERS, LEVELS, SIDE, WIDTH};
use crate::parallel;
use crate::report::{curve, sheet, table};
use crate::scene;
use crate::training::image::{FitSettings, LogPoint, fit};

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
}

/// Runs `fit-image`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        let target = load(&args.image, args.size)?;
        let settings = settings(args);
        fits(&target, &[&settings], settings.steps as f64 / 100.0)?;
        files::make_folder(&args.out)?;
        picture::write_png(&args.out.join("target.png"), target.view())?;
        let bar = progress::bar(Some(settings.steps), "fit");
        let mut pictures = vec![];
        let keep = |point: &LogPoint, fitted: &Array3<f32>| {
            if !point.loss.is_finite() {
                let (file, field) = (args.image.clone(), format!("loss at step {}", point.step));
                return Err(Error::input(Input {
                    file,
                    field,
                    found: point.loss,
                    expected: "a finite number",
                    remedy: "Lower --lr or --levels.",
                }));
            }
            picture::write_png(&args.out.join(format!("step_{:04}.png", point.step)), fitted.view())?;
            pictures.push(picture::to_rgb(fitted.view()));
            Ok::<(), Error>(())
        };
        let log = fit(&target, &settings, keep, |step, loss| {
            bar.set_position(step);
            bar.set_message(format!("loss {loss:.5}"));
        })?;
        bar.finish_and_clear();
        pictures.push(picture::to_rgb(target.view()));
        picture::write_rgb(&args.out.join("contact_sheet.png"), &sheet::contact_sheet(&pictures, 4))?;
        write_log(&args.out, &log)?;
        let (h, w, _) = target.dim();
        let object = json!({
            "out": args.out.display().to_string(), "width": w, "height": h, "settings": settings, "log": log,
        });
        output::print(json, &object, &text(&log, &args.out))?;
        Ok(ExitCode::SUCCESS)
    })
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

fn write_log(out: &Path, log: &[LogPoint]) -> Result<()> {
    let lines: String = log.iter().map(|p| serde_json::to_string(p).expect("plain data") + "\n").collect();
    files::write(&out.join("log.jsonl"), lines)?;
    let points = log.iter().map(|p| (p.step as f64, p.psnr)).collect();
    let series = [curve::Series { name: "whole picture".into(), points }];
    curve::write(&out.join("psnr.svg"), "PSNR of the fitted picture", "step", "dB", &series)
}

fn text(log: &[LogPoint], out: &Path) -> String {
    let row = |p: &LogPoint| {
        vec![
            p.step.to_string(),
            format!("{:.1}", p.seconds),
            format!("{:.6}", p.loss),
            format!("{:.2}", p.psnr),
        ]
    };
    let rows: Vec<_> = log.iter().map(row).collect();
    table::text(&["step", "seconds", "loss", "PSNR dB"], &rows) + &format!("{}\n", out.display())
}
