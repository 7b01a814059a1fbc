//! Laws of Adam's and AdamW's steps: what becomes of the gradient, of either mean and of their corrections, and what the parameter loses.

mod parts;

use parts::{correction, divided, gradient, mean, of_its_own, penalty, rate, root, square, taken_off};

use super::super::Moments;
use super::super::arrays::{self, each_moved, settings};
use crate::contract::arrays::{Arrays, values};
use crate::contract::laws::Laws;
use crate::convention::{AdamEps, Conventions};

/// What counts as the gradient.
const GRADIENT: [&str; 9] = [
    "g",
    "g held between -1 and 1",
    "g, its norm held below 1,",
    "g held between -1000 and 1000",
    "g held between -5 and 5",
    "g held between -10 and 10",
    "g / |g|",
    "-g",
    "g / N",
];

/// Settings that aren't asked.
const SETTINGS: [&str; 12] = [
    "beta1 and beta2 as they are",
    "beta1 = 0.9 and beta2 = 0.999, whatever they are",
    "beta1 = 0.9, beta2 = 0.999 and eps = 1e-8, whatever they are",
    "beta1 = 0.9 and beta2 = 0.99, whatever they are",
    "beta1 = 0.9 and beta2 = 0.95, whatever they are",
    "beta1 = 0.9 and beta2 = 0.98, whatever they are",
    "beta1 = 0.5 and beta2 = 0.999, whatever they are",
    "beta1 = 0.99 and beta2 = 0.999, whatever they are",
    "beta1 = beta2 = 0.9, whatever they are",
    "beta1 and beta2 exchanged",
    "beta1 in the place of beta2",
    "beta2 in the place of beta1",
];

/// The mean of gradients.
const MEAN: [&str; 12] = [
    "beta1 m + (1 - beta1) g",
    "beta1 m + g",
    "(1 - beta1) g",
    "(1 - beta1) m + beta1 g",
    "beta1 m - lr g",
    "beta1 m + lr g",
    "beta1 m + (1 - beta1) lr g",
    "beta1 m - (1 - beta1) g",
    "beta1 m + (1 - beta1) g^2",
    "m + (1 - beta1) g",
    "beta1 m + (1 - beta2) g",
    "g",
];

/// The mean of squares.
const SQUARE: [&str; 14] = [
    "beta2 v + (1 - beta2) g^2",
    "beta2 v + (1 - beta2) g",
    "beta2 v + g^2",
    "(1 - beta2) g^2",
    "(1 - beta2) v + beta2 g^2",
    "beta2 v + (1 - beta2) |g|",
    "v + g^2",
    "max(v, beta2 v + (1 - beta2) g^2)",
    "beta2 v + (1 - beta2) m'^2",
    "beta2 v + (1 - beta2) (g - m')^2",
    "beta2 v + ((1 - beta2) g)^2",
    "beta2 v + (1 - beta1) g^2",
    "max(beta2 v, |g|)",
    "beta2 v + (1 - beta2) mean(g^2)",
];

/// The decay, Adam's and AdamW's first.
const DECAY: [&str; 17] = [
    "weight_decay p added to g",
    "lr weight_decay p taken off p",
    "no decay",
    "weight_decay p taken off p",
    "weight_decay p / 2 added to g",
    "lr weight_decay p' taken off what the step has made",
    "weight_decay p taken off p, times the corrected rate",
    "lr weight_decay p / 2 taken off p",
    "lr weight_decay p added to p",
    "weight_decay p taken off g",
    "2 weight_decay p added to g",
    "weight_decay p added to the corrected m'",
    "lr 0.01 p taken off p",
    "lr weight_decay g taken off p",
    "1e-4 p added to g",
    "lr weight_decay p added to g",
    "weight_decay p added to g and lr weight_decay p taken off p",
];

/// What the parameter loses.
const STEP: [&str; 15] = [
    "lr m' / (sqrt(v') + eps)",
    "-lr in the place of lr",
    "lr^2 in the place of lr",
    "1 in the place of lr",
    "lr (1 + weight_decay) in the place of lr",
    "lr / t in the place of lr",
    "lr / sqrt(t) in the place of lr",
    "0.001 in the place of lr",
    "g in the place of the corrected m'",
    "beta1 m' + (1 - beta1) g in the place of m' (Nesterov)",
    "beta1 m' / (1 - beta1^(t+1)) + (1 - beta1) g / (1 - beta1^t) in the place of the corrected m' (NAdam)",
    "max(v, v') in the place of v' (AMSGrad)",
    "m in the place of m'",
    "v in the place of v'",
    "lr / 10 in the place of lr",
];

/// What is corrected by c1 = 1 - beta1^t and c2 = 1 - beta2^t.
const CORRECTED: [&str; 10] = [
    "m' / c1 and v' / c2",
    "m' alone is corrected",
    "v' alone is corrected",
    "lr c2 / c1 in the place of lr sqrt(c2) / c1, c1 and c2 the corrections",
    "lr / (c1 c2) in the place of lr sqrt(c2) / c1, c1 and c2 the corrections",
    "the rate is corrected besides: both are corrected twice",
    "the corrections of m' and v' are exchanged",
    "v' is corrected as m' is",
    "v' times its correction",
    "the corrected m' and v' are kept",
];

