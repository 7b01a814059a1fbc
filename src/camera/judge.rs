//! Somebody's transformations, judged. Matrices are row-major: `c2w[i][j]` is row i, column j.

use ndarray::{ArrayView1, ArrayView2, ArrayView3};

use super::component::{PIXEL_TO_CAMERA, TRANSFORM};
use crate::judge::door::front_door;

front_door! {
    /// Judges x_w = R x_c + o of one point: (c2w, x_c) -> x_w.
    ///
    /// ```
    /// use nerf_oracle::camera;
    /// camera::judge(|m, x| [0, 1, 2].map(|i| m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2] + m[i][3])).assert_pass();
    /// ```
    each TRANSFORM: judge as Point(c2w: [[f64; 4]; 4], x_c: [f64; 3]);
    /// With its gradient: (c2w, x_c, grad_x_w) -> (grad_c2w, grad_x_c).
    each_vjp(grad_x_w: [f64; 3]);
}

front_door! {
    /// Judges x_w of many points: `c2w` (M, 4, 4), `x_c` (M, 3) -> x_w (M, 3).
    whole TRANSFORM: judge_batch as Points(c2w: ArrayView3<f64>, x_c: ArrayView2<f64>);
    /// With its gradient: (c2w, x_c, grad_x_w) -> (grad_c2w, grad_x_c).
    whole_vjp(grad_x_w: ArrayView2<f64>);
}

front_door! {
    /// Judges x_c = s K^-1 (u, v, 1) of one pixel: (K, uv, s) -> x_c.
    ///
    /// ```
    /// use nerf_oracle::camera::judge;
    /// judge::pixel_to_camera(|k, [u, v], s| [s * (u - k[0][2]) / k[0][0], s * (v - k[1][2]) / k[1][1], s]).assert_pass();
    /// ```
    each PIXEL_TO_CAMERA: pixel_to_camera as Pixel(K: [[f64; 3]; 3], uv: [f64; 2], s: f64);
    /// With its gradient: (K, uv, s, grad_x_c) -> (this pixel's part of grad_K, grad_uv, grad_s).
    each_vjp(grad_x_c: [f64; 3]);
}

front_door! {
    /// Judges x_c of many pixels: `K` (3, 3), `uv` (M, 2), `s` (M) -> x_c (M, 3).
    whole PIXEL_TO_CAMERA: pixel_to_camera_batch as Pixels(
        K: ArrayView2<f64>,
        uv: ArrayView2<f64>,
        s: ArrayView1<f64>,
    );
    /// With its gradient: (K, uv, s, grad_x_c) -> (grad_K, grad_uv, grad_s).
    whole_vjp(grad_x_c: ArrayView2<f64>);
}
