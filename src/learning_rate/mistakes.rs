//! Schedules, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;
mod cosine;
pub(crate) mod laws;

use std::f64::consts::{FRAC_PI_2, PI};

use catalogue::{DECAY_OF_ITS_OWN, LAST_RATE_A_PART, RATE_FLOORED, WARMUP_FROM_A_PART, WARMUP_FROM_A_RATE};
pub(crate) use catalogue::{LR_EXPONENTIAL, LR_LOG_LINEAR};
pub(crate) use cosine::LR_COSINE;

use super::arrays::{self, count, delay, forward, rates};
use super::part;
use crate::contract::arrays::{Arrays, number};
use crate::convention::{Conventions, RateDelay, RateEnd, RateRamp};
use crate::math::{cos, exp, pow, sin};

/// The step that is taken for this one.
fn step(a: &Arrays, wrong: &[&str]) -> f64 {
    number(a, "step") + if wrong.contains(&"step_from_one") { 1.0 } else { 0.0 }
}

/// The part of the way that is taken for the right one.
fn way(step: f64, steps: f64, end: RateEnd, wrong: &[&str]) -> f64 {
    let t = part(step, steps, end);
    if wrong.contains(&"whole_steps") { t.floor() } else { t }
}

/// Exponential decay.
pub(crate) fn lr_exponential(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::exponential(a, c);
    }
    let has = |name: &str| wrong.contains(&name);
    let [steps, lr, decay] = ["decay_steps", "lr_init", "decay"].map(|name| number(a, name));
    let decay = DECAY_OF_ITS_OWN.among(wrong).unwrap_or(decay);
    // Of one step nothing is left to divide by: the first rate.
    let t = match steps - if has("one_step_less") { 1.0 } else { 0.0 } {
        0.0 => 0.0,
        steps => way(step(a, wrong), steps, c.rate_end, wrong),
    };
    let least = RATE_FLOORED.among(wrong).unwrap_or(0.0);
    let rate = match () {
        () if has("decay_as_rate") => lr * exp(-decay * t),
        () if has("inverse_time") => lr / (1.0 + decay * t),
        () if has("factor_every_step") => lr * pow(decay, t * steps),
        () if has("natural_exponent") => lr * exp(-t),
        () if has("linear_decay") => lr * (1.0 - (1.0 - decay) * t),
        () if has("compounded") => lr * pow(decay, t * (t * steps + 1.0) / 2.0),
        () => lr * pow(decay, t),
    };
    forward(rate.max(least))
}

/// The rate of a step of the warm-up.
fn warming_up([first, last]: [f64; 2], step: f64, warmup: f64, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let risen = step / warmup;
    if let Some(k) = WARMUP_FROM_A_PART.among(wrong) {
        return first * (k + (1.0 - k) * risen);
    }
    let begin = if has("warmup_from_last_rate") { Some(last) } else { WARMUP_FROM_A_RATE.among(wrong) };
    if let Some(begin) = begin {
        return begin + (first - begin) * risen;
    }
    first
        * match () {
            () if has("whole_steps") => risen.floor(),
            () if has("warmup_from_one") => (step + 1.0) / warmup,
            () if has("warmup_above_nothing") => step.max(1.0) / warmup,
            () if has("warmup_beyond_its_end") => (step + 1.0) / (warmup + 1.0),
            () if has("warmup_at_full_rate") => 1.0,
            () if has("warmup_along_a_cosine") => 0.5 * (1.0 - cos(PI * risen)),
            () => risen,
        }
}