/// The correction of a mean.
const CORRECTION: [&str; 13] = [
    "1 - beta^t",
    "1",
    "1 - beta",
    "1 - beta^(t+1)",
    "1 - beta^(t-1)",
    "1 - beta t",
    "1 - exp(-beta t)",
    "1 - exp(-beta (t-1))",
    "1 / (1 - beta^t)",
    "(1 - beta^t)^2",
    "1 + beta^t",
    "1 - beta^2",
    "1 - beta / t",
];

/// An eps that isn't asked.
const EPS: [f64; 10] = [0.0, 1e-8, 1e-7, 1e-6, 1e-10, 1e-5, 1e-12, 1e-15, 1e-4, 1e-3];

/// What m' is divided by.
const ROOT: [&str; 11] = [
    "sqrt(v') + eps",
    "sqrt(v' + eps)",
    "sqrt(v')",
    "sqrt(v') - eps",
    "sqrt(v' + eps) + eps",
    "v' + eps",
    "sqrt(sqrt(v')) + eps",
    "max(sqrt(v'), eps)",
    "sqrt(v' + eps^2)",
    "sqrt(|v'|) + eps",
    "1",
];

/// What is handed out for the means.
const KEPT: [&str; 4] = ["m' and v'", "m and v, as they came", "m' and v", "m and v'"];

const PARTS: usize = 11;

const CHOICES: [usize; PARTS] = [
    GRADIENT.len(),
    SETTINGS.len(),
    MEAN.len(),
    SQUARE.len(),
    DECAY.len(),
    STEP.len(),
    CORRECTED.len(),
    CORRECTION.len(),
    EPS.len(),
    ROOT.len(),
    KEPT.len(),
];

/// Those of Adam.
pub(crate) const OF_ADAM: Laws = Laws {
    choices: &CHOICES,
    says,
    of: |a, c, law| if law == [0; PARTS] { arrays::adam_step(a, c) } else { stepped(a, c, law) },
    rounding: &[],
};

/// Those of AdamW.
pub(crate) const OF_ADAMW: Laws = Laws {
    choices: &CHOICES,
    says: |part, choice| says(part, if part == 4 { decoupled(choice) } else { choice }),
    of: |a, c, law| {
        if law == [0; PARTS] {
            return arrays::adamw_step(a, c);
        }
        let mut law = law.to_vec();
        law[4] = decoupled(law[4]);
        stepped(a, c, &law)
    },
    rounding: &[],
};

/// The decay that a choice of AdamW's is: what is right for one optimizer is a choice of the other.
fn decoupled(choice: usize) -> usize {
    if choice < 2 { 1 - choice } else { choice }
}

fn says(part: usize, choice: usize) -> String {
    match part {
        0 => format!("{} in the place of g", GRADIENT[choice]),
        1 => SETTINGS[choice].into(),
        2 => format!("m' = {}", MEAN[choice]),
        3 => format!("v' = {}", SQUARE[choice]),
        4 => DECAY[choice].into(),
        5 => STEP[choice].into(),
        6 => CORRECTED[choice].into(),
        7 => format!("{} in the place of 1 - beta^t", CORRECTION[choice]),
        8 => format!("eps = {:e}, whatever it is", EPS[choice]),
        9 => format!("m' divided by {}", ROOT[choice]),
        _ => format!("{} handed out for m' and v'", KEPT[choice]),
    }
}

/// A step of each parameter; Adam's decay is the right one.
fn stepped(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (asked, t) = settings(a);
    let adam = of_its_own(asked, law);
    let [c1, c2] = [adam.beta1, adam.beta2].map(|beta| correction(beta, t, law[7]));
    let [by1, by2] = divided([c1, c2], law[6]);
    let grad = values(a, "grad");
    let squares: f64 = grad.iter().map(|g| g * g).sum();
    let (norm, mean_square) = (squares.sqrt(), squares / grad.len() as f64);
    let rate = rate(&adam, t as f64, law[5]);
    each_moved(a, c, |before, g| {
        let p = before.param;
        let g = gradient(g, norm, grad.len(), law[0]) + penalty(&adam, p, law[4]);
        let m = mean(&adam, before.m, g, law[2]);
        let v = square(&adam, [before.v, m, g], mean_square, law[3]);
        let upper = match law[5] {
            8 => g,
            9 => (adam.beta1 * m + (1.0 - adam.beta1) * g) / by1,
            10 => adam.beta1 * m / correction(adam.beta1, t + 1, law[7]) + (1.0 - adam.beta1) * g / by1,
            12 => before.m / by1,
            _ => m / by1,
        };
        let upper = if law[4] == 11 { upper + adam.weight_decay * p } else { upper };
        let lower = match law[5] {
            11 => before.v.max(v),
            13 => before.v,
            _ => v,
        };
        let root = match c.adam_eps {
            AdamEps::Corrected => root(lower / (by2 * by2), adam.eps, law[9]),
            AdamEps::Uncorrected => root(lower, adam.eps, law[9]) / by2,
        };
        let after = p - rate * upper / root;
        let param = after - taken_off(&adam, [p, after, g], rate * by2 / by1, law[4]);
        let (m, v) = if law[6] == 9 { (m / c1, v / c2) } else { (m, v) };
        let m = if matches!(law[10], 1 | 3) { before.m } else { m };
        let v = if matches!(law[10], 1 | 2) { before.v } else { v };
        Moments { param, m, v }
    })
}
