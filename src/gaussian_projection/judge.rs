//! Somebody's projection of Gaussians, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::GAUSSIAN_PROJECTION;
use crate::judge::door::front_door;

front_door! {
    /// Judges that of one Gaussian: (mean, covariance, w2c, K, width, height) -> (mean in the picture, covariance there, conic, depth,
    /// radius, compensation), or the first of these.
    ///
    /// ```
    /// use nerf_oracle::camera::Intrinsics;
    /// use nerf_oracle::gaussian_projection::{Form, View, judge, project};
    /// judge(|mean, sigma, w2c, k, width, height| {
    ///     let view = View {
    ///         rotation: [0, 1, 2].map(|i| [w2c[i][0], w2c[i][1], w2c[i][2]]),
    ///         translation: [0, 1, 2].map(|i| w2c[i][3]),
    ///         k: Intrinsics { fx: k[0][0], fy: k[1][1], cx: k[0][2], cy: k[1][2] },
    ///         width,
    ///         height,
    ///     };
    ///     let splat = project(mean, sigma, &view, Form::default());
    ///     (splat.mean, splat.covariance, splat.conic, splat.depth, splat.radius, splat.compensation)
    /// })
    /// .assert_pass();
    /// ```
    each GAUSSIAN_PROJECTION: judge as Gaussian(
        means: [f64; 3],
        covariances: [f64; 6],
        w2c: [[f64; 4]; 4],
        K: [[f64; 3]; 3],
        width: f64,
        height: f64,
    );
    /// With its gradient: the same and a cotangent for each output but the radius -> (grad_mean, grad_covariance).
    each_vjp(
        grad_means2d: [f64; 2],
        grad_covariances2d: [f64; 3],
        grad_conics: [f64; 3],
        grad_depths: f64,
        grad_compensations: f64,
    );
}

front_door! {
    /// Judges those of many: `means` (M, 3), `covariances` (M, 6), `w2c` (4, 4), `K` (3, 3), width, height -> (means2d, covariances2d,
    /// conics, depths, radii, compensations).
    whole GAUSSIAN_PROJECTION: judge_batch as Gaussians(
        means: ArrayView2<f64>,
        covariances: ArrayView2<f64>,
        w2c: ArrayView2<f64>,
        K: ArrayView2<f64>,
        width: f64,
        height: f64,
    );
    /// With its gradient: the same and a cotangent for each output but the radii -> (grad_means, grad_covariances).
    whole_vjp(
        grad_means2d: ArrayView2<f64>,
        grad_covariances2d: ArrayView2<f64>,
        grad_conics: ArrayView2<f64>,
        grad_depths: ArrayView1<f64>,
        grad_compensations: ArrayView1<f64>,
    );
}
