//! Vector-Jacobian product of poses, by hand. `g_` marks the gradient of the loss with respect to what follows.

use glam::{DMat3, DMat4, DVec3};

use super::{factor, flip, rotation};
use crate::convention::{Axes, Quaternion};

/// Gradients of [`super::rotation`] with respect to q.
///
/// R = I + s P(q) with P of second degree, so that with A = g_R and D = the gradient of A : P,
/// D_w = x (A21 - A12) + y (A02 - A20) + z (A10 - A01),
/// D_x = y (A01 + A10) + z (A02 + A20) - 2 x (A11 + A22) + w (A21 - A12), and so on around:
/// g_q = s D for a quaternion that is taken as it is, s (D - (q . D) q / |q|^2) for one that is normalized: what is along q has no effect.
pub fn rotation_vjp(q: [f64; 4], length: Quaternion, g_r: &DMat3) -> [f64; 4] {
    let s = factor(q, length);
    let [w, x, y, z] = q;
    let a = |i: usize, j: usize| g_r.col(j)[i];
    let turned = [a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)];
    let mixed = [a(1, 2) + a(2, 1), a(0, 2) + a(2, 0), a(0, 1) + a(1, 0)];
    let d = [
        x * turned[0] + y * turned[1] + z * turned[2],
        w * turned[0] + y * mixed[2] + z * mixed[1] - 2.0 * x * (a(1, 1) + a(2, 2)),
        w * turned[1] + x * mixed[2] + z * mixed[0] - 2.0 * y * (a(0, 0) + a(2, 2)),
        w * turned[2] + x * mixed[1] + y * mixed[0] - 2.0 * z * (a(0, 0) + a(1, 1)),
    ];
    let along = match length {
        Quaternion::Normalized => 0.5 * s * (w * d[0] + x * d[1] + y * d[2] + z * d[3]),
        Quaternion::AsGiven => 0.0,
    };
    [s * (d[0] - along * w), s * (d[1] - along * x), s * (d[2] - along * y), s * (d[3] - along * z)]
}

/// Gradients of [`super::from_colmap`] with respect to q and t; the last row of g_c2w isn't used.
///
/// The place is o = -R^T t: g_t = -R g_o, and by way of it g_R gains -t g_o^T. The columns of R^T pass their gradients to the rows of R,
/// with the signs of the axes.
///
/// ```
/// use glam::{DMat4, DVec3, DVec4};
/// use nerf_oracle::{convention::{Axes::Opencv, Quaternion::Normalized}, pose::backward::from_colmap};
/// // A camera that isn't turned, pulled along x: by its translation, and by a turn about y, as t lies before it.
/// let pull = DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::X);
/// let (g_q, g_t) = from_colmap([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 3.0], Opencv, Normalized, &pull);
/// assert_eq!((g_q, g_t), ([0.0, 0.0, 6.0, 0.0], [-1.0, 0.0, 0.0]));
/// ```
pub fn from_colmap(
    q: [f64; 4],
    t: [f64; 3],
    axes: Axes,
    length: Quaternion,
    g_c2w: &DMat4,
) -> ([f64; 4], [f64; 3]) {
    let (t, g_o, flip) = (DVec3::from(t), g_c2w.w_axis.truncate(), flip(axes));
    let rows = [g_c2w.x_axis.truncate(), flip * g_c2w.y_axis.truncate(), flip * g_c2w.z_axis.truncate()];
    let g_r = DMat3::from_cols(rows[0] - t.x * g_o, rows[1] - t.y * g_o, rows[2] - t.z * g_o).transpose();
    let g_t = -(rotation(q, length) * g_o);
    (rotation_vjp(q, length, &g_r), g_t.to_array())
}
