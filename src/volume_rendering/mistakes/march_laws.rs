//! Laws of a march: what stands for an opacity, which samples are skipped, where the march ends, and what counts as nothing at all.

use super::densities::softplus;
use super::march::unless_thin;
use crate::contract::laws::{Guard, as_written};
use crate::math::{exp, expm1};

/// What stands for the opacity of a density.
pub(super) const OF_DENSITY: [&str; 15] = [
    "1 - exp(-sigma_i delta_i)",
    "sigma_i delta_i",
    "min(1, sigma_i delta_i)",
    "1 - exp(-sigma_i)",
    "sigma_i",
    "min(1, sigma_i)",
    "1 - exp(-2 sigma_i delta_i)",
    "1 - exp(-sigma_i delta_i / 2)",
    "sigma_i delta_i / (1 + sigma_i delta_i)",
    "exp(-sigma_i delta_i)",
    "1 - exp(-sigma_i delta_i), at most 0.99",
    "1 - exp(-sigma_i delta_i), at most 0.999",
    "1 - exp(-sigma_i delta_i), at most 0.95",
    "1 - exp(-sigma_i delta_i), at most 0.9999",
    "1 - exp(sigma_i delta_i)",
];

/// What stands for an opacity that is given.
pub(super) const OF_OPACITY: [&str; 11] = [
    "alpha_i",
    "min(2 alpha_i, 1)",
    "2 alpha_i",
    "alpha_i / 2",
    "alpha_i^2",
    "sqrt(alpha_i)",
    "1 - exp(-alpha_i)",
    "alpha_i, 0 below 1e-4,",
    "alpha_i, 0 below 1e-3,",
    "alpha_i, 0 below 0.01,",
    "alpha_i, 0 below 0.05,",
];

/// What stands for a step.
const STEPS: [&str; 5] = [
    "t_{i+1} - t_i",
    "(t_{i+1} - t_{i-1}) / 2, t_1 - t_0 for the first",
    "t_i - t_{i-1}, 0 for the first",
    "t_i - t_{i-1}, 1e10 for the first",
    "t_i - t_{i-1}, 1e6 for the first",
];

/// What keeps it off 0.
const HELD_STEPS: [Guard; 7] = [
    Guard::AtLeast(1e-6),
    Guard::AtLeast(1e-5),
    Guard::AtLeast(1e-3),
    Guard::Plus(1e-10),
    Guard::Plus(1e-8),
    Guard::Plus(1e-6),
    Guard::Plus(1e-5),
];

/// How many there are.
pub(super) const STEP_CHOICES: usize = STEPS.len() + HELD_STEPS.len();

/// What is said of a step.
pub(super) fn step_said(choice: usize) -> String {
    let held = || HELD_STEPS[choice - STEPS.len()].said(STEPS[0]);
    STEPS.get(choice).map_or_else(held, |said| (*said).into())
}

/// What stands for a density.
pub(super) const DENSITY: [&str; 7] = [
    "sigma_i",
    "sigma_{i+1}, 0 for the last",
    "sigma_{i-1}, 0 for the first",
    "|sigma_i|",
    "log(1 + exp(sigma_i))",
    "exp(sigma_i)",
    "sigma_i ln 2, as powers of 2 have it,",
];

/// The densities of samples that are skipped.
const THIN: [f64; 7] = [f64::NEG_INFINITY, 0.01, 1e-3, 1e-4, 1e-5, 0.1, 1.0];

/// The weights of samples that are skipped.
const FAINT: [f64; 4] = [1e-4, 1e-3, 0.01, 1e-5];

/// How many choices there are of what is skipped.
pub(super) const SKIPPED: usize = THIN.len() + FAINT.len();

/// How many where densities aren't known.
pub(super) const SKIPPED_BY_WEIGHT: usize = 1 + FAINT.len();

/// The choice, among all, of one of those.
pub(super) fn of_weights(choice: usize) -> usize {
    if choice == 0 { 0 } else { choice + THIN.len() - 1 }
}

/// What is said of them.
pub(super) fn skipped_said(choice: usize) -> String {
    match THIN.get(choice) {
        Some(least) => format!("density 0 where sigma <= {}", as_written(*least)),
        None => format!(
            "opacity 0 where alpha_i prod_{{j<i}} (1 - alpha_j) < {}",
            as_written(FAINT[choice - THIN.len()])
        ),
    }
}

/// The densities without those that are skipped by themselves.
pub(super) fn without_thin(sigmas: &mut [f64], choice: usize) {
    let least = THIN.get(choice).copied().unwrap_or(f64::NEG_INFINITY);
    sigmas.iter_mut().for_each(|sigma| *sigma = unless_thin(*sigma, least));
}

