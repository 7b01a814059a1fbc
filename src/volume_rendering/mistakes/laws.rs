//! Other laws than the exponential's.

use crate::math::exp;

/// Opacities of optical depths by another law than the exponential's.
pub(super) fn other_alphas(depths: &[f64], wrong: &[&str]) -> Option<Vec<f64>> {
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
