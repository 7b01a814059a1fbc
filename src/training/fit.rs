//! The loop over a picture: step, measure, log, save.

use ndarray::Array3;

use super::checkpoint::{Checkpoint, RunFolder};
use super::image::{Fit, FitSettings, LogPoint, kept};
use super::pace::{Pace, Saved};
use super::sound;
use crate::error::Result;

/// A fit in its folder.
pub struct FitRun<'a> {
    fit: Fit,
    picture: &'a Array3<f32>,
    settings: &'a FitSettings,
    folder: &'a RunFolder,
    pace: Pace,
    /// The log, earlier parts of a resumed fit included.
    pub log: Vec<LogPoint>,
    /// Why the fit was given up.
    pub failure: Option<String>,
}

impl std::fmt::Debug for FitRun<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("FitRun").finish_non_exhaustive()
    }
}

impl<'a> FitRun<'a> {
    /// A fit from its first step.
    pub fn new(picture: &'a Array3<f32>, settings: &'a FitSettings, folder: &'a RunFolder) -> Self {
        FitRun {
            fit: Fit::new(settings),
            picture,
            settings,
            folder,
            pace: Pace::new(),
            log: vec![],
            failure: None,
        }
    }

    /// Resumes from the folder's checkpoint; a fit that was stopped before its first begins again.
    ///
    /// # Errors
    /// Where the checkpoint or the log can't be read, or belongs to another fit.
    pub fn resume(&mut self) -> Result<()> {
        if self.folder.is_before_first_checkpoint() {
            return Ok(());
        }
        let Checkpoint { state, step, seconds, .. } = self.folder.load()?;
        let file = self.folder.file("checkpoint.npz").display().to_string();
        sound::numbers(&state, step, &file)?;
        self.fit.restore(&state, step, seconds, &file)?;
        self.log = self.folder.log_until(step)?;
        Ok(())
    }

    /// Steps to the last, until `stop` says so, or until a number isn't finite. `seen` gets each log point with its picture, before
    /// the log has it; `slow` what a checkpoint costs and how seldom it is written then, in seconds, once.
    ///
    /// # Errors
    /// Those of `seen`, and where a file can't be written.
    pub fn go(
        &mut self,
        stop: impl Fn() -> bool,
        mut seen: impl FnMut(&LogPoint, &Array3<f32>) -> Result<()>,
        mut progress: impl FnMut(u64, f64),
        mut slow: impl FnMut(f64, f64),
    ) -> Result<()> {
        if self.fit.step == 0 {
            self.folder.begin_log()?;
            self.save(&mut slow)?;
        }
        while self.fit.step < self.settings.steps && self.failure.is_none() && !stop() {
            let loss = self.fit.step(self.picture);
            if !loss.is_finite() {
                // The last checkpoint stays.
                self.failure = Some(format!("the loss at step {} is {loss}", self.fit.step));
                return Ok(());
            }
            if kept(self.fit.step, self.settings.steps) {
                let (point, fitted) = self.fit.measure(self.picture, loss);
                seen(&point, &fitted)?;
                self.folder.log(&point)?;
                self.log.push(point);
            }
            progress(self.fit.step, loss);
            if self.pace.due() {
                self.save(&mut slow)?;
            }
        }
        if self.failure.is_none() { self.save(&mut slow) } else { Ok(()) }
    }

    fn save(&mut self, slow: &mut impl FnMut(f64, f64)) -> Result<()> {
        let Fit { step, seconds, .. } = self.fit;
        let samples = step * self.settings.batch as u64;
        let state = || self.fit.state().into_iter();
        let saved = self.pace.save(self.folder, || Checkpoint { state: state(), step, seconds, samples })?;
        match saved {
            Saved::Usual => {}
            Saved::Slow { cost, every } => slow(cost, every),
            Saved::Spoiled(name) => {
                self.failure = Some(format!("after step {step} not every number of its {name} is finite"));
            }
        }
        Ok(())
    }
}
