//! Somebody's Gaussians of frustums, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::CONICAL_FRUSTUM;
use crate::judge::door::front_door;

front_door! {
    /// Judges that of one interval: (origin, direction, radius, start, end) -> (t_mean, t_variance, r_variance, mean, variance), or the
    /// first of these.
    ///
    /// ```
    /// use nerf_oracle::conical_frustum::judge;
    /// judge(|o, d, radius, start, end| {
    ///     let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    ///     let (mm, hh) = (middle * middle, half * half);
    ///     let sum = 3.0 * mm + hh;
    ///     let part = |x: f64| if half == 0.0 { 0.0 } else { x };
    ///     let t = middle + part(2.0 * middle * hh / sum);
    ///     let along = hh / 3.0 - 4.0 / 15.0 * part(hh * hh * (12.0 * mm - hh) / (sum * sum));
    ///     let across = radius * radius * (mm / 4.0 + 5.0 / 12.0 * hh - 4.0 / 15.0 * part(hh * hh / sum));
    ///     let length = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    ///     let variance = d.map(|d| along * d * d + across * (1.0 - d * d / length));
    ///     (t, along, across, [0, 1, 2].map(|i| o[i] + t * d[i]), variance)
    /// })
    /// .assert_pass();
    /// ```
    each CONICAL_FRUSTUM: judge as Interval(
        origins: [f64; 3],
        directions: [f64; 3],
        radii: f64,
        starts: f64,
        ends: f64,
    );
    /// With its gradient: the same and those of the five outputs -> (grad_origin, grad_direction, grad_radius, grad_start, grad_end).
    each_vjp(
        grad_t_mean: f64,
        grad_t_variance: f64,
        grad_r_variance: f64,
        grad_means: [f64; 3],
        grad_variances: [f64; 3],
    );
}

front_door! {
    /// Judges those of many: `origins` (M, 3), `directions` (M, 3), `radii` (M), `starts` (M), `ends` (M) -> `t_mean` (M),
    /// `t_variance` (M), `r_variance` (M), `means` (M, 3), `variances` (M, 3).
    whole CONICAL_FRUSTUM: judge_batch as Intervals(
        origins: ArrayView2<f64>,
        directions: ArrayView2<f64>,
        radii: ArrayView1<f64>,
        starts: ArrayView1<f64>,
        ends: ArrayView1<f64>,
    );
    /// With its gradient: the same and those of the five outputs -> (grad_origins, grad_directions, grad_radii, grad_starts, grad_ends).
    whole_vjp(
        grad_t_mean: ArrayView1<f64>,
        grad_t_variance: ArrayView1<f64>,
        grad_r_variance: ArrayView1<f64>,
        grad_means: ArrayView2<f64>,
        grad_variances: ArrayView2<f64>,
    );
}
