//! Laws of the distortion loss: where intervals lie and how long they are, what is done to weights and edges, and which pairs count how often.

use super::super::arrays::forward;
use super::super::distortion;
use crate::contract::laws::Laws;
use crate::math::exp;

/// What the edges are made first.
const EDGES: [&str; 6] = [
    "t",
    "(t - t_0) / (t_N - t_0)",
    "t / t_N",
    "(t - t_0) / (t_N - t_0 + 1e-6)",
    "t clamped to [0, 1]",
    "1 / t",
];

/// What the weights are made first.
const WEIGHTS: [&str; 11] = [
    "w",
    "w / sum w",
    "w / (sum w + 1e-8)",
    "w / (sum w + 1e-10)",
    "w / (sum w + 1e-6)",
    "w / (sum w + 1e-5)",
    "w / max(sum w, 1e-6)",
    "w + 1e-5",
    "w + 1e-6",
    "w + 1e-8",
    "w / max w",
];

/// How far an interval is from another.
const DISTANCE: [&str; 7] = [
    "|m_i - m_j|",
    "(m_i - m_j)^2",
    "m_i - m_j",
    "sqrt(|m_i - m_j|)",
    "sqrt((m_i - m_j)^2 + 1e-8)",
    "sqrt((m_i - m_j)^2 + 1e-6)",
    "exp(-|m_i - m_j|)",
];

/// What an interval's own weight counts.
const OWN_WEIGHT: [&str; 4] = ["w_i^2", "w_i", "1", "sqrt(w_i)"];

/// How long an interval is.
const LENGTH: [&str; 13] = [
    "t_{i+1} - t_i",
    "1 / N",
    "m_{i+1} - m_i, the last one as the one before",
    "m_{i+1} - m_i, the last one 0",
    "m_{i+1} - m_i, the last one 1 / N",
    "m_i - m_{i-1}, the first one as the next",
    "m_i - m_{i-1}, the first one 0",
    "m_{i+1} - m_i, the last one 1e10",
    "1 / (N - 1)",
    "(t_N - t_0) / N",
    "1",
    "(t_{i+1} - t_i)^2",
    "m_i",
];

/// Where an interval lies.
const PLACE: [&str; 12] = [
    "(t_i + t_{i+1}) / 2",
    "t_i",
    "t_{i+1}",
    "i / (N - 1)",
    "i / N",
    "(i + 1/2) / N",
    "(i + 1) / N",
    "i",
    "t_0 + (t_N - t_0) i / (N - 1)",
    "t_0 + (t_N - t_0) (i + 1/2) / N",
    "t_i + t_{i+1}",
    "1 / t_i",
];

/// Which pairs count, and how much.
const PAIRS: [&str; 14] = [
    "sum_ij",
    "sum_{i<j}",
    "1/N^2 sum_ij",
    "1/N sum_ij",
    "2 sum_ij",
    "1/3 sum_ij",
    "1/4 sum_ij",
    "1/N sum_{i<j}",
    "2 / (N (N - 1)) sum_{i<j}",
    "sum over j = i + 1",
    "sum over |i - j| = 1",
    "the distance of each from sum_j w_j m_j for sum_ij",
    "the distance of each from the mean of m_j for sum_ij",
    "0, no sum_ij",
];

/// What the terms of single intervals count.
const OWN: [&str; 12] = [
    "1/3 sum_i",
    "0, no sum_i",
    "sum_i",
    "1/2 sum_i",
    "2/3 sum_i",
    "1/6 sum_i",
    "1/12 sum_i",
    "1/4 sum_i",
    "1/(3 N) sum_i",
    "1/N sum_i",
    "2 sum_i",
    "-1/3 sum_i",
];

/// What is made of both.
const MADE: [&str; 7] = [
    "sum_ij + 1/3 sum_i",
    "1/N (sum_ij + 1/3 sum_i)",
    "0.01 (sum_ij + 1/3 sum_i)",
    "1/2 (sum_ij + 1/3 sum_i)",
    "1/N^2 (sum_ij + 1/3 sum_i)",
    "(sum_ij + 1/3 sum_i) / (sum w + 1e-8)",
    "sqrt(sum_ij + 1/3 sum_i)",
];

/// Those of the distortion loss.
pub(crate) const OF_INTERVALS: Laws = Laws {
    choices: &[
        EDGES.len(),
        WEIGHTS.len(),
        DISTANCE.len(),
        OWN_WEIGHT.len(),
        LENGTH.len(),
        PLACE.len(),
        PAIRS.len(),
        OWN.len(),
        MADE.len(),
    ],
    says: |part, choice| match part {
        0 => format!("{} for the edges t", EDGES[choice]),
        1 => format!("{} for the weights w", WEIGHTS[choice]),
        2 => format!("pairs {} apart", DISTANCE[choice]),
        3 => format!("{} for w_i^2", OWN_WEIGHT[choice]),
        4 => format!("delta_i = {}", LENGTH[choice]),
        5 => format!("m_i = {}", PLACE[choice]),
        6 => format!("pairs counted as {}", PAIRS[choice]),
        7 => format!("{} w_i^2 delta_i", OWN[choice]),
        _ => format!("loss = {}", MADE[choice]),
    },
    of: |a, _, law| forward(a, |weights, t| of(weights, t, law)),
    rounding: &[],
};

fn edges(t: &[f64], choice: usize) -> Vec<f64> {
    let (first, last) = (t[0], t[t.len() - 1]);
    let one = |t: &f64| match choice {
        1 => (t - first) / (last - first),
        2 => t / last,
        3 => (t - first) / (last - first + 1e-6),
        4 => t.clamp(0.0, 1.0),
        5 => 1.0 / t,
        _ => *t,
    };
    t.iter().map(one).collect()
}

