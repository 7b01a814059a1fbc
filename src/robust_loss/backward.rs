//! Vector-Jacobian products of the robust losses, by hand. `g` is the gradient of the total loss with respect to them.

use super::{reduced, smooth};
use crate::convention::{CharbonnierEps, HuberSlope, LossReduction};

/// Gradient of [`super::huber`] with respect to the prediction: g d / n, d limited to [-delta, delta]; that of the target is its
/// negative.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::{HuberSlope, LossReduction}, robust_loss::backward::huber};
/// let g = huber(&[0.25, 2.0], &[0.0; 2], 0.5, HuberSlope::Delta, LossReduction::Sum, 1.0);
/// assert_eq!(g, [0.25, 0.5]);
/// ```
pub fn huber(
    prediction: &[f64],
    target: &[f64],
    delta: f64,
    slope: HuberSlope,
    reduction: LossReduction,
    g: f64,
) -> Vec<f64> {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let mut gradient = vec![];
    for (p, t) in prediction.iter().zip(target) {
        let limited = (p - t).max(-delta).min(delta);
        let one = if slope == HuberSlope::One { limited / delta } else { limited };
        gradient.push(reduced(g * one, prediction.len(), reduction));
    }
    gradient
}

/// Gradient of [`super::charbonnier`] with respect to the prediction: g d / (n sqrt(d^2 + eps^2)), 0 where d is; that of the target is
/// its negative.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::{CharbonnierEps, LossReduction}, robust_loss::backward::charbonnier};
/// let g = charbonnier(&[3.0, 0.0], &[0.0; 2], 4.0, CharbonnierEps::Square, LossReduction::Sum, 1.0);
/// assert_eq!(g, [0.6, 0.0]);
/// ```
pub fn charbonnier(
    prediction: &[f64],
    target: &[f64],
    eps: f64,
    form: CharbonnierEps,
    reduction: LossReduction,
    g: f64,
) -> Vec<f64> {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let mut gradient = vec![];
    for (p, t) in prediction.iter().zip(target) {
        let slope = (p - t) / smooth(p - t, eps, form);
        gradient.push(reduced(g * slope, prediction.len(), reduction));
    }
    gradient
}
