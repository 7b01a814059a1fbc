//! Somebody's fisheye, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::{FISHEYE_DISTORT, FISHEYE_UNDISTORT};
use crate::judge::door::front_door;

front_door! {
    /// Judges where one point lands: (point, k1 to k4) -> point.
    ///
    /// ```
    /// use nerf_oracle::fisheye::judge;
    /// judge(|[x, y], k| {
    ///     let r = x.hypot(y);
    ///     let theta = r.atan();
    ///     let t2 = theta * theta;
    ///     let theta_d = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
    ///     let scale = if r > 0.0 { theta_d / r } else { 1.0 };
    ///     [scale * x, scale * y]
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each FISHEYE_DISTORT: judge as Point(points: [f64; 2], coefficients: [f64; 4]);
    /// With its gradient: (point, coefficients, grad_distorted) -> (grad_point, grad_coefficients).
    each_vjp(grad_distorted: [f64; 2]);
}

front_door! {
    /// Judges that of many points: `points` (M, 2), `coefficients` (4) -> distorted (M, 2).
    whole FISHEYE_DISTORT: judge_batch as Points(points: ArrayView2<f64>, coefficients: ArrayView1<f64>);
    /// With its gradient: (points, coefficients, grad_distorted) -> (grad_points, grad_coefficients).
    whole_vjp(grad_distorted: ArrayView2<f64>);
}

front_door! {
    /// Judges the inverse for one point: (distorted, coefficients) -> point.
    ///
    /// ```
    /// use nerf_oracle::fisheye::{judge, undistort};
    /// judge::undistort(|p, k| undistort(k, p.into()).unwrap().to_array()).assert_pass();
    /// ```
    each FISHEYE_UNDISTORT: undistort as Distorted(distorted: [f64; 2], coefficients: [f64; 4]);
    /// With its gradient: (distorted, coefficients, grad_point) -> (grad_distorted, grad_coefficients).
    each_vjp(grad_points: [f64; 2]);
}

front_door! {
    /// Judges that of many points: `distorted` (M, 2), `coefficients` (4) -> points (M, 2).
    whole FISHEYE_UNDISTORT: undistort_batch as ManyDistorted(distorted: ArrayView2<f64>, coefficients: ArrayView1<f64>);
    /// With its gradient: (distorted, coefficients, grad_points) -> (grad_distorted, grad_coefficients).
    whole_vjp(grad_points: ArrayView2<f64>);
}
