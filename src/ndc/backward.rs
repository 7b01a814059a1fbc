//! Vector-Jacobian product of rays in normalized device coordinates, by hand. `g_` marks the gradient of the loss with respect to what
//! follows.

use super::View;

/// Gradients with respect to o and d, from those of o' and d'.
///
/// With a_j = c_j (g_o'_j - g_d'_j) / n, the gradient of p_j, and b_j = c_j g_d'_j, that of the slope d_j / |d_z| (c = 2f/W, 2f/H;
/// s the sign of the scene's z):
/// g_o_j = a_j, g_d_j = t a_j + s b_j / d_z, and by way of t = (s n - o_z) / d_z and of the slope
/// g_o_z = -(a . d) / d_z, g_d_z = -t (a . d) / d_z - s (b . d) / d_z^2. The constants o'_z and d'_z pass nothing.
///
/// ```
/// use nerf_oracle::{convention::NdcDepth, ndc::{View, backward::ndc_ray}};
/// let view = View { width: 8.0, height: 4.0, focal: 4.0, near: 1.0, depth: NdcDepth::Negative };
/// let (g_o, g_d) = ndc_ray([0.5, 0.0, 0.0], [0.25, 0.0, -1.0], &view, [1.0, 0.0, 0.0], [0.0; 3]);
/// assert_eq!(g_o, [1.0, 0.0, 0.25]); // x on the near plane, and the plane is nearer by 1 where o is
/// assert_eq!(g_d, [1.0, 0.0, 0.25]);
/// ```
pub fn ndc_ray(
    o: [f64; 3],
    d: [f64; 3],
    view: &View,
    g_o_ndc: [f64; 3],
    g_d_ndc: [f64; 3],
) -> ([f64; 3], [f64; 3]) {
    let (sign, scales) = (view.sign(), view.scales());
    let t = (sign * view.near - o[2]) / d[2];
    let (mut g_o, mut g_d) = ([0.0; 3], [0.0; 3]);
    for j in 0..2 {
        let g_p = scales[j] * (g_o_ndc[j] - g_d_ndc[j]) / view.near;
        let g_slope = sign * scales[j] * g_d_ndc[j] / d[2];
        g_o[j] = g_p;
        g_d[j] = t * g_p + g_slope;
        g_o[2] -= g_p * d[j] / d[2];
        g_d[2] -= g_d[j] * d[j] / d[2];
    }
    (g_o, g_d)
}