/// A cosine with its warm-up.
pub(crate) fn lr_cosine(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::cosine(a, c);
    }
    let has = |name: &str| wrong.contains(&name);
    let ([first, last], step) = (rates(a), step(a, wrong));
    let (most, warmup) = (number(a, "max_steps"), number(a, "warmup_steps"));
    let last = LAST_RATE_A_PART.among(wrong).map_or(last, |k| k * first);
    let [first, last] = if has("rates_exchanged") { [last, first] } else { [first, last] };
    let step = if has("begun_again_with_warmup") && most > 0.0 { step % most } else { step };
    if has("nothing_after_the_end") && step > most {
        return forward(0.0);
    }
    if step < warmup && !has("warmup_times_cosine") && !has("warmup_forgotten") {
        return forward(warming_up([first, last], step, warmup, wrong));
    }
    let forgotten = has("warmup_forgotten");
    let counted =
        forgotten || has("warmup_counted") || has("warmup_times_cosine") || has("warmup_taken_off_the_whole");
    let whole =
        forgotten || has("warmup_counted") || has("warmup_times_cosine") || has("warmup_not_taken_off");
    let early = if has("one_step_early") { 1.0 } else { 0.0 };
    let less = if has("one_step_less") { 1.0 } else { early };
    let end = if has("begun_again") { RateEnd::GoesOn } else { c.rate_end };
    let p = way(
        if counted { step } else { step - warmup } - early,
        if whole { most } else { most - warmup } - less,
        end,
        wrong,
    );
    let p = if has("begun_again") { p.fract() } else { p };
    let angle = p * match () {
        () if has("full_turn") => 2.0 * PI,
        () if has("pi_forgotten") => 1.0,
        () => PI,
    };
    let fallen = (1.0 + cos(angle)) * if has("half_forgotten") { 1.0 } else { 0.5 };
    forward(match () {
        () if has("warmup_times_cosine") && step < warmup => {
            (last + (first - last) * fallen) * (step / warmup)
        }
        () if has("linear_for_cosine") => first + (last - first) * p,
        () if has("one_forgotten") => last + (first - last) * cos(angle),
        () if has("seven_sixteenths") => first * cos(7.0 / 16.0 * PI * p).max(0.0),
        () if has("last_rate_forgotten") => first * fallen,
        () if has("last_rate_on_top") => last + first * fallen,
        () => last + (first - last) * fallen,
    })
}

/// A log-linear decay with its delay.
pub(crate) fn lr_log_linear(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::log_linear(a, c);
    }
    let has = |name: &str| wrong.contains(&name);
    let ([first, last], step, delay) = (rates(a), step(a, wrong), delay(a, c));
    let (most, wait) = (number(a, "max_steps"), count(a, "delay_steps") as f64);
    let begin = if delay.place == RateDelay::Before { wait } else { 0.0 };
    let [first, last] = if has("rates_exchanged") { [last, first] } else { [first, last] };
    let end = if has("not_clamped") { RateEnd::GoesOn } else { RateEnd::Held };
    let early = if has("one_step_early") { 1.0 } else { 0.0 };
    let t = way((step - early - begin).max(0.0), most - early - begin, end, wrong);
    let decayed = match () {
        () if has("linear_for_log") => (1.0 - t) * first + t * last,
        () if has("last_rate_for_factor") => first * pow(last, t),
        () => first * pow(last / first, t),
    };
    if wait == 0.0 || has("not_delayed_at_first") && step == 0.0 {
        return forward(decayed);
    }
    let wait = if has("delay_over_all_steps") { most } else { wait };
    let risen = part(step, wait, if has("delay_not_clamped") { RateEnd::GoesOn } else { RateEnd::Held });
    let risen = match delay.ramp {
        RateRamp::Linear => risen,
        RateRamp::Sine if has("half_pi_forgotten") => sin(risen),
        RateRamp::Sine if has("whole_pi") => sin(PI * risen),
        RateRamp::Sine => sin(FRAC_PI_2 * risen),
    };
    let mult = match () {
        () if has("mult_forgotten") => 0.0,
        () if has("mult_exchanged") => 1.0 - delay.mult,
        () => delay.mult,
    };
    let rest = if has("mult_on_top") { 1.0 } else { 1.0 - mult };
    forward((mult + rest * risen) * decayed)
}
