//! Vector-Jacobian products of the fisheye, by hand. `g_` marks the gradient of the loss with respect to what follows.

use glam::DVec2;

use super::{bent, bent_slope};

/// Gradients of [`super::distort`] with respect to p and k.
///
/// With u = p / r: what is along the radius is stretched by d theta_d / d r = (d theta_d / d theta) / (1 + r^2), what is across by
/// theta_d / r, so that g_p = along (u . g) u + across (g - (u . g) u), and g_kn = theta^(2n+1) (u . g). In the middle g_p = g, g_k = 0.
///
/// ```
/// use glam::DVec2;
/// let (g_p, g_k) = nerf_oracle::fisheye::backward::distort([0.0; 4], DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0));
/// assert_eq!(g_p, DVec2::new(0.5, std::f64::consts::FRAC_PI_4)); // atan' and atan at 1
/// assert_eq!(g_k[0], std::f64::consts::FRAC_PI_4.powi(3));
/// ```
pub fn distort(k: [f64; 4], p: DVec2, g: DVec2) -> (DVec2, [f64; 4]) {
    let r = p.length();
    if r == 0.0 {
        return (g, [0.0; 4]);
    }
    let (u, theta) = (p / r, libm::atan(r));
    let (along, across) = (bent_slope(k, theta) / (1.0 + r * r), bent(k, theta) / r);
    let radial = u.x * g.x + u.y * g.y;
    (along * radial * u + across * (g - radial * u), odd_powers(theta).map(|power| power * radial))
}

/// Gradients of [`super::undistort`] with respect to the target and k, at the point p that it found.
///
/// By the implicit function theorem, as with [`crate::lens::backward::undistort`]: the stretches of [`distort`], inverted, give
/// h = g_target, and g_kn = -theta^(2n+1) (u . h).
///
/// ```
/// use glam::DVec2;
/// let (g, g_k) = nerf_oracle::fisheye::backward::undistort([0.0; 4], DVec2::new(1.0, 0.0), DVec2::new(1.0, 0.0));
/// assert_eq!((g, g_k[0]), (DVec2::new(2.0, 0.0), -2.0 * std::f64::consts::FRAC_PI_4.powi(3)));
/// ```
pub fn undistort(k: [f64; 4], p: DVec2, g: DVec2) -> (DVec2, [f64; 4]) {
    let r = p.length();
    if r == 0.0 {
        return (g, [0.0; 4]);
    }
    let (u, theta) = (p / r, libm::atan(r));
    let (along, across) = (bent_slope(k, theta) / (1.0 + r * r), bent(k, theta) / r);
    let radial = u.x * g.x + u.y * g.y;
    let h = radial / along;
    (h * u + (g - radial * u) / across, odd_powers(theta).map(|power| -power * h))
}

/// theta^3, theta^5, theta^7, theta^9.
fn odd_powers(theta: f64) -> [f64; 4] {
    let t2 = theta * theta;
    let (t3, t5) = (theta * t2, theta * t2 * t2);
    [t3, t5, t5 * t2, t5 * t2 * t2]
}
