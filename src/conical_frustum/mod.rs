//! What a pixel sees between two distances: a piece of a cone, and the Gaussian that stands for it.
//!
//! Mip-NeRF (Barron et al. 2021), section 3.1, equations 7 and 8, and its supplement, section 1. The Gaussian has the mean and the
//! variance of a point drawn evenly from the frustum. Letters: `s` = start + end, `d` = end - start, `q` = d^2 / (3 s^2 + d^2).

use crate::convention::RayShape;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// A piece of a cone or cylinder around a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Where the ray begins: the cone's apex.
    pub origin: [f64; 3],
    /// The ray's direction, of any length but 0: t counts in units of it.
    pub direction: [f64; 3],
    /// The cone's radius at t = 1, or the cylinder's.
    pub radius: f64,
    /// Its first t.
    pub start: f64,
    /// Its last.
    pub end: f64,
}

/// The Gaussian of a frustum, along its ray and in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// The mean of t.
    pub t_mean: f64,
    /// The variance of t, in units of the direction's length.
    pub t_variance: f64,
    /// The variance along each line across the ray, in units of the scene.
    pub r_variance: f64,
    /// The mean.
    pub mean: [f64; 3],
    /// The diagonal of the covariance.
    pub variance: [f64; 3],
}

/// The mean o + t_mean d, and the variances t_variance d_i^2 + r_variance (1 - d_i^2 / |d|^2), with |d|^2 - d_i^2 summed by itself.
///
/// # Units
/// Origin and direction in those of the scene. The radius of a pixel of width w at depth 1 is 2 w / sqrt(12) in mip-NeRF: then a disk of
/// it has the pixel's variance. That is the caller's.
///
/// # Convention
/// `shape`: a cone, whose radius grows as t does, or a cylinder.
///
/// ```
/// use nerf_oracle::conical_frustum::{Frustum, conical_frustum};
/// use nerf_oracle::convention::RayShape::{Cone, Cylinder};
/// let f = Frustum { origin: [1.0, 0.0, 0.0], direction: [0.0, 0.0, 2.0], radius: 0.5, start: 0.0, end: 4.0 };
/// // A whole cone: three quarters of the way down.
/// let g = conical_frustum(&f, Cone);
/// assert_eq!((g.t_mean, g.mean), (3.0, [1.0, 0.0, 6.0]));
/// // 3/80 of the height's square, and 3/20 of the base's.
/// let near = |found: f64, expected: f64| (found - expected).abs() < 1e-15;
/// assert!(near(g.t_variance, 0.6) && near(g.r_variance, 0.6));
/// assert!(near(g.variance[0], 0.6) && near(g.variance[1], 0.6) && near(g.variance[2], 2.4));
/// let g = conical_frustum(&f, Cylinder);
/// assert_eq!((g.t_mean, g.r_variance, g.variance[2]), (2.0, 0.0625, 4.0 * (16.0 / 12.0)));
/// ```
pub fn conical_frustum(f: &Frustum, shape: RayShape) -> Gaussian {
    let (t_mean, t_variance, squares) = moments(f.start, f.end, shape);
    let r_variance = f.radius * f.radius * squares;
    let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        mean[i] = f.origin[i] + t_mean * f.direction[i];
        variance[i] = t_variance * f.direction[i] * f.direction[i] + r_variance * across(f.direction, i);
    }
    Gaussian { t_mean, t_variance, r_variance, mean, variance }
}

/// Mean and variance of t, and the variance across over the squared radius.
///
/// Of a cone: s (1/2 + q), d^2 (5 - 16 q + 20 q^2) / 60, and s^2 / 16 + d^2 (5/48 - q / 15): nothing cancels however short the interval
/// is (PE5). The textbook's 3 (t1^4 - t0^4) / (4 (t1^3 - t0^3)) and its like have no digit left where d is 1e-5 of s, in f64.
/// Of a cylinder: s / 2, d^2 / 12, 1/4.
pub fn moments(start: f64, end: f64, shape: RayShape) -> (f64, f64, f64) {
    let (s, d) = (start + end, end - start);
    if shape == RayShape::Cylinder {
        return (s / 2.0, d * d / 12.0, 0.25);
    }
    let q = thickness(s, d);
    let t_variance = d * d * (5.0 - 16.0 * q + 20.0 * q * q) / 60.0;
    (s * (0.5 + q), t_variance, s * s / 16.0 + d * d * (5.0 / 48.0 - q / 15.0))
}

/// q = d^2 / (3 s^2 + d^2), by d / s so that no square overflows: 0 for an interval without length, 1/4 for one from the apex.
fn thickness(s: f64, d: f64) -> f64 {
    if d == 0.0 {
        return 0.0;
    }
    let x = d / s;
    x * x / (3.0 + x * x)
}

/// 1 - d_i^2 / |d|^2: how much of axis i lies across the direction.
fn across(direction: [f64; 3], i: usize) -> f64 {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let others = direction[j] * direction[j] + direction[k] * direction[k];
    others / (direction[i] * direction[i] + others)
}
