//! Somebody's volume rendering, judged.

use ndarray::{ArrayD, ArrayView1, ArrayView2, ArrayView3};

use super::Rendering;
use super::component::{COMPOSITE_BACKGROUND, DEPTH, VOLUME_RENDER, VOLUME_RENDER_ALPHA};
use crate::judge::door::front_door;
use crate::judge::typed::{Output, Outputs};

/// Color, weights, opacity, and the transmittance behind the last sample.
impl Outputs for Rendering {
    fn into_arrays(self) -> Vec<Option<ArrayD<f64>>> {
        let last = self.transmittance.last().copied();
        vec![self.color.into_array(), self.weights.into_array(), self.opacity.into_array(), last.into_array()]
    }
}

front_door! {
    /// Judges the rendering of one ray: (sigmas, rgbs, deltas) -> (color, weights, opacity, transmittance), or the first of these.
    ///
    /// ```
    /// use nerf_oracle::volume_rendering;
    /// volume_rendering::judge(|sigmas, rgbs, deltas| {
    ///     let (mut color, mut through) = ([0.0; 3], 1.0);
    ///     for i in 0..sigmas.len() {
    ///         let alpha = -(-sigmas[i] * deltas[i]).exp_m1();
    ///         (0..3).for_each(|a| color[a] += through * alpha * rgbs[i][a]);
    ///         through *= (-sigmas[i] * deltas[i]).exp();
    ///     }
    ///     color
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each VOLUME_RENDER: judge as Ray(sigmas: &[f64], rgbs: &[[f64; 3]], deltas: &[f64]);
    /// With its gradient: (sigmas, rgbs, deltas, grad_color, grad_weights, grad_opacity, grad_transmittance)
    /// -> (grad_sigmas, grad_rgbs, grad_deltas).
    each_vjp(grad_colors: [f64; 3], grad_weights: &[f64], grad_opacity: f64, grad_transmittance: f64);
}

front_door! {
    /// Judges the rendering of many rays: `sigmas` and `deltas` (R, N), `rgbs` (R, N, 3) -> (colors (R, 3), weights (R, N), opacity (R),
    /// transmittance (R)), or the first of these.
    whole VOLUME_RENDER: judge_batch as Rays(
        sigmas: ArrayView2<f64>,
        rgbs: ArrayView3<f64>,
        deltas: ArrayView2<f64>,
    );
    /// With its gradient: the same and (grad_colors, grad_weights, grad_opacity, grad_transmittance)
    /// -> (grad_sigmas, grad_rgbs, grad_deltas).
    whole_vjp(
        grad_colors: ArrayView2<f64>,
        grad_weights: ArrayView2<f64>,
        grad_opacity: ArrayView1<f64>,
        grad_transmittance: ArrayView1<f64>,
    );
}

front_door! {
    /// Judges the rendering of one ray from opacities: (alphas, rgbs) -> (color, weights, opacity, transmittance), or the first of
    /// these.
    ///
    /// ```
    /// use nerf_oracle::volume_rendering::judge;
    /// judge::volume_render_alpha(|alphas, rgbs| {
    ///     let (mut color, mut through) = ([0.0; 3], 1.0);
    ///     for (alpha, rgb) in alphas.iter().zip(rgbs) {
    ///         (0..3).for_each(|a| color[a] += through * alpha * rgb[a]);
    ///         through *= 1.0 - alpha;
    ///     }
    ///     color
    /// })
    /// .assert_pass();
    /// ```
    each VOLUME_RENDER_ALPHA: volume_render_alpha as RayOfAlphas(alphas: &[f64], rgbs: &[[f64; 3]]);
    /// With its gradient: (alphas, rgbs, grad_color, grad_weights, grad_opacity, grad_transmittance) -> (grad_alphas, grad_rgbs).
    each_vjp(grad_colors: [f64; 3], grad_weights: &[f64], grad_opacity: f64, grad_transmittance: f64);
}

front_door! {
    /// Judges the rendering of many rays from opacities: `alphas` (R, N), `rgbs` (R, N, 3) -> as [`judge_batch`].
    whole VOLUME_RENDER_ALPHA: volume_render_alpha_batch as RaysOfAlphas(
        alphas: ArrayView2<f64>,
        rgbs: ArrayView3<f64>,
    );
    /// With its gradient: the same and the four cotangents -> (grad_alphas, grad_rgbs).
    whole_vjp(
        grad_colors: ArrayView2<f64>,
        grad_weights: ArrayView2<f64>,
        grad_opacity: ArrayView1<f64>,
        grad_transmittance: ArrayView1<f64>,
    );
}

front_door! {
    /// Judges C' = C + (1 - A) b of one ray: (color, opacity, background) -> color.
    ///
    /// ```
    /// use nerf_oracle::volume_rendering::judge;
    /// judge::composite_background(|color, opacity, b| [0, 1, 2].map(|a| color[a] + (1.0 - opacity) * b[a])).assert_pass();
    /// ```
    each COMPOSITE_BACKGROUND: composite_background as Composite(
        colors: [f64; 3],
        opacity: f64,
        background: [f64; 3],
    );
    /// With its gradient: (color, opacity, background, grad_color_out) -> (grad_color, grad_opacity, this ray's part of
    /// grad_background).
    each_vjp(grad_colors_out: [f64; 3]);
}

front_door! {
    /// Judges C' of many rays: `colors` (R, 3), `opacity` (R), `background` (3) -> (R, 3).
    whole COMPOSITE_BACKGROUND: composite_background_batch as Composites(
        colors: ArrayView2<f64>,
        opacity: ArrayView1<f64>,
        background: [f64; 3],
    );
    /// With its gradient: the same and grad_colors_out -> (grad_colors, grad_opacity, grad_background).
    whole_vjp(grad_colors_out: ArrayView2<f64>);
}

front_door! {
    /// Judges the expected distance along one ray: (weights, t, far) -> depth.
    ///
    /// ```
    /// use nerf_oracle::volume_rendering::judge;
    /// judge::depth(|w, t, far| {
    ///     let opacity: f64 = w.iter().sum();
    ///     if opacity > 0.0 { w.iter().zip(t).map(|(w, t)| w * t).sum::<f64>() / opacity } else { far }
    /// })
    /// .assert_pass();
    /// ```
    each DEPTH: depth as Depth(weights: &[f64], t: &[f64], far: f64);
    /// With its gradient: (weights, t, far, grad_depth) -> (grad_weights, grad_t).
    each_vjp(grad_depth: f64);
}

front_door! {
    /// Judges the expected distance along many rays: `weights` and `t` (R, N), `far` -> (R).
    whole DEPTH: depth_batch as Depths(weights: ArrayView2<f64>, t: ArrayView2<f64>, far: f64);
    /// With its gradient: the same and grad_depth -> (grad_weights, grad_t).
    whole_vjp(grad_depth: ArrayView1<f64>);
}
