//! `render RUN --out FILE.gif|DIR`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::{DMat4, DVec3};
use image::RgbImage;
use ndarray::Array3;
use serde_json::json;

use super::evaluate::open;
use super::options::{Backend, at_most, color, size, threads};
use super::{output, progress};
use crate::camera::{Camera, Intrinsics};
use crate::error::Result;
use crate::evaluation::{View, render_view};
use crate::files::{self, picture};
use crate::limits::{self, FRAMES};
use crate::parallel;
use crate::report::film;
use crate::scene::Scene;

/// Options of `render`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The folder of a run.
    pub run: PathBuf,
    /// A .gif, or a folder for frames as PNG and a film.gif.
    #[arg(long)]
    pub out: PathBuf,
    /// The cameras: the scene's test path, or a circle of N around the scene. The test path where there is one.
    #[arg(long, value_parser = path)]
    pub path: Option<CameraPath>,
    /// The color behind everything: black, white or R,G,B.
    #[arg(long, value_parser = color)]
    pub background: Option<[f64; 3]>,
    /// Picture size; the photographs' by default.
    #[arg(long, value_parser = size)]
    pub size: Option<(usize, usize)>,
    /// Depth (near white, far black) in the place of color.
    #[arg(long)]
    pub depth: bool,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
    /// Which path computes.
    #[arg(long, value_enum, default_value_t = Backend::Fast)]
    pub backend: Backend,
}

/// The cameras of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CameraPath {
    /// The scene's own.
    Test,
    /// A circle of this many cameras.
    Orbit(usize),
}

fn path(text: &str) -> Result<CameraPath, String> {
    match text.split_once(':') {
        None if text == "test" => Ok(CameraPath::Test),
        Some(("orbit", n)) => Ok(CameraPath::Orbit(at_most::<FRAMES>(n)?)),
        _ => Err("expected test or orbit:N, such as orbit:60".into()),
    }
}

/// Runs `render`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        let (frames, out) = (render(args)?, args.out.display().to_string());
        output::print(json, &json!({"out": out, "frames": frames}), &format!("{out}: {frames} frames\n"))?;
        Ok(ExitCode::SUCCESS)
    })
}

