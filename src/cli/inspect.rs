//! `inspect`: a scene's cameras, rays and samples, as numbers and as a picture.

use std::path::PathBuf;
use std::process::ExitCode;

use image::{RgbImage, imageops};
use ndarray::{Array1, Array2, Array3, Array4};
use serde_json::json;

use super::options::{at_most, distance, positive};
use super::output;
use crate::camera::{Camera, Lens};
use crate::convention::{Grid, PixelCenter};
use crate::error::Result;
use crate::files::npz::{self, Arrays};
use crate::files::{self, picture};
use crate::limits::{self, RAYS, SAMPLES};
use crate::random::{Key, Purpose};
use crate::ray::{PixelDraw, Ray, camera_ray, pixel_position};
use crate::report::inspect;
use crate::sample::sample_along_ray;
use crate::scene::cloud::Reprojection;
use crate::scene::{self, Frame, Options, Scene, random_pixel};
use crate::shown::shown;

/// Options of `inspect`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// builtin:NAME, an .npz, a folder or file of transforms*.json, or a capture's folder with COLMAP's sparse/0 or LLFF's
    /// poses_bounds.npy (or a folder of pictures in it, such as images_4).
    pub scene: String,
    /// The output folder: rays.npz and outside.png.
    #[arg(long)]
    pub out: PathBuf,
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

/// A ray that was drawn: its pixel, the ray, its samples.
struct Drawn {
    pixel: PixelDraw,
    ray: Ray,
    t: Vec<f64>,
}

/// Runs `inspect`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_writable(&args.out)?;
    let options = Options { near: args.near, far: args.far, holdout: args.holdout, ..Options::default() };
    let scene = scene::load(&args.scene, &options)?;
    for warning in &scene.warnings {
        output::say(&format!("warning: {warning}"));
    }
    let what = format!("{} rays with {} samples each", args.rays, args.samples);
    let bytes = limits::SHOWN_SAMPLE * args.rays as f64 * args.samples as f64;
    limits::fits(what, bytes, "Lower `rays` or `samples`.")?;
    files::make_folder(&args.out)?;
    let drawn = draw_rays(&scene, args)?;
    let shown: Vec<(Camera, RgbImage)> = scene
        .train
        .iter()
        .chain(&scene.val)
        .map(|frame| (frame.camera, thumbnail(frame, scene.size())))
        .collect();
    let (rays, still) = (args.out.join("rays.npz"), args.out.join("outside.png"));
    npz::write(&rays, &arrays(&scene, &shown, &drawn), true)?;
    let lines: Vec<(Ray, Vec<f64>)> = drawn.into_iter().map(|drawn| (drawn.ray, drawn.t)).collect();
    let outside = inspect::Outside { cameras: &shown, rays: &lines, far: scene.far, focus: scene.focus };
    picture::write_rgb(&still, &inspect::draw(&outside))?;
    let files = [rays.display().to_string(), still.display().to_string()];
    output::print(json, &summary(&scene, &files), &text(&scene, &files))?;
    Ok(ExitCode::SUCCESS)
}

/// Rays through random pixels of training frames, with jittered samples: exactly those of a first training step.
fn draw_rays(scene: &Scene, args: &Args) -> Result<Vec<Drawn>> {
    let (pixels, jitter) = (Key::new(args.seed, Purpose::Rays), Key::new(args.seed, Purpose::Samples));
    let mut drawn = Vec::with_capacity(args.rays);
    for n in 0..args.rays as u64 {
        let [image, j, i] = random_pixel(&scene.train, &pixels, 0, n);
        let frame = &scene.train[image];
        let uv = pixel_position(i, j, PixelCenter::Half);
        let rgb = frame.image.as_ref().map_or([0.0; 3], |image| image.at(j, i).map(f64::from));
        let t =
            sample_along_ray(scene.near, scene.far, &jitter.uniforms(0, n, args.samples), Grid::Intervals);
        drawn.push(Drawn { pixel: PixelDraw { image, uv, rgb }, ray: camera_ray(&frame.camera, uv)?, t });
    }
    Ok(drawn)
}

