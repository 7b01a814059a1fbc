//! Somebody's samples along rays, judged.

use ndarray::ArrayView2;

use super::component::{SAMPLE_ALONG_RAYS, STEP_SIZES};
use crate::judge::door::front_door;

front_door! {
    /// Judges the samples of one ray: (origin, direction, near, far, u) -> (t, points), (N) and (N, 3).
    ///
    /// ```
    /// use nerf_oracle::sample;
    /// sample::judge(|o, d, near, far, u| {
    ///     let bin = (far - near) / u.len() as f64;
    ///     let t: Vec<f64> = u.iter().enumerate().map(|(i, u)| near + (i as f64 + u) * bin).collect();
    ///     let points: Vec<[f64; 3]> = t.iter().map(|t| [0, 1, 2].map(|a| o[a] + t * d[a])).collect();
    ///     (t, points)
    /// })
    /// .assert_pass();
    /// ```
    each SAMPLE_ALONG_RAYS: judge as Ray(rays_o: [f64; 3], rays_d: [f64; 3], near: f64, far: f64, u: &[f64]);
}

front_door! {
    /// Judges the samples of many rays: `rays_o` and `rays_d` (R, 3), `near`, `far`, `u` (R, N) -> t (R, N), points (R, N, 3).
    whole SAMPLE_ALONG_RAYS: judge_batch as Rays(
        rays_o: ArrayView2<f64>,
        rays_d: ArrayView2<f64>,
        near: f64,
        far: f64,
        u: ArrayView2<f64>,
    );
}

front_door! {
    /// Judges the step lengths of one ray: (t, near, far) -> deltas, (N) each.
    ///
    /// ```
    /// use nerf_oracle::sample::judge;
    /// judge::step_sizes(|t, near, far| vec![(far - near) / t.len() as f64; t.len()]).assert_pass();
    /// ```
    each STEP_SIZES: step_sizes as Steps(t: &[f64], near: f64, far: f64);
}

front_door! {
    /// Judges the step lengths of many rays: `t` (R, N), `near`, `far` -> deltas (R, N).
    whole STEP_SIZES: step_sizes_batch as StepsOfRays(t: ArrayView2<f64>, near: f64, far: f64);
}
