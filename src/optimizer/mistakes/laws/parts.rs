//! The parts of a step of Adam's or AdamW's, by what is chosen: the first choice is the right one.

use super::super::super::{Adam, bias_correction};
use super::EPS;
use crate::math::exp;

/// What becomes of the settings.
pub(super) fn of_its_own(mut adam: Adam, law: &[usize]) -> Adam {
    (adam.beta1, adam.beta2) = match law[1] {
        1 | 2 => (0.9, 0.999),
        3 => (0.9, 0.99),
        4 => (0.9, 0.95),
        5 => (0.9, 0.98),
        6 => (0.5, 0.999),
        7 => (0.99, 0.999),
        8 => (0.9, 0.9),
        9 => (adam.beta2, adam.beta1),
        10 => (adam.beta1, adam.beta1),
        11 => (adam.beta2, adam.beta2),
        _ => (adam.beta1, adam.beta2),
    };
    adam.eps = if law[8] > 0 { EPS[law[8]] } else { adam.eps };
    adam.eps = if law[1] == 2 { 1e-8 } else { adam.eps };
    adam
}

pub(super) fn gradient(g: f64, norm: f64, n: usize, choice: usize) -> f64 {
    match choice {
        1 => g.clamp(-1.0, 1.0),
        2 => g / norm.max(1.0),
        3 => g.clamp(-1e3, 1e3),
        4 => g.clamp(-5.0, 5.0),
        5 => g.clamp(-10.0, 10.0),
        6 => g / norm,
        7 => -g,
        8 => g / n as f64,
        _ => g,
    }
}

/// What is added to the gradient.
pub(super) fn penalty(adam: &Adam, p: f64, choice: usize) -> f64 {
    let decay = adam.weight_decay * p;
    match choice {
        0 | 16 => decay,
        4 => 0.5 * decay,
        9 => -decay,
        10 => 2.0 * decay,
        14 => 1e-4 * p,
        15 => adam.lr * decay,
        _ => 0.0,
    }
}

/// What is taken off the parameter, besides the step: before it, and after it, with a corrected rate of so much.
pub(super) fn taken_off(adam: &Adam, [p, after, g]: [f64; 3], corrected_rate: f64, choice: usize) -> f64 {
    let decay = adam.lr * adam.weight_decay;
    match choice {
        1 | 16 => decay * p,
        3 => adam.weight_decay * p,
        5 => decay * after,
        6 => corrected_rate * adam.weight_decay * p,
        7 => 0.5 * decay * p,
        8 => -decay * p,
        12 => 0.01 * adam.lr * p,
        13 => decay * g,
        _ => 0.0,
    }
}

pub(super) fn mean(adam: &Adam, m: f64, g: f64, choice: usize) -> f64 {
    let Adam { beta1, beta2, lr, .. } = *adam;
    match choice {
        1 => beta1 * m + g,
        2 => (1.0 - beta1) * g,
        3 => (1.0 - beta1) * m + beta1 * g,
        4 => beta1 * m - lr * g,
        5 => beta1 * m + lr * g,
        6 => beta1 * m + (1.0 - beta1) * lr * g,
        7 => beta1 * m - (1.0 - beta1) * g,
        8 => beta1 * m + (1.0 - beta1) * g * g,
        9 => m + (1.0 - beta1) * g,
        10 => beta1 * m + (1.0 - beta2) * g,
        11 => g,
        _ => beta1 * m + (1.0 - beta1) * g,
    }
}

/// The mean of squares after the mean `m`, where all gradients' mean square is so much.
pub(super) fn square(adam: &Adam, [v, m, g]: [f64; 3], mean_square: f64, choice: usize) -> f64 {
    let (beta, rest) = (adam.beta2, 1.0 - adam.beta2);
    match choice {
        1 => beta * v + rest * g,
        2 => beta * v + g * g,
        3 => rest * g * g,
        4 => rest * v + beta * g * g,
        5 => beta * v + rest * g.abs(),
        6 => v + g * g,
        7 => v.max(beta * v + rest * g * g),
        8 => beta * v + rest * m * m,
        9 => beta * v + rest * (g - m) * (g - m),
        10 => beta * v + rest * rest * g * g,
        11 => beta * v + (1.0 - adam.beta1) * g * g,
        12 => (beta * v).max(g.abs()),
        13 => beta * v + rest * mean_square,
        _ => beta * v + rest * g * g,
    }
}

pub(super) fn correction(beta: f64, t: u64, choice: usize) -> f64 {
    let (right, steps) = (bias_correction(beta, t), t as f64);
    match choice {
        1 => 1.0,
        2 => 1.0 - beta,
        3 => bias_correction(beta, t + 1),
        4 => bias_correction(beta, t.saturating_sub(1)),
        5 => 1.0 - beta * steps,
        6 => 1.0 - exp(-beta * steps),
        7 => 1.0 - exp(-beta * (steps - 1.0)),
        8 => 1.0 / right,
        9 => right * right,
        10 => 2.0 - right,
        11 => 1.0 - beta * beta,
        12 => 1.0 - beta / steps,
        _ => right,
    }
}

/// What m' and the root of v' are divided by, of their corrections.
pub(super) fn divided([c1, c2]: [f64; 2], choice: usize) -> [f64; 2] {
    match choice {
        1 => [c1, 1.0],
        2 => [1.0, c2.sqrt()],
        3 => [c1, c2],
        4 => [c1, 1.0 / c2],
        5 => [c1 * c1 / c2.sqrt(), c2.sqrt()],
        6 => [c2, c1.sqrt()],
        7 => [c1, c1.sqrt()],
        8 => [c1, 1.0 / c2.sqrt()],
        _ => [c1, c2.sqrt()],
    }
}

pub(super) fn root(v: f64, eps: f64, choice: usize) -> f64 {
    match choice {
        1 => (v + eps).sqrt(),
        2 => v.sqrt(),
        3 => v.sqrt() - eps,
        4 => (v + eps).sqrt() + eps,
        5 => v + eps,
        6 => v.sqrt().sqrt() + eps,
        7 => v.sqrt().max(eps),
        8 => (v + eps * eps).sqrt(),
        9 => v.abs().sqrt() + eps,
        10 => 1.0,
        _ => v.sqrt() + eps,
    }
}

/// The rate of a step.
pub(super) fn rate(adam: &Adam, t: f64, choice: usize) -> f64 {
    match choice {
        1 => -adam.lr,
        2 => adam.lr * adam.lr,
        3 => 1.0,
        4 => adam.lr * (1.0 + adam.weight_decay),
        5 => adam.lr / t,
        6 => adam.lr / t.sqrt(),
        7 => 0.001,
        14 => 0.1 * adam.lr,
        _ => adam.lr,
    }
}
