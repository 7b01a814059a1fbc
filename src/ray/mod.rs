//! Rays: pixel -> origin and direction, and the random rays of a training step.
//!
//! Letters: `o` origin, `d` direction, `uv` pixel position, `u` a random number in [0, 1).

use glam::{DMat4, DVec2, DVec3};

use crate::camera::{Camera, Intrinsics, pixel_to_camera, rotate};
use crate::convention::{Axes, Directions, PixelCenter};
use crate::error::Result;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;
mod random;

#[cfg(test)]
mod tests;

pub use judge::judge;
pub use random::{PixelDraw, PixelDraws, draw_index, draw_pixel, sample_random_rays};

/// r(t) = o + t d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin: the camera's center, world space.
    pub o: DVec3,
    /// Direction, world space.
    pub d: DVec3,
}

impl Ray {
    /// The point r(t) = o + t d.
    pub fn at(&self, t: f64) -> DVec3 {
        self.o + self.d * t
    }
}

/// Direction in camera space through pixel `uv`, not normalized: `K^-1 (u, v, 1)`, turned to the axes of the pose.
pub fn camera_direction(k: &Intrinsics, uv: DVec2, axes: Axes) -> DVec3 {
    let d = pixel_to_camera(k, uv, 1.0);
    match axes {
        Axes::Opencv => d,
        Axes::Opengl => DVec3::new(d.x, -d.y, -d.z),
    }
}

/// The ray through pixel `uv`: `o` is the camera's center, `d = R K^-1 (u, v, 1)`, divided by its norm.
///
/// The textbook form `(x_w - o) / |x_w - o|` is the same over the reals, but its relative error is larger by `|o| / |x_w - o|`; here the
/// translation never enters.
///
/// # Convention
/// `uv` counts from the picture's upper left corner: the center of pixel (i, j) is (i + 0.5, j + 0.5). With
/// [`Directions::Depth`] the division is left out, with [`Directions::UnitInCamera`] it comes before R.
///
/// ```
/// use glam::{DMat4, DVec2, DVec3};
/// use nerf_oracle::camera::Intrinsics;
/// use nerf_oracle::convention::{Axes, Directions};
/// use nerf_oracle::ray::pixel_to_ray;
/// let k = Intrinsics { fx: 10.0, fy: 10.0, cx: 8.0, cy: 8.0 };
/// let ray = pixel_to_ray(&k, &DMat4::IDENTITY, DVec2::new(8.0, 8.0), Axes::Opencv, Directions::Unit);
/// assert_eq!((ray.o, ray.d), (DVec3::ZERO, DVec3::Z));
/// ```
pub fn pixel_to_ray(k: &Intrinsics, c2w: &DMat4, uv: DVec2, axes: Axes, directions: Directions) -> Ray {
    let (o, d_c) = (c2w.w_axis.truncate(), camera_direction(k, uv, axes));
    let d = match directions {
        Directions::Unit => rotate(c2w, d_c) / rotate(c2w, d_c).length(),
        Directions::UnitInCamera => rotate(c2w, d_c / d_c.length()),
        Directions::Depth => rotate(c2w, d_c),
    };
    Ray { o, d }
}

/// The position `uv` through which the ray of the pixel in column `i` and row `j` goes.
pub fn pixel_position(i: usize, j: usize, center: PixelCenter) -> DVec2 {
    let shift = match center {
        PixelCenter::Half => 0.5,
        PixelCenter::Integer => 0.0,
    };
    DVec2::new(i as f64 + shift, j as f64 + shift)
}

/// The ray of position `uv` in a scene's camera: unit direction, OpenCV axes, undistorted where there is a lens.
///
/// # Errors
/// Where the lens has no inverse at `uv`.
pub fn camera_ray(camera: &Camera, uv: DVec2) -> Result<Ray> {
    let Some(lens) = camera.distortion else {
        return Ok(pixel_to_ray(&camera.k, &camera.c2w, uv, Axes::Opencv, Directions::Unit));
    };
    let distorted = pixel_to_camera(&camera.k, uv, 1.0).truncate();
    let d = rotate(&camera.c2w, lens.undistort(distorted)?.extend(1.0));
    Ok(Ray { o: camera.c2w.w_axis.truncate(), d: d / d.length() })
}
