//! Whether a run learns: what `train` gives up on, with the reason and what to try.

use std::collections::VecDeque;

use ndarray::Array1;

use super::model::StepReport;
use crate::files::npz::{Array, Arrays};
use crate::parallel;
use crate::scene::{Frame, Photo, Scene};

/// Steps within which a run that stopped learning is noticed.
pub const WINDOW: usize = 50;

/// The share by which the error of a field that shows nothing yet must fall from one window to the next, so that it may go on; and how
/// many times its start it may take.
const FALLS: f64 = 0.02;
const PATIENT: u64 = 10;

/// A picture whose mean squared error is more than this share of that of the best constant color (0.5 dB better) shows nothing.
const SHOWS_NOTHING: f64 = 0.9;

/// Mean squared error of the best constant color below which there is hardly a picture to learn: a color off by 0.01.
const PLAIN: f64 = 1e-4;

/// Names in a checkpoint.
const RECENT: &str = "watch_recent";
const COUNTS: &str = "watch_counts";

/// The last steps of a run, and what they are held against.
#[derive(Clone, Debug, PartialEq)]
pub struct Watch {
    /// Mean squared error of the best constant color over all training pixels.
    constant: f64,
    /// Steps that a field may take until its pictures show anything.
    start: u64,
    recent: VecDeque<f64>,
    unseen: usize,
    still: usize,
}

impl Watch {
    /// Of a run over these training pictures; `start` is [`super::Model::start`], `any_background`
    /// [`super::Model::any_background`].
    pub fn new(scene: &Scene, start: u64, any_background: bool) -> Self {
        let recent = VecDeque::with_capacity(2 * WINDOW + 1);
        let constant = constant_error(&scene.train, any_background);
        Watch { constant, start, recent, unseen: 0, still: 0 }
    }

    /// Its part of a checkpoint, so that a run is given up at the same step however often it was stopped.
    pub fn state(&self) -> Arrays {
        let recent = self.recent.iter().copied().collect::<Array1<f64>>();
        let counts = Array1::from_vec(vec![self.unseen as i64, self.still as i64]);
        Arrays::from([(RECENT.into(), recent.into()), (COUNTS.into(), counts.into())])
    }

    /// Whether an array of a checkpoint is the watch's.
    pub(super) fn has(name: &str) -> bool {
        [RECENT, COUNTS].contains(&name)
    }

    /// Loads what [`Self::state`] returned; a checkpoint of before this version has none.
    pub fn restore(&mut self, state: &Arrays) {
        if let (Some(Array::F64(recent)), Some(Array::I64(counts))) = (state.get(RECENT), state.get(COUNTS)) {
            self.recent = recent.iter().copied().take(2 * WINDOW).collect();
            let mut counts = counts.iter().map(|&n| usize::try_from(n).unwrap_or(0));
            self.unseen = counts.next().unwrap_or(0);
            self.still = counts.next().unwrap_or(0);
        }
    }

    /// Why the run is given up after this step, if it is.
    pub fn failure(&mut self, step: u64, report: &StepReport) -> Option<String> {
        if !report.loss.is_finite() {
            return Some(format!(
                "the loss at step {step} is {}, no finite number. Lower `lr`.",
                report.loss
            ));
        }
        let count = |so_far: usize, bad: bool| if bad { so_far + 1 } else { 0 };
        self.unseen = count(self.unseen, report.samples == 0);
        self.still = count(self.still, report.still);
        self.recent.push_back(report.mse);
        if self.recent.len() > 2 * WINDOW {
            self.recent.pop_front();
        }
        if self.unseen >= WINDOW {
            return Some(format!(
                "no ray has met a sample for {WINDOW} steps, up to step {step}: nothing lies between near and far where the cameras \
                 look, or everything is taken for empty. Check `near` and `far`, or try `without` occupancy."
            ));
        }
        if self.still >= WINDOW {
            return Some(format!(
                "no gradient has flowed for {WINDOW} steps, up to step {step}: every density is 0. Try another `seed`, or a smaller \
                 `lr`."
            ));
        }
        let windows = |skip| self.recent.iter().rev().skip(skip).take(WINDOW);
        let [last, before] = [0, WINDOW].map(|skip| windows(skip).sum::<f64>() / WINDOW as f64);
        let judged = step >= self.start && self.recent.len() >= WINDOW && self.constant > PLAIN;
        // Pictures without contrast take longer, but they get better.
        let falls = self.recent.len() == 2 * WINDOW && last < (1.0 - FALLS) * before;
        let waits = falls && step < PATIENT * self.start;
        (judged && last > SHOWS_NOTHING * self.constant && !waits).then(|| {
            format!(
                "over the last {WINDOW} steps, up to step {step}, pictures are no better than one color all over ({last:.5} to {:.5} mean \
                 squared error). Check the poses and `near`, `far`; try another `background`, `seed` or `lr`.",
                self.constant
            )
        })
    }
}

