//! Honest schedules: powers, exponentials of logarithms, and schedulers that go on from their last rate. What is computed from
//! hyper-parameters alone is computed in f32 at least, and rounded to the type in the end.

use super::arrays::{count, delay, forward, rates};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, number};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, RateDelay, RateEnd, RateRamp};

/// The ways of each schedule; the last one of the first two goes from rate to rate, which loses a rounding a step.
pub(super) const WAYS: u64 = 4;

/// The longest schedule that is followed from rate to rate.
const FOLLOWED: u64 = 20_000;

/// step / steps, up to 1 where the rate is held.
fn part<O: Operations>(o: &O, step: f64, steps: f64, end: RateEnd) -> O::Number {
    let part = o.div(o.exact(step), o.exact(steps));
    if end == RateEnd::Held { o.min(part, o.exact(1.0)) } else { part }
}

/// base^t: a power, or e^(t ln base).
fn power<O: Operations>(o: &O, base: O::Number, t: O::Number, way: u64) -> O::Number {
    if way % 2 == 0 { o.pow(base, t) } else { o.exp(o.mul(t, o.ln(base))) }
}

/// lr_init decay^(step / decay_steps).
pub(super) fn exponential<O: Operations>(o: &O, a: &Arrays, c: &Conventions, way: u64) -> O::Number {
    let (lr, decay) = (o.hyper(number(a, "lr_init")), o.hyper(number(a, "decay")));
    let (step, steps) = (count(a, "step"), count(a, "decay_steps"));
    if way == WAYS - 1 && step <= FOLLOWED {
        // torch's ExponentialLR: one product a step, with the factor of a step.
        let factor = o.pow(decay, o.div(o.exact(1.0), o.exact(steps as f64)));
        let taken = if c.rate_end == RateEnd::Held { step.min(steps) } else { step };
        return (0..taken).fold(lr, |rate, _| o.mul(rate, factor));
    }
    o.mul(lr, power(o, decay, part(o, step as f64, steps as f64, c.rate_end), way))
}

/// (1 + cos(pi p)) / 2, or the square of cos(pi p / 2).
fn fallen<O: Operations>(o: &O, p: O::Number, way: u64) -> O::Number {
    let angle = o.mul(o.hyper(std::f64::consts::PI), p);
    if way == 1 {
        let cosine = o.cos(o.times(0.5, angle));
        return o.mul(cosine, cosine);
    }
    o.times(0.5, o.add(o.exact(1.0), o.cos(angle)))
}

/// A warm-up and a cosine.
pub(super) fn cosine<O: Operations>(o: &O, a: &Arrays, c: &Conventions, way: u64) -> O::Number {
    let [first, last] = rates(a).map(|rate| o.hyper(rate));
    let [step, most, warmup] = ["step", "max_steps", "warmup_steps"].map(|name| number(a, name));
    if step < warmup {
        let [step, warmup] = [step, warmup].map(|steps| o.exact(steps));
        let quotient_first = o.mul(first, o.div(step, warmup));
        return if way == 0 { quotient_first } else { o.div(o.mul(first, step), warmup) };
    }
    if way == WAYS - 1 && warmup == 0.0 && step <= most && most <= 1000.0 {
        return annealed(o, [first, last], step as u64, most);
    }
    let half = fallen(o, part(o, step - warmup, most - warmup, c.rate_end), way);
    if way == 2 {
        // nerfstudio's: a factor of the first rate, down to alpha.
        let alpha = o.div(last, first);
        return o.mul(first, o.add(o.mul(half, o.sub(o.exact(1.0), alpha)), alpha));
    }
    o.add(last, o.mul(o.sub(first, last), half))
}

/// torch's CosineAnnealingLR: what is above the last rate times the quotient of two steps' 1 + cos.
fn annealed<O: Operations>(o: &O, [first, last]: [O::Number; 2], step: u64, most: f64) -> O::Number {
    let above = |k: u64| {
        let angle = o.div(o.mul(o.hyper(std::f64::consts::PI), o.exact(k as f64)), o.exact(most));
        o.add(o.exact(1.0), o.cos(angle))
    };
    (1..=step).fold(first, |rate, k| {
        let quotient = o.div(above(k), above(k - 1));
        o.add(o.mul(quotient, o.sub(rate, last)), last)
    })
}

/// A log-linear decay with its delay.
pub(super) fn log_linear<O: Operations>(o: &O, a: &Arrays, c: &Conventions, way: u64) -> O::Number {
    let [first, last] = rates(a).map(|rate| o.hyper(rate));
    let delay = delay(a, c);
    let (step, wait, mult) = (number(a, "step"), delay.steps as f64, o.hyper(delay.mult));
    let begin = if delay.place == RateDelay::Before { wait } else { 0.0 };
    let t = part(o, (step - begin).max(0.0), number(a, "max_steps") - begin, RateEnd::Held);
    let decayed = if way < 2 {
        o.mul(first, power(o, o.div(last, first), t, way))
    } else {
        let [ln_first, ln_last] = [first, last].map(|rate| o.ln(rate));
        o.exp(o.add(o.mul(o.sub(o.exact(1.0), t), ln_first), o.mul(t, ln_last)))
    };
    if wait == 0.0 || (way % 2 == 0 && step >= wait) {
        return decayed;
    }
    let risen = part(o, step, wait, RateEnd::Held);
    let risen = match delay.ramp {
        RateRamp::Linear => risen,
        RateRamp::Sine => o.sin(o.mul(o.hyper(0.5 * std::f64::consts::PI), risen)),
    };
    if begin > step && way == 2 {
        // nerfstudio's: from the rate before the warm-up to the first one.
        let before = o.mul(mult, first);
        return o.add(before, o.mul(o.sub(first, before), risen));
    }
    o.mul(o.add(mult, o.mul(o.sub(o.exact(1.0), mult), risen)), decayed)
}

/// On a machine of f32 at least: a stable one doesn't go from rate to rate.
fn on(m: &Machine, rate: impl Fn(&Machine, u64) -> f64) -> Arrays {
    let fine = Machine { dtype: if m.dtype == Dtype::F64 { Dtype::F64 } else { Dtype::F32 }, ..*m };
    let ways = if m.stable { WAYS - 1 } else { WAYS };
    // Machines that differ in their noise alone take different ways.
    forward(m.round(rate(&fine, (m.form + m.noise) % ways)))
}

/// The exponential.
pub(crate) fn lr_exponential(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    on(m, |fine, way| exponential(fine, a, c, way))
}

/// The cosine.
pub(crate) fn lr_cosine(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    on(m, |fine, way| cosine(fine, a, c, way))
}

/// The log-linear decay.
pub(crate) fn lr_log_linear(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    on(m, |fine, way| log_linear(fine, a, c, way))
}
