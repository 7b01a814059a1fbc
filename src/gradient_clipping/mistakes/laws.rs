//! Laws of a clip by the common norm: whose norm it is, which, when it counts, and what numbers are multiplied by.

use super::super::arrays::{self, by_norm, tensors};
use crate::contract::arrays::{Arrays, input, number};
use crate::contract::laws::{Guard, Laws};
use crate::convention::Conventions;

/// Whose norm shortens what.
const WHOSE: [&str; 6] = [
    "all tensors by the norm of all",
    "each tensor by its own norm",
    "the weights by their norm, the bias as it is",
    "all tensors by the norm of the weights",
    "all tensors by the norm of the bias",
    "each row by its own norm",
];

/// The norm.
const NORM: [&str; 13] = [
    "sqrt(sum of g^2)",
    "the sum of the tensors' norms",
    "sqrt(sqrt(sum of g^2))",
    "sum of g^2",
    "sum of |g|",
    "max |g|",
    "sqrt(mean of g^2)",
    "the longest tensor's norm",
    "sqrt(the sum of the tensors' norms)",
    "sqrt(the sum of the tensors' norms^4)",
    "the mean of the tensors' norms",
    "mean of |g|",
    "|sum of g|",
];

/// What an eps does; the first stands for what the convention adds.
const HELD: [Guard; 9] = [
    Guard::Nothing,
    Guard::Plus(1e-12),
    Guard::Plus(1e-5),
    Guard::Plus(1e-10),
    Guard::Plus(1e-4),
    Guard::Plus(1e-3),
    Guard::Plus(1.0),
    Guard::UnderRoot(1e-6),
    Guard::UnderRoot(1e-8),
];

/// When gradients are shortened.
const WHEN: [&str; 6] = [
    "where max_norm / norm < 1",
    "always",
    "where norm < max_norm",
    "where norm^2 > max_norm",
    "where norm > 1",
    "where norm > max_norm, whatever is added to it",
];

/// What becomes of them.
const BY: [&str; 10] = [
    "g max_norm / norm",
    "g / norm",
    "g max_norm",
    "g max_norm / norm^2",
    "g norm / max_norm",
    "g sqrt(max_norm / norm)",
    "g (max_norm / norm)^2",
    "g held between -max_norm and max_norm",
    "0",
    "g min(max_norm, max_norm / norm)",
];

/// What is told as the norm.
const TOLD: [&str; 4] = ["the norm before", "the norm after the clip", "norm^2", "max_norm / norm"];

/// Those of a clip by the common norm.
pub(crate) const OF_NORMS: Laws = Laws {
    choices: &[WHOSE.len(), NORM.len(), HELD.len(), WHEN.len(), BY.len(), TOLD.len()],
    says: |part, choice| match part {
        0 => WHOSE[choice].into(),
        1 => format!("norm = {}", NORM[choice]),
        2 => format!("{} in the place of norm", HELD[choice].said("norm")),
        3 => format!("shortened {}", WHEN[choice]),
        4 => format!("g' = {}", BY[choice]),
        _ => format!("{} returned for the norm", TOLD[choice]),
    },
    of,
    rounding: &[],
};

/// The norm of these tensors.
fn norm(tensors: &[&[f64]], choice: usize) -> f64 {
    let square = |tensor: &[f64]| tensor.iter().map(|g| g * g).sum::<f64>();
    let norms = || tensors.iter().map(|tensor| square(tensor).sqrt());
    let numbers = || tensors.iter().copied().flatten();
    let squares: f64 = tensors.iter().map(|tensor| square(tensor)).sum();
    let sizes: f64 = numbers().map(|g| g.abs()).sum();
    let n = numbers().count() as f64;
    match choice {
        1 => norms().sum(),
        2 => squares.sqrt().sqrt(),
        3 => squares,
        4 => sizes,
        5 => numbers().fold(0.0, |most, g| g.abs().max(most)),
        6 => (squares / n).sqrt(),
        7 => norms().fold(0.0, f64::max),
        8 => norms().sum::<f64>().sqrt(),
        9 => norms().map(|norm| norm.powi(4)).sum::<f64>().sqrt(),
        10 => norms().sum::<f64>() / tensors.len() as f64,
        11 => sizes / n,
        12 => numbers().sum::<f64>().abs(),
        _ => squares.sqrt(),
    }
}

/// What takes the place of the norm that is divided by.
fn held(norm: f64, c: &Conventions, choice: usize) -> f64 {
    if choice == 0 { norm + c.clip_eps.value() } else { HELD[choice].of(norm) }
}

/// Numbers as they are clipped by a norm.
fn clipped(numbers: &[f64], norm: f64, most: f64, c: &Conventions, law: &[usize]) -> Vec<f64> {
    let held = held(norm, c, law[2]);
    let shortened = match law[3] {
        0 => held > most,
        1 => true,
        2 => norm < most,
        3 => norm * norm > most,
        4 => norm > 1.0,
        _ => norm > most,
    };
    let one = |g: f64| match law[4] {
        9 => g * most.min(most / held),
        _ if !shortened => g,
        0 => g * (most / held),
        1 => g / held,
        2 => g * most,
        3 => g * most / (held * held),
        4 => g * held / most,
        5 => g * (most / held).sqrt(),
        6 => g * (most / held) * (most / held),
        7 => g.max(-most).min(most),
        _ => 0.0,
    };
    numbers.iter().map(|g| one(*g)).collect()
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return arrays::clip_by_global_norm(a, c);
    }
    let ([weights, bias], most) = (tensors(a), number(a, "max_norm"));
    let [w, b] = [&weights[..], &bias[..]];
    let norm = |tensors: &[&[f64]]| norm(tensors, law[1]);
    let by = |numbers: &[f64], norm: f64| clipped(numbers, norm, most, c, law);
    let all = match law[0] {
        2 | 3 => norm(&[w]),
        4 => norm(&[b]),
        _ => norm(&[w, b]),
    };
    let after = match law[0] {
        1 => [w, b].map(|tensor| by(tensor, norm(&[tensor]))),
        2 => [by(w, all), bias.clone()],
        5 => {
            let width = input(a, "g_weights").shape()[1].max(1);
            [w.chunks(width).flat_map(|row| by(row, norm(&[row]))).collect(), by(b, norm(&[b]))]
        }
        _ => [by(w, all), by(b, all)],
    };
    let told = match law[5] {
        1 => norm(&[&after[0], &after[1]]),
        2 => all * all,
        3 => most / held(all, c, law[2]),
        _ => all,
    };
    by_norm(a, after, told)
}
