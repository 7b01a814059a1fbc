//! Somebody's robust losses, judged.

use super::component::{CHARBONNIER, HUBER};
use crate::judge::door::front_door;

front_door! {
    /// Judges Huber's loss: (prediction, target, delta) -> value; arrays of any shape, as one row of numbers.
    ///
    /// ```
    /// use nerf_oracle::robust_loss;
    /// let piece = |d: f64, delta: f64| if d.abs() <= delta { d * d / 2.0 } else { delta * (d.abs() - delta / 2.0) };
    /// robust_loss::judge(|p, t, delta| {
    ///     p.iter().zip(t).map(|(p, t)| piece(p - t, delta)).sum::<f64>() / p.len() as f64
    /// })
    /// .assert_pass();
    /// ```
    whole HUBER: judge as Huber(prediction: &[f64], target: &[f64], delta: f64);
    /// With its gradient: (prediction, target, delta, grad_value) -> grad_prediction.
    whole_vjp(grad_value: f64);
}

front_door! {
    /// Judges Charbonnier's loss: (prediction, target, eps) -> value; arrays of any shape, as one row of numbers.
    ///
    /// ```
    /// use nerf_oracle::robust_loss::judge;
    /// judge::charbonnier(|p, t, eps| {
    ///     p.iter().zip(t).map(|(p, t)| (p - t).hypot(eps)).sum::<f64>() / p.len() as f64
    /// })
    /// .assert_pass();
    /// ```
    whole CHARBONNIER: charbonnier as Charbonnier(prediction: &[f64], target: &[f64], eps: f64);
    /// With its gradient: (prediction, target, eps, grad_value) -> grad_prediction.
    whole_vjp(grad_value: f64);
}
