//! Vector-Jacobian product of the contraction of Gaussians, by hand.

use super::{Gaussian, between, jacobian, product, scale, transposed};
use crate::contraction::{backward::contract, largest, length};
use crate::convention::{ContractionNorm, ContractionRange};

/// Gradients with respect to a Gaussian's mean and covariance. `g` has those of the contracted mean and covariance, all nine entries.
///
/// To the covariance J^T G J. To the mean J^T g as of a point, and what the covariance adds because J turns and shrinks with the mean: the
/// second derivative of f, times the gradient of J, which is G J Sigma^T + G^T J Sigma.
///
/// # Convention
/// As in the forward pass. At r = 1 the second derivative jumps: that of the inside, 0, is taken.
///
/// ```
/// use nerf_oracle::convention::{ContractionNorm::L2, ContractionRange::Two};
/// use nerf_oracle::gaussian_contraction::{Gaussian, backward};
/// let x = Gaussian { mean: [0.0, 2.0, 0.0], covariance: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
/// let mut g = Gaussian { mean: [0.0; 3], covariance: [[0.0; 3]; 3] };
/// g.covariance[1][1] = 1.0;
/// // The variance along the ray is r^-4, whose slope is -4 r^-5.
/// let g = backward::contract_gaussian(&x, &g, L2, Two);
/// assert_eq!((g.mean, g.covariance[1][1]), ([0.0, -0.125, 0.0], 0.0625));
/// ```
pub fn contract_gaussian(
    x: &Gaussian,
    g: &Gaussian,
    norm: ContractionNorm,
    range: ContractionRange,
) -> Gaussian {
    let j = jacobian(x.mean, norm, range);
    let once = product(product(g.covariance, j), transposed(x.covariance));
    let twice = product(product(transposed(g.covariance), j), x.covariance);
    let mut g_j = [[0.0; 3]; 3];
    for i in 0..3 {
        for k in 0..3 {
            g_j[i][k] = scale(range) * (once[i][k] + twice[i][k]);
        }
    }
    let (by_point, by_slope) = (contract(x.mean, g.mean, norm, range), bend(x.mean, g_j, norm));
    Gaussian {
        mean: [0, 1, 2].map(|a| by_point[a] + by_slope[a]),
        covariance: between(transposed(j), g.covariance),
    }
}

/// From the gradient B of J, in the range [-2, 2], to that of x: 0 where r <= 1, beyond with u = x / r, p = -(2 / r^2) (1 - 1/r)
///
/// * L2: p (u (tr B - 3 u^T B u) + (B + B^T) u) - 2 u u^T B u / r^3: p bends what is across the ray, -2 / r^3 is the slope of 1 / r^2;
/// * L-infinity, k the largest coordinate, j the others: p B_jk sign x_k in coordinate j, and in coordinate k what they share,
///   p B_jj sign x_k + (2 / r^2) (2 - 3/r) u_j B_jk, less 2 B_kk sign x_k / r^3;
/// * MERF: the same with -1 / r^2 for p, and 2 / r^2 for the other factor.
pub(super) fn bend(x: [f64; 3], b: [[f64; 3]; 3], norm: ContractionNorm) -> [f64; 3] {
    let r = length(x, norm);
    if r <= 1.0 {
        return [0.0; 3];
    }
    match norm {
        ContractionNorm::L2 => bend_of_ball(x, b, r),
        ContractionNorm::Linf | ContractionNorm::Merf => bend_of_cube(x, b, r, norm),
    }
}

fn bend_of_ball(x: [f64; 3], b: [[f64; 3]; 3], r: f64) -> [f64; 3] {
    let u = x.map(|x| x / r);
    let (mut both, mut trace, mut along) = ([0.0; 3], 0.0, 0.0);
    for i in 0..3 {
        for k in 0..3 {
            both[i] += (b[i][k] + b[k][i]) * u[k];
            along += u[i] * b[i][k] * u[k];
        }
        trace += b[i][i];
    }
    let p = -2.0 * (1.0 - 1.0 / r) / (r * r);
    [0, 1, 2].map(|a| p * (u[a] * (trace - 3.0 * along) + both[a]) - 2.0 * along * u[a] / (r * r * r))
}

fn bend_of_cube(x: [f64; 3], b: [[f64; 3]; 3], r: f64, norm: ContractionNorm) -> [f64; 3] {
    let k = largest(x);
    let sign = x[k].signum();
    let (across, slant) = if norm == ContractionNorm::Merf {
        (-1.0 / (r * r), 2.0 / (r * r))
    } else {
        (-2.0 * (1.0 - 1.0 / r) / (r * r), 2.0 * (2.0 - 3.0 / r) / (r * r))
    };
    let mut g = [0.0; 3];
    g[k] = -2.0 * b[k][k] / (r * r * x[k]);
    for j in (0..3).filter(|&j| j != k) {
        g[j] = sign * across * b[j][k];
        g[k] += sign * across * b[j][j] + slant * b[j][k] * x[j] / r;
    }
    g
}
