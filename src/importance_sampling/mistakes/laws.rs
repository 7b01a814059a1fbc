//! Laws of importance sampling: what a bin's share is made of, how its bin is found for u, and what of the bin is taken.

use super::super::arrays::{Ray, drawn, forward, ray as ray_of};
use super::super::{SNAPPED, bin_of};
use crate::contract::laws::Laws;
use crate::convention::Conventions;

/// What a bin's share is made of.
const SHARE: [&str; 12] = [
    "w + padding",
    "w",
    "w + 1e-5",
    "w + 1e-6",
    "w + 1e-8",
    "max(w, 1e-16)",
    "max(w, 1e-5)",
    "max(w, 0.01)",
    "w^2",
    "w (e_{k+1} - e_k)",
    "w / (e_{k+1} - e_k)",
    "the larger of w and its neighbors'",
];

/// What F is.
const SUMS: [&str; 7] = [
    "0 and the running sums over the whole",
    "the running sums over the whole, without 0 in front",
    "the running sums over the whole and 1e-5",
    "the running sums, not divided",
    "the running sums over the whole, the last one 1 whatever it is",
    "the middles of the running sums",
    "the running sums over the whole and 1",
];

/// What is looked for.
const WANTED: [&str; 8] = [
    "u",
    "1e-5 + (1 - 2e-5) u",
    "u held between 1e-5 and 1 - 1e-5",
    "1 - u",
    "u times the last F",
    "the first ray's u",
    "(k + u_k) / M, stratified",
    "k / (M - 1), evenly",
];

/// How the bin is found.
const FOUND: [&str; 8] = [
    "the last bin of some share that begins at or below u",
    "the last edge below u",
    "the last edge at or below u, the bin without share too",
    "the bin behind the one that holds u",
    "the bin in front of the one that holds u",
    "the edge nearest to u",
    "the first edge at or above u, its bin",
    "the last edge at or below u, its upper one held by the number of bins less one",
];

/// What of the bin is taken.
const TAKEN: [&str; 11] = [
    "e_k + s (e_{k+1} - e_k)",
    "e_k",
    "e_{k+1}",
    "(e_k + e_{k+1}) / 2",
    "e_k + u (e_{k+1} - e_k)",
    "e_k + (1 - s) (e_{k+1} - e_k)",
    "e_0 + (k + s) (e_N - e_0) / N",
    "e_0 + (k + u) (e_N - e_0) / N",
    "e_k + s (e_1 - e_0)",
    "e_k + s (e_N - e_0)",
    "e_k + s",
];

/// How s is found.
const DIVIDED: [&str; 4] = [
    "as it is by convention",
    "(u - F_k) / (F_{k+1} - F_k + 1e-5)",
    "(u - F_k) / (F_{k+1} - F_k), 0 where F_{k+1} - F_k < 1e-8",
    "(u - F_k) / (F_{k+1} - F_k), held between 0 and 1",
];

/// Those of samples.
pub(crate) const OF_SAMPLES: Laws = Laws {
    choices: &[SHARE.len(), SUMS.len(), WANTED.len(), FOUND.len(), TAKEN.len(), DIVIDED.len(), 2],
    says: |part, choice| match part {
        0 => format!("{} in the place of a bin's share", SHARE[choice]),
        1 => format!("F = {}", SUMS[choice]),
        2 => format!("{} in the place of u", WANTED[choice]),
        3 => format!("found: {}", FOUND[choice]),
        4 => format!("t = {}", TAKEN[choice]),
        5 => format!("s = {}", DIVIDED[choice]),
        _ => "sorted".into(),
    },
    of: |a, c, law| forward(a, c, |ray| of_ray(ray, &ray_of(a, 0, c), c, law)),
    rounding: &[],
};

fn shares(ray: &Ray, choice: usize) -> Vec<f64> {
    let (w, e) = (&ray.weights, &ray.edges);
    let n = w.len();
    let one = |k: usize| match choice {
        0 => w[k] + ray.padding,
        1 => w[k],
        2 => w[k] + 1e-5,
        3 => w[k] + 1e-6,
        4 => w[k] + 1e-8,
        5 => w[k].max(1e-16),
        6 => w[k].max(1e-5),
        7 => w[k].max(0.01),
        8 => w[k] * w[k],
        9 => w[k] * (e[k + 1] - e[k]),
        10 => w[k] / (e[k + 1] - e[k]),
        _ => w[k.max(1) - 1].max(w[k]).max(w[(k + 1).min(n - 1)]),
    };
    (0..n).map(one).collect()
}

