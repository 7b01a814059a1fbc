//! Somebody's loss scales, judged.

use super::component::{LOSS_SCALE_UPDATE, UNSCALE_GRADIENTS};
use crate::judge::door::front_door;

front_door! {
    /// Judges an update: (scale, growth_tracker, found_inf, growth_factor, backoff_factor, growth_interval) -> (scale_out,
    /// growth_tracker_out).
    ///
    /// ```
    /// use nerf_oracle::loss_scaling;
    /// loss_scaling::judge(|scale, tracker, found_inf, growth, backoff, interval| {
    ///     if found_inf == 1 {
    ///         (scale * backoff, 0)
    ///     } else if tracker + 1 == interval {
    ///         (scale * growth, 0)
    ///     } else {
    ///         (scale, tracker + 1)
    ///     }
    /// })
    /// .assert_pass();
    /// ```
    whole LOSS_SCALE_UPDATE: judge as Update(
        scale: f64,
        growth_tracker: usize,
        found_inf: usize,
        growth_factor: f64,
        backoff_factor: f64,
        growth_interval: usize,
    );
}

front_door! {
    /// Judges unscaled gradients: (gradients, scale) -> (found_inf, unscaled). What stands in them where an overflow was found is open.
    ///
    /// ```
    /// use nerf_oracle::loss_scaling::judge;
    /// judge::unscale(|gradients, scale| {
    ///     let overflow = gradients.iter().any(|g| !g.is_finite());
    ///     (usize::from(overflow), gradients.iter().map(|g| g / scale).collect::<Vec<_>>())
    /// })
    /// .assert_pass();
    /// ```
    whole UNSCALE_GRADIENTS: unscale as Scaled(gradients: &[f64], scale: f64);
}
