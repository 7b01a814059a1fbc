//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::Delay;
use crate::contract::arrays::{Arrays, arrays, number, scalar};
use crate::convention::Conventions;

/// A number of steps.
pub(crate) fn count(a: &Arrays, name: &str) -> u64 {
    number(a, name) as u64
}

/// The rates at the ends.
pub(crate) fn rates(a: &Arrays) -> [f64; 2] {
    ["lr_init", "lr_final"].map(|name| number(a, name))
}

/// The delay of a log-linear schedule.
pub(crate) fn delay(a: &Arrays, c: &Conventions) -> Delay {
    let (steps, mult) = (count(a, "delay_steps"), number(a, "delay_mult"));
    Delay { steps, mult, place: c.rate_delay, ramp: c.rate_ramp }
}

/// A rate as the output.
pub(crate) fn forward(rate: f64) -> Arrays {
    arrays([("rate", scalar(rate))])
}

pub(super) fn exponential(a: &Arrays, c: &Conventions) -> Arrays {
    let [step, steps] = ["step", "decay_steps"].map(|name| count(a, name));
    forward(super::exponential(number(a, "lr_init"), number(a, "decay"), step, steps, c.rate_end))
}

pub(super) fn cosine(a: &Arrays, c: &Conventions) -> Arrays {
    let [step, most, warmup] = ["step", "max_steps", "warmup_steps"].map(|name| count(a, name));
    forward(super::cosine(rates(a), step, most, warmup, c.rate_end))
}

pub(super) fn log_linear(a: &Arrays, c: &Conventions) -> Arrays {
    forward(super::log_linear(rates(a), count(a, "step"), count(a, "max_steps"), &delay(a, c)))
}