fn sums(shares: &[f64], choice: usize) -> Vec<f64> {
    let n = shares.len();
    let running: Vec<f64> = (0..=n).map(|k| shares[..k].iter().sum()).collect();
    let whole = running[n];
    let over = |by: f64| -> Vec<f64> {
        let share = |(k, sum): (usize, &f64)| if by > 0.0 { sum / by } else { k as f64 / n as f64 };
        running.iter().enumerate().map(share).collect()
    };
    match choice {
        0 => over(whole),
        1 => over(whole)[1..].to_vec(),
        2 => over(whole + 1e-5),
        3 => running,
        4 => [&over(whole)[..n], &[1.0]].concat(),
        5 => over(whole).windows(2).map(|f| 0.5 * (f[0] + f[1])).collect(),
        _ => over(whole + 1.0),
    }
}

fn of_ray(ray: &Ray, first: &Ray, c: &Conventions, law: &[usize]) -> Vec<f64> {
    let sorted = |mut t: Vec<f64>| {
        if law[6] == 1 {
            t.sort_by(f64::total_cmp);
        }
        t
    };
    if law[..6] == [0; 6] {
        return sorted(drawn(ray, c));
    }
    let f = sums(&shares(ray, law[0]), law[1]);
    let (e, n, count) = (&ray.edges, f.len() - 1, ray.u.len());
    let one = |(m, &u): (usize, &f64)| {
        let u = match law[2] {
            0 => u,
            1 => 1e-5 + (1.0 - 2e-5) * u,
            2 => u.clamp(1e-5, 1.0 - 1e-5),
            3 => 1.0 - u,
            4 => u * f[n],
            5 => first.u[m],
            6 => (m as f64 + u) / count as f64,
            _ => m as f64 / (count.max(2) - 1) as f64,
        };
        let below = f.iter().filter(|f| **f < u).count();
        let up_to = f.iter().filter(|f| **f <= u).count();
        let last = n.max(1) - 1;
        let nearest = |best: usize, k: usize| if (f[k] - u).abs() < (f[best] - u).abs() { k } else { best };
        let k = match law[3] {
            0 if f.len() > 1 => bin_of(&f, u),
            1 => below.max(1) - 1,
            2 | 7 => up_to.max(1) - 1,
            3 => up_to,
            4 => up_to.max(2) - 2,
            5 => (0..=n).fold(0, nearest),
            6 => below,
            _ => 0,
        };
        let k = k.min(n);
        let up = if law[3] == 7 { (k + 1).min(last) } else { (k + 1).min(n) };
        let share = f[up] - f[k];
        let s = match law[5] {
            0 => match c.pdf_division.faint() {
                Some(faint) if share < SNAPPED => (u - f[k]) / faint,
                _ if share == 0.0 => 0.0,
                _ => (u - f[k]) / share,
            },
            1 => (u - f[k]) / (share + 1e-5),
            2 if share < 1e-8 => 0.0,
            _ if share == 0.0 => 0.0,
            2 => (u - f[k]) / share,
            _ => ((u - f[k]) / share).clamp(0.0, 1.0),
        };
        let (bins, ends) = ((e.len() - 1) as f64, e[e.len() - 1] - e[0]);
        let (low, high) = (e[k.min(e.len() - 1)], e[up.min(e.len() - 1)]);
        match law[4] {
            0 => low + s * (high - low),
            1 => low,
            2 => high,
            3 => 0.5 * (low + high),
            4 => low + u * (high - low),
            5 => low + (1.0 - s) * (high - low),
            6 => e[0] + (k as f64 + s) * ends / bins,
            7 => e[0] + (k as f64 + u) * ends / bins,
            8 => low + s * (e[1] - e[0]),
            9 => low + s * ends,
            _ => low + s,
        }
    };
    sorted(ray.u.iter().enumerate().map(one).collect())
}
