//! A run's page, and that of an evaluation: views beside photographs, the worst first.

use std::path::Path;

use super::output::decibels;
use crate::error::Result;
use crate::evaluation::{Scores, ViewScore, score};
use crate::files::{self, picture};
use crate::parallel;
use crate::report::page::Page;
use crate::report::views::{self, Shown};
use crate::scene::{Frame, Scene};
use crate::training::checkpoint::RunFolder;
use crate::training::run::{Run, Validated};

/// Writes `index.html` into a run's folder: its figures, its curve, the views of its last full validation.
///
/// # Errors
/// Where a file can't be read or written.
pub(super) fn write(
    folder: &RunFolder,
    scene: &Scene,
    run: &Run,
    warnings: &[String],
    failure: Option<&str>,
) -> Result<()> {
    let name = &scene.name;
    let lead = match failure {
        Some(why) => format!("This run of {name} doesn't learn: {why}"),
        None => format!("A field that was trained on {} photographs of {name}.", scene.train.len()),
    };
    let mut page = Page::new("A trained field", &lead);
    page.warnings(&scene.warnings).warnings(warnings);
    if let Some(last) = run.log.last() {
        let full = run.log.iter().rev().find_map(|point| point.val_psnr);
        let rows = [
            ("steps", last.step.to_string()),
            ("seconds", format!("{:.1}", last.seconds)),
            ("points learned from", last.samples.to_string()),
            ("PSNR of views that it has never seen, dB", decibels(full)),
            ("PSNR of the last batch, dB", decibels(Some(last.train_psnr))),
        ];
        page.table(&["figure", "value"], &rows.map(|(name, value)| vec![name.to_string(), value]));
    }
    page.heading("Training").picture("psnr.svg", "PSNR over steps", 720);
    let shown = run.validated.as_ref().map(|validated| of_run(folder, scene, validated)).transpose()?;
    views::add(&mut page, shown.unwrap_or_default());
    files::write(&folder.file("index.html"), page.finish())
}

/// The views of a validation, which are in the folder, with photographs and differences beside them.
fn of_run(folder: &RunFolder, scene: &Scene, validated: &Validated) -> Result<Vec<Shown>> {
    let one = |n: usize| {
        let (frame, file) = (&scene.val[validated.frames[n]], &validated.files[n]);
        let view = picture::read(&folder.file(file))?;
        let photograph = frame.image.as_ref().expect("validation frames have photographs").to_array();
        // The PSNR is that of the log, without rounding to bytes; SSIM hardly sees that.
        let score = ViewScore {
            ssim: score(&frame.name, view.view(), photograph.view(), true).ssim,
            ..validated.scores.views[n].clone()
        };
        let beside = |what: &str| format!("views/view{n:02}_{what}.png");
        let shown = Shown { score, files: [file.clone(), beside("photograph"), beside("difference")] };
        views::write(&folder.file(""), &shown, &view, &photograph)?;
        Ok(shown)
    };
    parallel::map(validated.frames.len(), one).into_iter().collect()
}

/// An evaluation's page as it grows: each view is written when it has been rendered.
pub(super) struct Evaluated<'a> {
    folder: &'a Path,
    files: Vec<[String; 3]>,
}

impl<'a> Evaluated<'a> {
    /// Into this folder.
    pub(super) fn new(folder: &'a Path) -> Result<Self> {
        files::make_folder(&folder.join("views"))?;
        Ok(Evaluated { folder, files: vec![] })
    }

    /// The next view.
    pub(super) fn add(&mut self, frame: &Frame, view: &ndarray::Array3<f32>) -> Result<()> {
        let n = self.files.len();
        let files = ["view", "photograph", "difference"].map(|what| format!("views/{n:03}_{what}.png"));
        let Some(photograph) = frame.image.as_ref().map(|image| image.to_array()) else { return Ok(()) };
        picture::write_png(&self.folder.join(&files[0]), view.view())?;
        picture::write_png(&self.folder.join(&files[1]), photograph.view())?;
        picture::write_rgb(&self.folder.join(&files[2]), &views::difference(view, &photograph))?;
        self.files.push(files);
        Ok(())
    }

    /// Once all views are there.
    pub(super) fn finish(self, scores: &Scores, scene: &Scene, step: u64) -> Result<()> {
        let lead = format!("{} views of {} after {step} steps.", scores.views.len(), scene.name);
        let mut page = Page::new("An evaluated field", &lead);
        let rows = [
            ("mean of the views' PSNRs, dB", format!("{:.2}", scores.psnr)),
            ("PSNR of the mean error, dB", format!("{:.2}", scores.psnr_pooled)),
            ("mean of the views' SSIMs", scores.ssim.map_or("-".into(), |ssim| format!("{ssim:.4}"))),
        ];
        page.table(&["figure", "value"], &rows.map(|(name, value)| vec![name.to_string(), value]));
        let views = scores.views.iter().cloned().zip(self.files);
        views::add(&mut page, views.map(|(score, files)| Shown { score, files }).collect());
        files::write(&self.folder.join("index.html"), page.finish())
    }
}
