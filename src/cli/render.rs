//! `render RUN --out FILE.gif|DIR`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use image::RgbImage;
use serde_json::json;

use super::evaluate::open;
use super::options::{Backend, at_most, color, size, threads};
use super::{output, progress};
use crate::camera::Camera;
use crate::error::Result;
use crate::evaluation::render_view;
use crate::files::{self, picture};
use crate::limits::{self, FRAMES};
use crate::parallel;
use crate::report::depth;
use crate::report::film::{self, Format};
use crate::scene::{Scene, path};

/// Options of `render`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The folder of a run.
    pub run: PathBuf,
    /// A .gif, a .png (animated, in full color), an .mp4 (by ffmpeg), or a folder for frames as PNG and a film.gif.
    #[arg(long)]
    pub out: PathBuf,
    /// The cameras: test, the scene's test path; orbit:N, a circle around it; spiral:N, a spiral before it; capture:N, the capture's own
    /// path, smoothed; KEYS.json or KEYS.json:N, through key cameras (frames with transform_matrix). The test path where there is one.
    #[arg(long, value_parser = camera_path)]
    pub path: Option<CameraPath>,
    /// The color behind everything: black, white or R,G,B.
    #[arg(long, value_parser = color)]
    pub background: Option<[f64; 3]>,
    /// Picture size; the photographs' by default.
    #[arg(long, value_parser = size)]
    pub size: Option<(usize, usize)>,
    /// Depth in the place of color: viridis, near bright and far dark, with its scale under each frame.
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum CameraPath {
    /// The scene's own.
    Test,
    /// A circle of this many cameras.
    Orbit(usize),
    /// A spiral of this many, for cameras that stand side by side.
    Spiral(usize),
    /// So many along the capture's own path.
    Capture(usize),
    /// Through the key cameras of a JSON file: so many in all.
    Keys(PathBuf, Option<usize>),
}

fn camera_path(text: &str) -> Result<CameraPath, String> {
    match text.split_once(':') {
        None if text == "test" => Ok(CameraPath::Test),
        Some(("orbit", n)) => Ok(CameraPath::Orbit(at_most::<FRAMES>(n)?)),
        Some(("spiral", n)) => Ok(CameraPath::Spiral(at_most::<FRAMES>(n)?)),
        Some(("capture", n)) => Ok(CameraPath::Capture(at_most::<FRAMES>(n)?)),
        _ if text.ends_with(".json") => Ok(CameraPath::Keys(text.into(), None)),
        _ => match text.rsplit_once(':') {
            Some((file, n)) if file.ends_with(".json") => {
                Ok(CameraPath::Keys(file.into(), Some(at_most::<FRAMES>(n)?)))
            }
            _ => Err("expected test, orbit:N (such as orbit:60), spiral:N, capture:N, or KEYS.json".into()),
        },
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

/// Renders and writes as `args` say; returns how many frames.
fn render(args: &Args) -> Result<usize> {
    let frames = frames(args)?;
    write(&args.out, &frames)?;
    Ok(frames.len())
}

/// The frames as `args` say, once it is known that they can be written.
pub(super) fn frames(args: &Args) -> Result<Vec<RgbImage>> {
    match Format::of(&args.out) {
        Some(format) => files::check_replaceable(&args.out).and_then(|()| format.check(&args.out))?,
        None => files::check_writable(&args.out)?,
    }
    let trained = open(&args.run, args.backend, false)?;
    let scene = &trained.scene;
    let cameras = cameras(args, scene)?;
    let background = args.background.unwrap_or(scene.background).map(|b| b as f32);
    let bar = progress::bar(Some(cameras.len() as u64), "render");
    let mut frames = vec![];
    for camera in &cameras {
        let view = render_view(&*trained.model, camera, background)?;
        frames.push(if args.depth {
            depth::with_scale(&depth::picture(&view, scene.near, scene.far), scene.near, scene.far)
        } else {
            picture::to_rgb(view.rgb.view())
        });
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(frames)
}

/// One film, or a folder with frames and a film.
pub(super) fn write(out: &Path, frames: &[RgbImage]) -> Result<()> {
    const FRAMES_PER_SECOND: u16 = 20;
    if let Some(format) = Format::of(out) {
        return format.write(out, frames, FRAMES_PER_SECOND);
    }
    files::make_folder(out)?;
    for (n, frame) in frames.iter().enumerate() {
        picture::write_rgb(&out.join(format!("frame_{n:04}.png")), frame)?;
    }
    Format::Gif.write(&out.join("film.gif"), frames, FRAMES_PER_SECOND)
}

fn cameras(args: &Args, scene: &Scene) -> Result<Vec<Camera>> {
    let chosen = args.path.clone().unwrap_or(if scene.test.is_empty() {
        CameraPath::Orbit(60)
    } else {
        CameraPath::Test
    });
    let mut cameras: Vec<Camera> = match chosen {
        CameraPath::Test => scene.test.iter().map(|frame| frame.camera).collect(),
        CameraPath::Orbit(n) => path::orbit(scene, n),
        CameraPath::Spiral(n) => path::spiral(scene, n),
        CameraPath::Capture(n) => path::smoothed(scene, n),
        CameraPath::Keys(file, n) => path::through(&file, scene, n)?,
    };
    film::check_count(cameras.len(), &scene.name)?;
    // A film has one size.
    let first = (cameras[0].width, cameras[0].height);
    let mixed = cameras.iter().any(|camera| (camera.width, camera.height) != first);
    if let Some((width, height)) = args.size.or(mixed.then_some(first)) {
        cameras.iter_mut().for_each(|camera| *camera = path::resized(camera, width, height));
    }
    let (frames, Camera { width, height, .. }) = (cameras.len(), cameras[0]);
    let what = format!("{frames} frames of {width}x{height}");
    let bytes = (width * height) as f64 * (limits::VIEW_PIXEL + limits::KEPT_PIXEL * frames as f64);
    limits::fits(what, bytes, "Lower `size`, or render fewer frames with `path` orbit:N.")?;
    Ok(cameras)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_parse() {
        for (text, path) in [
            ("orbit:12", CameraPath::Orbit(12)),
            ("test", CameraPath::Test),
            ("spiral:7", CameraPath::Spiral(7)),
            ("capture:9", CameraPath::Capture(9)),
            ("a/b.json", CameraPath::Keys("a/b.json".into(), None)),
            ("C:/b.json:5", CameraPath::Keys("C:/b.json".into(), Some(5))),
        ] {
            assert_eq!(camera_path(text), Ok(path));
        }
        for bad in ["orbit:0", "circle", "spiral", "spiral:x", "capture:-1", "b.json:0", "b.json:x", "b.txt"]
        {
            assert!(camera_path(bad).is_err(), "{bad}");
        }
    }
}
