//! Vector-Jacobian product of the projection, by hand.

use super::{Form, Splat, View, clamped, in_camera, times, transform};
use crate::convention::SplatClampGradient;

/// Gradients with respect to the mean and to the six numbers of the covariance. `g` has those of the loss with respect to the splat; that
/// of its radius isn't looked at.
///
/// With (A, B, C) the conic: g_a = -(A^2 g_A + A B g_B + B^2 g_C), g_b = -(2 A B g_A + (A C + B^2) g_B + 2 B C g_C),
/// g_c = -(B^2 g_A + B C g_B + C^2 g_C), and what the compensation adds; then with P and Q the rows of T
///
/// * g_Sigma_ii = g_a P_i^2 + g_b P_i Q_i + g_c Q_i^2, g_Sigma_ij = 2 g_a P_i P_j + g_b (P_i Q_j + P_j Q_i) + 2 g_c Q_i Q_j: a number off
///   the diagonal stands in the matrix twice;
/// * g_P = 2 g_a Sigma P + g_b Sigma Q, g_Q = 2 g_c Sigma Q + g_b Sigma P, and by J's entries to t; g_mean = R^T g_t.
///
/// # Convention
/// A clamped slope has no gradient of its own; the mean's depth still scales the splat. [`SplatClampGradient::Held`] differentiates J as
/// if t_x, not t_x/t_z, were held. Where the compensation is 0 or at its floor, its gradient is 0; a determinant at its floor has none.
/// Neither has a splat that was culled.
pub fn project(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, g: &Splat) -> ([f64; 3], [f64; 6]) {
    let (t, splat) = (in_camera(mean, view), super::project(mean, sigma, view, form));
    if splat == Splat::NOWHERE {
        return ([0.0; 3], [0.0; 6]);
    }
    let [p, q] = transform(t, view, form);
    let g_covariance = of_covariance(&splat, form, g);
    let mut g_t = of_jacobian(t, jacobian_gradient([p, q], sigma, g_covariance, view), view, form);
    g_t[0] += view.k.fx / t[2] * g.mean[0];
    g_t[1] += view.k.fy / t[2] * g.mean[1];
    g_t[2] += g.depth - (view.k.fx * t[0] * g.mean[0] + view.k.fy * t[1] * g.mean[1]) / (t[2] * t[2]);
    let r = view.rotation;
    let g_mean = [0, 1, 2].map(|k| r[0][k] * g_t[0] + r[1][k] * g_t[1] + r[2][k] * g_t[2]);
    (g_mean, of_sigma([p, q], g_covariance))
}

/// Gradient of the dilated covariance: its own, by way of the conic, and of the compensation.
pub(super) fn of_covariance(splat: &Splat, form: Form, g: &Splat) -> [f64; 3] {
    let ([a, b, c], [x, y, z], h) = (splat.covariance, splat.conic, form.dilation.value());
    let [g_x, g_y, g_z] = g.conic;
    let mut sum = [
        g.covariance[0] - (x * x * g_x + x * y * g_y + y * y * g_z),
        g.covariance[1] - (2.0 * x * y * g_x + (x * z + y * y) * g_y + 2.0 * y * z * g_z),
        g.covariance[2] - (y * y * g_x + y * z * g_y + z * z * g_z),
    ];
    if splat.compensation > form.compensation.value() {
        // Of the determinants before and after the dilation.
        let (det, least) = (a * c - b * b, form.compensation.determinant());
        let learns = |det: f64| if det > least { 1.0 } else { 0.0 };
        let ratio = g.compensation / (2.0 * splat.compensation * det.max(least));
        let before = learns((a - h) * (c - h) - b * b) * ratio;
        let after = learns(det) * ratio * splat.compensation * splat.compensation;
        sum[0] += before * (c - h) - after * c;
        sum[1] -= 2.0 * b * (before - after);
        sum[2] += before * (a - h) - after * a;
    }
    sum
}

/// Gradient of the covariance's six numbers.
pub(super) fn of_sigma([p, q]: [[f64; 3]; 2], [g_a, g_b, g_c]: [f64; 3]) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| {
        let cross = if i == j { p[i] * q[i] } else { p[i] * q[j] + p[j] * q[i] };
        let twice = if i == j { 1.0 } else { 2.0 };
        twice * (g_a * p[i] * p[j] + g_c * q[i] * q[j]) + g_b * cross
    })
}

/// Gradients of J's entries: (J_00, J_02) and (J_11, J_12).
pub(super) fn jacobian_gradient(
    [p, q]: [[f64; 3]; 2],
    sigma: [f64; 6],
    [g_a, g_b, g_c]: [f64; 3],
    view: &View,
) -> [[f64; 2]; 2] {
    let (of_p, of_q) = (times(sigma, p), times(sigma, q));
    let row = |axis: usize, own: [f64; 3], g_own: f64, other: [f64; 3]| {
        let g = [0, 1, 2].map(|k| 2.0 * g_own * own[k] + g_b * other[k]);
        [axis, 2].map(|n| {
            let r = view.rotation[n];
            g[0] * r[0] + g[1] * r[1] + g[2] * r[2]
        })
    };
    [row(0, of_p, g_a, of_q), row(1, of_q, g_c, of_p)]
}

/// From J to t: J_00 = f/z, J_02 = -(f/z) slope.
pub(super) fn of_jacobian(t: [f64; 3], g: [[f64; 2]; 2], view: &View, form: Form) -> [f64; 3] {
    let mut g_t = [0.0; 3];
    let focal = [view.k.fx, view.k.fy];
    for (axis, (slope, held)) in clamped(t, view, form).into_iter().enumerate() {
        let scale = focal[axis] / t[2];
        let [own, along] = g[axis];
        g_t[2] += scale / t[2] * (slope * along - own);
        if !held {
            g_t[axis] = -scale / t[2] * along;
        }
        if !held || form.clamp_gradient == SplatClampGradient::Held {
            g_t[2] += scale / t[2] * slope * along;
        }
    }
    g_t
}
