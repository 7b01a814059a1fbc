//! Laws of Huber's loss: of which differences, by which delta, which pieces are where, how often the loss is taken, and what is averaged.

use super::super::arrays::{forward, huber};
use super::super::reduced;
use super::differences::{DIFFERENCE, Differences};
use crate::contract::arrays::{Arrays, number};
use crate::contract::laws::Laws;
use crate::convention::{Conventions, HuberSlope};
use crate::math::{exp, ln};

/// Delta.
const DELTA: [&str; 12] = [
    "delta",
    "1",
    "0.1",
    "0.5",
    "0.01",
    "delta^2",
    "2 delta",
    "delta / 2",
    "1 / delta",
    "sqrt(delta)",
    "1.345",
    "0.2",
];

/// The piece inside.
const INSIDE: [&str; 9] = [
    "d^2 / 2",
    "d^2",
    "d^2 / (2 delta)",
    "d^2 / delta",
    "delta d^2 / 2",
    "d^2 / 4",
    "|d|",
    "|d| / 2",
    "d^2 / (2 delta^2)",
];

/// The piece beyond.
const BEYOND: [&str; 17] = [
    "delta (|d| - delta / 2)",
    "|d| - delta / 2",
    "delta |d|",
    "|d|",
    "|d| - 1/2",
    "delta (|d| - 1/2)",
    "delta |d| - 1/2",
    "delta (|d| - delta)",
    "delta (2 |d| - delta)",
    "delta^2 / 2",
    "delta |d| + delta^2 / 2",
    "delta (d - delta / 2)",
    "delta |d| - delta / 2",
    "delta^2",
    "0",
    "(|d| - delta / 2) / delta",
    "delta^2 / 2 + |d| - delta",
];

/// Which piece is where, or what is in their place.
const PIECES: [&str; 19] = [
    "inside where |d| <= delta",
    "inside where d^2 <= delta",
    "inside where d <= delta",
    "inside everywhere",
    "beyond everywhere",
    "inside where |d| > delta",
    "the smaller piece",
    "the larger piece",
    "the sum of both",
    "inside where the mean of |d| is delta at most",
    "inside where every |d| is delta at most",
    "inside where d^2 / 2 <= delta",
    "delta^2 (sqrt(1 + (d / delta)^2) - 1)",
    "sqrt(1 + (d / delta)^2) - 1",
    "delta (sqrt(1 + (d / delta)^2) - 1)",
    "sqrt(d^2 + delta^2)",
    "delta^2 sqrt(1 + (d / delta)^2)",
    "delta^2 / 2 ln(1 + (d / delta)^2)",
    "ln cosh d",
];

/// How often the loss is taken.
const TIMES: [&str; 5] = ["1", "2", "1/2", "delta", "1 / delta^2"];

/// What is averaged.
const AVERAGED: [&str; 7] = [
    "every number, or added up, as it is by convention",
    "rays, the sum over channels of each",
    "the numbers of each piece, the two means added",
    "what is made of the mean of |d|",
    "what is made of each color's length",
    "what is made of the root of the mean of d^2",
    "the first axis, all else added up",
];

/// Those of Huber's loss.
pub(crate) const OF_HUBER: Laws = Laws {
    choices: &[
        DIFFERENCE.len(),
        DELTA.len(),
        INSIDE.len(),
        BEYOND.len(),
        PIECES.len(),
        TIMES.len(),
        AVERAGED.len(),
    ],
    says: |part, choice| match part {
        0 => format!("d = {}", DIFFERENCE[choice]),
        1 => format!("{} for delta", DELTA[choice]),
        2 => format!("inside {}", INSIDE[choice]),
        3 => format!("beyond {}", BEYOND[choice]),
        4 => format!("of the pieces: {}", PIECES[choice]),
        5 => format!("{} times that", TIMES[choice]),
        _ => format!("averaged: {}", AVERAGED[choice]),
    },
    of: of_huber,
    rounding: &[],
};

fn other_delta(delta: f64, choice: usize) -> f64 {
    match choice {
        1 => 1.0,
        2 => 0.1,
        3 => 0.5,
        4 => 0.01,
        5 => delta * delta,
        6 => 2.0 * delta,
        7 => 0.5 * delta,
        8 => 1.0 / delta,
        9 => delta.sqrt(),
        10 => 1.345,
        11 => 0.2,
        _ => delta,
    }
}

