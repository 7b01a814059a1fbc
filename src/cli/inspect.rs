//! `inspect`: a scene's cameras, rays and samples, as numbers, as a picture and as a page with a view in 3D.

use std::path::PathBuf;
use std::process::ExitCode;

use image::{RgbImage, imageops};
use serde_json::json;

use self::drawn::{Asked, Drawn};
use super::options::{Backend, at_most, distance, positive};
use super::{evaluate, output};
use crate::camera::{Camera, Lens};
use crate::error::Result;
use crate::files::npz;
use crate::files::{self, picture};
use crate::limits::{self, RAYS, SAMPLES};
use crate::parallel;
use crate::ray::Ray;
use crate::report::inspect;
use crate::scene::cloud::Reprojection;
use crate::scene::{self, Frame, Options, Scene, aim};
use crate::shown::shown;
use crate::training::probe::Cells;

mod arrays;
mod drawn;
mod page;

/// Options of `inspect`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// builtin:NAME, an .npz, a folder or file of transforms*.json, or a capture's folder with COLMAP's sparse/0 or LLFF's
    /// poses_bounds.npy (or a folder of pictures in it, such as images_4).
    pub scene: String,
    /// The output folder: rays.npz, outside.png and index.html.
    #[arg(long)]
    pub out: PathBuf,
    /// The folder of a trained run: its densities, colors and occupied cells, near and far as it was trained with.
    #[arg(long)]
    pub run: Option<PathBuf>,
    /// Write cameras.ply and points.ply too, for other programs.
    #[arg(long)]
    pub ply: bool,
    /// How many rays, through random pixels of random training frames.
    #[arg(long, default_value_t = 100, value_parser = at_most::<RAYS>)]
    pub rays: usize,
    /// How many samples per ray, jittered as in training.
    #[arg(long, default_value_t = 64, value_parser = at_most::<SAMPLES>)]
    pub samples: usize,
    /// Where samples start, instead of what the scene says.
    #[arg(long, value_parser = distance)]
    pub near: Option<f64>,
    /// Where samples end.
    #[arg(long, value_parser = distance)]
    pub far: Option<f64>,
    /// Every Nth frame is for validation, where the scene has no split.
    #[arg(long, value_parser = positive)]
    pub holdout: Option<usize>,
    /// Seed of the rays and their jitter.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// The longest side of a thumbnail in `rays.npz`.
const THUMBNAIL: u32 = 64;

/// Runs `inspect`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_writable(&args.out)?;
    let trained = args.run.as_ref().map(|run| evaluate::open(run, Backend::Fast, false)).transpose()?;
    let of_run = |value: fn(&Scene) -> f64| trained.as_ref().map(|trained| value(&trained.scene));
    let options = Options {
        near: args.near.or(of_run(|scene| scene.near)),
        far: args.far.or(of_run(|scene| scene.far)),
        holdout: args.holdout,
        ..Options::default()
    };
    let mut scene = scene::load(&args.scene, &options)?;
    if let Some(trained) = trained.as_ref().filter(|trained| trained.scene.digest() != scene.digest()) {
        let name = shown(&trained.scene.name).into_owned();
        scene.warnings.push(format!("The run was trained on other pictures or cameras than these: {name}."));
    }
    let say =
        |warnings: &[String]| warnings.iter().for_each(|warning| output::say(&format!("warning: {warning}")));
    say(&scene.warnings);
    let what = format!("{} rays with {} samples each", args.rays, args.samples);
    let bytes = limits::SHOWN_SAMPLE * args.rays as f64 * args.samples as f64;
    limits::fits(what, bytes, "Lower `rays` or `samples`.")?;
    files::make_folder(&args.out)?;
    let asked = Asked { rays: args.rays, samples: args.samples, seed: args.seed };
    let drawn = drawn::draw(&scene, trained.as_ref().map(|trained| &*trained.model), &asked)?;
    let frames: Vec<&Frame> = scene.train.iter().chain(&scene.val).collect();
    let (doubts, of_all) = aim::doubts(&frames, scene.focus);
    let more: Vec<String> = of_all.into_iter().chain(drawn::missing(&scene, &drawn)).collect();
    say(&more);
    scene.warnings.extend(more);
    let cells = trained.as_ref().and_then(|trained| trained.model.cells());
    let files = write(args, &scene, &drawn, &doubts, cells)?;
    output::print(json, &summary(&scene, &files), &text(&scene, &files))?;
    Ok(ExitCode::SUCCESS)
}