fn weighing(weights: &[f64], choice: usize) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let most = weights.iter().copied().fold(0.0, f64::max);
    let one = |w: &f64| match choice {
        1 => w / total,
        2 => w / (total + 1e-8),
        3 => w / (total + 1e-10),
        4 => w / (total + 1e-6),
        5 => w / (total + 1e-5),
        6 => w / total.max(1e-6),
        7 => w + 1e-5,
        8 => w + 1e-6,
        9 => w + 1e-8,
        10 => w / most,
        _ => *w,
    };
    weights.iter().map(one).collect()
}

fn place(t: &[f64], i: usize, choice: usize) -> f64 {
    let (n, k) = ((t.len() - 1) as f64, i as f64);
    let along = |part: f64| t[0] + (t[t.len() - 1] - t[0]) * part;
    // What is spread evenly begins at 0, even alone.
    let spread = if i == 0 { 0.0 } else { k / (n - 1.0) };
    match choice {
        1 => t[i],
        2 => t[i + 1],
        3 => spread,
        4 => k / n,
        5 => (k + 0.5) / n,
        6 => (k + 1.0) / n,
        7 => k,
        8 => along(spread),
        9 => along((k + 0.5) / n),
        10 => t[i] + t[i + 1],
        11 => 1.0 / t[i],
        _ => 0.5 * (t[i] + t[i + 1]),
    }
}

fn length(t: &[f64], m: &[f64], i: usize, choice: usize) -> f64 {
    let n = m.len();
    let whole = n as f64;
    let step = |i: usize| if i + 1 < n { m[i + 1] - m[i] } else { 0.0 };
    let last = i + 1 == n;
    match choice {
        1 => 1.0 / whole,
        2 if last => step(n.max(2) - 2),
        4 if last => 1.0 / whole,
        7 if last => 1e10,
        2..=4 | 7 => step(i),
        5 => step(i.max(1) - 1),
        6 if i == 0 => 0.0,
        6 => step(i - 1),
        8 => 1.0 / (whole - 1.0),
        9 => (t[n] - t[0]) / whole,
        10 => 1.0,
        11 => (t[i + 1] - t[i]) * (t[i + 1] - t[i]),
        12 => m[i],
        _ => t[i + 1] - t[i],
    }
}

fn distance(apart: f64, choice: usize) -> f64 {
    match choice {
        1 => apart * apart,
        2 => apart,
        3 => apart.abs().sqrt(),
        4 => (apart * apart + 1e-8).sqrt(),
        5 => (apart * apart + 1e-6).sqrt(),
        6 => exp(-apart.abs()),
        _ => apart.abs(),
    }
}

/// What the pairs of intervals add up to.
fn pairs(w: &[f64], m: &[f64], apart: usize, choice: usize) -> f64 {
    let n = w.len();
    let sum = |counts: fn(usize, usize) -> bool| -> f64 {
        let one = |i: usize| -> f64 {
            let others = (0..n).filter(|j| counts(i, *j));
            others.map(|j| w[i] * w[j] * distance(m[i] - m[j], apart)).sum()
        };
        (0..n).map(one).sum()
    };
    let from = |center: f64| -> f64 { w.iter().zip(m).map(|(w, m)| w * distance(m - center, apart)).sum() };
    let whole = n as f64;
    match choice {
        1 => sum(|i, j| i < j),
        2 => sum(|_, _| true) / (whole * whole),
        3 => sum(|_, _| true) / whole,
        4 => 2.0 * sum(|_, _| true),
        5 => sum(|_, _| true) / 3.0,
        6 => sum(|_, _| true) / 4.0,
        7 => sum(|i, j| i < j) / whole,
        8 => 2.0 * sum(|i, j| i < j) / (whole * (whole - 1.0)),
        9 => sum(|i, j| i + 1 == j),
        10 => sum(|i, j| i.abs_diff(j) == 1),
        11 => from(w.iter().zip(m).map(|(w, m)| w * m).sum()),
        12 => from(m.iter().sum::<f64>() / whole),
        13 => 0.0,
        _ => sum(|_, _| true),
    }
}

/// The loss of one ray.
fn of(weights: &[f64], t: &[f64], law: &[usize]) -> f64 {
    if law.iter().all(|choice| *choice == 0) {
        return distortion(weights, t);
    }
    let n = weights.len();
    let (t, w) = (edges(t, law[0]), weighing(weights, law[1]));
    let m: Vec<f64> = (0..n).map(|i| place(&t, i, law[5])).collect();
    let own = |i: usize| [w[i] * w[i], w[i], 1.0, w[i].sqrt()][law[3]] * length(&t, &m, i, law[4]);
    let (own, whole): (f64, f64) = ((0..n).map(own).sum(), n as f64);
    let own = match law[7] {
        0 => own / 3.0,
        1 => 0.0,
        2 => own,
        3 => own / 2.0,
        4 => own * 2.0 / 3.0,
        5 => own / 6.0,
        6 => own / 12.0,
        7 => own / 4.0,
        8 => own / (3.0 * whole),
        9 => own / whole,
        10 => own * 2.0,
        _ => -own / 3.0,
    };
    let loss = pairs(&w, &m, law[2], law[6]) + own;
    match law[8] {
        0 => loss,
        1 => loss / whole,
        2 => 0.01 * loss,
        3 => 0.5 * loss,
        4 => loss / (whole * whole),
        5 => loss / (w.iter().sum::<f64>() + 1e-8),
        _ => loss.sqrt(),
    }
}
