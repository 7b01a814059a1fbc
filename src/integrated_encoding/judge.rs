//! Somebody's integrated encoding, judged.

use ndarray::ArrayView2;

use super::component::INTEGRATED_ENCODING;
use crate::judge::door::front_door;

front_door! {
    /// Judges the encoding of one Gaussian: `means` (D), `variances` (D), L -> (2 L D).
    ///
    /// ```
    /// use std::f64::consts::PI;
    /// use nerf_oracle::integrated_encoding;
    /// integrated_encoding::judge(|means, variances, levels| {
    ///     let mut out = vec![];
    ///     for k in 0..levels {
    ///         let band = 2f64.powi(k as i32);
    ///         let left = |v: &f64| (-0.5 * (PI * band).powi(2) * v).exp();
    ///         // sin and cos of 2^k pi x, by what is left of 2^k x after whole turns: exact.
    ///         let angle = |x: &f64| PI * ((x * band) % 2.0);
    ///         out.extend(means.iter().zip(variances).map(|(x, v)| left(v) * angle(x).sin()));
    ///         out.extend(means.iter().zip(variances).map(|(x, v)| left(v) * angle(x).cos()));
    ///     }
    ///     out
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each INTEGRATED_ENCODING: judge as Point(means: &[f64], variances: &[f64], L: usize);
    /// With its gradient: (means, variances, L, grad_encoding) -> (grad_means, grad_variances).
    each_vjp(grad_encoding: &[f64]);
}

front_door! {
    /// Judges the encoding of many: `means` (M, D), `variances` (M, D), L -> (M, 2 L D).
    whole INTEGRATED_ENCODING: judge_batch as Points(means: ArrayView2<f64>, variances: ArrayView2<f64>, L: usize);
    /// With its gradient: (means, variances, L, grad_encoding) -> (grad_means, grad_variances).
    whole_vjp(grad_encoding: ArrayView2<f64>);
}
