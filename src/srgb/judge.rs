//! Somebody's sRGB curve, judged.

use ndarray::ArrayView1;

use super::component::LINEAR_TO_SRGB;
use crate::judge::door::front_door;

front_door! {
    /// Judges the sRGB value of one linear value.
    ///
    /// ```
    /// use nerf_oracle::srgb::{backward, judge, linear_to_srgb};
    /// judge(linear_to_srgb).vjp(backward::linear_to_srgb).assert_pass();
    /// ```
    each LINEAR_TO_SRGB: judge as Number(linear: f64);
    /// With its gradient: (linear, grad_srgb) -> grad_linear.
    each_vjp(grad_srgb: f64);
}

front_door! {
    /// Judges many values: `linear` (M) -> srgb (M).
    whole LINEAR_TO_SRGB: judge_batch as Numbers(linear: ArrayView1<f64>);
    /// With its gradient: (linear, grad_srgb) -> grad_linear, (M) each.
    whole_vjp(grad_srgb: ArrayView1<f64>);
}
