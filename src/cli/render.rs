//! `render RUN --out FILE.gif|DIR`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use image::RgbImage;
use serde_json::{Value, json};

use super::evaluate::{Trained, open};
use super::options::{Backend, at_most, color, size, threads};
use super::parts::Merged;
use super::shard::{self, Piece, Shard};
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
    /// I/N: every Nth frame from the Ith on, as a part for merge, in the folder --out.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
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
    let asked = Asked::new(args)?;
    let frames = asked.frames(args)?;
    let count = frames.len();
    match args.shard {
        None => write(&args.out, &frames)?,
        Some(shard) => {
            let piece = |(number, picture)| Piece { number, value: Value::Null, picture: Some(picture) };
            let pieces = asked.mine(args).zip(frames).map(piece).collect();
            shard::write(&args.out, shard, &asked.work(args)?, asked.cameras.len(), pieces)?;
        }
    }
    Ok(count)
}

/// The frames as `args` say, once it is known that they can be written.
pub(super) fn frames(args: &Args) -> Result<Vec<RgbImage>> {
    Asked::new(args)?.frames(args)
}

/// Whether a film, or a folder, can be written there.
fn check(out: &Path) -> Result<()> {
    match Format::of(out) {
        Some(format) => files::check_replaceable(out).and_then(|()| format.check(out)),
        None => files::check_writable(out),
    }
}

/// A model, and what is asked of it.
struct Asked {
    trained: Trained,
    cameras: Vec<Camera>,
    background: [f32; 3],
}

impl Asked {
    fn new(args: &Args) -> Result<Asked> {
        if args.shard.is_some() { files::check_writable(&args.out) } else { check(&args.out) }?;
        let trained = open(&args.run, args.backend, false)?;
        let cameras = cameras(args, &trained.scene)?;
        let background = args.background.unwrap_or(trained.scene.background).map(|b| b as f32);
        Ok(Asked { trained, cameras, background })
    }

    /// The numbers of the frames of this shard.
    fn mine(&self, args: &Args) -> impl Iterator<Item = usize> {
        let shard = args.shard;
        (0..self.cameras.len()).filter(move |n| shard::has(shard, *n))
    }

    fn frames(&self, args: &Args) -> Result<Vec<RgbImage>> {
        let scene = &self.trained.scene;
        let bar = progress::bar(Some(self.mine(args).count() as u64), "render");
        let mut frames = vec![];
        for n in self.mine(args) {
            let view = render_view(&*self.trained.model, &self.cameras[n], self.background)?;
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

    /// All that determines the frames.
    fn work(&self, args: &Args) -> Result<Value> {
        Ok(json!({
            "command": "render", "version": env!("CARGO_PKG_VERSION"), "step": self.trained.step,
            "checkpoint": shard::of_file(&args.run.join("checkpoint.npz"))?,
            "cameras": shard::of_cameras(&self.cameras),
            "backend": args.backend, "background": self.background, "depth": args.depth,
        }))
    }
}

/// The film of parts; returns how many frames.
pub(super) fn merge(whole: &Merged, out: &Path) -> Result<usize> {
    check(out)?;
    let frames = whole.pictures()?;
    write(out, &frames)?;
    Ok(frames.len())
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