/// Writes everything; the files' names.
fn write(
    args: &Args,
    scene: &Scene,
    drawn: &[Drawn],
    doubts: &[Option<String>],
    cells: Option<Cells>,
) -> Result<Vec<String>> {
    let frames: Vec<&Frame> = scene.train.iter().chain(&scene.val).collect();
    let small: Vec<(Camera, RgbImage)> =
        parallel::map(frames.len(), |n| (frames[n].camera, thumbnail(frames[n], scene.size())));
    let file = |name: &str| args.out.join(name);
    let arrays = arrays::of(scene, &small, drawn);
    npz::write(&file("rays.npz"), &arrays, true)?;
    let lines: Vec<(Ray, Vec<f64>)> = drawn.iter().map(|drawn| (drawn.ray, drawn.t.clone())).collect();
    let outside = inspect::Outside { cameras: &small, rays: &lines, far: scene.far, focus: scene.focus };
    picture::write_rgb(&file("outside.png"), &inspect::draw(&outside))?;
    files::write(&file("index.html"), page::html(scene, &outside, &arrays, doubts, cells))?;
    let mut names = vec!["rays.npz", "outside.png", "index.html"];
    if args.ply {
        page::write_ply(scene, &outside, [&file("cameras.ply"), &file("points.ply")])?;
        names.extend(["cameras.ply", "points.ply"]);
    }
    Ok(names.into_iter().map(|name| file(name).display().to_string()).collect())
}

/// A small version of a frame's photograph; gray where it has none. All of the shape of the first picture, as the array wants it.
fn thumbnail(frame: &Frame, (w, h): (usize, usize)) -> RgbImage {
    let (w, h) = (w as f64, h as f64);
    let shrink = (f64::from(THUMBNAIL) / w.max(h)).min(1.0);
    let (width, height) = ((w * shrink).round().max(1.0) as u32, (h * shrink).round().max(1.0) as u32);
    match &frame.image {
        Some(image) => {
            // Means of whole squares first: that saves 3 s of CPU for 200 photographs of 1 Mpx.
            let (rows, columns) = image.size();
            let twice = 2 * THUMBNAIL as usize;
            let smaller = image.shrunk((rows.max(columns) / twice).clamp(1, rows.min(columns)));
            let rgb = picture::to_rgb(smaller.to_array().view());
            imageops::resize(&rgb, width, height, imageops::FilterType::Triangle)
        }
        None => RgbImage::from_pixel(width, height, image::Rgb([128; 3])),
    }
}

/// The object of `--json`.
fn summary(scene: &Scene, files: &[String]) -> serde_json::Value {
    let (width, height) = scene.size();
    let (distortion, fisheye) = match scene.train[0].camera.distortion {
        None => (None, None),
        Some(Lens::Opencv(lens)) => (Some(lens), None),
        Some(Lens::Fisheye(k)) => (None, Some(k)),
    };
    json!({
        "scene": scene.name, "train": scene.train.len(), "val": scene.val.len(), "test": scene.test.len(),
        "width": width, "height": height, "near": scene.near, "far": scene.far, "focus": scene.focus.to_array(),
        "bounds": scene.bounds.map(|(low, high)| [low.to_array(), high.to_array()]),
        "intrinsics": scene.train[0].camera.k, "distortion": distortion, "fisheye": fisheye,
        "points": scene.cloud.as_ref().map(|cloud| json!({"count": cloud.points.len(), "reprojection": cloud.reprojection})),
        "reasons": scene.reasons, "warnings": scene.warnings, "files": files,
    })
}

/// The same for people.
fn text(scene: &Scene, files: &[String]) -> String {
    let (width, height) = scene.size();
    let counts = format!(
        "{} to learn from, {} to measure on, {} poses of a film",
        scene.train.len(),
        scene.val.len(),
        scene.test.len()
    );
    let mut lines =
        vec![shown(&scene.name).into_owned(), format!("frames: {counts}"), format!("size: {width}x{height}")];
    if let Some(cloud) = &scene.cloud {
        let fit = cloud.reprojection.map_or(String::new(), |fit| {
            let Reprojection { sights, pixels, stated, .. } = fit;
            format!(", shown {sights} times, projected {pixels:.2} pixels off on average ({stated:.2} as the file says)")
        });
        lines.push(format!("points: {}{fit}", cloud.points.len()));
    }
    lines.extend(
        scene.reasons.iter().map(|(field, why)| format!("{field}: {}", why.as_str().unwrap_or_default())),
    );
    lines.extend(files.iter().map(|file| format!("written: {}", shown(file))));
    lines.join("\n  ") + "\n"
}
