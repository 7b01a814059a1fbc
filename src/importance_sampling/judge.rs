//! Somebody's importance sampling, judged.

use ndarray::ArrayView2;

use super::component::IMPORTANCE_SAMPLING;
use crate::judge::door::front_door;

front_door! {
    /// Judges the samples of one ray: `edges` (N + 1), `weights` (N), padding, `u` (M) -> t (M).
    ///
    /// ```
    /// use nerf_oracle::importance_sampling::{backward, judge, sample};
    /// judge(sample).vjp(backward::sample).assert_pass();
    /// ```
    each IMPORTANCE_SAMPLING: judge as Ray(edges: &[f64], weights: &[f64], padding: f64, u: &[f64]);
    /// With its gradient: (edges, weights, padding, u, grad_t) -> (grad_edges, grad_u).
    each_vjp(grad_t: &[f64]);
}

front_door! {
    /// Judges the samples of many rays: `edges` (R, N + 1), `weights` (R, N), padding, `u` (R, M) -> t (R, M).
    whole IMPORTANCE_SAMPLING: judge_batch as Rays(
        edges: ArrayView2<f64>,
        weights: ArrayView2<f64>,
        padding: f64,
        u: ArrayView2<f64>,
    );
    /// With its gradient: the same and grad_t -> (grad_edges, grad_u).
    whole_vjp(grad_t: ArrayView2<f64>);
}
