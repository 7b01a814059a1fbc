//! Laws of the positional encoding: which bands, which waves, and of what.

use super::super::arrays::{dims, settings};
use super::super::{Encoding, positional_encoding, wave};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::math::{cos, exp, pow, sin};

/// The bands, in the place of 2^k and of what the convention multiplies them with.
const BANDS: [&str; 20] = [
    "as they are by convention",
    "k",
    "k + 1",
    "k pi",
    "(k + 1) pi",
    "2 pi k",
    "2 pi (k + 1)",
    "k^2",
    "2^(k + 1)",
    "2^(k + 1) pi",
    "2^(k - 1) pi",
    "2^(L - 1 - k)",
    "2^-k",
    "2^-k pi",
    "10000^(-k / L)",
    "10000^(-2 k / L)",
    "e^k",
    "1 + k (L - 1) / L",
    "2^(k (L - 1) / L)",
    "1",
];

/// The waves.
const WAVES: [&str; 8] = [
    "sin, cos",
    "cos, sin",
    "sin, sin",
    "cos, cos",
    "sin, -cos",
    "-sin, cos",
    "sin, cos of the band before",
    "sin, sin(x + pi / 2) without the band",
];

/// What is encoded.
const OF: [&str; 9] = [
    "x",
    "2 x - 1",
    "(x + 1) / 2",
    "x / 2",
    "2 x",
    "x / pi",
    "x over its length",
    "x mapped from the points' least to their largest onto -1 to 1",
    "x mapped from the points' least to their largest onto 0 to 1",
];

/// What stands for x itself.
const ITSELF: [&str; 4] = ["what is encoded", "x", "0", "pi x"];

/// Those of a point.
pub(crate) const OF_POINTS: Laws = Laws {
    choices: &[BANDS.len(), WAVES.len(), OF.len(), ITSELF.len()],
    says: |part, choice| match part {
        0 => format!("bands {}", BANDS[choice]),
        1 => format!("waves {}", WAVES[choice]),
        2 => format!("{} in the place of x", OF[choice]),
        _ => format!("{} for x itself", ITSELF[choice]),
    },
    of,
    rounding: &[],
};

fn band(k: usize, levels: usize, choice: usize) -> f64 {
    let (k, levels, pi) = (k as f64, levels as f64, std::f64::consts::PI);
    match choice {
        1 => k,
        2 => k + 1.0,
        3 => k * pi,
        4 => (k + 1.0) * pi,
        5 => 2.0 * pi * k,
        6 => 2.0 * pi * (k + 1.0),
        7 => k * k,
        8 => pow(2.0, k + 1.0),
        9 => pow(2.0, k + 1.0) * pi,
        10 => pow(2.0, k - 1.0) * pi,
        11 => pow(2.0, levels - 1.0 - k),
        12 => pow(2.0, -k),
        13 => pow(2.0, -k) * pi,
        14 => pow(10_000.0, -k / levels),
        15 => pow(10_000.0, -2.0 * k / levels),
        16 => exp(k),
        17 => 1.0 + k * (levels - 1.0) / levels,
        18 => pow(2.0, k * (levels - 1.0) / levels),
        _ => 1.0,
    }
}

fn waves(encoding: &Encoding, k: usize, x: f64, law: &[usize]) -> (f64, f64) {
    let at = |k: usize| match law[0] {
        0 => wave(encoding.frequency, encoding.band(k), x),
        n => {
            let angle = band(k, encoding.levels, n) * x;
            (sin(angle), cos(angle))
        }
    };
    let (sin, cos) = at(k);
    match law[1] {
        0 => (sin, cos),
        1 => (cos, sin),
        2 => (sin, sin),
        3 => (cos, cos),
        4 => (sin, -cos),
        5 => (-sin, cos),
        6 => (sin, at(k.max(1) - 1).1),
        _ => (sin, crate::math::sin(x + std::f64::consts::FRAC_PI_2)),
    }
}

/// What is encoded of a point; `ends` are the least and the largest of each coordinate.
fn encoded(x: &[f64], ends: &[[f64; 2]], choice: usize) -> Vec<f64> {
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let share = |(x, [least, most]): (&f64, &[f64; 2])| (x - least) / (most - least);
    let each = |f: &dyn Fn(f64) -> f64| x.iter().map(|x| f(*x)).collect::<Vec<f64>>();
    match choice {
        0 => x.to_vec(),
        1 => each(&|x| 2.0 * x - 1.0),
        2 => each(&|x| 0.5 * (x + 1.0)),
        3 => each(&|x| 0.5 * x),
        4 => each(&|x| 2.0 * x),
        5 => each(&|x| x / std::f64::consts::PI),
        6 => each(&|x| x / length),
        7 => x.iter().zip(ends).map(|x| 2.0 * share(x) - 1.0).collect(),
        _ => x.iter().zip(ends).map(share).collect(),
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (encoding, dims, points) = (settings(a, c), dims(a), rows(a, "x"));
    let end = |d: usize| {
        let of = || points.iter().map(move |x| x[d]);
        [of().fold(f64::INFINITY, f64::min), of().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ends: Vec<[f64; 2]> = (0..dims).map(end).collect();
    let point = |x: &Vec<f64>| {
        let own = encoded(x, &ends, law[2]);
        let mut out = positional_encoding(&own, &encoding);
        if law[..2] != [0, 0] {
            for (k, d) in (0..encoding.levels).flat_map(|k| (0..dims).map(move |d| (k, d))) {
                let (sin, cos) = waves(&encoding, k, own[d], law);
                out[encoding.column(dims, k, d, 0)] = sin;
                out[encoding.column(dims, k, d, 1)] = cos;
            }
        }
        for d in (0..dims).filter(|_| encoding.identity) {
            out[encoding.identity_column(dims, d)] = match law[3] {
                0 => own[d],
                1 => x[d],
                2 => 0.0,
                _ => std::f64::consts::PI * own[d],
            };
        }
        out
    };
    let out: Vec<Vec<f64>> = points.iter().map(point).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims)))])
}
