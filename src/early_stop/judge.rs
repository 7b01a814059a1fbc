//! Somebody's rendering with early stop, judged. Rays are packed: ray r has the samples `offsets[r]..offsets[r + 1]`.

use super::component::EARLY_STOP;
use crate::judge::door::front_door;

front_door! {
    /// Judges packed rays: (sigmas, rgbs, deltas, offsets, eps) -> (live, colors, weights, opacity, transmittance), or the first of
    /// these: R, (R, 3), S, R, R of them.
    ///
    /// ```
    /// use nerf_oracle::early_stop::{judge, live_samples};
    /// judge(|sigmas, _, deltas, offsets, eps| -> Vec<usize> {
    ///     let ray = |pair: &[usize]| live_samples(&sigmas[pair[0]..pair[1]], &deltas[pair[0]..pair[1]], eps);
    ///     offsets.windows(2).map(ray).collect()
    /// })
    /// .assert_pass();
    /// ```
    whole EARLY_STOP: judge as Rays(
        sigmas: &[f64],
        rgbs: &[[f64; 3]],
        deltas: &[f64],
        offsets: Vec<usize>,
        eps: f64,
    );
    /// With its gradient: the same and (grad_colors, grad_weights, grad_opacity, grad_transmittance)
    /// -> (grad_sigmas, grad_rgbs, grad_deltas).
    whole_vjp(
        grad_colors: &[[f64; 3]],
        grad_weights: &[f64],
        grad_opacity: &[f64],
        grad_transmittance: &[f64],
    );
}
