//! Laws of hand-written backward passes: what sample i gains by itself, what it hides, what both are multiplied with, and what colors get.

use super::super::arrays::{self, closed, cotangent_over, gradients_of_counted, gradients_of_densities};
use super::super::{Rendering, optical_depths, volume_render, volume_render_alpha};
use super::march_laws::{END, end_said, ended};
use crate::contract::arrays::{Arrays, array, arrays as named, row, rows3, size};
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::math::{exp, expm1};

/// What q_i = g . c_i is multiplied with. The right one comes first in both: of densities, of opacities.
const OWN: [&str; 8] = [
    "T_{i+1} q_i",
    "T_i q_i",
    "w_i q_i",
    "alpha_i q_i",
    "(1 - alpha_i) q_i",
    "q_i",
    "alpha_i T_{i+1} q_i",
    "nothing",
];

/// What is taken off that. B_i is the worth of the light behind sample i, S_i = T_{i+1} B_i that of what the samples behind it add.
const HIDDEN: [&str; 16] = [
    "S_i = sum_{j>i} w_j q_j",
    "S_i / (1 - alpha_i)",
    "sum_{j>=i} w_j q_j, its own with it",
    "sum_j w_j q_j, the whole pixel",
    "nothing",
    "S_i / T_{i+1}",
    "(1 - alpha_i) S_i / T_{i+1}",
    "alpha_i S_i / T_{i+1}",
    "w_i S_i / T_{i+1}",
    "sum_{j<i} w_j q_j, what lies in front",
    "T_{i+1} sum_j w_j q_j",
    "T_i sum_j w_j q_j",
    "(1 - alpha_i) S_i",
    "-S_i",
    "-S_i / (1 - alpha_i)",
    "S_i / max(1 - alpha_i, 1e-6)",
];

/// What the slope of sigma_i delta_i is multiplied with for sigma_i.
const STEP: [&str; 9] = [
    "delta_i",
    "1",
    "delta_{i-1}",
    "alpha_i delta_i",
    "(1 - alpha_i) delta_i",
    "T_i delta_i",
    "-delta_i",
    "delta_i^2",
    "sigma_i delta_i",
];

/// The same of an opacity.
const SCALE: [&str; 6] = ["1", "alpha_i", "1 - alpha_i", "T_i", "-1", "1 / (1 - alpha_i)"];

/// What the gradient of a color is.
const COLOR: [&str; 8] = ["w_i g", "alpha_i g", "T_i g", "g", "T_{i+1} g", "alpha_i T_{i+1} g", "w_i", "0"];

/// The opacities below which a sample has no gradient.
const FAINT: [(f64, &str); 4] =
    [(f64::NEG_INFINITY, ""), (1e-4, "1e-4"), (1.0 / 255.0, "1 / 255"), (1e-3, "1e-3")];

/// Those of densities.
pub(crate) const OF_DENSITIES: Laws = Laws {
    choices: &[OWN.len(), HIDDEN.len(), STEP.len(), COLOR.len(), END.len(), FAINT.len()],
    says: |part, choice| match part {
        2 => format!("the gradient of sigma_i times {} in the place of delta_i", STEP[choice]),
        _ => says(part, choice, "sigma_i delta_i"),
    },
    of: of_densities,
    rounding: &[],
};

/// Those of opacities.
pub(crate) const OF_OPACITIES: Laws = Laws {
    choices: &[OWN.len(), HIDDEN.len(), SCALE.len(), COLOR.len(), END.len(), FAINT.len()],
    says: |part, choice| match part {
        // The right ones of densities are wrong here, and the other way around.
        0 if choice == 1 => says(0, 0, "alpha_i"),
        1 if choice == 1 => says(1, 0, "alpha_i"),
        2 => format!("the gradient of alpha_i times {}", SCALE[choice]),
        _ => says(part, choice, "alpha_i"),
    },
    of: of_opacities,
    rounding: &[],
};

