//! Somebody's density activation, judged.

use ndarray::ArrayView1;

use super::component::TRUNC_EXP;
use crate::judge::door::front_door;

front_door! {
    /// Judges sigma = e^x of one number.
    ///
    /// ```
    /// use nerf_oracle::trunc_exp;
    /// trunc_exp::judge(|x| x.exp()).vjp(|x, g| g * x.clamp(-15.0, 15.0).exp()).assert_pass();
    /// ```
    each TRUNC_EXP: judge as Number(x: f64);
    /// With its gradient: (x, grad_sigma) -> grad_x.
    each_vjp(grad_sigmas: f64);
}

front_door! {
    /// Judges sigma = e^x of many numbers: `x` (M) -> sigmas (M).
    whole TRUNC_EXP: judge_batch as Numbers(x: ArrayView1<f64>);
    /// With its gradient: (x, grad_sigmas) -> grad_x, (M) each.
    whole_vjp(grad_sigmas: ArrayView1<f64>);
}
