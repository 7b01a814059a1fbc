//! Somebody's whole way from the pixel to its color, judged.

use ndarray::{ArrayView3, ArrayView4};

use super::component::RENDER_TRACE;
use crate::judge::door::front_door;

front_door! {
    /// Judges a small picture: (height, width, focal, cx, cy, c2w, near, far, u, sigmas, rgbs, background)
    /// -> (uv, rays_o, rays_d, t, deltas, weights, colors), or some of these with `()` for the others. The first one that is off tells
    /// where the mistake is.
    ///
    /// ```
    /// use nerf_oracle::ndarray::Array3;
    /// use nerf_oracle::trace;
    /// trace::judge(|height, width, _, _, _, _, near, far, u, _, _, _| {
    ///     let uv = Array3::from_shape_fn((height, width, 2), |(j, i, a)| [i, j][a] as f64 + 0.5);
    ///     let delta = (far - near) / u.dim().2 as f64;
    ///     let t = Array3::from_shape_fn(u.dim(), |(j, i, n)| near + (n as f64 + u[[j, i, n]]) * delta);
    ///     (uv, (), (), t, Array3::from_elem(u.dim(), delta))
    /// })
    /// .assert_pass();
    /// ```
    whole RENDER_TRACE: judge as Picture(
        height: usize,
        width: usize,
        focal: f64,
        cx: f64,
        cy: f64,
        c2w: [[f64; 4]; 4],
        near: f64,
        far: f64,
        u: ArrayView3<f64>,
        sigmas: ArrayView3<f64>,
        rgbs: ArrayView4<f64>,
        background: [f64; 3],
    );
}
