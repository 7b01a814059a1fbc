//! Gradients that are kept short before the optimizer takes them: all of them by their common norm, or each number by itself.

use crate::convention::ClipEps;
use crate::math::Sum;

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Clips the gradients of all tensors by their common norm (Pascanu et al. 2013, algorithm 1): times max_norm / norm where that is less
/// than 1. Returns them with the norm that they had.
///
/// The norm is the root of the sum of all squares, so that the direction of the whole step stays. `max_norm` is above 0.
///
/// # Convention
/// `eps` is added to the norm that is divided by: a norm of just below `max_norm` is then shortened too.
///
/// ```
/// use nerf_oracle::{convention::ClipEps, gradient_clipping::clip_by_global_norm};
/// let clip = |max_norm| clip_by_global_norm(&[&[3.0, 4.0], &[12.0]], max_norm, ClipEps::None);
/// assert_eq!(clip(6.5), (vec![vec![1.5, 2.0], vec![6.0]], 13.0));
/// assert_eq!(clip(20.0), (vec![vec![3.0, 4.0], vec![12.0]], 13.0));
/// ```
pub fn clip_by_global_norm(gradients: &[&[f64]], max_norm: f64, eps: ClipEps) -> (Vec<Vec<f64>>, f64) {
    let mut squares = Sum::default();
    for tensor in gradients {
        for g in *tensor {
            squares.add(g * g);
        }
    }
    let norm = squares.value().sqrt();
    // min(1, max_norm / (norm + eps)).
    let scale = max_norm / (norm + eps.value()).max(max_norm);
    let clipped = gradients.iter().map(|tensor| tensor.iter().map(|g| g * scale).collect()).collect();
    (clipped, norm)
}

/// Clips one number of a gradient to [-limit, limit].
///
/// ```
/// use nerf_oracle::gradient_clipping::clip_by_value;
/// assert_eq!([-3.0, -0.25, 0.0, 0.5, 2.0].map(|g| clip_by_value(g, 0.5)), [-0.5, -0.25, 0.0, 0.5, 0.5]);
/// ```
pub fn clip_by_value(g: f64, limit: f64) -> f64 {
    if g > limit {
        limit
    } else if g < -limit {
        -limit
    } else {
        g
    }
}
