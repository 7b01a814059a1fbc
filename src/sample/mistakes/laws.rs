//! Laws of samples and of steps: where a sample's part of the ray begins, how long it is, what is drawn in it, and what that is mapped to.

use super::super::arrays::{sample_along_rays, samples, step_sizes};
use super::super::sample_along_ray;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size, threes};
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::math::{exp, ln};

/// Where the part of sample i begins, from 0 to 1.
const LOWER: [&str; 8] = [
    "as the grid has it",
    "i / N",
    "i / (N - 1)",
    "(i + 1/2) / N",
    "(i + 1) / N",
    "(i + 1) / (N - 1)",
    "(i - 1) / (N - 1), at least 0",
    "(i - 1/2) / (N - 1), at least 0",
];

/// How long it is.
const WIDTH: [&str; 8] = [
    "as the grid has it",
    "1 / N",
    "1 / (N - 1)",
    "2 / (N - 1)",
    "1",
    "1 / (2 N)",
    "1 / (2 (N - 1))",
    "the rest of the way up to (i + 1) / (N - 1), at most 1",
];

/// What is drawn.
const DRAWN: [&str; 10] = [
    "u_i",
    "1 - u_i",
    "u_i - 1/2",
    "2 u_i - 1",
    "u of the ray's first sample",
    "u of the first ray",
    "u of the first ray's first sample",
    "0",
    "1/2",
    "u_i / N",
];

/// What s is mapped to.
const MAPPED: [&str; 9] = [
    "near + s (far - near)",
    "near + s far",
    "s far",
    "s",
    "1 / ((1 - s) / near + s / far)",
    "near (far / near)^s",
    "near + s^2 (far - near)",
    "far - s (far - near)",
    "near + sqrt(s) (far - near)",
];

/// What points are.
const POINTS: [&str; 5] = ["o + t d", "o + t d / |d|", "t d", "o - t d", "t (o + d)"];

/// Those of samples.
pub(crate) const OF_SAMPLES: Laws = Laws {
    choices: &[LOWER.len(), WIDTH.len(), DRAWN.len(), MAPPED.len(), POINTS.len()],
    says: |part, choice| match part {
        0 => format!("s = {} and what is drawn beyond it", LOWER[choice]),
        1 => format!("what is drawn times {}", WIDTH[choice]),
        2 => format!("{} for what is drawn", DRAWN[choice]),
        3 => format!("t = {}", MAPPED[choice]),
        _ => format!("points {}", POINTS[choice]),
    },
    of: of_samples,
    rounding: &[],
};

fn of_samples(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, n) = size(a, "u");
    let last = (n.max(2) - 1) as f64;
    let on_the_grid = |u: f64| sample_along_ray(0.0, 1.0, &vec![u; n], c.grid);
    let (low, high) = (on_the_grid(0.0), on_the_grid(1.0));
    let one = |r: usize| -> Vec<f64> {
        if law[..4] == [0; 4] {
            return sample_along_ray(near, far, &row(a, "u", r), c.grid);
        }
        let (own, first) = (row(a, "u", r), row(a, "u", 0));
        let at = |i: usize| {
            let x = i as f64;
            let lower = match law[0] {
                0 => low[i],
                1 => x / n as f64,
                2 => x / last,
                3 => (x + 0.5) / n as f64,
                4 => (x + 1.0) / n as f64,
                5 => (x + 1.0) / last,
                6 => (x - 1.0).max(0.0) / last,
                _ => (x - 0.5).max(0.0) / last,
            };
            let width = match law[1] {
                0 => high[i] - low[i],
                1 => 1.0 / n as f64,
                2 => 1.0 / last,
                3 => 2.0 / last,
                4 => 1.0,
                5 => 0.5 / n as f64,
                6 => 0.5 / last,
                _ => ((x + 1.0) / last).min(1.0) - lower,
            };
            let drawn = match law[2] {
                0 => own[i],
                1 => 1.0 - own[i],
                2 => own[i] - 0.5,
                3 => 2.0 * own[i] - 1.0,
                4 => own[0],
                5 => first[i],
                6 => first[0],
                7 => 0.0,
                8 => 0.5,
                _ => own[i] / n as f64,
            };
            let s = lower + drawn * width;
            match law[3] {
                0 => near + s * (far - near),
                1 => near + s * far,
                2 => s * far,
                3 => s,
                4 => 1.0 / ((1.0 - s) / near + s / far),
                5 => near * exp(s * ln(far / near)),
                6 => near + s * s * (far - near),
                7 => far - s * (far - near),
                _ => near + s.sqrt() * (far - near),
            }
        };
        (0..n).map(at).collect()
    };
    let t: Vec<Vec<f64>> = (0..rays).map(one).collect();
    let mut out = if law[..4] == [0; 4] { sample_along_rays(a, c) } else { samples(a, &t) };
    if law[4] > 0 {
        let (o, d) = (threes(a, "rays_o"), threes(a, "rays_d"));
        let mut points = vec![];
        for (r, t) in t.iter().enumerate() {
            let length = d[r].iter().map(|d| d * d).sum::<f64>().sqrt();
            let point = |t: &f64| {
                [0, 1, 2].map(|k| match law[4] {
                    1 => o[r][k] + t * d[r][k] / length,
                    2 => t * d[r][k],
                    3 => o[r][k] - t * d[r][k],
                    _ => t * (o[r][k] + d[r][k]),
                })
            };
            points.extend(t.iter().flat_map(point));
        }
        out.insert("points".into(), array(&[rays, n, 3], points));
    }
    out
}