fn says(part: usize, choice: usize, of: &str) -> String {
    match part {
        0 => format!("the gradient of {of} gains {}, q_i = g . c_i", OWN[choice]),
        1 if HIDDEN[choice].contains("S_i") && choice > 0 => {
            format!("the gradient of {of} loses {}, {}", HIDDEN[choice], HIDDEN[0])
        }
        1 => format!("the gradient of {of} loses {}", HIDDEN[choice]),
        3 => format!("the gradient of c_i = {}", COLOR[choice]),
        4 => end_said(choice),
        _ => format!("no gradient where alpha_i < {}", FAINT[choice].1),
    }
}

/// A ray on its way back.
struct Back<'a> {
    ray: &'a Rendering,
    alphas: &'a [f64],
    /// g . c_i and what the weight's own cotangents add.
    q: Vec<f64>,
    /// S_i, and the worth of the light behind each sample.
    sums: Vec<f64>,
    worth: Vec<f64>,
}

impl<'a> Back<'a> {
    fn new(a: &Arrays, r: usize, c: &Conventions, ray: &'a Rendering, alphas: &'a [f64]) -> Self {
        let (g, n) = (cotangent_over(a, r, c), alphas.len());
        let of_color = |rgb: &[f64; 3]| (0..3).map(|k| g.color[k] * rgb[k]).sum::<f64>();
        let rgbs = rows3(a, "rgbs", r);
        let q: Vec<f64> = (0..n).map(|i| of_color(&rgbs[i]) + g.weights[i] + g.opacity).collect();
        let (mut sums, mut worth) = (vec![0.0; n], vec![0.0; n]);
        let (mut sum, mut behind) = (ray.transmittance[n] * g.transmittance, g.transmittance);
        for i in (0..n).rev() {
            (sums[i], worth[i]) = (sum, behind);
            sum += ray.weights[i] * q[i];
            behind = alphas[i] * q[i] + (1.0 - alphas[i] + c.product_eps.value()) * behind;
        }
        Back { ray, alphas, q, sums, worth }
    }

    fn own(&self, i: usize, choice: usize) -> f64 {
        let (t, alpha) = (&self.ray.transmittance, self.alphas[i]);
        let by = match choice {
            0 => t[i + 1],
            1 => t[i],
            2 => self.ray.weights[i],
            3 => alpha,
            4 => 1.0 - alpha,
            5 => 1.0,
            6 => alpha * t[i + 1],
            _ => 0.0,
        };
        by * self.q[i]
    }

    fn hidden(&self, i: usize, choice: usize) -> f64 {
        let (t, alpha, worth) = (&self.ray.transmittance, self.alphas[i], self.worth[i]);
        let own = |j: usize| self.ray.weights[j] * self.q[j];
        let whole = self.sums[0] + own(0);
        match choice {
            0 => self.sums[i],
            1 => t[i] * worth,
            2 => self.sums[i] + own(i),
            3 => whole,
            4 => 0.0,
            5 => worth,
            6 => (1.0 - alpha) * worth,
            7 => alpha * worth,
            8 => self.ray.weights[i] * worth,
            9 => (0..i).map(own).sum(),
            10 => t[i + 1] * whole,
            11 => t[i] * whole,
            12 => (1.0 - alpha) * self.sums[i],
            13 => -self.sums[i],
            14 => -t[i] * worth,
            _ => self.sums[i] / (1.0 - alpha).max(1e-6),
        }
    }

    fn color(&self, i: usize, g: [f64; 3], choice: usize) -> [f64; 3] {
        let (t, alpha) = (&self.ray.transmittance, self.alphas[i]);
        match choice {
            0 => g.map(|g| self.ray.weights[i] * g),
            1 => g.map(|g| alpha * g),
            2 => g.map(|g| t[i] * g),
            3 => g,
            4 => g.map(|g| t[i + 1] * g),
            5 => g.map(|g| alpha * t[i + 1] * g),
            6 => [self.ray.weights[i]; 3],
            _ => [0.0; 3],
        }
    }
}