/// Why a run is given up whose pictures of these held-out frames reach so many dB, if it is.
pub(super) fn unseen_failure(frames: &[Frame], psnr: f64) -> Option<String> {
    let constant = constant_error(frames, false);
    let error = 10f64.powf(-0.1 * psnr);
    // Where there is hardly anything to see, it must at least not be off by more than that.
    (error > SHOWS_NOTHING * constant.max(PLAIN)).then(|| {
        format!(
            "held-out views are no better than one color all over ({error:.5} to {constant:.5} mean squared error): what was learned are the \
             training pictures alone. Do the poses belong to the pictures (order, axes, upside down, mirrored)? Are there enough views?"
        )
    })
}

/// What the best constant color leaves of these pictures: the mean of the three channels' variances. Of pictures with opacity that are
/// learned over any background, color c + (1 - a) b with b even in [0, 1], what the best constant c and a leave: var c - cov(c, a) + var a / 3.
pub fn constant_error(frames: &[Frame], any_background: bool) -> f64 {
    let pictures: Vec<&Photo> = frames.iter().filter_map(|frame| frame.image.as_ref()).collect();
    let sums = parallel::map(pictures.len(), |n| {
        // Sums of c, c^2, a, a^2 and c a.
        let (mut sums, picture) = ([[0.0; 5]; 3], pictures[n]);
        let seen_through = any_background && picture.keeps_opacity();
        for pixel in 0..picture.len() {
            // Over black the color that the pixel has by itself, over white what shines through it beside that.
            let color = if seen_through { picture.pixel_over(pixel, [0.0; 3]) } else { picture.pixel(pixel) };
            let white = if seen_through { picture.pixel_over(pixel, [1.0; 3]) } else { color };
            for k in 0..3 {
                let (c, a) = (f64::from(color[k]), 1.0 - f64::from(white[k] - color[k]));
                let terms = [c, c * c, a, a * a, c * a];
                (0..5).for_each(|term| sums[k][term] += terms[term]);
            }
        }
        sums
    });
    let count = pictures.iter().map(|picture| picture.len()).sum::<usize>() as f64;
    let left = |k: usize| {
        let mean = |term: usize| sums.iter().map(|sum| sum[k][term]).sum::<f64>() / count;
        let [c, c2, a, a2, ca] = [0, 1, 2, 3, 4].map(mean);
        (c2 - c * c) - (ca - c * a) + (a2 - a * a) / 3.0
    };
    (0..3).map(left).sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch() -> Watch {
        Watch { constant: 0.1, start: 300, recent: VecDeque::new(), unseen: 0, still: 0 }
    }

    /// The first step at which a run is given up, and why.
    fn first(report: impl Fn(u64) -> StepReport) -> Option<(u64, String)> {
        let mut watch = watch();
        (1..=1000).find_map(|step| Some((step, watch.failure(step, &report(step))?)))
    }

    const GOOD: StepReport = StepReport { loss: 0.01, mse: 0.01, samples: 100, still: false };

    #[test]
    fn a_run_that_learns_goes_on() {
        assert_eq!(first(|_| GOOD), None);
        // Slow at first, a step without a sample now and then.
        let report = |step: u64| {
            let mse = if step < 250 { 0.1 } else { 0.02 };
            StepReport {
                mse,
                samples: u64::from(!step.is_multiple_of(40)),
                still: step.is_multiple_of(30),
                ..GOOD
            }
        };
        assert_eq!(first(report), None);
    }

    /// Stopped and resumed anywhere, it gives up at the same step.
    #[test]
    fn a_resumed_watch_sees_what_it_would_have_seen() {
        let reports = [
            StepReport { samples: 0, ..GOOD },
            StepReport { still: true, ..GOOD },
            StepReport { mse: 0.1, ..GOOD },
        ];
        for bad in reports {
            let from = |step| if step > 380 { bad } else { GOOD };
            let whole = first(from);
            let mut watch = watch();
            let resumed = (1..=1000).find_map(|step| {
                let state = watch.state();
                watch = self::watch();
                watch.restore(&state);
                Some((step, watch.failure(step, &from(step))?))
            });
            assert_eq!(whole, resumed);
        }
    }

    #[test]
    fn what_stops_learning_is_noticed_within_the_window() {
        let from = |bad: StepReport| move |step| if step > 400 { bad } else { GOOD };
        let cases = [
            (StepReport { loss: f64::NAN, ..GOOD }, 401, "finite"),
            (StepReport { samples: 0, ..GOOD }, 450, "no ray has met a sample"),
            (StepReport { still: true, ..GOOD }, 450, "no gradient"),
            (StepReport { mse: 0.1, ..GOOD }, 450, "one color all over"),
        ];
        for (bad, at, why) in cases {
            let (step, reason) = first(from(bad)).unwrap();
            assert!(step <= at && reason.contains(why), "{step}: {reason}");
        }
        // From the start: when the start is over.
        assert_eq!(first(|_| StepReport { mse: 0.095, ..GOOD }).unwrap().0, 300);
        assert_eq!(first(|_| StepReport { samples: 0, ..GOOD }).unwrap().0, 50);
    }

    /// Half of the pixels 1, half 0 in one channel: variance 1/4, a third of it over the channels.
    #[test]
    fn the_best_constant_color_leaves_the_variance() {
        let mut scene = crate::scene::load("builtin:slab", &crate::scene::Options::default()).unwrap();
        for frame in &mut scene.train {
            let color = |(_, i, k): (usize, usize, usize)| if k == 1 { (i % 2) as f32 } else { 0.3 };
            frame.image = Some(ndarray::Array3::from_shape_fn((64, 64, 3), color).into());
        }
        let left = constant_error(&scene.train, true);
        assert!((left - 0.25 / 3.0).abs() < 1e-7, "{left}");
    }

    /// Half of the pixels black and opaque, half of them clear: over black there is nothing to see, over any background a half that
    /// varies as it does, 1/3, and what the best constant leaves of that: var a / 3.
    #[test]
    fn opacity_counts_over_any_background() {
        let mut scene = crate::scene::load("builtin:slab", &crate::scene::Options::default()).unwrap();
        let clear = (0..64 * 64).map(|n| [0, 0, 0, if n % 2 == 0 { 255 } else { 0 }]).collect::<Vec<_>>();
        for frame in &mut scene.train {
            frame.image = Some(Photo::cut(64, 64, clear.clone(), [0.0; 3]));
        }
        assert_eq!(constant_error(&scene.train, false), 0.0);
        let left = constant_error(&scene.train, true);
        assert!((left - 0.25 / 3.0).abs() < 1e-7, "{left}");
    }

    /// Three percent better from window to window, and never better than a constant color: it has ten times as long, and no more.
    #[test]
    fn patience_ends() {
        let (mut watch, mut step) = (watch(), 0);
        let reason = loop {
            step += 1;
            let mse = 2.0 * 0.97f64.powf(step as f64 / WINDOW as f64);
            if let Some(reason) = watch.failure(step, &StepReport { mse, ..GOOD }) {
                break reason;
            }
        };
        assert!(step == 3000 && reason.contains("one color all over"), "{step}: {reason}");
    }

    /// Held-out views that are off by as much as one color, or, of hardly any picture, by more than that.
    #[test]
    fn held_out_views_must_show_something() {
        let scene = |contrast: f32| {
            let mut scene = crate::scene::load("builtin:slab", &crate::scene::Options::default()).unwrap();
            let color = |(_, i, _): (usize, usize, usize)| 0.5 + contrast * (i % 2) as f32;
            for frame in &mut scene.val {
                frame.image = Some(ndarray::Array3::from_shape_fn((64, 64, 3), color).into());
            }
            scene.val
        };
        // A variance of 0.01: 20 dB; 0.9 of that are 20.5 dB.
        let told = |contrast: f32, psnr: f64| unseen_failure(&scene(contrast), psnr).is_some();
        assert!(told(0.2, 20.0) && told(0.2, 20.3) && !told(0.2, 20.6) && !told(0.2, 30.0));
        assert!(told(0.0, 40.0) && !told(0.0, 41.0));
    }

    /// Slow, but better from window to window: it goes on.
    #[test]
    fn a_run_that_falls_may_go_on() {
        let slow = |step: u64| StepReport { mse: 0.2 * 0.999f64.powi(step as i32), ..GOOD };
        assert_eq!(first(slow), None);
        let (step, reason) =
            first(|step| StepReport { mse: 0.2 * 0.9999f64.powi(step as i32), ..GOOD }).unwrap();
        assert!(step == 300 && reason.contains("one color all over"), "{step}: {reason}");
    }
}
