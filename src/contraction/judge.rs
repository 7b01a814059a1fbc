//! Somebody's scene contraction, judged.

use ndarray::ArrayView2;

use super::component::CONTRACTION;
use crate::judge::door::front_door;

front_door! {
    /// Judges the contraction of one point.
    ///
    /// ```
    /// use nerf_oracle::contraction::judge;
    /// judge(|x| {
    ///     let r = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    ///     if r > 1.0 { x.map(|x| (2.0 - 1.0 / r) * (x / r)) } else { x }
    /// })
    /// .assert_pass();
    /// ```
    each CONTRACTION: judge as Point(x: [f64; 3]);
    /// With its gradient: (x, grad_contracted) -> grad_x.
    each_vjp(grad_contracted: [f64; 3]);
}

front_door! {
    /// Judges that of many points: `x` (M, 3) -> contracted (M, 3).
    whole CONTRACTION: judge_batch as Points(x: ArrayView2<f64>);
    /// With its gradient: (x, grad_contracted) -> grad_x.
    whole_vjp(grad_contracted: ArrayView2<f64>);
}
