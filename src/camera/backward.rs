//! Vector-Jacobian products of the camera, by hand. `g_` marks the gradient of the loss with respect to what follows.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::Intrinsics;

/// Gradients of [`super::transform`] with respect to `c2w` (last row 0) and `x_c`.
///
/// `x_w = R x_c + o`: g_R = g_x_w x_c^T, g_o = g_x_w, g_x_c = R^T g_x_w.
pub fn transform(c2w: &DMat4, x_c: DVec3, g_x_w: DVec3) -> (DMat4, DVec3) {
    let g_c2w =
        DMat4::from_cols(column(g_x_w * x_c.x), column(g_x_w * x_c.y), column(g_x_w * x_c.z), column(g_x_w));
    (g_c2w, rotate_transposed(c2w, g_x_w))
}

/// `R^T g`: the sum of each column of R times g.
pub fn rotate_transposed(c2w: &DMat4, g: DVec3) -> DVec3 {
    let along = |axis: DVec4| axis.x * g.x + axis.y * g.y + axis.z * g.z;
    DVec3::new(along(c2w.x_axis), along(c2w.y_axis), along(c2w.z_axis))
}

/// A column of the gradient of `c2w`, 0 in the row that isn't used.
pub fn column(v: DVec3) -> DVec4 {
    v.extend(0.0)
}

/// Gradients of [`super::pixel_to_camera`] with respect to `K`, `uv` and `s`.
///
/// `x = s (u - cx) / fx`: g_u = s / fx g_x, g_cx = -g_u, g_fx = -x / fx g_x, and g_s gathers x / s, y / s and 1.
pub fn pixel_to_camera(k: &Intrinsics, uv: DVec2, s: f64, g_x_c: DVec3) -> (Intrinsics, DVec2, f64) {
    let (x, y) = ((uv.x - k.cx) / k.fx, (uv.y - k.cy) / k.fy);
    let g_uv = DVec2::new(s * g_x_c.x / k.fx, s * g_x_c.y / k.fy);
    let g_k = Intrinsics { fx: -x * g_uv.x, fy: -y * g_uv.y, cx: -g_uv.x, cy: -g_uv.y };
    (g_k, g_uv, x * g_x_c.x + y * g_x_c.y + g_x_c.z)
}
