//! Whether a run learns: what `train` gives up on, with the reason and what to try.

use std::collections::VecDeque;

use ndarray::Array1;

use super::model::StepReport;
use crate::files::npz::{Array, Arrays};
use crate::parallel;
use crate::scene::Scene;

/// Steps within which a run that stopped learning is noticed.
pub const WINDOW: usize = 50;

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
    /// Of a run over these training pictures; `start` is [`super::Model::start`].
    pub fn new(scene: &Scene, start: u64) -> Self {
        let recent = VecDeque::with_capacity(WINDOW + 1);
        Watch { constant: constant_error(scene), start, recent, unseen: 0, still: 0 }
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
            self.recent = recent.iter().copied().take(WINDOW).collect();
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
        if self.recent.len() > WINDOW {
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
        let mean = self.recent.iter().sum::<f64>() / self.recent.len() as f64;
        let judged = step >= self.start && self.recent.len() == WINDOW && self.constant > PLAIN;
        (judged && mean > SHOWS_NOTHING * self.constant).then(|| {
            format!(
                "over the last {WINDOW} steps, up to step {step}, pictures are no better than one color all over ({mean:.5} to {:.5} mean \
                 squared error). Check the poses and `near`, `far`; try another `background`, `seed` or `lr`.",
                self.constant
            )
        })
    }
}

/// The variance of the training pixels' colors, the mean of the three channels: what the best constant color leaves.
pub fn constant_error(scene: &Scene) -> f64 {
    let sums = parallel::map(scene.train.len(), |n| {
        let mut sums = [[0.0; 2]; 3];
        for color in scene.train[n].image.iter().flat_map(|image| image.colors()) {
            for (sum, x) in sums.iter_mut().zip(color.map(f64::from)) {
                *sum = [sum[0] + x, sum[1] + x * x];
            }
        }
        sums
    });
    let count: usize =
        scene.train.iter().filter_map(|frame| frame.image.as_ref()).map(|image| image.len()).sum();
    let variance = |k: usize| {
        let of = |power: usize| sums.iter().map(|sum| sum[k][power]).sum::<f64>() / count as f64;
        of(1) - of(0) * of(0)
    };
    (0..3).map(variance).sum::<f64>() / 3.0
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
        assert!((constant_error(&scene) - 0.25 / 3.0).abs() < 1e-7, "{}", constant_error(&scene));
    }
}
