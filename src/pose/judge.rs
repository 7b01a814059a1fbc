//! Somebody's poses, judged.

use ndarray::ArrayView2;

use super::component::POSE_FROM_COLMAP;
use crate::judge::door::front_door;

front_door! {
    /// Judges the pose of one picture of COLMAP's: (q, t) -> c2w, row by row.
    ///
    /// ```
    /// use glam::{DMat4, DQuat, DVec3};
    /// use nerf_oracle::pose::judge;
    /// judge(|[w, x, y, z], t| {
    ///     let q = DQuat::from_xyzw(x, y, z, w).normalize();
    ///     let c2w = DMat4::from_rotation_translation(q, t.into()).inverse();
    ///     c2w.transpose().to_cols_array_2d()
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each POSE_FROM_COLMAP: judge as Picture(q: [f64; 4], t: [f64; 3]);
    /// With its gradient: (q, t, grad_c2w) -> (grad_q, grad_t).
    each_vjp(grad_c2w: [[f64; 4]; 4]);
}

front_door! {
    /// Judges those of many pictures: `q` (M, 4), `t` (M, 3) -> c2w (M, 4, 4).
    whole POSE_FROM_COLMAP: judge_batch as Pictures(q: ArrayView2<f64>, t: ArrayView2<f64>);
    /// With its gradient: (q, t, grad_c2w) -> (grad_q, grad_t).
    whole_vjp(grad_c2w: ndarray::ArrayView3<f64>);
}
