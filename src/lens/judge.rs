//! Somebody's lens, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::{LENS_DISTORT, LENS_UNDISTORT};
use crate::judge::door::front_door;

front_door! {
    /// Judges the distortion of one point: (point, coefficients) -> point. There are 4, 5 or 8 coefficients, in OpenCV's order.
    ///
    /// ```
    /// use nerf_oracle::lens::judge;
    /// judge(|[x, y], k| {
    ///     let k = |n: usize| k.get(n).copied().unwrap_or(0.0);
    ///     let r2 = x * x + y * y;
    ///     let radial = (1.0 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1.0 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    ///     let twice = 2.0 * x * y;
    ///     [
    ///         x * radial + k(2) * twice + k(3) * (r2 + 2.0 * x * x),
    ///         y * radial + k(2) * (r2 + 2.0 * y * y) + k(3) * twice,
    ///     ]
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each LENS_DISTORT: judge as Point(points: [f64; 2], coefficients: &[f64]);
    /// With its gradient: (point, coefficients, grad_distorted) -> (grad_point, grad_coefficients).
    each_vjp(grad_distorted: [f64; 2]);
}

front_door! {
    /// Judges that of many points: `points` (M, 2), `coefficients` (C) -> distorted (M, 2).
    whole LENS_DISTORT: judge_batch as Points(points: ArrayView2<f64>, coefficients: ArrayView1<f64>);
    /// With its gradient: (points, coefficients, grad_distorted) -> (grad_points, grad_coefficients).
    whole_vjp(grad_distorted: ArrayView2<f64>);
}

front_door! {
    /// Judges the inverse for one point: (distorted, coefficients) -> point.
    ///
    /// ```
    /// use nerf_oracle::lens::{Distortion, judge};
    /// judge::undistort(|p, k| Distortion::from_opencv(k).undistort(p.into()).unwrap().to_array()).assert_pass();
    /// ```
    each LENS_UNDISTORT: undistort as Distorted(distorted: [f64; 2], coefficients: &[f64]);
    /// With its gradient: (distorted, coefficients, grad_point) -> (grad_distorted, grad_coefficients).
    each_vjp(grad_points: [f64; 2]);
}

front_door! {
    /// Judges that of many points: `distorted` (M, 2), `coefficients` (C) -> points (M, 2).
    whole LENS_UNDISTORT: undistort_batch as ManyDistorted(distorted: ArrayView2<f64>, coefficients: ArrayView1<f64>);
    /// With its gradient: (distorted, coefficients, grad_points) -> (grad_distorted, grad_coefficients).
    whole_vjp(grad_points: ArrayView2<f64>);
}