fn of_densities(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let a = &closed(a, c);
    let (count, n) = size(a, "sigmas");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![], vec![], vec![]);
    for r in 0..count {
        let (sigmas, deltas, rgbs) = (row(a, "sigmas", r), row(a, "deltas", r), rows3(a, "rgbs", r));
        let whole = volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
        let end = ended(&whole.transmittance, law[4]);
        let sigmas = [&sigmas[..end], &vec![0.0; n - end]].concat();
        let depths = optical_depths(&sigmas, &deltas);
        let alphas: Vec<f64> = depths.iter().map(|&x| -expm1(-x)).collect();
        let ray = if end == n { whole } else { volume_render(&sigmas, &rgbs, &deltas, c.product_eps) };
        let back = Back::new(a, r, c, &ray, &alphas);
        let g = cotangent_over(a, r, c).color;
        for i in 0..n {
            if i >= end || alphas[i] < FAINT[law[5]].0 {
                g_sigmas.push(0.0);
                g_deltas.push(0.0);
                g_rgbs.extend([0.0; 3]);
                continue;
            }
            // What an eps adds inside of the product isn't seen through the sample.
            let (through, eps) = (exp(-depths[i]), c.product_eps.value());
            let kept = |choice: usize| match choice {
                0 if eps > 0.0 => through / (through + eps),
                _ => 1.0,
            };
            let slope = kept(law[0]) * back.own(i, law[0]) - kept(law[1]) * back.hidden(i, law[1]);
            let before = if i == 0 { 0.0 } else { deltas[i - 1] };
            let step = match law[2] {
                0 => deltas[i],
                1 => 1.0,
                2 => before,
                3 => alphas[i] * deltas[i],
                4 => (1.0 - alphas[i]) * deltas[i],
                5 => ray.transmittance[i] * deltas[i],
                6 => -deltas[i],
                7 => deltas[i] * deltas[i],
                _ => depths[i],
            };
            g_sigmas.push(super::super::product(step, slope));
            g_deltas.push(super::super::product(sigmas[i], slope));
            g_rgbs.extend(back.color(i, g, law[3]));
        }
    }
    let gradients = named([
        ("grad_sigmas", array(&[count, n], g_sigmas)),
        ("grad_rgbs", array(&[count, n, 3], g_rgbs)),
        ("grad_deltas", array(&[count, n], g_deltas)),
    ]);
    gradients_of_densities(a, c, gradients)
}

fn of_opacities(given: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let a = &arrays::counted(given, c);
    let (count, n) = size(a, "alphas");
    let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
    // The first two of each are right of densities in this order, of opacities in the other.
    let of = |choice: usize| if choice < 2 { 1 - choice } else { choice };
    for r in 0..count {
        let (alphas, rgbs) = (row(a, "alphas", r), rows3(a, "rgbs", r));
        let whole = volume_render_alpha(&alphas, &rgbs, c.product_eps);
        let end = ended(&whole.transmittance, law[4]);
        let alphas = [&alphas[..end], &vec![0.0; n - end]].concat();
        let ray = if end == n { whole } else { volume_render_alpha(&alphas, &rgbs, c.product_eps) };
        let back = Back::new(a, r, c, &ray, &alphas);
        let g = cotangent_over(a, r, c).color;
        for i in 0..n {
            if i >= end || alphas[i] < FAINT[law[5]].0 {
                g_alphas.push(0.0);
                g_rgbs.extend([0.0; 3]);
                continue;
            }
            let slope = back.own(i, of(law[0])) - back.hidden(i, of(law[1]));
            let scale = match law[2] {
                0 => 1.0,
                1 => alphas[i],
                2 => 1.0 - alphas[i],
                3 => ray.transmittance[i],
                4 => -1.0,
                _ => 1.0 / (1.0 - alphas[i]),
            };
            g_alphas.push(super::super::product(scale, slope));
            g_rgbs.extend(back.color(i, g, law[3]));
        }
    }
    let gradients =
        named([("grad_alphas", array(&[count, n], g_alphas)), ("grad_rgbs", array(&[count, n, 3], g_rgbs))]);
    gradients_of_counted(given, c, gradients)
}
