//! `demo`: a tour in about a minute, with nothing but this program.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use super::evaluate::{self, Trained};
use super::options::{Backend, positive_number};
use super::{output, render, train};
use crate::error::Result;
use crate::evaluation::{camera_rays, render_view};
use crate::files::{self, picture};
use crate::report::page::Page;
use crate::report::{sheet, table};

/// Options of `demo`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The output folder.
    #[arg(long, default_value = "out/demo")]
    pub out: PathBuf,
    /// Training time.
    #[arg(long, default_value_t = SECONDS, value_parser = positive_number)]
    pub seconds: f64,
}

/// The scene that the demo trains.
const SCENE: &str = "builtin:spheres,size=128";

/// Largest difference of a color between the f32 path and the f64 reference that the demo accepts.
const TOLERANCE: f64 = 1e-5;

/// The default seconds of training, and the validation PSNR that they must reach.
const SECONDS: f64 = 40.0;
const LEARNED: f64 = 25.0;

/// Rays on which the two are compared.
const CHECKED_RAYS: usize = 64;

/// Frames of the film.
const FRAMES: usize = 40;

/// Runs `demo`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let run = args.out.join("run");
    output::note(&format!("Training a small network on {SCENE} for {} s ...", args.seconds));
    let summary = train::train(&training(args, &run))?;
    if let Some(signal) = summary.stopped {
        return Ok(signal.end("what was trained is kept"));
    }
    output::note("Checking the f32 path against the f64 reference ...");
    let trained = evaluate::open(&run, Backend::Fast, false)?;
    let difference = largest_difference(&trained, &evaluate::open(&run, Backend::Reference, false)?)?;
    output::note(&format!("Rendering a film of {FRAMES} frames ..."));
    let frames = render::frames(&film(&run, &args.out.join("film.png")))?;
    // In full color for the page, and as what every program shows.
    ["film.png", "film.gif"].iter().try_for_each(|name| render::write(&args.out.join(name), &frames))?;
    write_comparison(&trained, &args.out.join("comparison.png"))?;
    let rows = vec![
        vec!["validation PSNR, dB".into(), output::decibels(summary.val_psnr)],
        vec!["steps".into(), trained.step.to_string()],
        vec![
            "largest difference of a color, f32 path against f64 reference".into(),
            format!("{difference:.1e}"),
        ],
    ];
    write_page(&args.out, &rows)?;
    // Within its default seconds it has to learn the scene, too.
    let learned = summary.failure.is_none()
        && (args.seconds < SECONDS || summary.val_psnr.is_some_and(|psnr| psnr >= LEARNED));
    let (ok, page) = (difference <= TOLERANCE && learned, args.out.join("index.html").display().to_string());
    let object = json!({
        "out": args.out.display().to_string(), "page": page, "train": summary.object, "val_psnr": summary.val_psnr,
        "largest_difference_from_reference": difference, "tolerance": TOLERANCE, "wanted_psnr": LEARNED, "ok": ok,
    });
    output::print(json, &object, &(table::text(&["figure", "value"], &rows) + &format!("Open {page}\n")))?;
    Ok(if ok { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// A network of width 64 and batches small enough for a minute.
fn training(args: &Args, run: &Path) -> train::Args {
    train::Args {
        seconds: Some(args.seconds),
        width: Some(64),
        rays: Some(512),
        samples: Some(48),
        lr: Some(2e-3),
        overwrite: true,
        ..train::Args::new(SCENE, run)
    }
}

fn film(run: &Path, out: &Path) -> render::Args {
    render::Args {
        run: run.to_path_buf(),
        out: out.to_path_buf(),
        path: Some(render::CameraPath::Orbit(FRAMES)),
        background: None,
        size: Some((128, 128)),
        depth: false,
        threads: None,
        shard: None,
        backend: Backend::Fast,
    }
}

/// The same parameters on the same rays of the first validation view: those of the largest opacity, since an empty ray agrees with
/// anything.
fn largest_difference(fast: &Trained, reference: &Trained) -> Result<f64> {
    let all = camera_rays(&fast.scene.val[0].camera)?;
    let mut seen: Vec<_> = fast.model.render(&all).into_iter().zip(all).collect();
    seen.sort_by(|(a, _), (b, _)| b.opacity.total_cmp(&a.opacity));
    seen.truncate(CHECKED_RAYS);
    let (pixels, rays): (Vec<_>, Vec<_>) = seen.into_iter().unzip();
    let mut largest = 0.0;
    for (a, b) in pixels.iter().zip(reference.model.render(&rays)) {
        for k in 0..3 {
            largest = f64::max(largest, f64::from((a.rgb[k] - b.rgb[k]).abs()));
        }
    }
    // All rays are empty, so nothing was checked.
    Ok(if pixels[0].opacity > 0.0 { largest } else { f64::NAN })
}

/// Photographs above, rendered views below.
fn write_comparison(trained: &Trained, path: &Path) -> Result<()> {
    let (mut photographs, mut views) = (vec![], vec![]);
    for frame in trained.scene.val.iter().take(4) {
        let Some(image) = &frame.image else { continue };
        photographs.push(picture::to_rgb(image.to_array().view()));
        let view = render_view(&*trained.model, &frame.camera, trained.scene.background.map(|b| b as f32))?;
        views.push(picture::to_rgb(view.rgb.view()));
    }
    let columns = views.len();
    photographs.extend(views);
    picture::write_rgb(path, &sheet::contact_sheet(&photographs, columns))
}

fn write_page(out: &Path, rows: &[Vec<String>]) -> Result<()> {
    let lead = "A neural radiance field, trained on pictures of a scene with closed-form density and color, checked \
                against the f64 reference, and rendered from cameras that it has never seen.";
    let mut page = Page::new("nerf-oracle demo", lead);
    page.table(&["figure", "value"], rows)
        .heading("Film")
        .picture("film.png", "an orbit of new views", 384)
        .heading("Validation views")
        .picture("comparison.png", "photographs above, the field's views below", 540)
        .heading("Training")
        .picture("run/psnr.svg", "PSNR over steps", 720);
    files::write(&out.join("index.html"), page.finish())
}
