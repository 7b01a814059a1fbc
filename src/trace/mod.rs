//! The trace of a picture: every intermediate array from the pixel to its color, for given densities and colors.
//!
//! Tests of single functions miss the mistakes of the caller: step lengths in another unit than t, jitter of another width than
//! the grid's, a pixel grid that differs at evaluation. A trace shows the first array in which two programs differ.

use crate::camera::Camera;
use crate::convention::{Conventions, Delta};
use crate::ray::{Ray, pixel_position, pixel_to_ray};
use crate::sample::{sample_along_ray, step_sizes};
use crate::volume_rendering::{Rendering, composite_background, volume_render};

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
mod chain;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

#[cfg(test)]
mod by_hand;
pub use judge::judge;

#[cfg(test)]
mod tests;

/// Every intermediate value of one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The position that its ray goes through, in pixels.
    pub uv: [f64; 2],
    /// The ray.
    pub ray: Ray,
    /// Sample positions, (N).
    pub t: Vec<f64>,
    /// Step lengths, (N).
    pub deltas: Vec<f64>,
    /// Without background.
    pub rendering: Rendering,
    /// Over the background.
    pub color: [f64; 3],
}

/// Traces pixel (column i, row j), whose samples have these densities and colors.
///
/// # Shapes
/// `u`, `sigmas`, `rgbs` (N).
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use glam::DMat4;
/// use nerf_oracle::{camera::{Camera, Intrinsics}, convention::CS180, trace::trace_pixel};
/// let k = Intrinsics { fx: 4.0, fy: 4.0, cx: 2.0, cy: 1.0 };
/// let camera = Camera { width: 4, height: 2, k, c2w: DMat4::IDENTITY, distortion: None };
/// let sigmas = [std::f64::consts::LN_2, 0.0];
/// let trace = trace_pixel(&camera, (1, 0), (2.0, 4.0), &[0.5; 2], &sigmas, &[[1.0, 0.5, 0.0]; 2], [0.0; 3], &CS180);
/// assert_eq!((trace.uv, trace.t, trace.color), ([1.5, 0.5], vec![2.5, 3.5], [0.5, 0.25, 0.0]));
/// ```
pub fn trace_pixel(
    camera: &Camera,
    (i, j): (usize, usize),
    (near, far): (f64, f64),
    u: &[f64],
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    background: [f64; 3],
    c: &Conventions,
) -> Trace {
    assert_eq!(sigmas.len(), u.len(), "sigmas and u: one each a sample");
    assert_eq!(rgbs.len(), u.len(), "rgbs and u: one each a sample");
    let uv = pixel_position(i, j, c.pixel_center);
    let ray = pixel_to_ray(&camera.k, &camera.c2w, uv, c.axes, c.directions);
    let t = sample_along_ray(near, far, u, c.grid);
    let mut deltas = step_sizes(&t, near, far, c.delta, c.last_delta);
    if c.delta == Delta::DifferencesTimesNorm {
        deltas.iter_mut().for_each(|delta| *delta *= ray.d.length());
    }
    let rendering = volume_render(sigmas, rgbs, &deltas, c.product_eps);
    let color = composite_background(rendering.color, rendering.opacity, background);
    Trace { uv: uv.to_array(), ray, t, deltas, rendering, color }
}
