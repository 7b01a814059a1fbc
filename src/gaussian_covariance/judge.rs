//! Somebody's covariance of a Gaussian, judged.

use ndarray::{ArrayView2, ArrayView3};

use super::component::GAUSSIAN_COVARIANCE;
use crate::judge::door::front_door;

front_door! {
    /// Judges that of one Gaussian: (quaternion, scales) -> covariance, 3 x 3.
    ///
    /// ```
    /// use nerf_oracle::gaussian_covariance::{judge, rotation};
    /// judge(|q, s| {
    ///     let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    ///     let r = rotation(q.map(|x| x / length));
    ///     [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| r[i][k] * s[k] * s[k] * r[j][k]).sum::<f64>()))
    /// })
    /// .assert_pass();
    /// ```
    each GAUSSIAN_COVARIANCE: judge as Gaussian(quaternions: [f64; 4], scales: [f64; 3]);
    /// With its gradient: (quaternion, scales, grad_covariance) -> (grad_quaternion, grad_scales).
    each_vjp(grad_covariances: [[f64; 3]; 3]);
}

front_door! {
    /// Judges those of many: `quaternions` (M, 4), `scales` (M, 3) -> covariances (M, 3, 3).
    whole GAUSSIAN_COVARIANCE: judge_batch as Gaussians(quaternions: ArrayView2<f64>, scales: ArrayView2<f64>);
    /// With its gradient: (quaternions, scales, grad_covariances) -> (grad_quaternions, grad_scales).
    whole_vjp(grad_covariances: ArrayView3<f64>);
}