/// The opacities without those that are skipped by their weights; whether that is the choice.
pub(super) fn without_faint(alphas: &mut [f64], choice: usize) -> bool {
    let Some(faint) = choice.checked_sub(THIN.len()) else { return false };
    let mut light = 1.0;
    for alpha in alphas {
        if light * *alpha < FAINT[faint] {
            *alpha = 0.0;
        }
        light *= 1.0 - *alpha;
    }
    true
}

/// Where the march ends, and what comes behind isn't there: in front of a sample where less light than that is left, or (1) in front of the
/// one that leaves less. It is the same whether a program asks in front of a sample or behind the one before.
pub(super) const END: [(f64, usize); 20] = [
    (f64::NEG_INFINITY, 0),
    (1e-4, 0),
    (1e-4, 1),
    (1e-3, 0),
    (0.01, 0),
    (1e-3, 1),
    (0.05, 0),
    (0.02, 0),
    (0.1, 0),
    (5e-3, 0),
    (1e-5, 0),
    (1e-6, 0),
    (0.03, 0),
    (0.2, 0),
    (2e-3, 0),
    (0.01, 1),
    (0.05, 1),
    (0.1, 1),
    (1e-5, 1),
    (1e-6, 1),
];

/// The opacities below which a ray counts as empty: its color and its opacity are 0.
pub(super) const SEEN: [f64; 5] = [f64::NEG_INFINITY, 0.01, 1e-3, 1e-4, 0.1];

/// What is said of an end.
pub(super) fn end_said(choice: usize) -> String {
    match END[choice] {
        (least, 0) => format!("an end in front of a sample where T < {}", as_written(least)),
        (least, _) => format!("an end in front of the sample that brings T below {}", as_written(least)),
    }
}

/// What that choice makes of a density and its optical depth; `alpha` is the right one.
pub(super) fn of_density(alpha: f64, sigma: f64, depth: f64, choice: usize) -> f64 {
    match choice {
        0 => alpha,
        1 => depth,
        2 => depth.min(1.0),
        3 => -expm1(-sigma),
        4 => sigma,
        5 => sigma.min(1.0),
        6 => -expm1(-2.0 * depth),
        7 => -expm1(-0.5 * depth),
        8 if depth.is_infinite() => 1.0,
        8 => depth / (1.0 + depth),
        9 => exp(-depth),
        14 => -expm1(depth),
        n => alpha.min([0.99, 0.999, 0.95, 0.9999][n - 10]),
    }
}

/// What that choice makes of a ray's steps.
pub(super) fn stepped(deltas: Vec<f64>, choice: usize) -> Vec<f64> {
    let before = |i: usize| i.checked_sub(1).map(|before| deltas[before]);
    let of = |(i, delta): (usize, &f64)| match choice {
        0 => *delta,
        1 => 0.5 * (before(i).unwrap_or(*delta) + delta),
        2..=4 => before(i).unwrap_or([0.0, 1e10, 1e6][choice - 2]),
        _ => HELD_STEPS[choice - STEPS.len()].of(*delta),
    };
    deltas.iter().enumerate().map(of).collect()
}

/// What that choice makes of a ray's densities.
pub(super) fn other_densities(sigmas: Vec<f64>, choice: usize) -> Vec<f64> {
    let of = |i: usize| match choice {
        0 => sigmas[i],
        1 => sigmas.get(i + 1).copied().unwrap_or(0.0),
        2 => i.checked_sub(1).map_or(0.0, |before| sigmas[before]),
        3 => sigmas[i].abs(),
        4 => softplus(sigmas[i]),
        5 => exp(sigmas[i]),
        _ => sigmas[i] * std::f64::consts::LN_2,
    };
    (0..sigmas.len()).map(of).collect()
}

/// What that choice makes of an opacity.
pub(super) fn of_opacity(alpha: f64, choice: usize) -> f64 {
    let at_least = |least: f64| if alpha < least { 0.0 } else { alpha };
    match choice {
        0 => alpha,
        1 => (2.0 * alpha).min(1.0),
        2 => 2.0 * alpha,
        3 => 0.5 * alpha,
        4 => alpha * alpha,
        5 => alpha.sqrt(),
        6 => -expm1(-alpha),
        n => at_least([1e-4, 1e-3, 0.01, 0.05][n - 7]),
    }
}

/// How many samples a march has until less light is left.
pub(super) fn ended(transmittance: &[f64], choice: usize) -> usize {
    let n = transmittance.len() - 1;
    let (least, behind) = END[choice];
    (0..n).find(|i| transmittance[i + behind] < least).unwrap_or(n)
}
