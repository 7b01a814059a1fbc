//! Learning rates that change with the steps of a training: an exponential, a cosine after a linear warm-up, and a log-linear decay with
//! a delay.
//!
//! `step` is the number of steps that were taken before: the first step has the rate of step 0.

use crate::convention::{RateDelay, RateEnd, RateRamp};
use crate::math::{cos_pi, pow, sin_pi};

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Exponential decay (NeRF's `run_nerf.py`): lr_init decay^(step / decay_steps), which is lr_init decay after `decay_steps`, at least one.
///
/// # Convention
/// `end`: with [`RateEnd::Held`] it falls no further than that.
///
/// ```
/// use nerf_oracle::{convention::RateEnd, learning_rate::exponential};
/// assert_eq!(exponential(1e-2, 0.01, 50, 100, RateEnd::GoesOn), 1e-3);
/// assert_eq!(exponential(0.5, 0.25, 20, 10, RateEnd::GoesOn), 0.03125);
/// assert_eq!(exponential(0.5, 0.25, 20, 10, RateEnd::Held), 0.125);
/// ```
pub fn exponential(lr_init: f64, decay: f64, step: u64, decay_steps: u64, end: RateEnd) -> f64 {
    lr_init * pow(decay, part(step as f64, decay_steps as f64, end))
}

/// A cosine after a linear warm-up (Loshchilov and Hutter 2017, equation 5, without restarts): lr_init step / warmup_steps in the first
/// `warmup_steps`, then lr_final + (lr_init - lr_final) (1 + cos(pi p)) / 2, where p goes from 0 to 1 in the steps that are left up to
/// `max_steps`, at least one.
///
/// # Convention
/// `end`: with [`RateEnd::Held`] it is `lr_final` from `max_steps` on, else it rises again. Half of the way the rate is the mean of both.
///
/// ```
/// use nerf_oracle::{convention::RateEnd, learning_rate::cosine};
/// let rate = |step| cosine([0.75, 0.25], step, 30, 10, RateEnd::Held);
/// assert_eq!([0, 5, 10, 20, 30, 40].map(rate), [0.0, 0.375, 0.75, 0.5, 0.25, 0.25]);
/// ```
pub fn cosine(
    [lr_init, lr_final]: [f64; 2],
    step: u64,
    max_steps: u64,
    warmup_steps: u64,
    end: RateEnd,
) -> f64 {
    let (step, warmup) = (step as f64, warmup_steps as f64);
    if step < warmup {
        return lr_init * (step / warmup);
    }
    let p = part(step - warmup, max_steps as f64 - warmup, end);
    lr_final + (lr_init - lr_final) * (0.5 * (1.0 + cos_pi(p)))
}

/// The beginning of a training, in which the rate is lower.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Delay {
    /// Its length; 0: there is none.
    pub steps: u64,
    /// What it leaves of the rate in step 0.
    pub mult: f64,
    /// Whether the decay has begun.
    pub place: RateDelay,
    /// How the rate rises.
    pub ramp: RateRamp,
}

impl Delay {
    /// What it leaves of the rate: from `mult` to 1, m + (1 - m) sin(pi / 2 step / steps).
    fn factor(&self, step: u64) -> f64 {
        if step >= self.steps {
            return 1.0;
        }
        let part = step as f64 / self.steps as f64;
        let risen = if self.ramp == RateRamp::Linear { part } else { sin_pi(0.5 * part) };
        self.mult + (1.0 - self.mult) * risen
    }
}

/// Log-linear decay with a delay (jaxnerf's and multinerf's `learning_rate_decay`): the logarithm of the rate goes evenly from that of
/// `lr_init` to that of `lr_final`, where it stays from `max_steps` on. lr_init^(1 - t) lr_final^t = lr_init (lr_final / lr_init)^t.
///
/// # Convention
/// `delay.place`: with [`RateDelay::Before`] the decay begins after the delay, and both together have `max_steps`. `delay.ramp`: as a
/// sine or evenly.
///
/// ```
/// use nerf_oracle::learning_rate::{Delay, log_linear};
/// let rate = |step, delay| log_linear([0.5, 0.125], step, 10, &delay);
/// assert_eq!([0, 5, 10, 15].map(|step| rate(step, Delay::default())), [0.5, 0.25, 0.125, 0.125]);
/// assert_eq!(rate(0, Delay { steps: 4, mult: 0.25, ..Delay::default() }), 0.125);
/// ```
pub fn log_linear([lr_init, lr_final]: [f64; 2], step: u64, max_steps: u64, delay: &Delay) -> f64 {
    let begin = if delay.place == RateDelay::Before { delay.steps as f64 } else { 0.0 };
    let t = part((step as f64 - begin).max(0.0), max_steps as f64 - begin, RateEnd::Held);
    delay.factor(step) * (lr_init * pow(lr_final / lr_init, t))
}

/// Which part of the way is done.
fn part(step: f64, steps: f64, end: RateEnd) -> f64 {
    if end == RateEnd::Held { (step / steps).min(1.0) } else { step / steps }
}
