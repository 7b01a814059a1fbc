//! Somebody's positional encoding, judged.

use ndarray::ArrayView2;

use super::component::POSITIONAL_ENCODING;
use crate::judge::door::front_door;

front_door! {
    /// Judges the encoding of one point: `x` (D), L -> (D + 2 L D).
    ///
    /// ```
    /// use std::f64::consts::PI;
    /// use nerf_oracle::encoding;
    /// encoding::judge(|x, levels| {
    ///     let mut out = x.to_vec();
    ///     for k in 0..levels {
    ///         // sin and cos of 2^k pi x, by what is left of 2^k x after whole turns: exact.
    ///         let angle = |x: &f64| PI * ((x * 2f64.powi(k as i32)) % 2.0);
    ///         out.extend(x.iter().map(|x| angle(x).sin()));
    ///         out.extend(x.iter().map(|x| angle(x).cos()));
    ///     }
    ///     out
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each POSITIONAL_ENCODING: judge as Point(x: &[f64], L: usize);
    /// With its gradient: (x, L, grad_encoding) -> grad_x.
    each_vjp(grad_encoding: &[f64]);
}

front_door! {
    /// Judges the encoding of many points: `x` (M, D), L -> (M, D + 2 L D).
    whole POSITIONAL_ENCODING: judge_batch as Points(x: ArrayView2<f64>, L: usize);
    /// With its gradient: (x, L, grad_encoding) -> grad_x.
    whole_vjp(grad_encoding: ArrayView2<f64>);
}
