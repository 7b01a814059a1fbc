//! The loop over a scene: step, probe, validate, log, save.

use std::time::Instant;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::checkpoint::{Checkpoint, RunFolder};
use super::model::{Model, StepReport};
use super::pace::{Pace, Saved};
use super::schedule::{MOST, Schedule};
use super::sound;
use super::watch::{self, Watch};
use crate::error::Result;
use crate::evaluation::{Scores, evaluate, over};
use crate::files::picture;
use crate::loss::psnr;
use crate::random::{Key, Purpose};
use crate::ray::{Ray, camera_ray};
use crate::scene::{Frame, Scene, random_pixel};

/// The most views of a full validation, evenly chosen, unless all are asked for.
const VIEWS: usize = 8;

/// When a run ends, and how it is measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Stop after this step.
    pub steps: Option<u64>,
    /// Stop after this many seconds of wall clock from the first step, everything included.
    pub seconds: Option<f64>,
    /// Stop when the full validation reaches this PSNR, in dB.
    pub stop_at_psnr: Option<f64>,
    /// Full validation every N steps.
    pub val_every: Option<u64>,
    /// Full validation at these steps.
    pub val_at: Vec<u64>,
    /// All views in full validations, however many.
    pub val_all: bool,
    /// The run's seed, for the probe's pixels.
    pub seed: u64,
}

/// One line of `log.jsonl`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogPoint {
    /// Steps done.
    pub step: u64,
    /// Wall clock from the first step, everything included but the full validation at the end.
    pub seconds: f64,
    /// Points with forward and backward so far.
    pub samples: u64,
    /// Loss of this step's batch, before the step.
    pub loss: f64,
    /// Its PSNR; infinite (null in the file) if the batch was reproduced exactly.
    #[serde(deserialize_with = "super::log::decibels")]
    pub train_psnr: f64,
    /// PSNR over seeded pixels of all validation views, [`Schedule::pixels`] of them.
    pub val_probe: Option<f64>,
    /// Mean of the validation views' PSNRs, all pixels.
    pub val_psnr: Option<f64>,
    /// PSNR of their pooled error.
    pub val_psnr_pooled: Option<f64>,
    /// How many views those are.
    #[serde(default)]
    pub val_views: Option<usize>,
}

/// What a run tells while it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum News<'a> {
    /// It was measured.
    Point(&'a LogPoint),
    /// A checkpoint takes `cost` seconds: more than a hundredth of the usual time between two, so they come every so many seconds.
    SlowCheckpoints {
        /// Seconds that one takes.
        cost: f64,
        /// Seconds between two.
        every: f64,
    },
}

/// The state of the loop.
pub struct Run<'a> {
    model: &'a mut dyn Model,
    scene: &'a Scene,
    folder: &'a RunFolder,
    options: &'a Options,
    probe: Vec<(Ray, [f32; 3])>,
    schedule: Schedule,
    watch: Watch,
    step: u64,
    /// Of the wall clock after the last step.
    seconds: f64,
    samples: u64,
    pace: Pace,
    /// The log, earlier parts of a resumed run included.
    pub log: Vec<LogPoint>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Why the run was given up, where it doesn't learn.
    pub failure: Option<String>,
}

impl std::fmt::Debug for Run<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Run").finish_non_exhaustive()
    }
}

impl<'a> Run<'a> {
    /// A run from its first step.
    ///
    /// # Errors
    /// Where a validation pixel has no ray.
    pub fn new(
        model: &'a mut dyn Model,
        scene: &'a Scene,
        folder: &'a RunFolder,
        options: &'a Options,
    ) -> Result<Self> {
        let probe = probe_pixels(scene, options.seed)?;
        let schedule = Schedule::new(options.val_every, &options.val_at);
        let watch = Watch::new(scene, model.start(), model.any_background());
        let (log, warnings, pace) = (vec![], vec![], Pace::new());
        #[rustfmt::skip]
        let run = Run { model, scene, folder, options, probe, schedule, watch, step: 0, seconds: 0.0, samples: 0, pace, log, warnings, failure: None };
        Ok(run)
    }

    /// Resumes from the folder's checkpoint; a run that was stopped before its first begins again.
    ///
    /// # Errors
    /// Where the checkpoint or the log can't be read, or belongs to another model or run.
    pub fn resume(&mut self) -> Result<()> {
        if self.folder.is_before_first_checkpoint() {
            return Ok(());
        }
        let Checkpoint { state, step, seconds, samples } = self.folder.load()?;
        sound::restore(self.model, &state, step, &self.folder.file("checkpoint.npz").display().to_string())?;
        self.watch.restore(&state);
        (self.step, self.seconds, self.samples) = (step, seconds, samples);
        self.log = self.folder.log_until(step)?;
        self.schedule.skip_to(step);
        Ok(())
    }

