//! Somebody's structural similarity, judged.

use ndarray::ArrayView3;

use super::component::SSIM;
use crate::judge::door::front_door;

front_door! {
    /// Judges the similarity of two pictures: `prediction` and `target` (H, W, C), peak -> value.
    ///
    /// ```
    /// use nerf_oracle::ssim::{Form, backward, judge, ssim};
    /// judge(|p, t, peak| ssim(p, t, peak, Form::default()))
    ///     .vjp(|p, t, peak, g| backward::ssim(p, t, peak, Form::default(), g))
    ///     .assert_pass();
    /// ```
    whole SSIM: judge as Pictures(prediction: ArrayView3<f64>, target: ArrayView3<f64>, peak: f64);
    /// With its gradient: (prediction, target, peak, grad_value) -> grad_prediction.
    whole_vjp(grad_value: f64);
}
