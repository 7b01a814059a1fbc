//! Somebody's contraction of Gaussians, judged.

use ndarray::{ArrayView2, ArrayView3};

use super::component::CONTRACT_GAUSSIANS;
use crate::judge::door::front_door;

front_door! {
    /// Judges that of one Gaussian: (mean, covariance) -> (contracted mean, contracted covariance).
    ///
    /// ```
    /// use nerf_oracle::gaussian_contraction::judge;
    /// judge(|x, sigma| {
    ///     let r = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    ///     if r <= 1.0 {
    ///         return (x, sigma);
    ///     }
    ///     let (u, s) = (x.map(|x| x / r), (2.0 - 1.0 / r) / r);
    ///     // s t, and what is along the ray by 1 / r^2 in its place.
    ///     let tangent = |t: [f64; 3]| {
    ///         let along = (1.0 / (r * r) - s) * (u[0] * t[0] + u[1] * t[1] + u[2] * t[2]);
    ///         [0, 1, 2].map(|i| s * t[i] + along * u[i])
    ///     };
    ///     let transposed = |m: [[f64; 3]; 3]| [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[j][i]));
    ///     let half = transposed(sigma).map(tangent);
    ///     (x.map(|x| s * x), transposed(half).map(tangent))
    /// })
    /// .assert_pass();
    /// ```
    each CONTRACT_GAUSSIANS: judge as Gaussian(means: [f64; 3], covariances: [[f64; 3]; 3]);
    /// With its gradient: (mean, covariance, grad_contracted_mean, grad_contracted_covariance) -> (grad_mean, grad_covariance).
    each_vjp(grad_contracted_means: [f64; 3], grad_contracted_covariances: [[f64; 3]; 3]);
}

front_door! {
    /// Judges those of many: `means` (M, 3), `covariances` (M, 3, 3) -> contracted means (M, 3) and covariances (M, 3, 3).
    whole CONTRACT_GAUSSIANS: judge_batch as Gaussians(means: ArrayView2<f64>, covariances: ArrayView3<f64>);
    /// With its gradient: the same and those of both outputs -> (grad_means, grad_covariances).
    whole_vjp(grad_contracted_means: ArrayView2<f64>, grad_contracted_covariances: ArrayView3<f64>);
}
