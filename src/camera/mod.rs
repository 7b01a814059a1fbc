//! Pinhole camera: pixel -> camera space -> world space.
//!
//! Letters: `K` intrinsics (fx, fy, cx, cy, in pixels), `uv` pixel position (u to the right, v down, in pixels), `s` depth
//! along the camera's axis, `x_c` a point in camera space, `x_w` in world space, `c2w` the camera-to-world pose.

use glam::{DMat4, DVec2, DVec3};
use serde::{Deserialize, Serialize};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

#[cfg(test)]
pub(crate) mod tests;

use crate::error::Result;
use crate::fisheye;
pub use crate::lens::Distortion;
pub use judge::judge;

/// A pinhole camera's intrinsic parameters, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Focal length along u.
    pub fx: f64,
    /// Focal length along v.
    pub fy: f64,
    /// Principal point, u.
    pub cx: f64,
    /// Principal point, v.
    pub cy: f64,
}

/// What bends the rays of a camera that isn't a pinhole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lens {
    /// Radial and tangential distortion.
    Opencv(Distortion),
    /// A fisheye's k1, k2, k3, k4.
    Fisheye([f64; 4]),
}

impl Lens {
    /// Where an ideal point at depth 1 lands on the picture, in the same units.
    pub fn distort(&self, p: DVec2) -> DVec2 {
        match *self {
            Lens::Opencv(lens) => lens.distort(p),
            Lens::Fisheye(k) => fisheye::distort(k, p),
        }
    }

    /// The ideal point that lands at `target`.
    ///
    /// # Errors
    /// Where there is none: the lens folds over, or a fisheye sees it 90 degrees or more off its axis.
    pub fn undistort(&self, target: DVec2) -> Result<DVec2> {
        match *self {
            Lens::Opencv(lens) => lens.undistort(target),
            Lens::Fisheye(k) => fisheye::undistort(k, target),
        }
    }
}

/// One photograph's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Picture width in pixels.
    pub width: usize,
    /// Picture height in pixels.
    pub height: usize,
    /// Intrinsics.
    pub k: Intrinsics,
    /// Camera to world, OpenCV axes (x right, y down, z forward), rigid.
    pub c2w: DMat4,
    /// The lens, where it isn't a pinhole.
    pub distortion: Option<Lens>,
}

/// A point from camera space to world space: `x_w = R x_c + o`, the upper 3x4 of `c2w` times (x_c, 1).
///
/// # Convention
/// `c2w` maps column vectors; its last row (0, 0, 0, 1) is not used.
///
/// ```
/// use glam::{DMat4, DVec3};
/// let c2w = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0));
/// assert_eq!(nerf_oracle::camera::transform(&c2w, DVec3::X), DVec3::new(2.0, 2.0, 3.0));
/// ```
pub fn transform(c2w: &DMat4, x_c: DVec3) -> DVec3 {
    rotate(c2w, x_c) + c2w.w_axis.truncate()
}

/// A direction from camera space to world space: `R d_c`. The translation must not enter.
pub fn rotate(c2w: &DMat4, d_c: DVec3) -> DVec3 {
    c2w.x_axis.truncate() * d_c.x + c2w.y_axis.truncate() * d_c.y + c2w.z_axis.truncate() * d_c.z
}

/// The point at depth `s` behind pixel `uv`: `x_c = s K^-1 (u, v, 1)`.
///
/// # Units
/// `uv` and `K` in pixels, `s` and the result in scene units.
///
/// # Convention
/// OpenCV axes: x right, y down, z forward, so that the result's z is `s`.
///
/// ```
/// use glam::{DVec2, DVec3};
/// use nerf_oracle::camera::{Intrinsics, pixel_to_camera};
/// let k = Intrinsics { fx: 100.0, fy: 200.0, cx: 50.0, cy: 40.0 };
/// assert_eq!(pixel_to_camera(&k, DVec2::new(60.0, 60.0), 2.0), DVec3::new(0.2, 0.2, 2.0));
/// ```
pub fn pixel_to_camera(k: &Intrinsics, uv: DVec2, s: f64) -> DVec3 {
    DVec3::new(s * (uv.x - k.cx) / k.fx, s * (uv.y - k.cy) / k.fy, s)
}

/// The pixel on which a point in camera space falls: `(u, v) = (fx x / z + cx, fy y / z + cy)`. Inverse of [`pixel_to_camera`].
///
/// ```
/// use glam::{DVec2, DVec3};
/// use nerf_oracle::camera::{Intrinsics, camera_to_pixel};
/// let k = Intrinsics { fx: 100.0, fy: 200.0, cx: 50.0, cy: 40.0 };
/// assert_eq!(camera_to_pixel(&k, DVec3::new(0.2, 0.2, 2.0)), DVec2::new(60.0, 60.0));
/// ```
pub fn camera_to_pixel(k: &Intrinsics, x_c: DVec3) -> DVec2 {
    DVec2::new(k.fx * x_c.x / x_c.z + k.cx, k.fy * x_c.y / x_c.z + k.cy)
}