fn inside(d: f64, delta: f64, choice: usize) -> f64 {
    match choice {
        1 => d * d,
        2 => d * d / (2.0 * delta),
        3 => d * d / delta,
        4 => 0.5 * delta * d * d,
        5 => 0.25 * d * d,
        6 => d.abs(),
        7 => 0.5 * d.abs(),
        8 => 0.5 * d * d / (delta * delta),
        _ => 0.5 * d * d,
    }
}

fn beyond(d: f64, delta: f64, choice: usize) -> f64 {
    let (size, half) = (d.abs(), 0.5 * delta);
    match choice {
        1 => size - half,
        2 => delta * size,
        3 => size,
        4 => size - 0.5,
        5 => delta * (size - 0.5),
        6 => delta * size - 0.5,
        7 => delta * (size - delta),
        8 => delta * (2.0 * size - delta),
        9 => delta * half,
        10 => delta * (size + half),
        11 => delta * (d - half),
        12 => delta * size - half,
        13 => delta * delta,
        14 => 0.0,
        15 => (size - half) / delta,
        16 => delta * half + size - delta,
        _ => delta * (size - half),
    }
}

/// Whether a difference is inside, where one of two pieces is taken.
fn is_inside(d: f64, delta: f64, all: &Differences, choice: usize) -> bool {
    match choice {
        1 => d * d <= delta,
        2 => d <= delta,
        3 => true,
        4 => false,
        5 => d.abs() > delta,
        9 => all.mean(1) <= delta,
        10 => all.d.iter().all(|d| d.abs() <= delta),
        11 => 0.5 * d * d <= delta,
        _ => d.abs() <= delta,
    }
}

fn one_of_huber(d: f64, delta: f64, all: &Differences, law: &[usize]) -> f64 {
    let (low, high) = (inside(d, delta, law[2]), beyond(d, delta, law[3]));
    let root = (1.0 + (d / delta) * (d / delta)).sqrt();
    match law[4] {
        6 => low.min(high),
        7 => low.max(high),
        8 => low + high,
        12 => delta * delta * (root - 1.0),
        13 => root - 1.0,
        14 => delta * (root - 1.0),
        15 => (d * d + delta * delta).sqrt(),
        16 => delta * delta * root,
        17 => 0.5 * delta * delta * ln(1.0 + (d / delta) * (d / delta)),
        // ln cosh d, without numbers that overflow.
        18 => d.abs() + ln(0.5 + 0.5 * exp(-2.0 * d.abs())),
        _ if is_inside(d, delta, all, law[4]) => low,
        _ => high,
    }
}

fn of_huber(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return huber(a, c);
    }
    let all = Differences::new(a, law[0]);
    let delta = other_delta(number(a, "delta"), law[1]);
    let one = |d: &f64| one_of_huber(*d, delta, &all, law);
    let n = all.d.len();
    let sum = || all.d.iter().map(one).sum::<f64>();
    let over = |parts: usize| sum() / parts as f64;
    let piece = |kept: bool| {
        let those: Vec<f64> =
            all.d.iter().filter(|d| is_inside(**d, delta, &all, law[4]) == kept).map(one).collect();
        if those.is_empty() { 0.0 } else { those.iter().sum::<f64>() / those.len() as f64 }
    };
    let value = match law[6] {
        0 => reduced(sum(), n, c.loss_reduction),
        1 => over(n / all.channels),
        2 => piece(true) + piece(false),
        3 => one(&all.mean(1)),
        4 => {
            let lengths: Vec<f64> = all.squares().into_iter().map(f64::sqrt).collect();
            reduced(lengths.iter().map(one).sum(), lengths.len(), c.loss_reduction)
        }
        5 => one(&all.mean(2).sqrt()),
        _ => over(n / all.first),
    };
    let value = if c.huber_slope == HuberSlope::One { value / delta } else { value };
    forward(match law[5] {
        1 => 2.0 * value,
        2 => 0.5 * value,
        3 => delta * value,
        4 => value / (delta * delta),
        _ => value,
    })
}