    /// Steps until an end is reached, `stop` says so, or the run turns out not to learn; `seen` hears of every log point.
    ///
    /// # Errors
    /// Where a step fails or a file can't be written.
    pub fn go(&mut self, stop: impl Fn() -> bool, seen: impl FnMut(News)) -> Result<()> {
        self.go_watched(stop, seen, |_, _| {})
    }

    /// The same; `stepped` sees the model after each step, by its number, and can't change it.
    ///
    /// # Errors
    /// As [`Self::go`].
    pub fn go_watched(
        &mut self,
        stop: impl Fn() -> bool,
        mut seen: impl FnMut(News),
        mut stepped: impl FnMut(u64, &dyn Model),
    ) -> Result<()> {
        if self.step == 0 {
            self.folder.begin_log()?;
            // At once, so that the run can be opened as soon as it has begun.
            self.save(&mut seen)?;
        }
        let (before, start) = (self.seconds, Instant::now());
        while !self.finished() && !stop() {
            let report = self.model.step(self.scene, self.step + 1)?;
            self.seconds = before + start.elapsed().as_secs_f64();
            self.step += 1;
            self.samples += report.samples;
            self.failure = self.watch.failure(self.step, &report);
            stepped(self.step, &*self.model);
            let reached = self.measure(&report, &mut seen)?;
            if self.failure.is_none() && self.pace.due() {
                self.save(&mut seen)?;
            }
            if self.failure.is_some() {
                // The last checkpoint stays: it may be from when the run still learned.
                return Ok(());
            }
            if reached {
                break;
            }
        }
        self.save(&mut seen)?;
        // A run that was interrupted may still learn.
        if self.finished() {
            self.failure = self.unseen_failure();
        }
        Ok(())
    }

    /// What the last full validation says of a run that learned its own pictures, or nothing at all.
    fn unseen_failure(&self) -> Option<String> {
        let last = self.log.last().filter(|last| last.step >= self.model.start())?;
        let frames: Vec<Frame> = validated(self.scene, last.step, self.most())
            .into_iter()
            .map(|(frame, _)| frame.clone())
            .collect();
        watch::unseen_failure(&frames, last.val_psnr_pooled?)
    }

    /// The most views of a full validation.
    fn most(&self) -> usize {
        if self.options.val_all { usize::MAX } else { VIEWS }
    }

    fn finished(&self) -> bool {
        self.options.steps.is_some_and(|n| self.step >= n)
            || self.options.seconds.is_some_and(|s| self.seconds >= s)
    }

    /// Probes and validates where it is due; true when the run has reached its goal.
    fn measure(&mut self, report: &StepReport, seen: &mut impl FnMut(News)) -> Result<bool> {
        let failed = self.failure.is_some();
        let last = self.finished() && !failed;
        let probe_due = self.schedule.probe(self.step);
        let full_due = self.schedule.full(self.step);
        let (mut probe, mut full) = (None, None);
        let mut reached = false;
        if (probe_due.is_some() || last) && !self.probe.is_empty() {
            let value = self.probe_psnr(Schedule::pixels(self.step));
            reached = self.options.stop_at_psnr.is_some_and(|goal| value >= goal);
            probe = Some(value);
        }
        if (full_due || last || reached) && !self.probe.is_empty() {
            let scores = self.validate()?;
            reached = self.options.stop_at_psnr.is_some_and(|goal| scores.psnr >= goal);
            full = Some(scores);
        }
        if probe_due.is_some() || full_due || last || failed {
            let asked = self.model.warning().filter(|_| full.is_some() || failed);
            self.warnings.extend(asked.filter(|warning| !self.warnings.contains(warning)));
            let point = LogPoint {
                step: self.step,
                seconds: self.seconds,
                samples: self.samples,
                loss: report.loss,
                train_psnr: psnr(report.mse, 1.0),
                val_probe: probe,
                val_psnr: full.as_ref().map(|s| s.psnr),
                val_psnr_pooled: full.as_ref().map(|s| s.psnr_pooled),
                val_views: full.as_ref().map(|s| s.views.len()),
            };
            self.folder.log(&point)?;
            seen(News::Point(&point));
            self.log.push(point);
        }
        Ok(reached && full.is_some())
    }

