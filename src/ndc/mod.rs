//! Rays of forward-facing cameras in normalized device coordinates, where everything between the near plane and infinity is a cube.
//!
//! NeRF (Mildenhall et al. 2020), appendix C. Letters: `n` depth of the near plane, `f` focal length, `p` where the ray meets that plane.

use crate::convention::NdcDepth;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub mod cube;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// What all rays share: the camera that the cube is the view of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Width of the picture, in pixels.
    pub width: f64,
    /// Height of the picture, in pixels.
    pub height: f64,
    /// Focal length, in pixels.
    pub focal: f64,
    /// Depth of the near plane, above 0.
    pub near: f64,
    /// Whether the scene lies at negative or at positive z.
    pub depth: NdcDepth,
}

impl View {
    /// z of a point in front, per unit of depth.
    pub(crate) fn sign(&self) -> f64 {
        match self.depth {
            NdcDepth::Negative => -1.0,
            NdcDepth::Positive => 1.0,
        }
    }

    /// What a slope x / depth, or y / depth, is multiplied by: 1 at the picture's edge.
    pub(crate) fn scales(&self) -> [f64; 2] {
        [2.0 * self.focal / self.width, 2.0 * self.focal / self.height]
    }
}

/// Origin and direction of a ray in normalized device coordinates.
///
/// With p = o + t d at depth n:
/// o' = (2f/W p_x/n, 2f/H p_y/n, -1) and d' = (2f/W (d_x/|d_z| - p_x/n), 2f/H (d_y/|d_z| - p_y/n), 2), where |d_z| is the
/// direction's depth: -d_z or d_z, by convention. Equations 25 and 26 of the paper, at o_z = -n.
///
/// # Units
/// o, d and n in those of the scene, in the coordinates of the camera whose view the cube is; pictures in pixels. The result is in
/// [-1, 1] where that camera sees it, with the near plane at -1 and infinity at 1: o' + t' d' reaches it at t' = 1.
///
/// # Convention
/// `view.depth`: the scene lies at z < 0 (OpenGL's axes, the paper and nearly all code) or at z > 0 (OpenCV's). x and y are scaled alike.
/// d' isn't a unit vector: its length says where infinity is. A ray with d_z = 0 never meets the near plane: what comes out isn't finite.
///
/// ```
/// use nerf_oracle::{convention::NdcDepth, ndc::{View, ndc_ray}};
/// let view = View { width: 8.0, height: 4.0, focal: 4.0, near: 1.0, depth: NdcDepth::Negative };
/// // From (0.5, 0, 0) straight ahead: on the near plane at x = 0.5, in the picture's middle at infinity.
/// let ray = ndc_ray([0.5, 0.0, 0.0], [0.0, 0.0, -2.0], &view);
/// assert_eq!(ray, ([0.5, 0.0, -1.0], [-0.5, 0.0, 2.0]));
/// ```
pub fn ndc_ray(o: [f64; 3], d: [f64; 3], view: &View) -> ([f64; 3], [f64; 3]) {
    let (sign, scales) = (view.sign(), view.scales());
    let t = (sign * view.near - o[2]) / d[2];
    let mut o_ndc = [0.0, 0.0, -1.0];
    let mut d_ndc = [0.0, 0.0, 2.0];
    for j in 0..2 {
        let start = (o[j] + t * d[j]) / view.near;
        let slope = sign * d[j] / d[2];
        o_ndc[j] = scales[j] * start;
        d_ndc[j] = scales[j] * (slope - start);
    }
    (o_ndc, d_ndc)
}

/// A point in normalized device coordinates: on [`ndc_ray`]'s rays through it, at t' = 1 - n / depth.
///
/// (2f/W x/depth, 2f/H y/depth, 1 - 2 n/depth), the depth -z or z by convention: NeRF (Mildenhall et al. 2020), appendix C, the
/// projection with the far plane at infinity. Units as in [`ndc_ray`]. At depth 0 what comes out isn't finite.
///
/// ```
/// use nerf_oracle::{convention::NdcDepth, ndc::{View, ndc_point}};
/// let view = View { width: 8.0, height: 4.0, focal: 4.0, near: 1.0, depth: NdcDepth::Negative };
/// assert_eq!(ndc_point([0.5, 0.25, -2.0], &view), [0.25, 0.25, 0.0]);
/// ```
pub fn ndc_point(x: [f64; 3], view: &View) -> [f64; 3] {
    let (depth, scales) = (view.sign() * x[2], view.scales());
    [scales[0] * x[0] / depth, scales[1] * x[1] / depth, 1.0 - 2.0 * view.near / depth]
}
