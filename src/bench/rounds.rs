//! Rounds: every kernel runs once in each of them, so that other load hits all alike; medians and quartiles over rounds.

use std::time::Instant;

use super::Kernel;

/// One kernel's seconds, round by round.
#[derive(Clone, Debug)]
pub struct Timer {
    repeats: usize,
    /// Seconds of one run, one number per round.
    pub seconds: Vec<f64>,
}

impl Timer {
    /// Runs the kernel twice, to fill caches and to see how often it must run to take `least` seconds.
    pub fn new(kernel: &mut dyn Kernel, least: f64) -> Timer {
        kernel.run();
        let once = seconds(|| kernel.run());
        Timer { repeats: (least / once.max(1e-9)).ceil().clamp(1.0, 1e6) as usize, seconds: vec![] }
    }

    /// One round: a run that isn't counted, because others have used the caches meanwhile, unless the kernel is slow; then those that
    /// are counted.
    pub fn round(&mut self, kernel: &mut dyn Kernel) {
        if self.repeats > 1 {
            kernel.run();
        }
        let all = seconds(|| (0..self.repeats).for_each(|_| kernel.run()));
        self.seconds.push(all / self.repeats as f64);
    }

    /// The median of the rounds.
    pub fn median(&self) -> f64 {
        quantile(&self.seconds, 0.5)
    }

    /// The distance of the quartiles over the median.
    pub fn spread(&self) -> f64 {
        (quantile(&self.seconds, 0.75) - quantile(&self.seconds, 0.25)) / self.median()
    }
}

/// Seconds that `work` takes.
pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The q-quantile, linear between neighbors; NaN for no values.
///
/// ```
/// assert_eq!(nerf_oracle::bench::rounds::quantile(&[4.0, 1.0, 2.0], 0.5), 2.0);
/// assert_eq!(nerf_oracle::bench::rounds::quantile(&[4.0, 1.0, 2.0], 0.75), 3.0);
/// ```
pub fn quantile(values: &[f64], q: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = q * last as f64;
    let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
    low + (high - low) * at.fract()
}