/// Renders as `args` say; returns how many frames.
pub(super) fn render(args: &Args) -> Result<usize> {
    if is_film(&args.out) { files::check_replaceable(&args.out) } else { files::check_writable(&args.out) }?;
    let trained = open(&args.run, args.backend, false)?;
    let scene = &trained.scene;
    let cameras = cameras(args, scene)?;
    let background = args.background.unwrap_or(scene.background).map(|b| b as f32);
    let bar = progress::bar(Some(cameras.len() as u64), "render");
    let mut frames = vec![];
    for camera in &cameras {
        let view = render_view(&*trained.model, camera, background)?;
        let rgb = if args.depth { depth_picture(&view, scene.near, scene.far) } else { view.rgb };
        frames.push(picture::to_rgb(rgb.view()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    write(&args.out, &frames)?;
    Ok(frames.len())
}

fn is_film(out: &Path) -> bool {
    out.extension().is_some_and(|e| e.eq_ignore_ascii_case("gif"))
}

/// One GIF, or a folder with frames and a film.
pub(super) fn write(out: &Path, frames: &[RgbImage]) -> Result<()> {
    const FRAMES_PER_SECOND: u32 = 20;
    if is_film(out) {
        return film::write_gif(out, frames, FRAMES_PER_SECOND);
    }
    files::make_folder(out)?;
    for (n, frame) in frames.iter().enumerate() {
        picture::write_rgb(&out.join(format!("frame_{n:04}.png")), frame)?;
    }
    film::write_gif(&out.join("film.gif"), frames, FRAMES_PER_SECOND)
}

/// Near white, far black, empty rays black.
fn depth_picture(view: &View, near: f64, far: f64) -> Array3<f32> {
    let (h, w) = view.depth.dim();
    Array3::from_shape_fn((h, w, 3), |(j, i, _)| {
        let nearness = (far as f32 - view.depth[[j, i]]) / (far - near) as f32;
        nearness.clamp(0.0, 1.0) * view.opacity[[j, i]].clamp(0.0, 1.0)
    })
}

fn cameras(args: &Args, scene: &Scene) -> Result<Vec<Camera>> {
    let chosen =
        args.path.unwrap_or(if scene.test.is_empty() { CameraPath::Orbit(60) } else { CameraPath::Test });
    let mut cameras: Vec<Camera> = match chosen {
        CameraPath::Test => scene.test.iter().map(|frame| frame.camera).collect(),
        CameraPath::Orbit(n) => orbit(scene, n),
    };
    film::check_count(cameras.len(), &scene.name)?;
    if let Some((width, height)) = args.size {
        cameras.iter_mut().for_each(|camera| *camera = resized(camera, width, height));
    }
    let (frames, Camera { width, height, .. }) = (cameras.len(), cameras[0]);
    let what = format!("{frames} frames of {width}x{height}");
    let bytes = (width * height) as f64 * (limits::VIEW_PIXEL + limits::KEPT_PIXEL * frames as f64);
    limits::fits(what, bytes, "Lower `size`, or render fewer frames with `path` orbit:N.")?;
    Ok(cameras)
}

/// The same field of view on another grid of pixels: K scales with the picture, the principal point with it.
fn resized(camera: &Camera, width: usize, height: usize) -> Camera {
    let (sx, sy) = (width as f64 / camera.width as f64, height as f64 / camera.height as f64);
    let Intrinsics { fx, fy, cx, cy } = camera.k;
    Camera { width, height, k: Intrinsics { fx: fx * sx, fy: fy * sy, cx: cx * sx, cy: cy * sy }, ..*camera }
}

/// A circle of cameras that look at the scene's focus, with the mean distance, height and up direction of the training cameras; where
/// those stand on one side only (a hand-held capture), an ellipse among them instead of a path around the back.
fn orbit(scene: &Scene, count: usize) -> Vec<Camera> {
    let first = scene.train[0].camera;
    let places: Vec<DVec3> = scene.train.iter().map(|f| f.camera.c2w.w_axis.truncate()).collect();
    let n = places.len() as f64;
    let up =
        -scene.train.iter().map(|f| f.camera.c2w.y_axis.truncate()).sum::<DVec3>().normalize_or(DVec3::NEG_Z);
    let mean = places.iter().sum::<DVec3>() / n;
    let offset = mean - scene.focus;
    let distance = places.iter().map(|p| (*p - scene.focus).length()).sum::<f64>() / n;
    let around = (offset - up * offset.dot(up)).length() < 0.5 * distance;
    let (center, a, b) = if around {
        let height = up * offset.dot(up);
        let radius = (distance * distance - height.length_squared()).max(0.0).sqrt();
        let (x, y) = up.any_orthonormal_pair();
        (scene.focus + height, x * radius, y * radius)
    } else {
        let forward = -offset.normalize();
        let right = forward.cross(up).normalize_or(forward.any_orthonormal_vector());
        let spread =
            |axis: DVec3| (places.iter().map(|p| (*p - mean).dot(axis).powi(2)).sum::<f64>() / n).sqrt();
        (mean, right * spread(right), right.cross(forward) * spread(right.cross(forward)))
    };
    let place = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        center + a * angle.cos() + b * angle.sin()
    };
    (0..count).map(|k| Camera { c2w: look_at(place(k), scene.focus, up), ..first }).collect()
}

/// A pose with OpenCV axes at `eye` that looks at `target`, its picture upright.
fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let z = (target - eye).normalize_or(DVec3::Z);
    let x = z.cross(up).normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x);
    DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), eye.extend(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_at_its_target_with_up_up() {
        let pose = look_at(DVec3::new(0.0, -4.0, 1.0), DVec3::ZERO, DVec3::Z);
        let (x, y, z) = (pose.x_axis.truncate(), pose.y_axis.truncate(), pose.z_axis.truncate());
        assert!((x.cross(y) - z).length() < 1e-12, "right-handed");
        assert!(y.z < 0.0, "the picture's down is the world's down");
        assert!(((DVec3::ZERO - DVec3::new(0.0, -4.0, 1.0)).normalize() - z).length() < 1e-12);
    }

    #[test]
    fn paths_parse() {
        assert_eq!(path("orbit:12"), Ok(CameraPath::Orbit(12)));
        assert_eq!(path("test"), Ok(CameraPath::Test));
        assert!(path("orbit:0").is_err() && path("circle").is_err());
    }
}
