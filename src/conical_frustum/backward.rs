//! Vector-Jacobian product of the frustum's Gaussian, by hand.

use super::{Frustum, Gaussian, across, moments, thickness};
use crate::convention::RayShape;

/// Gradients with respect to a frustum's origin, direction, radius, start and end, as a frustum of them. `g` has those of the Gaussian's
/// numbers.
///
/// Through mean and variances to the moments: g_t_mean + g_mean . d, g_t_variance + sum_i g_i d_i^2, g_r_variance + sum_i g_i n_i, with
/// n_i = 1 - d_i^2 / |d|^2 and g_i the gradient of variance i. To the direction: t_mean g_mean_j + 2 t_variance d_j g_j
/// + r_variance (2 d_j / |d|^2) sum_i (g_i - g_j) d_i^2 / |d|^2.
///
/// # Convention
/// As in the forward pass. An interval without length has the limit's gradient, that of thin ones.
///
/// ```
/// use nerf_oracle::conical_frustum::{Frustum, Gaussian, backward};
/// use nerf_oracle::convention::RayShape::Cone;
/// let f = Frustum { origin: [0.0; 3], direction: [0.0, 0.0, 1.0], radius: 0.5, start: 0.0, end: 4.0 };
/// let g = Gaussian { t_mean: 1.0, t_variance: 0.0, r_variance: 0.0, mean: [0.0; 3], variance: [0.0; 3] };
/// // A whole cone's mean is 3/4 of its end; a cut at its tip has no volume.
/// let g = backward::conical_frustum(&f, Cone, &g);
/// assert_eq!((g.start, g.end), (0.0, 0.75));
/// ```
pub fn conical_frustum(f: &Frustum, shape: RayShape, g: &Gaussian) -> Frustum {
    let (t_mean, t_variance, squares) = moments(f.start, f.end, shape);
    let r_variance = f.radius * f.radius * squares;
    let v = f.direction;
    let length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let (mut g_mean, mut g_t, mut g_r) = (g.t_mean, g.t_variance, g.r_variance);
    let mut direction = [0.0; 3];
    for j in 0..3 {
        g_mean += g.mean[j] * v[j];
        g_t += g.variance[j] * v[j] * v[j];
        g_r += g.variance[j] * across(v, j);
        let mut turned = 0.0;
        for i in 0..3 {
            turned += (g.variance[i] - g.variance[j]) * v[i] * v[i] / length;
        }
        direction[j] = t_mean * g.mean[j]
            + 2.0 * t_variance * v[j] * g.variance[j]
            + r_variance * (2.0 * v[j] / length) * turned;
    }
    let radius = 2.0 * f.radius * squares * g_r;
    let (start, end) = ends(f.start, f.end, shape, [g_mean, g_t, f.radius * f.radius * g_r]);
    Frustum { origin: g.mean, direction, radius, start, end }
}

/// From the gradients of the three moments to those of start and end: g_s - g_d and g_s + g_d.
///
/// Of a cone, by dq/ds = -6 s q^2 / d^2 and dq/dd = 2 q (1 - q) / d:
/// the mean's slopes are 1/2 - q + 2 q^2 and 6 (d/s) / (3 + (d/s)^2)^2, the variance's 4/5 s q^2 (2 - 5 q) and
/// d (5 - 32 q + 76 q^2 - 40 q^3) / 30, those across s (1/8 + 2/5 q^2) and d (5/24 - 4/15 q + 2/15 q^2).
fn ends(start: f64, end: f64, shape: RayShape, [g_mean, g_t, g_r]: [f64; 3]) -> (f64, f64) {
    let (s, d) = (start + end, end - start);
    if shape == RayShape::Cylinder {
        return (0.5 * g_mean - d * g_t / 6.0, 0.5 * g_mean + d * g_t / 6.0);
    }
    let q = thickness(s, d);
    let x = if d == 0.0 { 0.0 } else { d / s };
    let of_s = [0.5 - q + 2.0 * q * q, 0.8 * s * q * q * (2.0 - 5.0 * q), s * (0.125 + 0.4 * q * q)];
    let of_d = [
        6.0 * x / ((3.0 + x * x) * (3.0 + x * x)),
        d * (5.0 - 32.0 * q + 76.0 * q * q - 40.0 * q * q * q) / 30.0,
        d * (5.0 / 24.0 - 4.0 / 15.0 * q + 2.0 / 15.0 * q * q),
    ];
    let g_s = of_s[0] * g_mean + of_s[1] * g_t + of_s[2] * g_r;
    let g_d = of_d[0] * g_mean + of_d[1] * g_t + of_d[2] * g_r;
    (g_s - g_d, g_s + g_d)
}
