//! Losses that outliers don't rule: squares for small errors, lengths for large ones.
//!
//! Letters: d = prediction - target, entry by entry.

use crate::convention::{CharbonnierEps, HuberSlope, LossReduction};
use crate::math::Sum;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Huber's loss (Huber 1964): d^2 / 2 for |d| up to delta, delta (|d| - delta / 2) beyond; the mean over all entries.
///
/// # Convention
/// `slope`: with [`HuberSlope::One`] divided by delta, so that the slope beyond is 1 and that inside 1 / delta. `reduction`: mean or sum.
/// At |d| = delta both pieces and their slopes meet.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::{HuberSlope, LossReduction}, robust_loss::huber};
/// // One half squared, halved; and 1/2 (2 - 1/4).
/// let loss = |slope, reduction| huber(&[0.5, 0.0], &[0.0, 2.0], 0.5, slope, reduction);
/// assert_eq!(loss(HuberSlope::Delta, LossReduction::Sum), 0.125 + 0.875);
/// assert_eq!(loss(HuberSlope::One, LossReduction::Mean), 1.0);
/// ```
pub fn huber(
    prediction: &[f64],
    target: &[f64],
    delta: f64,
    slope: HuberSlope,
    reduction: LossReduction,
) -> f64 {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let mut sum = Sum::default();
    for (p, t) in prediction.iter().zip(target) {
        let size = (p - t).abs();
        sum.add(if size <= delta { 0.5 * size * size } else { delta * (size - 0.5 * delta) });
    }
    let sum = if slope == HuberSlope::One { sum.value() / delta } else { sum.value() };
    reduced(sum, prediction.len(), reduction)
}

/// Charbonnier's loss (Charbonnier et al. 1994; mip-NeRF 360, section 5): sqrt(d^2 + eps^2), the mean over all entries.
///
/// It is nearly |d|, but smooth: at d = 0 it is eps and has the slope 0.
///
/// # Convention
/// `eps`: with [`CharbonnierEps::AsGiven`] it is added as it is, sqrt(d^2 + eps). `reduction`: mean or sum.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::{CharbonnierEps, LossReduction}, robust_loss::charbonnier};
/// let loss = |reduction| charbonnier(&[3.0, 0.0], &[0.0; 2], 4.0, CharbonnierEps::Square, reduction);
/// assert_eq!((loss(LossReduction::Sum), loss(LossReduction::Mean)), (5.0 + 4.0, 4.5));
/// ```
pub fn charbonnier(
    prediction: &[f64],
    target: &[f64],
    eps: f64,
    form: CharbonnierEps,
    reduction: LossReduction,
) -> f64 {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let mut sum = Sum::default();
    for (p, t) in prediction.iter().zip(target) {
        sum.add(smooth(p - t, eps, form));
    }
    reduced(sum.value(), prediction.len(), reduction)
}

/// The smooth length of one difference.
fn smooth(d: f64, eps: f64, form: CharbonnierEps) -> f64 {
    let eps = if form == CharbonnierEps::Square { eps * eps } else { eps };
    (d * d + eps).sqrt()
}

/// A sum, or the mean of as many entries.
fn reduced(sum: f64, entries: usize, reduction: LossReduction) -> f64 {
    if reduction == LossReduction::Sum { sum } else { sum / entries as f64 }
}
