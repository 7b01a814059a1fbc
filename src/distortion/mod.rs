//! The distortion loss: how far apart along a ray its weights lie.
//!
//! Mip-NeRF 360 (Barron et al. 2022), section 4: weights in one place are a surface, scattered ones are fog. Letters: N intervals between
//! N + 1 edges t, m_i the middle of interval i, delta_i its length, w_i its weight.

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

/// sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 delta_i (equation 15): the mean distance of two points of the ray, each drawn by weight.
///
/// # Shapes
/// `weights` (N), `t` (N + 1), never falling; one number.
///
/// # Units
/// Those of t: a length along the ray, or, as in the paper, the normalized distance s in [0, 1], which all rays share. Over rays the loss
/// is added up or averaged: that is the caller's.
///
/// # Convention
/// This is the definition, in N^2 terms. In ascending order the first sum is 2 sum_i w_i (m_i sum_{j<i} w_j - sum_{j<i} w_j m_j): N terms
/// (Sun et al. 2022), but a difference of large numbers where t is far from 0 (VR8). With what is at i added to both inner sums it is the
/// same number.
///
/// # Panics
/// Where there isn't one edge more than weights.
///
/// ```
/// use nerf_oracle::distortion::distortion;
/// // Two points, half of the weight each, 2 apart on the average: once in either order.
/// assert_eq!(distortion(&[0.5, 0.0, 0.5], &[0.0, 0.0, 2.0, 2.0]), 1.0);
/// // One interval of length 3: two points of it are 1 apart on the average.
/// assert_eq!(distortion(&[1.0], &[2.0, 5.0]), 1.0);
/// ```
pub fn distortion(weights: &[f64], t: &[f64]) -> f64 {
    assert_eq!(weights.len() + 1, t.len(), "weights and t: one edge more than weights");
    let mut loss = Sum::default();
    for i in 0..weights.len() {
        for j in 0..weights.len() {
            loss.add(weights[i] * weights[j] * apart(t, i, j).abs());
        }
        loss.add(weights[i] * weights[i] * (t[i + 1] - t[i]) / 3.0);
    }
    loss.value()
}

/// m_i - m_j, by lengths between edges, so that nothing far from 0 is added up.
fn apart(t: &[f64], i: usize, j: usize) -> f64 {
    0.5 * ((t[i] - t[j]) + (t[i + 1] - t[j + 1]))
}
