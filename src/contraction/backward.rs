//! Vector-Jacobian product of the contraction, by hand. `g` is the gradient of the loss with respect to the contracted point.

use super::{largest, length};
use crate::convention::{ContractionNorm, ContractionRange};

/// The gradient with respect to x: g where r <= 1, beyond with s = (2 - 1/r) / r
///
/// * L2: s (g - (u . g) u) + (u . g) u / r^2, u = x / r: what is across the ray shrinks as the ball does, what is along it as disparity;
/// * L-infinity: s g, and for the largest coordinate k, r = |x_k|, besides -(2/r^2) (1 - 1/r) (g . x) sign x_k;
/// * MERF: g_j / r, and for the largest coordinate g_k / r^2 - sign x_k (sum_{j != k} g_j x_j) / r^2.
///
/// All of it times 1, 1/2 or 1/4, by the range.
///
/// # Convention
/// At r = 1 the first two have one derivative, from both sides. Where coordinates tie for the largest, the norm has several: the first
/// of them counts alone, as with `max(dim)` of PyTorch; `amax` shares among them, which is a subgradient too. At 0 the gradient is g.
///
/// ```
/// use nerf_oracle::contraction::backward::contract;
/// use nerf_oracle::convention::{ContractionNorm::{L2, Linf, Merf}, ContractionRange::{Two, Unit}};
/// assert_eq!(contract([0.0; 3], [1.0, 2.0, 3.0], L2, Two), [1.0, 2.0, 3.0]);
/// assert_eq!(contract([0.0, 2.0, 0.0], [1.0, 1.0, 1.0], L2, Two), [0.75, 0.25, 0.75]);
/// assert_eq!(contract([0.0, 2.0, 0.0], [1.0, 1.0, 1.0], Linf, Unit), [0.1875, 0.0625, 0.1875]);
/// assert_eq!(contract([0.0, 2.0, 0.0], [1.0, 1.0, 1.0], Merf, Two), [0.5, 0.25, 0.5]);
/// ```
pub fn contract(x: [f64; 3], g: [f64; 3], norm: ContractionNorm, range: ContractionRange) -> [f64; 3] {
    let scale = match range {
        ContractionRange::Two => 1.0,
        ContractionRange::One => 0.5,
        ContractionRange::Unit => 0.25,
    };
    let g = g.map(|g| scale * g);
    let r = length(x, norm);
    if r <= 1.0 {
        return g;
    }
    let s = (2.0 - 1.0 / r) / r;
    let (k, along) = (largest(x), g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
    let sign = x[k].signum();
    match norm {
        ContractionNorm::L2 => {
            let u = x.map(|x| x / r);
            let radial = along / r;
            [0, 1, 2].map(|j| s * (g[j] - radial * u[j]) + radial * u[j] / (r * r))
        }
        ContractionNorm::Linf => {
            let mut g_x = g.map(|g| s * g);
            g_x[k] -= 2.0 * (1.0 - 1.0 / r) * along / (r * x[k]);
            g_x
        }
        ContractionNorm::Merf => {
            let mut others = 0.0;
            for j in (0..3).filter(|&j| j != k) {
                others += g[j] * x[j];
            }
            let mut g_x = g.map(|g| g / r);
            g_x[k] = (g[k] - sign * others) / (r * r);
            g_x
        }
    }
}
