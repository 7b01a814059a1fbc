//! Vector-Jacobian product of `pixel_to_ray`, by hand.

use glam::{DMat4, DVec2, DVec3};

use super::camera_direction;
use crate::camera::{Intrinsics, backward, rotate};
use crate::convention::{Axes, Directions};

/// Gradients of [`super::pixel_to_ray`] with respect to `K`, `c2w` (last row 0) and `uv`.
///
/// r = R d_c, d = r / |r|: g_r = (g_d - d (d . g_d)) / |r|, the part of g_d across the ray; then g_R = g_r d_c^T,
/// g_d_c = R^T g_r, and on through [`crate::camera::pixel_to_camera`] at s = 1. g_o is the gradient of the translation. Divided in the
/// camera's frame, d = R (d_c / |d_c|): g_R = g_d (d_c / |d_c|)^T, and g_d_c is the part of R^T g_d across d_c, over |d_c|.
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
    let (rotated, g_r) = match directions {
        Directions::Depth => (d_c, g_d),
        Directions::Unit => (d_c, across(rotate(c2w, d_c), g_d)),
        Directions::UnitInCamera => (d_c / d_c.length(), g_d),
    };
    let (mut g_c2w, mut g_d_c) = backward::transform(c2w, rotated, g_r);
    g_c2w.w_axis = backward::column(g_o);
    if directions == Directions::UnitInCamera {
        g_d_c = across(d_c, g_d_c);
    }
    if axes == Axes::Opengl {
        g_d_c = DVec3::new(g_d_c.x, -g_d_c.y, -g_d_c.z);
    }
    let (g_k, g_uv, _) = backward::pixel_to_camera(k, uv, 1.0, g_d_c);
    (g_k, g_c2w, g_uv)
}

/// The gradient of r where g is that of r / |r|.
fn across(r: DVec3, g: DVec3) -> DVec3 {
    let d = r / r.length();
    let along = d.x * g.x + d.y * g.y + d.z * g.z;
    (g - d * along) / r.length()
}
