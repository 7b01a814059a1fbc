//! Laws of the expected distance: what the weights weigh, what that is divided by, and what is made of it.

use super::super::arrays::depths;
use super::super::product;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size};
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::math::exp;

/// What is weighed.
const WEIGHED: [&str; 14] = [
    "t_i",
    "t_{i+1} - t_i, the last one 0",
    "t_{i+1} - t_i, the last one 1e10",
    "t_{i+1} - t_i, the last one up to far",
    "t_{i+1} - t_i, the last one as the one before",
    "1 / t_i",
    "t_i^2",
    "i",
    "i + 1",
    "i / N",
    "t_i / far",
    "t_i - t_0",
    "(t_i + t_{i+1}) / 2",
    "t_{i+1}",
];

/// What it is divided by, and what an empty ray has.
const OVER: [&str; 8] =
    ["as it is by convention", "1", "A", "A + 1e-10", "A + 1e-6", "N", "the largest w", "A, at least 1e-6"];

/// What comes to it.
const MORE: [&str; 5] = ["nothing", "(1 - A) far", "(1 - A) t_{N-1}", "1 - A", "A far"];

/// What is made of that.
const MADE: [&str; 8] = [
    "z",
    "1 / z",
    "z / far",
    "1 - z / far",
    "1 / max(z, 1e-10)",
    "sqrt(z)",
    "exp(-z)",
    "z, held between t_0 and t_{N-1}",
];

/// How it is found.
const HOW: [&str; 5] = [
    "weighed",
    "t where the sum of weights reaches 1/2",
    "t where the sum of weights reaches half of all of them",
    "t of the largest weight",
    "t of the first weight",
];

/// What weighs.
const WEIGHTS: [&str; 8] =
    ["w_i", "w_i + 1e-5", "w_i + 1e-6", "w_i + 1e-8", "w_i + 1e-10", "w_i + 1e-3", "w_i^2", "sqrt(w_i)"];

/// Those of depths.
pub(crate) const OF_DEPTHS: Laws = Laws {
    choices: &[WEIGHED.len(), OVER.len(), MORE.len(), MADE.len(), HOW.len(), WEIGHTS.len()],
    says: |part, choice| match part {
        0 => format!("{} in the place of t_i", WEIGHED[choice]),
        1 => format!("sum_i w_i t_i divided by {}", OVER[choice]),
        2 => format!("{} added", MORE[choice]),
        3 => format!("depth = {}", MADE[choice]),
        4 => format!("depth z = {}", HOW[choice]),
        _ => format!("{} for w_i", WEIGHTS[choice]),
    },
    of,
    rounding: &[],
};

fn weighed(t: &[f64], i: usize, far: f64, choice: usize) -> f64 {
    let n = t.len();
    let last = i + 1 == n;
    let next = if last { far } else { t[i + 1] };
    match choice {
        0 => t[i],
        1 if last => 0.0,
        2 if last => 1e10,
        4 if last => t[n - 1] - t[n.max(2) - 2],
        1..=4 => next - t[i],
        5 => 1.0 / t[i],
        6 => t[i] * t[i],
        7 => i as f64,
        8 => (i + 1) as f64,
        9 => i as f64 / n as f64,
        10 => t[i] / far,
        11 => t[i] - t[0],
        12 => 0.5 * (t[i] + next),
        _ => next,
    }
}

fn weight(w: f64, choice: usize) -> f64 {
    match choice {
        6 => w * w,
        7 => w.sqrt(),
        n => w + [0.0, 1e-5, 1e-6, 1e-8, 1e-10, 1e-3][n],
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (rays, n) = size(a, "weights");
    let far = number(a, "far");
    let mut values = a.clone();
    values.get_mut("weights").expect("an input").mapv_inplace(|w| weight(w, law[5]));
    let others = |r: usize| -> Vec<f64> {
        let t = row(a, "t", r);
        (0..n).map(|i| weighed(&t, i, far, law[0])).collect()
    };
    values.insert("t".into(), array(&[rays, n], (0..rays).flat_map(others).collect()));
    let right = depths(&values, c);
    let one = |r: usize| {
        let (weights, x) = (row(&values, "weights", r), row(&values, "t", r));
        let t = row(a, "t", r);
        let sum: f64 = weights.iter().zip(&x).map(|(w, x)| product(*w, *x)).sum();
        let whole: f64 = weights.iter().sum();
        let most = weights.iter().copied().fold(0.0, f64::max);
        let spent = |half: f64| {
            let mut sum = 0.0;
            let reached = weights.iter().position(|w| {
                sum += w;
                sum > half
            });
            x.get(reached.unwrap_or(n.max(1) - 1)).copied().unwrap_or(far)
        };
        let z = match law[4] {
            1 => spent(0.5),
            2 => spent(0.5 * whole),
            3 => x.get(weights.iter().position(|w| *w == most).unwrap_or(0)).copied().unwrap_or(far),
            4 => x.get(weights.iter().position(|w| *w > 0.0).unwrap_or(0)).copied().unwrap_or(far),
            _ => match law[1] {
                0 => row(&right, "depth", r)[0],
                1 => sum,
                2 => sum / whole,
                3 => sum / (whole + 1e-10),
                4 => sum / (whole + 1e-6),
                5 => sum / n as f64,
                6 => sum / most,
                _ => sum / whole.max(1e-6),
            },
        };
        let last = t.last().copied().unwrap_or(far);
        let z = z + match law[2] {
            0 => 0.0,
            1 => (1.0 - whole) * far,
            2 => (1.0 - whole) * last,
            3 => 1.0 - whole,
            _ => whole * far,
        };
        match law[3] {
            0 => z,
            1 => 1.0 / z,
            2 => z / far,
            3 => 1.0 - z / far,
            4 => 1.0 / z.max(1e-10),
            5 => z.sqrt(),
            6 => exp(-z),
            _ => z.max(t.first().copied().unwrap_or(far)).min(last),
        }
    };
    arrays([("depth", array(&[rays], (0..rays).map(one).collect()))])
}
