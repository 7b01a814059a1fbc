//! Somebody's intersection of rays and a box, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::RAY_AABB;
use crate::judge::door::front_door;

front_door! {
    /// Judges one ray: (origin, direction, low, high, near, far) -> (t_near, t_far, hit).
    ///
    /// ```
    /// use nerf_oracle::ray_aabb::{between, judge};
    /// judge(|o, d, low, high, near, far| match between(o, d, low, high, near, far) {
    ///     Some(hit) => (hit.enter, hit.leave, true),
    ///     None => (far, far, false),
    /// })
    /// .assert_pass();
    /// ```
    each RAY_AABB: judge as Ray(
        rays_o: [f64; 3],
        rays_d: [f64; 3],
        low: [f64; 3],
        high: [f64; 3],
        near: f64,
        far: f64,
    );
    /// With its gradient: the same and (grad_t_near, grad_t_far) -> (grad_o, grad_d).
    each_vjp(grad_t_near: f64, grad_t_far: f64);
}

front_door! {
    /// Judges many rays: `rays_o` and `rays_d` (R, 3), low, high, near, far -> (t_near, t_far, hit), R each.
    whole RAY_AABB: judge_batch as Rays(
        rays_o: ArrayView2<f64>,
        rays_d: ArrayView2<f64>,
        low: [f64; 3],
        high: [f64; 3],
        near: f64,
        far: f64,
    );
    /// With its gradient: the same and (grad_t_near, grad_t_far) -> (grad_rays_o, grad_rays_d).
    whole_vjp(grad_t_near: ArrayView1<f64>, grad_t_far: ArrayView1<f64>);
}
