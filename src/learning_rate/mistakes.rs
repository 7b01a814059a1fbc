//! Schedules, wrong on purpose. Without a mistake every function equals the oracle.

use std::f64::consts::{FRAC_PI_2, PI};

use super::arrays::{self, count, delay, forward, rates};
use super::part;
use crate::contract::arrays::{Arrays, number};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, RateDelay, RateEnd, RateRamp};
use crate::math::{cos, exp, pow, sin};

const STEP_FROM_ONE: Mistake = Mistake::new(
    "step_from_one",
    "the first step has the rate of step 1",
    "every rate is one step early: nothing shows but in short schedules, and a training that is resumed does it again",
    "the first step is step 0; torch: optimizer.step() before scheduler.step()",
    "torch.optim.lr_scheduler warns of this order",
    1,
);

const WHOLE_STEPS: Mistake = Mistake::new(
    "whole_steps",
    "step / steps without its fraction",
    "a staircase: the first rate up to the end, then the last one",
    "divide as real numbers; StepLR is another schedule",
    "integers in C and in CUDA, // in Python; keras' ExponentialDecay where staircase is set",
    1,
);

/// Mistakes of exponential decay.
pub(crate) const LR_EXPONENTIAL: &[Mistake] = &[
    STEP_FROM_ONE,
    WHOLE_STEPS,
    Mistake::new(
        "factor_every_step",
        "decay^step: that of all steps in each",
        "the rate is gone after some hundred steps, and nothing is learned after them",
        "decay^(step / decay_steps)",
        "ExponentialLR with the gamma of a run, stepped every batch",
        1,
    ),
    Mistake::new(
        "natural_exponent",
        "e^(-step / decay_steps)",
        "0.37 of the rate is left in the end, whatever the decay",
        "decay^(step / decay_steps), e^(ln(decay) step / decay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "linear_decay",
        "1 - (1 - decay) step / decay_steps: a straight line to the same end",
        "rates that are too high in the middle, and negative ones after the end",
        "a power",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "compounded",
        "decay^(step / decay_steps) times the last step's rate",
        "the logarithm falls with the square of the steps",
        "times the first rate, which is kept apart",
        "loops that read the rate to decay out of the optimizer",
        0,
    ),
];

/// Mistakes of a cosine with its warm-up.
pub(crate) const LR_COSINE: &[Mistake] = &[
    STEP_FROM_ONE,
    WHOLE_STEPS,
    Mistake::new(
        "full_turn",
        "cos(2 pi p)",
        "the last rate in the middle, the first one in the end",
        "half of a turn: cos(pi p)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pi_forgotten",
        "cos(p)",
        "0.77 of the way is left in the end",
        "cos(pi p)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_forgotten",
        "1 + cos(pi p) without its half",
        "the training begins with nearly twice the rate",
        "(1 + cos(pi p)) / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_rate_on_top",
        "lr_final + lr_init (1 + cos(pi p)) / 2",
        "the training begins with both rates",
        "(lr_init - lr_final) (1 + cos(pi p)) / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_rate_forgotten",
        "lr_init (1 + cos(pi p)) / 2",
        "the last steps have no rate",
        "lr_final + (lr_init - lr_final) (1 + cos(pi p)) / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "warmup_counted",
        "p = step / max_steps after the warm-up too",
        "a jump where the warm-up ends",
        "p = (step - warmup_steps) / (max_steps - warmup_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "warmup_not_taken_off",
        "p = (step - warmup_steps) / max_steps",
        "the training ends before the last rate",
        "p = (step - warmup_steps) / (max_steps - warmup_steps)",
        "CosineAnnealingLR over all steps after a LinearLR, by SequentialLR",
        0,
    ),
];

/// Mistakes of a log-linear decay with its delay.
pub(crate) const LR_LOG_LINEAR: &[Mistake] = &[
    STEP_FROM_ONE,
    WHOLE_STEPS,
    Mistake::new(
        "not_clamped",
        "step / max_steps beyond 1",
        "after the last step the rate falls on",
        "clip(step / max_steps, 0, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "linear_for_log",
        "(1 - t) lr_init + t lr_final",
        "rates that are many times too high up to the last steps",
        "the same of logarithms",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_rate_for_factor",
        "lr_init lr_final^t: the last rate as the factor of a decay",
        "a last rate of lr_init lr_final, hundreds of times too low",
        "lr_init (lr_final / lr_init)^t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_pi_forgotten",
        "sin(step / delay_steps)",
        "0.84 of the rate at the end of the delay, and for ever where it is clipped",
        "sin(pi / 2 step / delay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "delay_not_clamped",
        "the sine goes on after the delay",
        "rates that swing, negative ones too",
        "clip(step / delay_steps, 0, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mult_on_top",
        "m + sin(...)",
        "1 + m of the rate after the delay",
        "m + (1 - m) sin(...)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mult_forgotten",
        "sin(...) alone",
        "the first steps have no rate",
        "m + (1 - m) sin(...)",
        "never; cheap to keep",
        0,
    ),
];

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
    let t = way(step(a, wrong), steps, c.rate_end, wrong);
    forward(match () {
        () if has("factor_every_step") => lr * pow(decay, t * steps),
        () if has("natural_exponent") => lr * exp(-t),
        () if has("linear_decay") => lr * (1.0 - (1.0 - decay) * t),
        () if has("compounded") => lr * pow(decay, t * (t * steps + 1.0) / 2.0),
        () => lr * pow(decay, t),
    })
}

/// A cosine with its warm-up.
pub(crate) fn lr_cosine(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::cosine(a, c);
    }
    let has = |name: &str| wrong.contains(&name);
    let ([first, last], step) = (rates(a), step(a, wrong));
    let (most, warmup) = (number(a, "max_steps"), number(a, "warmup_steps"));
    if step < warmup {
        let risen = step / warmup;
        return forward(first * if has("whole_steps") { risen.floor() } else { risen });
    }
    let counted = has("warmup_counted");
    let whole = counted || has("warmup_not_taken_off");
    let p = way(
        if counted { step } else { step - warmup },
        if whole { most } else { most - warmup },
        c.rate_end,
        wrong,
    );
    let angle = p * match () {
        () if has("full_turn") => 2.0 * PI,
        () if has("pi_forgotten") => 1.0,
        () => PI,
    };
    let fallen = (1.0 + cos(angle)) * if has("half_forgotten") { 1.0 } else { 0.5 };
    forward(match () {
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
    let end = if has("not_clamped") { RateEnd::GoesOn } else { RateEnd::Held };
    let t = way((step - begin).max(0.0), most - begin, end, wrong);
    let decayed = match () {
        () if has("linear_for_log") => (1.0 - t) * first + t * last,
        () if has("last_rate_for_factor") => first * pow(last, t),
        () => first * pow(last / first, t),
    };
    if wait == 0.0 {
        return forward(decayed);
    }
    let risen = part(step, wait, if has("delay_not_clamped") { RateEnd::GoesOn } else { RateEnd::Held });
    let risen = match delay.ramp {
        RateRamp::Linear => risen,
        RateRamp::Sine if has("half_pi_forgotten") => sin(risen),
        RateRamp::Sine => sin(FRAC_PI_2 * risen),
    };
    let mult = if has("mult_forgotten") { 0.0 } else { delay.mult };
    let rest = if has("mult_on_top") { 1.0 } else { 1.0 - mult };
    forward((mult + rest * risen) * decayed)
}
