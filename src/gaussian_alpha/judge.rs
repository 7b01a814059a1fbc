//! Somebody's opacities of splats, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::GAUSSIAN_ALPHA;
use crate::judge::door::front_door;

front_door! {
    /// Judges those at one pixel: (pixel, means, conics, opacities) -> alphas, one a splat.
    ///
    /// ```
    /// use nerf_oracle::gaussian_alpha::judge;
    /// judge(|pixel, means, conics, opacities| {
    ///     let one = |n: usize| {
    ///         let ([x, y], [a, b, c]) = ([0, 1].map(|k| means[n][k] - pixel[k]), conics[n]);
    ///         opacities[n] * f64::exp(-0.5 * (a * x * x + c * y * y) - b * x * y)
    ///     };
    ///     (0..means.len()).map(one).collect::<Vec<f64>>()
    /// })
    /// .assert_pass();
    /// ```
    each GAUSSIAN_ALPHA: judge as Pixel(
        pixels: [f64; 2],
        means2d: &[[f64; 2]],
        conics: &[[f64; 3]],
        opacities: &[f64],
    );
    /// With its gradient: the same and one cotangent a splat -> (grad_means, grad_conics, grad_opacities), which add up over pixels.
    each_vjp(grad_alphas: &[f64]);
}

front_door! {
    /// Judges those at many pixels: `pixels` (P, 2), `means2d` (G, 2), `conics` (G, 3), `opacities` (G) -> alphas (P, G).
    whole GAUSSIAN_ALPHA: judge_batch as Pixels(
        pixels: ArrayView2<f64>,
        means2d: ArrayView2<f64>,
        conics: ArrayView2<f64>,
        opacities: ArrayView1<f64>,
    );
    /// With its gradient: the same and grad_alphas -> (grad_means2d, grad_conics, grad_opacities).
    whole_vjp(grad_alphas: ArrayView2<f64>);
}
