//! Somebody's clipped gradients, judged.

use ndarray::{ArrayView2, ArrayViewD};

use super::component::{CLIP_BY_GLOBAL_NORM, CLIP_BY_VALUE};
use crate::judge::door::front_door;

front_door! {
    /// Judges a clip by the common norm: `g_weights` (N, M), `g_bias` (N), `max_norm` -> both clipped, and their norm.
    ///
    /// ```
    /// use nerf_oracle::gradient_clipping;
    /// gradient_clipping::judge(|weights, bias, max_norm| {
    ///     let squares: f64 = weights.iter().chain(bias).map(|g| g * g).sum();
    ///     let norm = squares.sqrt();
    ///     // torch's; the judge finds by itself what is added to the norm.
    ///     let scale = (max_norm / (norm + 1e-6)).min(1.0);
    ///     (weights.mapv(|g| g * scale), bias.iter().map(|g| g * scale).collect::<Vec<_>>(), norm)
    /// })
    /// .assert_pass();
    /// ```
    whole CLIP_BY_GLOBAL_NORM: judge as Layer(g_weights: ArrayView2<f64>, g_bias: &[f64], max_norm: f64);
}

front_door! {
    /// Judges a clip by value: (g, limit) -> g_out; arrays of any shape.
    ///
    /// ```
    /// use nerf_oracle::gradient_clipping::judge;
    /// use nerf_oracle::ndarray::ArrayViewD;
    /// judge::clip_by_value(|g: ArrayViewD<f64>, limit| g.mapv(|g| g.clamp(-limit, limit))).assert_pass();
    /// ```
    whole CLIP_BY_VALUE: clip_by_value as Numbers(g: ArrayViewD<f64>, limit: f64);
}
