//! Vector-Jacobian products of the lens, by hand. `g_` marks the gradient of the loss with respect to what follows.

use glam::DVec2;

use super::{Distortion, Radial};

/// Gradients of [`Distortion::distort`] with respect to p and to the coefficients, in OpenCV's order: k1, k2, p1, p2, k3, k4, k5, k6.
///
/// g_p = J g, J being symmetric. With s = (x g_x + y g_y) / D, D the radial factor's denominator:
/// g_k1 = s r^2, g_k2 = s r^4, g_k3 = s r^6; g_k4 = -radial s r^2, g_k5 = -radial s r^4, g_k6 = -radial s r^6;
/// g_p1 = 2 x y g_x + (r^2 + 2 y^2) g_y, g_p2 = (r^2 + 2 x^2) g_x + 2 x y g_y.
///
/// ```
/// use glam::DVec2;
/// use nerf_oracle::lens::{Distortion, backward::distort};
/// let lens = Distortion { k1: 0.5, ..Distortion::default() };
/// let (g_p, g_k) = distort(&lens, DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0));
/// assert_eq!(g_p, DVec2::new(2.5, 1.5)); // along the radius, and across
/// assert_eq!(g_k, [1.0, 1.0, 1.0, 3.0, 1.0, -1.5, -1.5, -1.5]);
/// ```
pub fn distort(lens: &Distortion, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
    let Radial { r2, denominator, value, .. } = lens.radial(p);
    let s = (p.x * g.x + p.y * g.y) / denominator;
    let twice = 2.0 * p.x * p.y;
    let g_p1 = twice * g.x + (r2 + 2.0 * p.y * p.y) * g.y;
    let g_p2 = (r2 + 2.0 * p.x * p.x) * g.x + twice * g.y;
    let powers = [r2, r2 * r2, r2 * r2 * r2];
    let [g_k1, g_k2, g_k3] = powers.map(|power| s * power);
    let [g_k4, g_k5, g_k6] = powers.map(|power| -value * s * power);
    (lens.jacobian(p) * g, [g_k1, g_k2, g_p1, g_p2, g_k3, g_k4, g_k5, g_k6])
}

/// Gradients of [`Distortion::undistort`] with respect to the target and to the coefficients, at the point p that it found.
///
/// By the implicit function theorem: distort(p, k) = target, so J dp + (d distort / d k) dk = d target. With h = J^-1 g (J is symmetric):
/// g_target = h, and g_k is minus that of [`distort`] for h.
///
/// ```
/// use glam::DVec2;
/// use nerf_oracle::lens::{Distortion, backward::undistort};
/// let lens = Distortion { k1: 0.5, ..Distortion::default() };
/// let (g_target, g_k) = undistort(&lens, DVec2::new(1.0, 0.0), DVec2::new(5.0, 3.0));
/// assert_eq!(g_target, DVec2::new(2.0, 2.0));
/// assert_eq!(g_k[..2], [-2.0, -2.0]);
/// ```
pub fn undistort(lens: &Distortion, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
    let j = lens.jacobian(p);
    let (xx, xy, yy) = (j.x_axis.x, j.y_axis.x, j.y_axis.y);
    let determinant = xx * yy - xy * xy;
    let h = DVec2::new((yy * g.x - xy * g.y) / determinant, (xx * g.y - xy * g.x) / determinant);
    (h, distort(lens, p, h).1.map(|g_k| -g_k))
}