/// A small version of a frame's photograph; gray where it has none. All of the shape of the first picture, as the array wants it.
fn thumbnail(frame: &Frame, (w, h): (usize, usize)) -> RgbImage {
    let (w, h) = (w as f64, h as f64);
    let shrink = (f64::from(THUMBNAIL) / w.max(h)).min(1.0);
    let (width, height) = ((w * shrink).round().max(1.0) as u32, (h * shrink).round().max(1.0) as u32);
    match &frame.image {
        Some(image) => imageops::resize(
            &picture::to_rgb(image.to_array().view()),
            width,
            height,
            imageops::FilterType::Triangle,
        ),
        None => RgbImage::from_pixel(width, height, image::Rgb([128; 3])),
    }
}

/// What `rays.npz` holds, F frames (training, then validation), R rays, N samples:
/// `c2ws` (F,4,4) with OpenCV axes, `intrinsics` (F,4) fx fy cx cy, `sizes` (F,2) width height, `size` (2) that of the first,
/// `is_val` (F), `thumbnails` (F,h,w,3),
/// `rays_frame` (R), `rays_uv` (R,2), `rays_rgb` (R,3), `rays_o` (R,3), `rays_d` (R,3), `t` (R,N), `points` (R,N,3), `near`, `far`.
fn arrays(scene: &Scene, shown: &[(Camera, RgbImage)], drawn: &[Drawn]) -> Arrays {
    let (f, r, n) = (shown.len(), drawn.len(), drawn[0].t.len());
    let (width, height) = scene.size();
    let k = |f: usize| shown[f].0.k;
    let (w, h) = (shown[0].1.width() as usize, shown[0].1.height() as usize);
    let thumbnails = Array4::from_shape_fn((f, h, w, 3), |(f, j, i, c)| shown[f].1[(i as u32, j as u32)][c]);
    let scalar = |x: f64| ndarray::arr0(x).into();
    [
        ("c2ws", Array3::from_shape_fn((f, 4, 4), |(f, i, j)| shown[f].0.c2w.col(j)[i]).into()),
        (
            "intrinsics",
            Array2::from_shape_fn((f, 4), |(f, i)| [k(f).fx, k(f).fy, k(f).cx, k(f).cy][i]).into(),
        ),
        (
            "sizes",
            Array2::from_shape_fn((f, 2), |(f, i)| [shown[f].0.width, shown[f].0.height][i] as i64).into(),
        ),
        ("size", Array1::from_vec(vec![width as i64, height as i64]).into()),
        ("is_val", Array1::from_shape_fn(f, |f| u8::from(f >= scene.train.len())).into()),
        ("thumbnails", thumbnails.into()),
        ("rays_frame", Array1::from_shape_fn(r, |r| drawn[r].pixel.image as i64).into()),
        ("rays_uv", Array2::from_shape_fn((r, 2), |(r, i)| drawn[r].pixel.uv[i]).into()),
        ("rays_rgb", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].pixel.rgb[i]).into()),
        ("rays_o", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].ray.o[i]).into()),
        ("rays_d", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].ray.d[i]).into()),
        ("t", Array2::from_shape_fn((r, n), |(r, i)| drawn[r].t[i]).into()),
        ("points", Array3::from_shape_fn((r, n, 3), |(r, i, k)| drawn[r].ray.at(drawn[r].t[i])[k]).into()),
        ("near", scalar(scene.near)),
        ("far", scalar(scene.far)),
    ]
    .into_iter()
    .map(|(name, array)| (name.to_string(), array))
    .collect()
}

/// The object of `--json`.
fn summary(scene: &Scene, files: &[String; 2]) -> serde_json::Value {
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
fn text(scene: &Scene, files: &[String; 2]) -> String {
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
