//! Integrated positional encoding: the encoding's mean over a Gaussian, in place of its value at a point.
//!
//! Mip-NeRF (Barron et al. 2021), section 3.1, equations 11 to 16: E[sin y] = sin(mean) exp(-variance / 2) for normal y, and the same of
//! the cosine. A wave that is short beside the Gaussian fades.

use crate::encoding::{Encoding, factor, wave};
use crate::math::exp;

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

/// The encoding of one Gaussian: sin(a x) and cos(a x) of its mean, each times exp(-a^2 v / 2), with a = factor * f_k.
///
/// # Shapes
/// `means` (D), `variances` (D): the diagonal of the covariance, the rest of which no column sees. Result (2 L D), or (D + 2 L D).
///
/// # Units
/// Those of [`crate::encoding::positional_encoding`], variances in their square.
///
/// # Convention
/// All of `encoding`'s, which are those of the positional encoding; but mip-NeRF doesn't keep the mean itself beside the waves.
/// A factor pi scales the mean by pi and the variance by pi^2, as it does with whatever is linear.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::CS180, encoding::Encoding, integrated_encoding::integrated_encoding};
/// let encoding = Encoding { identity: false, ..Encoding::new(2, &CS180) };
/// // A point is encoded as ever; of a wide Gaussian nothing is left.
/// assert_eq!(integrated_encoding(&[0.5], &[0.0], &encoding), [1.0, 0.0, 0.0, -1.0]);
/// assert!(integrated_encoding(&[0.5], &[9.0], &encoding).iter().all(|y| y.abs() < 1e-19));
/// ```
pub fn integrated_encoding(means: &[f64], variances: &[f64], encoding: &Encoding) -> Vec<f64> {
    assert_eq!(means.len(), variances.len(), "means and variances: one each a dimension");
    let dims = means.len();
    let mut out = vec![0.0; encoding.width(dims)];
    for d in 0..dims {
        if encoding.identity {
            out[encoding.identity_column(dims, d)] = means[d];
        }
        for k in 0..encoding.levels {
            let (sin, cos) = wave(encoding.frequency, encoding.band(k), means[d]);
            let left = attenuation(encoding, k, variances[d]);
            out[encoding.column(dims, k, d, 0)] = left * sin;
            out[encoding.column(dims, k, d, 1)] = left * cos;
        }
    }
    out
}

/// exp(-a^2 v / 2): what is left of band k's waves over a variance.
pub(crate) fn attenuation(encoding: &Encoding, k: usize, variance: f64) -> f64 {
    let a = factor(encoding.frequency) * encoding.band(k);
    exp(-0.5 * (a * a * variance))
}
