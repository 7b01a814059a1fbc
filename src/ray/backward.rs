//! Vector-Jacobian product of `pixel_to_ray`, by hand.

use glam::{DMat4, DVec2, DVec3};

use super::camera_direction;
use crate::camera::{Intrinsics, backward, rotate};
use crate::convention::{Axes, Directions};

/// Gradients of [`super::pixel_to_ray`] with respect to `K`, `c2w` (last row 0) and `uv`.
///
/// r = R d_c, d = r / |r|: g_r = (g_d - d (d . g_d)) / |r|, the part of g_d across the ray; then g_R = g_r d_c^T,
/// g_d_c = R^T g_r, and on through [`crate::camera::pixel_to_camera`] at s = 1. g_o is the gradient of the translation.
pub fn pixel_to_ray(
    k: &Intrinsics,
    c2w: &DMat4,
    uv: DVec2,
    axes: Axes,
    directions: Directions,
    g_o: DVec3,
    g_d: DVec3,
) -> (Intrinsics, DMat4, DVec2) {
    let d_c = camera_direction(k, uv, axes);
    let r = rotate(c2w, d_c);
    let g_r = match directions {
        Directions::Depth => g_d,
        Directions::Unit => {
            let d = r / r.length();
            let along = d.x * g_d.x + d.y * g_d.y + d.z * g_d.z;
            (g_d - d * along) / r.length()
        }
    };
    let (mut g_c2w, mut g_d_c) = backward::transform(c2w, d_c, g_r);
    g_c2w.w_axis = backward::column(g_o);
    if axes == Axes::Opengl {
        g_d_c = DVec3::new(g_d_c.x, -g_d_c.y, -g_d_c.z);
    }
    let (g_k, g_uv, _) = backward::pixel_to_camera(k, uv, 1.0, g_d_c);
    (g_k, g_c2w, g_uv)
}
