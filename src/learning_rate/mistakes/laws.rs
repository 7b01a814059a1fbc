//! Laws of learning rates: which part of the way counts, what falls over it, and what happens before and after.

use super::super::arrays::{count, exponential, forward, log_linear, rates};
use super::super::{cosine, part};
use crate::contract::arrays::{Arrays, number};
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::math::{cos_pi, exp, ln, pow};

/// Which part of the way is done, s of n steps.
const WAY: [&str; 9] = [
    "s / n",
    "min(1, s / n)",
    "floor(s / n)",
    "(s + 1) / n",
    "min(1, (s + 1) / n)",
    "s / (n - 1)",
    "(s mod n) / n",
    "s",
    "s / n + 1",
];

/// How an exponential falls.
const FALLING: [&str; 11] = [
    "lr_init decay^p",
    "lr_init exp(-decay p)",
    "lr_init exp(-(1 - decay) p)",
    "lr_init (1 - decay)^p",
    "lr_init / (1 + decay p)",
    "lr_init / (1 + p)",
    "lr_init (1 - p) + lr_init decay p",
    "lr_init decay p",
    "lr_init exp(decay p)",
    "lr_init decay^-p",
    "max(lr_init decay^p, lr_init / 10)",
];

/// Those of an exponential.
pub(crate) const OF_EXPONENTIALS: Laws = Laws {
    choices: &[WAY.len(), FALLING.len()],
    says: |part, choice| match part {
        0 => format!("p = {}", WAY[choice]),
        _ => FALLING[choice].into(),
    },
    of: of_exponentials,
    rounding: &[],
};

/// The part of the way: s of n steps.
fn way(s: f64, n: f64, choice: usize) -> f64 {
    match choice {
        1 => (s / n).min(1.0),
        2 => (s / n).floor(),
        3 => (s + 1.0) / n,
        4 => ((s + 1.0) / n).min(1.0),
        5 => s / (n - 1.0),
        6 => s % n / n,
        7 => s,
        8 => s / n + 1.0,
        _ => s / n,
    }
}

fn of_exponentials(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law == [0, 0] {
        return exponential(a, c);
    }
    let (first, decay) = (number(a, "lr_init"), number(a, "decay"));
    let (s, n) = (number(a, "step"), number(a, "decay_steps"));
    let p = if law[0] == 0 { part(s, n, c.rate_end) } else { way(s, n, law[0]) };
    forward(match law[1] {
        0 => first * pow(decay, p),
        1 => first * exp(-decay * p),
        2 => first * exp(-(1.0 - decay) * p),
        3 => first * pow(1.0 - decay, p),
        4 => first / (1.0 + decay * p),
        5 => first / (1.0 + p),
        6 => first * (1.0 - p) + first * decay * p,
        7 => first * decay * p,
        8 => first * exp(decay * p),
        9 => first * pow(decay, -p),
        _ => (first * pow(decay, p)).max(0.1 * first),
    })
}

/// The rate while it warms up.
const WARMING: [&str; 9] = [
    "lr_init s / warmup",
    "lr_init (s + 1) / warmup",
    "lr_init (s + 1) / (warmup + 1)",
    "lr_final + (lr_init - lr_final) s / warmup",
    "lr_init",
    "that of the cosine",
    "that of the cosine times s / warmup",
    "lr_init (s / warmup)^2",
    "0",
];

/// Which part of the cosine is done.
const TURNED: [&str; 8] = [
    "(s - warmup) / (max - warmup)",
    "min(1, (s - warmup) / (max - warmup))",
    "s / max",
    "min(1, s / max)",
    "(s - warmup) / max",
    "(s + 1 - warmup) / (max - warmup)",
    "(s - warmup) / (max - warmup - 1)",
    "the remainder of (s - warmup) / (max - warmup)",
];

/// What falls.
const COSINE: [&str; 11] = [
    "lr_final + (lr_init - lr_final) (1 + cos(pi p)) / 2",
    "lr_init (1 + cos(pi p)) / 2",
    "max(lr_final, lr_init (1 + cos(pi p)) / 2)",
    "lr_init cos(pi p / 2)",
    "lr_final + lr_init (1 + cos(pi p)) / 2",
    "lr_final + (lr_init - lr_final) (1 + cos(pi p))",
    "lr_final + (lr_init - lr_final) cos(pi p)",
    "lr_final + (lr_init - lr_final) (1 - p)",
    "lr_init (lr_final / lr_init)^p",
    "1e-5 + (lr_init - 1e-5) (1 + cos(pi p)) / 2",
    "1e-6 + (lr_init - 1e-6) (1 + cos(pi p)) / 2",
];

/// What comes after.
const AFTER: [&str; 4] = ["what the formula says", "lr_final", "0", "lr_init"];