    fn probe_psnr(&self, pixels: usize) -> f64 {
        let probe = &self.probe[..pixels];
        let rays: Vec<Ray> = probe.iter().map(|p| p.0).collect();
        let background = self.scene.background.map(|b| b as f32);
        let mut error = 0.0;
        for (pixel, (_, target)) in self.model.render(&rays).into_iter().zip(probe) {
            let color = over(pixel, background);
            error += (0..3).map(|k| f64::from(color[k].clamp(0.0, 1.0) - target[k]).powi(2)).sum::<f64>();
        }
        psnr(error / (3 * rays.len()) as f64, 1.0)
    }

    fn validate(&self) -> Result<Scores> {
        let background = self.scene.background.map(|b| b as f32);
        let chosen = validated(self.scene, self.step, self.most());
        let frames: Vec<&Frame> = chosen.iter().map(|(frame, _)| *frame).collect();
        let mut files = chosen.iter().map(|(_, file)| file);
        evaluate(&*self.model, frames, background, false, |_, view| {
            let file = files.next().expect("a file for each view that was chosen");
            picture::write_png(&self.folder.file(file), view.rgb.view())
        })
    }

    /// Writes a checkpoint. A state with a number in it that is none isn't kept: the run has failed, and the last good one stays.
    fn save(&mut self, seen: &mut impl FnMut(News)) -> Result<()> {
        let step = self.step;
        let state = || {
            let mut state = self.model.state();
            state.extend(self.watch.state());
            Checkpoint { state, step, seconds: self.seconds, samples: self.samples }
        };
        match self.pace.save(self.folder, state)? {
            Saved::Usual => {}
            Saved::Slow { cost, every } => seen(News::SlowCheckpoints { cost, every }),
            Saved::Spoiled(name) => {
                self.failure =
                    Some(format!("after step {step} not every number of its {name} is finite. Lower `lr`."));
            }
        }
        Ok(())
    }
}

/// The frames that a full validation of at most so many views has after a step, each with its view's file in the run's folder.
pub(crate) fn validated(scene: &Scene, step: u64, most: usize) -> Vec<(&Frame, String)> {
    let views: Vec<&Frame> = scene.val.iter().filter(|frame| frame.image.is_some()).collect();
    let file = |n: usize| format!("views/step{step:06}_view{n:02}.png");
    evenly(views.len(), most).into_iter().map(|n| (views[n], file(n))).collect()
}

/// At most `most` of `count` numbers, as far from each other as from the ends twice over.
fn evenly(count: usize, most: usize) -> Vec<usize> {
    let chosen = count.min(most);
    (0..chosen).map(|n| (2 * n + 1) * count / (2 * chosen)).collect()
}

/// Seeded pixels of all validation views, with their rays and colors.
fn probe_pixels(scene: &Scene, seed: u64) -> Result<Vec<(Ray, [f32; 3])>> {
    let frames: Vec<_> = scene.val.iter().filter(|frame| frame.image.is_some()).collect();
    if frames.is_empty() {
        return Ok(vec![]);
    }
    let key = Key::new(seed, Purpose::Probe);
    let pixel = |n: usize| {
        let [frame, j, i] = random_pixel(&frames, &key, 0, n as u64);
        let frame = frames[frame];
        let image = frame.image.as_ref().expect("kept those that have one");
        let ray = camera_ray(&frame.camera, DVec2::new(i as f64 + 0.5, j as f64 + 0.5))?;
        Ok((ray, image.at(j, i)))
    };
    (0..MOST).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_chosen_evenly() {
        assert_eq!(evenly(3, 8), [0, 1, 2]);
        assert_eq!(evenly(8, 8), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(evenly(100, 8), [6, 18, 31, 43, 56, 68, 81, 93]);
        assert!(evenly(0, 8).is_empty());
    }

    /// A line of before this version has no number of views.
    #[test]
    fn older_lines_are_read() {
        let old = r#"{"step":1,"seconds":0.5,"samples":9,"loss":0.1,"train_psnr":10.0,"val_probe":null,"val_psnr":9.0,"val_psnr_pooled":9.0}"#;
        let point: LogPoint = serde_json::from_str(old).unwrap();
        assert_eq!((point.val_views, point.val_psnr), (None, Some(9.0)));
        assert!(serde_json::to_string(&point).unwrap().contains(r#""val_views":null"#));
    }
}
