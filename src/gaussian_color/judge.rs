//! Somebody's colors of splats, judged.

use ndarray::{ArrayView1, ArrayView2, ArrayView3};

use super::component::GAUSSIAN_COLOR;
use crate::judge::door::front_door;

front_door! {
    /// Judges that of one splat: (mean, camera center, coefficients) -> color. There are 1, 4, 9 or 16 coefficients.
    ///
    /// ```
    /// use nerf_oracle::convention::{HarmonicSign::Alternating, SplatColor::Clamped};
    /// use nerf_oracle::gaussian_color::{Form, backward, color, judge};
    /// let form = Form { sign: Alternating, color: Clamped };
    /// judge(|mean, center, f| color(mean, center, f, form))
    ///     .vjp(|mean, center, f, g| backward::color(mean, center, f, form, g))
    ///     .assert_pass();
    /// ```
    each GAUSSIAN_COLOR: judge as Splat(means: [f64; 3], camera_center: [f64; 3], coefficients: &[[f64; 3]]);
    /// With its gradient: (mean, camera center, coefficients, grad_color) -> (grad_mean, grad_coefficients).
    each_vjp(grad_colors: [f64; 3]);
}

front_door! {
    /// Judges those of many: `means` (M, 3), `camera_center` (3), `coefficients` (M, B, 3) -> colors (M, 3).
    whole GAUSSIAN_COLOR: judge_batch as Splats(
        means: ArrayView2<f64>,
        camera_center: ArrayView1<f64>,
        coefficients: ArrayView3<f64>,
    );
    /// With its gradient: the same and grad_colors -> (grad_means, grad_coefficients).
    whole_vjp(grad_colors: ArrayView2<f64>);
}
