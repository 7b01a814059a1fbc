//! A run's page, and that of an evaluation: views beside photographs, the worst first.

use std::path::Path;

use serde_json::Value;

use super::output::decibels;
use crate::error::Result;
use crate::evaluation::{Scores, score_photo};
use crate::files::{self, picture};
use crate::report::page::Page;
use crate::report::views::{self, Shown};
use crate::scene::{Frame, Scene};
use crate::training::checkpoint::RunFolder;
use crate::training::run::{LogPoint, validated};

/// Writes `index.html` into a run's folder: its figures, its curve, the views of its last full validation. Of what is in the folder
/// alone, without times, so that a run that was stopped and resumed has the same page.
///
/// # Errors
/// Where a file can't be read or written.
pub(super) fn write(
    folder: &RunFolder,
    scene: &Scene,
    log: &[LogPoint],
    warnings: &[Value],
    failure: Option<&str>,
) -> Result<()> {
    let name = &scene.name;
    let lead = match failure {
        Some(why) => format!("This run of {name} doesn't learn: {why}"),
        None => format!("A field that was trained on {} photographs of {name}.", scene.train.len()),
    };
    let mut page = Page::new("A trained field", &lead);
    page.warnings(&warnings.iter().filter_map(|said| Some(said.as_str()?.into())).collect::<Vec<String>>());
    if let Some(last) = log.last() {
        let full = log.iter().rev().find_map(|point| point.val_psnr);
        let rows = [
            ("steps", last.step.to_string()),
            ("points learned from", last.samples.to_string()),
            ("PSNR of views that it has never seen, dB", decibels(full)),
            ("PSNR of the last batch, dB", decibels(Some(last.train_psnr))),
        ];
        page.table(&["figure", "value"], &rows.map(|(name, value)| vec![name.to_string(), value]));
    }
    page.heading("Training").picture("psnr.svg", "PSNR over steps", 720);
    views::add(&mut page, of_run(folder, scene, log)?);
    files::write(&folder.file("index.html"), page.finish())
}

/// The views of the log's last full validation, which are in the folder, with photographs and differences beside them.
fn of_run(folder: &RunFolder, scene: &Scene, log: &[LogPoint]) -> Result<Vec<Shown>> {
    let Some(point) = log.iter().rev().find(|point| point.val_psnr.is_some()) else { return Ok(vec![]) };
    // Older logs don't say how many views they had.
    let most = point.val_views.unwrap_or(0);
    let chosen = validated(scene, point.step, most);
    let one = |(n, (frame, file)): (usize, &(&Frame, String))| {
        let view = picture::read(&folder.file(file))?;
        let photograph = frame.image.as_ref().expect("validation frames have photographs");
        let score = score_photo(&frame.name, &view, photograph, true);
        // Without the step: those of an earlier page are replaced.
        let beside = |what: &str| format!("views/{what}_view{n:02}.png");
        let shown = Shown { score, files: [file.clone(), beside("photograph"), beside("difference")] };
        views::write(&folder.file(""), &shown.files, &view, &photograph.to_array())?;
        Ok(shown)
    };
    // People may have tidied up.
    let there = chosen.iter().enumerate().filter(|(_, (_, file))| folder.file(file).exists());
    there.map(one).collect()
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
        views::write(self.folder, &files, view, &photograph)?;
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