/// What a sample's step is.
const STEP: [&str; 13] = [
    "as it is by convention",
    "t_{i+1} - t_i",
    "t_i - t_{i-1}",
    "(t_{i+1} - t_{i-1}) / 2",
    "(far - near) / N",
    "(far - near) / (N - 1)",
    "1 / N",
    "1",
    "t_1 - t_0",
    "(t_{N-1} - t_0) / N",
    "(t_{N-1} - t_0) / (N - 1)",
    "t_i",
    "far - t_i",
];

/// What the first, or the last, is where it has no neighbor.
const END: [&str; 10] = [
    "the same",
    "0",
    "its neighbor's",
    "the gap at its own end",
    "half of the gap at its own end",
    "the mean of the first gap and the last",
    "the mean of all gaps",
    "what is left up to near, or far",
    "1e10",
    "1e-3",
];

/// Those of steps.
pub(crate) const OF_STEPS: Laws = Laws {
    choices: &[STEP.len(), END.len(), END.len()],
    says: |part, choice| match part {
        0 => format!("delta_i = {}", STEP[choice]),
        1 => format!("the last one {}", END[choice]),
        _ => format!("the first one {}", END[choice]),
    },
    of: of_steps,
    rounding: &[],
};

fn of_steps(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, n) = size(a, "t");
    let right = step_sizes(a, c);
    let one = |r: usize| -> Vec<f64> {
        let (t, mut steps) = (row(a, "t", r), row(&right, "deltas", r));
        if n < 2 {
            return steps;
        }
        let gap = |i: usize| t[i + 1] - t[i];
        let (first, last) = (gap(0), gap(n - 2));
        let all = (t[n - 1] - t[0]) / (n - 1) as f64;
        for (i, step) in steps.iter_mut().enumerate() {
            let (before, behind) = (gap(i.max(1) - 1), gap(i.min(n - 2)));
            *step = match law[0] {
                0 => *step,
                1 => behind,
                2 => before,
                3 => 0.5 * (before + behind),
                4 => (far - near) / n as f64,
                5 => (far - near) / (n - 1) as f64,
                6 => 1.0 / n as f64,
                7 => 1.0,
                8 => first,
                9 => (t[n - 1] - t[0]) / n as f64,
                10 => all,
                11 => t[i],
                _ => far - t[i],
            };
        }
        let end = |choice: usize, own: f64, neighbor: f64, gap: f64, left: f64| match choice {
            0 => own,
            1 => 0.0,
            2 => neighbor,
            3 => gap,
            4 => 0.5 * gap,
            5 => 0.5 * (first + last),
            6 => all,
            7 => left,
            8 => 1e10,
            _ => 1e-3,
        };
        steps[n - 1] = end(law[1], steps[n - 1], steps[n - 2], last, far - t[n - 1]);
        steps[0] = end(law[2], steps[0], steps[1], first, t[0] - near);
        steps
    };
    arrays([("deltas", array(&[rays, n], (0..rays).flat_map(one).collect()))])
}
