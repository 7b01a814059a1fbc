//! Somebody's distortion loss, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::DISTORTION_LOSS;
use crate::judge::door::front_door;

front_door! {
    /// Judges the loss of one ray: (weights, t) -> loss.
    ///
    /// ```
    /// use nerf_oracle::distortion::{backward, distortion, judge};
    /// judge(distortion).vjp(backward::distortion).assert_pass();
    /// ```
    each DISTORTION_LOSS: judge as Ray(weights: &[f64], t: &[f64]);
    /// With its gradient: (weights, t, grad_loss) -> (grad_weights, grad_t).
    each_vjp(grad_loss: f64);
}

front_door! {
    /// Judges that of many rays: `weights` (R, N), `t` (R, N + 1) -> loss (R).
    whole DISTORTION_LOSS: judge_batch as Rays(weights: ArrayView2<f64>, t: ArrayView2<f64>);
    /// With its gradient: (weights, t, grad_loss) -> (grad_weights, grad_t).
    whole_vjp(grad_loss: ArrayView1<f64>);
}
