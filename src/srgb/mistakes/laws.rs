//! Laws of the sRGB curve: what is done to the light first, the two pieces and where they meet, and what is done to the result.

use super::super::arrays::forward;
use super::super::{THRESHOLD, linear_to_srgb};
use crate::contract::arrays::values;
use crate::contract::laws::Laws;
use crate::math::pow;

/// What the light is made first.
const FIRST: [&str; 13] = [
    "x",
    "x clamped to [0, 1]",
    "x + 1e-8",
    "x + 1e-6",
    "max(x, 1e-8)",
    "max(x, 1e-6)",
    "max(x, 1e-5)",
    "max(x, 1e-4)",
    "x / (1 + x)",
    "the curve of x",
    "floor(255 x) / 255",
    "round(255 x) / 255",
    "x / max x",
];

/// Which piece is where.
const PIECES: [&str; 7] = [
    "the straight piece below",
    "the straight piece above",
    "the larger piece",
    "the smaller piece",
    "the sum of both pieces",
    "the straight piece below, and both added above",
    "the straight piece below, in place: then the power of all that is above by then",
];

/// Where the pieces meet.
const THRESHOLDS: [(&str, f64); 11] = [
    ("0.0031308", THRESHOLD),
    ("0.04045", 0.04045),
    ("0, without a straight piece", f64::NEG_INFINITY),
    ("0.031308", 0.031308),
    ("0.003", 0.003),
    ("0.03928", 0.03928),
    ("0.04", 0.04),
    ("0.018", 0.018),
    ("0.00031308", 0.000_313_08),
    ("0.5", 0.5),
    ("0.01", 0.01),
];

/// The straight piece.
const STRAIGHT: [&str; 10] =
    ["12.92 x", "x", "x / 12.92", "12.5 x", "0", "4.5 x", "12.9 x", "12.92 x - b", "12 x", "1.292 x"];

/// The power.
const EXPONENTS: [(&str, f64); 14] = [
    ("1 / 2.4", 1.0 / 2.4),
    ("2.4", 2.4),
    ("1 / 2.2", 1.0 / 2.2),
    ("2.2", 2.2),
    ("1 / 2", 0.5),
    ("0.41666", 0.41666),
    ("0.4167", 0.4167),
    ("0.4166", 0.4166),
    ("0.416", 0.416),
    ("0.42", 0.42),
    ("0.45", 0.45),
    ("1 / 2.5", 0.4),
    ("1 / 3", 1.0 / 3.0),
    ("1 / 2.6", 1.0 / 2.6),
];

/// What is taken off.
const OFFSETS: [(&str, f64); 8] = [
    ("0.055", 0.055),
    ("0", 0.0),
    ("0.05", 0.05),
    ("-0.055", -0.055),
    ("0.099", 0.099),
    ("0.005", 0.005),
    ("0.55", 0.55),
    ("0.0055", 0.0055),
];

/// The curved piece.
const CURVED: [&str; 12] = [
    "1.055 x^k - b",
    "(1.055 x)^k - b",
    "x^k - b",
    "1.055 (x^k - b)",
    "x^k for every x",
    "1.055 (x - b)^k",
    "(1.055 x - b)^k",
    "1.055 x^(k - b)",
    "((x + b) / 1.055)^k",
    "(x^k + b) / 1.055",
    "1.05 x^k - b",
    "1.55 x^k - b",
];

/// What the result is made.
const LAST: [&str; 7] = [
    "s",
    "s clamped to [0, 1]",
    "max(s, 0)",
    "floor(255 s) / 255",
    "round(255 s) / 255",
    "255 s",
    "round(255 s)",
];

/// Those of the curve.
pub(crate) const OF_LIGHT: Laws = Laws {
    choices: &[
        FIRST.len(),
        PIECES.len(),
        THRESHOLDS.len(),
        STRAIGHT.len(),
        EXPONENTS.len(),
        OFFSETS.len(),
        CURVED.len(),
        LAST.len(),
    ],
    says: |part, choice| match part {
        0 => format!("of {}", FIRST[choice]),
        1 => PIECES[choice].into(),
        2 => format!("the pieces meet at {}", THRESHOLDS[choice].0),
        3 => format!("the straight piece is {}", STRAIGHT[choice]),
        4 => format!("k = {}", EXPONENTS[choice].0),
        5 => format!("b = {}", OFFSETS[choice].0),
        6 => format!("the curved piece is {}", CURVED[choice]),
        _ => format!("srgb = {}", LAST[choice]),
    },
    of: |a, _, law| {
        let most = values(a, "linear").into_iter().fold(0.0, f64::max);
        forward(a, |x| of(x, most, law))
    },
    rounding: &[(0, 10), (0, 11), (7, 3), (7, 4), (7, 6)],
};

/// The light, of which that of the brightest is `most`.
fn first(x: f64, most: f64, choice: usize) -> f64 {
    match choice {
        1 => x.clamp(0.0, 1.0),
        2 => x + 1e-8,
        3 => x + 1e-6,
        4 => x.max(1e-8),
        5 => x.max(1e-6),
        6 => x.max(1e-5),
        7 => x.max(1e-4),
        8 => x / (1.0 + x),
        9 => linear_to_srgb(x),
        10 => (255.0 * x).floor() / 255.0,
        11 => (255.0 * x).round() / 255.0,
        12 => x / most,
        _ => x,
    }
}

fn straight(x: f64, b: f64, choice: usize) -> f64 {
    match choice {
        1 => x,
        2 => x / 12.92,
        3 => 12.5 * x,
        4 => 0.0,
        5 => 4.5 * x,
        6 => 12.9 * x,
        7 => 12.92 * x - b,
        8 => 12.0 * x,
        9 => 1.292 * x,
        _ => 12.92 * x,
    }
}

fn curved(x: f64, k: f64, b: f64, choice: usize) -> f64 {
    match choice {
        1 => pow(1.055 * x, k) - b,
        2 => pow(x, k) - b,
        3 => 1.055 * (pow(x, k) - b),
        4 => pow(x, k),
        5 => 1.055 * pow(x - b, k),
        6 => pow(1.055 * x - b, k),
        7 => 1.055 * pow(x, k - b),
        8 => pow((x + b) / 1.055, k),
        9 => (pow(x, k) + b) / 1.055,
        10 => 1.05 * pow(x, k) - b,
        11 => 1.55 * pow(x, k) - b,
        _ => 1.055 * pow(x, k) - b,
    }
}

fn of(x: f64, most: f64, law: &[usize]) -> f64 {
    let x = first(x, most, law[0]);
    let (at, k, b) = (THRESHOLDS[law[2]].1, EXPONENTS[law[4]].1, OFFSETS[law[5]].1);
    let (low, high) = (straight(x, b, law[3]), curved(x, k, b, law[6]));
    let below = x <= at;
    let s = match law[1] {
        _ if law[6] == 4 => high,
        0 if below => low,
        1 if !below => low,
        2 => low.max(high),
        3 => low.min(high),
        4 => low + high,
        5 if below => low,
        5 => low + high,
        6 if below && low > at => curved(low, k, b, law[6]),
        6 if below => low,
        _ => high,
    };
    match law[7] {
        0 => s,
        1 => s.clamp(0.0, 1.0),
        2 => s.max(0.0),
        3 => (255.0 * s).floor() / 255.0,
        4 => (255.0 * s).round() / 255.0,
        5 => 255.0 * s,
        _ => (255.0 * s).round(),
    }
}
