//! Registry row of COLMAP's poses.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Quaternion and translation to camera to world.
pub(crate) const POSE_FROM_COLMAP: Component = Component {
    name: "pose_from_colmap",
    folder: "pose",
    code: include_str!("honest.rs"),
    formula: "c2w = [R^T, -R^T t; 0, 0, 0, 1] with R = R(q), q = (w, x, y, z) and x_c = R x_w + t; columns 2 and 3 negative for OpenGL's axes",
    source: "COLMAP documentation, Output Format (images.txt); Shepperd 1978 for R(q)",
    inputs: &[
        Port::smooth("q", "M,4", "unit quaternions of the way from the world to the camera: w, x, y, z"),
        Port::smooth("t", "M,3", "translations of the same way"),
    ],
    outputs: &[Port::smooth("c2w", "M,4,4", "camera to world, last row 0, 0, 0, 1")],
    conventions: &["axes", "quaternion"],
    forward: Direction {
        oracle: arrays::pose_from_colmap,
        bound: bound::pose_from_colmap,
        honest: honest::pose_from_colmap,
        wrong: mistakes::pose_from_colmap,
    },
    vjp: Some(Direction {
        oracle: arrays::pose_from_colmap_vjp,
        bound: bound::pose_from_colmap_vjp,
        honest: honest::pose_from_colmap_vjp,
        wrong: mistakes::pose_from_colmap_vjp,
    }),
    cases: cases::pose_from_colmap,
    mistakes: mistakes::POSE_FROM_COLMAP,
    special: Special { large: cases::large, ..Special::NONE },
};
