//! Somebody's rays in normalized device coordinates, judged.

use ndarray::ArrayView2;

use super::component::NDC_RAYS;
use crate::judge::door::front_door;

front_door! {
    /// Judges one ray: (origin, direction, width, height, focal, near) -> (origin, direction).
    ///
    /// ```
    /// use nerf_oracle::ndc::judge;
    /// judge(|o, d, width, height, focal, near| {
    ///     let t = -(near + o[2]) / d[2];
    ///     let p = [0, 1, 2].map(|j| o[j] + t * d[j]);
    ///     let c = [-2.0 * focal / width, -2.0 * focal / height];
    ///     let start = [c[0] * p[0] / p[2], c[1] * p[1] / p[2], 1.0 + 2.0 * near / p[2]];
    ///     let ahead = [c[0] * (d[0] / d[2] - p[0] / p[2]), c[1] * (d[1] / d[2] - p[1] / p[2]), -2.0 * near / p[2]];
    ///     (start, ahead)
    /// })
    /// .assert_pass();
    /// ```
    each NDC_RAYS: judge as Ray(
        rays_o: [f64; 3],
        rays_d: [f64; 3],
        width: f64,
        height: f64,
        focal: f64,
        near: f64,
    );
    /// With its gradient: the same and (grad_rays_o_ndc, grad_rays_d_ndc) -> (grad_o, grad_d).
    each_vjp(grad_rays_o_ndc: [f64; 3], grad_rays_d_ndc: [f64; 3]);
}

front_door! {
    /// Judges many rays: `rays_o` and `rays_d` (R, 3), width, height, focal, near -> (rays_o_ndc, rays_d_ndc), (R, 3) each.
    whole NDC_RAYS: judge_batch as Rays(
        rays_o: ArrayView2<f64>,
        rays_d: ArrayView2<f64>,
        width: f64,
        height: f64,
        focal: f64,
        near: f64,
    );
    /// With its gradient: the same and (grad_rays_o_ndc, grad_rays_d_ndc) -> (grad_rays_o, grad_rays_d).
    whole_vjp(grad_rays_o_ndc: ArrayView2<f64>, grad_rays_d_ndc: ArrayView2<f64>);
}
