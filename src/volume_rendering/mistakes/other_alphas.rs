//! Other laws than the exponential's.

use super::catalogue::{ALPHAS_CAPPED, FAINT_SKIPPED};
use super::march::ALPHAS_SCALED;
use crate::math::{exp, expm1};
use crate::volume_rendering::optical_depths;

/// Opacities of optical depths by another law than the exponential's.
pub(super) fn other_alphas(sigmas: &[f64], deltas: &[f64], wrong: &[&str]) -> Option<Vec<f64>> {
    let depths = optical_depths(sigmas, deltas);
    let right = || depths.iter().map(|&x| -expm1(-x));
    if let Some(most) = ALPHAS_CAPPED.among(wrong) {
        return Some(right().map(|alpha| alpha.min(most)).collect());
    }
    if let Some(k) = ALPHAS_SCALED.among(wrong) {
        return Some(right().map(|alpha| k * alpha).collect());
    }
    if let Some(least) = FAINT_SKIPPED.among(wrong) {
        return Some(right().map(|alpha| if alpha < least { 0.0 } else { alpha }).collect());
    }
    if wrong.contains(&"delta_outside") {
        let alpha = |(sigma, delta): (&f64, &f64)| 1.0 - exp(-sigma) * delta;
        return Some(sigmas.iter().zip(deltas).map(alpha).collect());
    }
    let law: fn(f64) -> f64 = match () {
        () if wrong.contains(&"straight_alpha") => |x| x.clamp(0.0, 1.0),
        () if wrong.contains(&"hyperbolic_alpha") => |x| if x.is_infinite() { 1.0 } else { x / (1.0 + x) },
        () if wrong.contains(&"tanh_alpha") => {
            |x| crate::math::expm1(2.0 * x.min(50.0)) / (exp(2.0 * x.min(50.0)) + 1.0)
        }
        () => return None,
    };
    Some(depths.iter().map(|&x| law(x)).collect())
}

/// e^x_i / sum e^x_j.
pub(super) fn softmax(x: &[f64]) -> Vec<f64> {
    let most = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let powers: Vec<f64> = x.iter().map(|x| exp(x - most)).collect();
    let total: f64 = powers.iter().sum();
    powers.iter().map(|power| power / total).collect()
}
