//! Vector-Jacobian product of the covariance, by hand. `g` is the gradient of the loss with respect to all nine entries.

use super::{Form, deviations, rotation, unit};
use crate::convention::{QuaternionLength, QuaternionOrder, SplatScale};

/// Gradients with respect to the quaternion and the scales, in the form in which they were given.
///
/// With M = R diag(s): g_M = (g + g^T) M, g_s_k = sum_i g_M_ik R_ik, g_R_ik = g_M_ik s_k; then the polynomial's g_u, and
/// g_q = (g_u - (g_u . u) u) / |q|. Of a logarithm: s_k times g_s_k.
///
/// # Convention
/// `g` needn't be symmetric: an entry and its mirror image are two outputs. Where the quaternion is taken as it is, g_q = g_u.
///
/// ```
/// use nerf_oracle::gaussian_covariance::{Form, backward};
/// // The variance along x is s_x^2: its slope is 2 s_x.
/// let mut g = [[0.0; 3]; 3];
/// g[0][0] = 1.0;
/// let (g_q, g_s) = backward::covariance([1.0, 0.0, 0.0, 0.0], [3.0, 1.0, 1.0], g, Form::default());
/// assert_eq!((g_q, g_s), ([0.0; 4], [6.0, 0.0, 0.0]));
/// ```
pub fn covariance(q: [f64; 4], scales: [f64; 3], g: [[f64; 3]; 3], form: Form) -> ([f64; 4], [f64; 3]) {
    let (u, length) = unit(q, form);
    let (r, s) = (rotation(u), deviations(scales, form));
    let (mut g_r, mut g_s) = ([[0.0; 3]; 3], [0.0; 3]);
    for i in 0..3 {
        for k in 0..3 {
            let mut g_m = 0.0;
            for j in 0..3 {
                g_m += (g[i][j] + g[j][i]) * (r[j][k] * s[k]);
            }
            g_r[i][k] = g_m * s[k];
            g_s[k] += g_m * r[i][k];
        }
    }
    if form.scale == SplatScale::Log {
        g_s = [0, 1, 2].map(|k| s[k] * g_s[k]);
    }
    let mut g_u = rotation_vjp(u, g_r);
    if form.length == QuaternionLength::Divided {
        let radial = g_u[0] * u[0] + g_u[1] * u[1] + g_u[2] * u[2] + g_u[3] * u[3];
        g_u = [0, 1, 2, 3].map(|a| (g_u[a] - radial * u[a]) / length);
    }
    let [w, x, y, z] = g_u;
    let g_q = match form.order {
        QuaternionOrder::RealFirst => [w, x, y, z],
        QuaternionOrder::RealLast => [x, y, z, w],
    };
    (g_q, g_s)
}

/// Gradient of [`super::rotation`] with respect to its quaternion: each power rule, term by term.
pub fn rotation_vjp([w, x, y, z]: [f64; 4], g: [[f64; 3]; 3]) -> [f64; 4] {
    // What the turn is about: the antisymmetric part; the symmetric one.
    let (a, b, c) = (g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]);
    let (yz, xz, xy) = (g[1][2] + g[2][1], g[0][2] + g[2][0], g[0][1] + g[1][0]);
    [
        2.0 * (x * a + y * b + z * c),
        2.0 * (w * a + y * xy + z * xz - 2.0 * x * (g[1][1] + g[2][2])),
        2.0 * (w * b + x * xy + z * yz - 2.0 * y * (g[0][0] + g[2][2])),
        2.0 * (w * c + x * xz + y * yz - 2.0 * z * (g[0][0] + g[1][1])),
    ]
}