/// Those of a cosine.
pub(crate) const OF_COSINES: Laws = Laws {
    choices: &[WARMING.len(), TURNED.len(), COSINE.len(), AFTER.len()],
    says: |part, choice| match part {
        0 => format!("{} while it warms up", WARMING[choice]),
        1 => format!("p = {}", TURNED[choice]),
        2 => format!("lr = {}", COSINE[choice]),
        _ => format!("{} after the last step", AFTER[choice]),
    },
    of: of_cosines,
    rounding: &[],
};

fn of_cosines(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let ([first, last], s) = (rates(a), number(a, "step"));
    let (most, warmup) = (number(a, "max_steps"), number(a, "warmup_steps"));
    if law == [0; 4] {
        return forward(cosine(
            [first, last],
            count(a, "step"),
            count(a, "max_steps"),
            count(a, "warmup_steps"),
            c.rate_end,
        ));
    }
    let (done, all) = (s - warmup, most - warmup);
    let p = match law[1] {
        0 => part(done, all, c.rate_end),
        1 => (done / all).min(1.0),
        2 => s / most,
        3 => (s / most).min(1.0),
        4 => done / most,
        5 => (done + 1.0) / all,
        6 => done / (all - 1.0),
        _ => done % all / all,
    };
    let half = 0.5 * (1.0 + cos_pi(p));
    let falling = match law[2] {
        0 => last + (first - last) * half,
        1 => first * half,
        2 => (first * half).max(last),
        3 => first * cos_pi(0.5 * p),
        4 => last + first * half,
        5 => last + (first - last) * 2.0 * half,
        6 => last + (first - last) * cos_pi(p),
        7 => last + (first - last) * (1.0 - p),
        8 => first * exp(p * ln(last / first)),
        9 => 1e-5 + (first - 1e-5) * half,
        _ => 1e-6 + (first - 1e-6) * half,
    };
    let falling = if s > most { [falling, last, 0.0, first][law[3]] } else { falling };
    let warming = match law[0] {
        0 => first * (s / warmup),
        1 => first * (s + 1.0) / warmup,
        2 => first * (s + 1.0) / (warmup + 1.0),
        3 => last + (first - last) * s / warmup,
        4 => first,
        5 => falling,
        6 => falling * s / warmup,
        7 => first * (s / warmup) * (s / warmup),
        _ => 0.0,
    };
    forward(if s < warmup { warming } else { falling })
}

/// What a delay leaves of the rate.
const DELAYED: [&str; 6] = [
    "what it is by convention",
    "1, not at all",
    "nothing, the decay beginning behind the delay's steps",
    "m + (1 - m) sin(pi / 2 s / max)",
    "m + (1 - m) s / max",
    "m before its end",
];

/// How a log-linear rate falls.
const LOG_LINEAR: [&str; 6] = [
    "exp((1 - p) ln lr_init + p ln lr_final)",
    "(1 - p) lr_init + p lr_final",
    "lr_init 0.1^p",
    "lr_init (lr_final / lr_init)^p, p not held",
    "lr_init lr_final^p",
    "lr_init (lr_final / lr_init)^(p^2)",
];

/// What the first step has.
const AT_FIRST: [&str; 3] = ["what the formula says", "0", "lr_init"];

/// Those of a log-linear decay.
pub(crate) const OF_DECAYS: Laws = Laws {
    choices: &[DELAYED.len(), LOG_LINEAR.len(), AT_FIRST.len()],
    says: |part, choice| match part {
        0 => format!("delayed by {}", DELAYED[choice]),
        1 => format!("lr = {}", LOG_LINEAR[choice]),
        _ => format!("lr = {} at step 0", AT_FIRST[choice]),
    },
    of: of_decays,
    rounding: &[],
};

fn of_decays(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law == [0; 3] {
        return log_linear(a, c);
    }
    let ([first, last], s, most) = (rates(a), number(a, "step"), number(a, "max_steps"));
    let delay = super::super::arrays::delay(a, c);
    let (steps, mult) = (delay.steps as f64, delay.mult);
    let late = delay.place == crate::convention::RateDelay::Before || law[0] == 2;
    let begin = if late { steps } else { 0.0 };
    let way = (s - begin).max(0.0) / (most - begin);
    let p = way.min(1.0);
    let rate = match law[1] {
        0 => first * pow(last / first, p),
        1 => (1.0 - p) * first + p * last,
        2 => first * pow(0.1, p),
        3 => first * pow(last / first, way),
        4 => first * pow(last, p),
        _ => first * pow(last / first, p * p),
    };
    let all = (s / most).min(1.0);
    let factor = match law[0] {
        0 => delay.factor(count(a, "step")),
        3 => mult + (1.0 - mult) * crate::math::sin_pi(0.5 * all),
        4 => mult + (1.0 - mult) * all,
        5 if s < steps => mult,
        _ => 1.0,
    };
    forward(match law[2] {
        1 if s == 0.0 => 0.0,
        2 if s == 0.0 => first,
        _ => rate * factor,
    })
}
