//! Somebody's rays, judged. Matrices are row-major: `c2w[i][j]` is row i, column j.

use ndarray::{ArrayView2, ArrayView3};

use super::component::{IMAGE_RAYS, PIXEL_TO_RAY};
use crate::judge::door::front_door;

front_door! {
    /// Judges the ray of one pixel: (K, c2w, uv) -> (origin, direction).
    ///
    /// ```
    /// use nerf_oracle::ray;
    /// ray::judge(|k, m, [u, v]| {
    ///     let d = [(u - k[0][2]) / k[0][0], (v - k[1][2]) / k[1][1], 1.0];
    ///     let d = [0, 1, 2].map(|i| m[i][0] * d[0] + m[i][1] * d[1] + m[i][2] * d[2]);
    ///     let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    ///     ([m[0][3], m[1][3], m[2][3]], d.map(|x| x / length))
    /// })
    /// .profile("cs180")
    /// .assert_pass();
    /// ```
    each PIXEL_TO_RAY: judge as Pixel(K: [[f64; 3]; 3], c2w: [[f64; 4]; 4], uv: [f64; 2]);
    /// With its gradient: (K, c2w, uv, grad_o, grad_d) -> (this pixel's part of grad_K, grad_c2w, grad_uv).
    each_vjp(grad_rays_o: [f64; 3], grad_rays_d: [f64; 3]);
}

front_door! {
    /// Judges the rays of many pixels: `K` (3, 3), `c2w` (M, 4, 4), `uv` (M, 2) -> (rays_o, rays_d), (M, 3) each.
    whole PIXEL_TO_RAY: judge_batch as Pixels(K: ArrayView2<f64>, c2w: ArrayView3<f64>, uv: ArrayView2<f64>);
    /// With its gradient: (K, c2w, uv, grad_rays_o, grad_rays_d) -> (grad_K, grad_c2w, grad_uv).
    whole_vjp(grad_rays_o: ArrayView2<f64>, grad_rays_d: ArrayView2<f64>);
}

front_door! {
    /// Judges the rays of a whole picture: (height, width, focal, cx, cy, c2w) -> (uv, rays_o, rays_d), (H, W, 2 or 3) each.
    ///
    /// ```
    /// use nerf_oracle::ndarray::Array3;
    /// use nerf_oracle::ray::judge;
    /// // Pixel positions alone.
    /// judge::image_rays(|height, width, _, _, _, _| {
    ///     Array3::from_shape_fn((height, width, 2), |(j, i, a)| [i, j][a] as f64 + 0.5)
    /// })
    /// .assert_pass();
    /// ```
    whole IMAGE_RAYS: image_rays as Picture(
        height: usize,
        width: usize,
        focal: f64,
        cx: f64,
        cy: f64,
        c2w: [[f64; 4]; 4],
    );
}
