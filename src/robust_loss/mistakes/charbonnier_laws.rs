//! Laws of Charbonnier's loss: of which differences, by which eps, what is under which root, what is made of that, and what is averaged.

use super::super::arrays::{charbonnier, forward};
use super::super::reduced;
use super::differences::{DIFFERENCE, Differences};
use crate::contract::arrays::{Arrays, number};
use crate::contract::laws::Laws;
use crate::convention::{CharbonnierEps, Conventions};
use crate::math::{ln, pow};

/// Eps.
const EPS: [&str; 12] =
    ["eps", "1e-3", "1e-6", "1e-8", "1e-4", "1e-2", "1e-5", "1e-9", "1e-12", "eps^2", "2 eps", "1"];

/// What is under the root.
const UNDER: [&str; 10] = [
    "d^2 + eps^2",
    "d^2 - eps^2",
    "d^2",
    "|d| + eps^2",
    "(|d| + eps)^2",
    "(d + eps)^2",
    "max(d^2, eps^2)",
    "1 + (d / eps)^2",
    "d^2 + 2 eps^2",
    "(d / eps)^2 + eps^2",
];

/// The root.
const ROOT: [&str; 9] = ["sqrt(u)", "u", "u^0.45", "u^0.25", "u^0.4", "u / 2", "u^2", "ln(1 + u)", "ln(u)"];

/// What is made of the root.
const MADE: [&str; 10] =
    ["s", "s - eps", "s - 1", "s / eps", "eps s", "eps^2 (s - 1)", "2 s", "s / 2", "s + eps", "eps (s - 1)"];

/// What is averaged.
const OVER: [&str; 8] = [
    "every number, or added up, as it is by convention",
    "colors, the root over the sum over channels",
    "colors, the root over the mean over channels",
    "rays, the sum over channels of each",
    "the root over the mean of all",
    "the root over the sum of all",
    "the root over the mean of |d|",
    "the first axis, all else added up",
];

/// Those of Charbonnier's loss.
pub(crate) const OF_CHARBONNIER: Laws = Laws {
    choices: &[DIFFERENCE.len(), EPS.len(), UNDER.len(), ROOT.len(), MADE.len(), OVER.len()],
    says: |part, choice| match part {
        0 => format!("d = {}", DIFFERENCE[choice]),
        1 => format!("{} for eps", EPS[choice]),
        2 => format!("u = {}", UNDER[choice]),
        3 => format!("s = {}", ROOT[choice]),
        4 => format!("loss = {}", MADE[choice]),
        _ => format!("averaged: {}", OVER[choice]),
    },
    of: of_charbonnier,
    rounding: &[],
};

fn other_eps(eps: f64, choice: usize) -> f64 {
    match choice {
        1 => 1e-3,
        2 => 1e-6,
        3 => 1e-8,
        4 => 1e-4,
        5 => 1e-2,
        6 => 1e-5,
        7 => 1e-9,
        8 => 1e-12,
        9 => eps * eps,
        10 => 2.0 * eps,
        11 => 1.0,
        _ => eps,
    }
}

/// What is made of a difference whose square this is; `d` has its sign.
fn one_of_charbonnier(d: f64, squared: f64, [eps, added]: [f64; 2], law: &[usize]) -> f64 {
    let u = match law[2] {
        1 => squared - added,
        2 => squared,
        3 => squared.sqrt() + added,
        4 => (squared.sqrt() + eps) * (squared.sqrt() + eps),
        5 => (d + eps) * (d + eps),
        6 => squared.max(added),
        7 => 1.0 + squared / added,
        8 => squared + 2.0 * added,
        9 => squared / added + added,
        _ => squared + added,
    };
    let s = match law[3] {
        1 => u,
        2 => pow(u, 0.45),
        3 => u.sqrt().sqrt(),
        4 => pow(u, 0.4),
        5 => 0.5 * u,
        6 => u * u,
        7 => ln(1.0 + u),
        8 => ln(u),
        _ => u.sqrt(),
    };
    match law[4] {
        1 => s - eps,
        2 => s - 1.0,
        3 => s / eps,
        4 => eps * s,
        5 => eps * eps * (s - 1.0),
        6 => 2.0 * s,
        7 => 0.5 * s,
        8 => s + eps,
        9 => eps * (s - 1.0),
        _ => s,
    }
}

fn of_charbonnier(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return charbonnier(a, c);
    }
    let all = Differences::new(a, law[0]);
    let eps = other_eps(number(a, "eps"), law[1]);
    let added = if c.charbonnier_eps == CharbonnierEps::Square { eps * eps } else { eps };
    let n = all.d.len();
    let one = |d: f64, squared: f64| one_of_charbonnier(d, squared, [eps, added], law);
    let sum = || all.d.iter().map(|d| one(*d, d * d)).sum::<f64>();
    let of_square = |squared: f64| one(squared.sqrt(), squared);
    let of_colors = |parts: usize| {
        let squares = all.squares();
        let roots = squares.iter().map(|square| of_square(square / parts as f64)).sum();
        reduced(roots, squares.len(), c.loss_reduction)
    };
    forward(match law[5] {
        0 => reduced(sum(), n, c.loss_reduction),
        1 => of_colors(1),
        2 => of_colors(all.channels),
        3 => sum() / (n / all.channels) as f64,
        4 => of_square(all.mean(2)),
        5 => of_square(all.mean(2) * n as f64),
        6 => one(all.mean(1), all.mean(1) * all.mean(1)),
        _ => sum() / (n / all.first) as f64,
    })
}
