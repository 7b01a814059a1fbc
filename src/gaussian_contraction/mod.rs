//! Contraction of Gaussians: what a pixel sees of an unbounded scene, laid into a bounded one.
//!
//! Mip-NeRF 360 (Barron et al. 2022), section 3.1 with equation 10: the contraction is taken for its tangent at the mean, as an extended
//! Kalman filter does, so that a Gaussian stays one. Letters: `f` the contraction of [`crate::contraction`], `J` its Jacobian at the mean,
//! `r` the mean's length, `s` = (2 - 1/r) / r.

use crate::contraction::{contract, largest, length};
use crate::convention::{ContractionNorm, ContractionRange};

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

/// A Gaussian in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Its mean.
    pub mean: [f64; 3],
    /// Its covariance in rows, symmetric.
    pub covariance: [[f64; 3]; 3],
}

/// The mean f(mean), and the covariance J Sigma J^T.
///
/// # Units
/// The mean in those of the scene, whose near part lies within length 1, the covariance in their squares.
///
/// # Convention
/// `norm` and `range` are those of the contraction. A range that halves the points divides the covariance by 4. Nothing is made symmetric:
/// a matrix that isn't is multiplied as it is.
///
/// ```
/// use nerf_oracle::convention::{ContractionNorm::L2, ContractionRange::Two};
/// use nerf_oracle::gaussian_contraction::{Gaussian, contract_gaussian};
/// // A ball at four times the distance of what stays: 7/16 as wide across its ray, 1/16 as long along it.
/// let ball = [[256.0, 0.0, 0.0], [0.0, 256.0, 0.0], [0.0, 0.0, 256.0]];
/// let far = contract_gaussian(&Gaussian { mean: [0.0, 4.0, 0.0], covariance: ball }, L2, Two);
/// assert_eq!(far.mean, [0.0, 1.75, 0.0]);
/// assert_eq!(far.covariance, [[49.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 49.0]]);
/// ```
pub fn contract_gaussian(x: &Gaussian, norm: ContractionNorm, range: ContractionRange) -> Gaussian {
    let j = jacobian(x.mean, norm, range);
    Gaussian { mean: contract(x.mean, norm, range), covariance: between(j, x.covariance) }
}

/// J: the entry i, j is the slope of coordinate i of f along coordinate j.
///
/// The identity where r <= 1, beyond
///
/// * L2: s (I - u u^T) + u u^T / r^2, u = x / r: what is across the ray shrinks as the ball does, what is along it as disparity;
/// * L-infinity, for the largest coordinate k: s I, but in column k -(2/r) (1 - 1/r) (x_i / r) sign x_k, and there in row k 1/r^2;
/// * MERF: I / r, but in column k -(x_i / r) sign x_k / r, and there in row k 1/r^2.
///
/// All of it times 1, 1/2 or 1/4, by the range. No entry is a difference of larger ones: 1 - u_i^2 is summed of the other two.
///
/// # Convention
/// As of the contraction: where coordinates tie for the largest, the first of them is. At r = 1 the first two have one slope from both
/// sides, MERF's has two, of which the identity is taken.
///
/// ```
/// use nerf_oracle::convention::{ContractionNorm::{L2, Linf, Merf}, ContractionRange::Two};
/// use nerf_oracle::gaussian_contraction::jacobian;
/// let x = [0.0, 2.0, 1.0];
/// assert_eq!(jacobian([0.0, 2.0, 0.0], L2, Two), [[0.75, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.75]]);
/// assert_eq!(jacobian(x, Linf, Two), [[0.75, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, -0.25, 0.75]]);
/// assert_eq!(jacobian(x, Merf, Two), [[0.5, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, -0.25, 0.5]]);
/// ```
pub fn jacobian(x: [f64; 3], norm: ContractionNorm, range: ContractionRange) -> [[f64; 3]; 3] {
    let (r, scale) = (length(x, norm), scale(range));
    if r <= 1.0 {
        return [[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]];
    }
    beyond(x, r, norm).map(|row| row.map(|slope| scale * slope))
}

/// The Jacobian of the far piece, in the range [-2, 2].
fn beyond(x: [f64; 3], r: f64, norm: ContractionNorm) -> [[f64; 3]; 3] {
    let (u, k) = (x.map(|x| x / r), largest(x));
    let s = (2.0 - 1.0 / r) / r;
    let bent = -2.0 * (1.0 - 1.0 / r) / r;
    let mut j = [[0.0; 3]; 3];
    for i in 0..3 {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        match norm {
            ContractionNorm::L2 => {
                j[i][i] = s * (u[a] * u[a] + u[b] * u[b]) + u[i] * u[i] / (r * r);
                j[i][a] = bent * u[i] * u[a];
                j[i][b] = bent * u[i] * u[b];
            }
            ContractionNorm::Linf => {
                j[i][i] = s;
                j[i][k] = bent * (x[i] / x[k]);
            }
            ContractionNorm::Merf => {
                j[i][i] = 1.0 / r;
                j[i][k] = -(x[i] / x[k]) / r;
            }
        }
    }
    if norm != ContractionNorm::L2 {
        j[k][k] = 1.0 / (r * r);
    }
    j
}

/// How much smaller the range is than [-2, 2].
fn scale(range: ContractionRange) -> f64 {
    match range {
        ContractionRange::Two => 1.0,
        ContractionRange::One => 0.5,
        ContractionRange::Unit => 0.25,
    }
}

/// A S A^T.
fn between(a: [[f64; 3]; 3], s: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    product(product(a, s), transposed(a))
}

/// A B.
fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut c = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}

/// A^T.
fn transposed(a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut c = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            c[i][j] = a[j][i];
        }
    }
    c
}
