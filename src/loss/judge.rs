//! Somebody's losses, judged.

use ndarray::{ArrayView3, ArrayView4};

use super::component::{MSE, PSNR, TO_UINT8};
use crate::judge::door::front_door;

front_door! {
    /// Judges the mean squared error: (prediction, target) -> value; arrays of any shape, as one row of numbers.
    ///
    /// ```
    /// use nerf_oracle::loss;
    /// loss::judge(|a, b| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64)
    ///     .vjp(|a, b, g| a.iter().zip(b).map(|(x, y)| g * 2.0 * (x - y) / a.len() as f64).collect::<Vec<_>>())
    ///     .in_f32()
    ///     .assert_pass();
    /// ```
    whole MSE: judge as Mse(prediction: &[f64], target: &[f64]);
    /// With its gradient: (prediction, target, grad_value) -> grad_prediction.
    whole_vjp(grad_value: f64);
}

front_door! {
    /// Judges the PSNR of several pictures: `prediction` and `target` (B, H, W, 3), peak -> value.
    ///
    /// ```
    /// use nerf_oracle::loss::judge;
    /// judge::psnr(|a, b, peak| {
    ///     let psnr = |n| {
    ///         let (a, b): (&_, &_) = (&a.index_axis(nerf_oracle::ndarray::Axis(0), n), &b.index_axis(nerf_oracle::ndarray::Axis(0), n));
    ///         let mse = (a - b).mapv(|x| x * x).mean().unwrap();
    ///         10.0 * (peak * peak / mse).log10()
    ///     };
    ///     (0..a.dim().0).map(psnr).sum::<f64>() / a.dim().0 as f64
    /// })
    /// .assert_pass();
    /// ```
    whole PSNR: psnr as Psnr(prediction: ArrayView4<f64>, target: ArrayView4<f64>, peak: f64);
}

front_door! {
    /// Judges the bytes of a picture: `image` (H, W, 3) -> bytes (H, W, 3).
    ///
    /// ```
    /// use nerf_oracle::loss::judge;
    /// judge::to_uint8(|image| image.mapv(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8)).assert_pass();
    /// ```
    whole TO_UINT8: to_uint8 as Picture(image: ArrayView3<f64>);
}
