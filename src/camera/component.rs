//! Registry rows of the camera.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// The pose of each point or ray.
pub(crate) const C2W: Port = Port::smooth("c2w", "M,4,4", "camera to world; the upper 3x4 is used");

/// Intrinsic parameters.
pub(crate) const K: Port = Port::smooth("K", "3,3", "intrinsics in pixels: fx, fy, cx, cy alone");

/// Pixel positions.
pub(crate) const UV: Port = Port::smooth("uv", "M,2", "pixel positions, u right, v down");

/// Camera space to world space.
pub(crate) const TRANSFORM: Component = Component {
    name: "transform",
    folder: "camera",
    code: include_str!("honest.rs"),
    formula: "x_w = R x_c + o, with R and o the upper 3x4 of c2w",
    source: "homogeneous coordinates; Hartley and Zisserman 2004, section 6.1",
    inputs: &[C2W, Port::smooth("x_c", "M,3", "points in camera space")],
    outputs: &[Port::smooth("x_w", "M,3", "points in world space")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::transform,
        bound: bound::transform,
        honest: honest::transform,
        wrong: mistakes::transform,
    },
    vjp: Some(Direction {
        oracle: arrays::transform_vjp,
        bound: bound::transform_vjp,
        honest: honest::transform_vjp,
        wrong: mistakes::transform_vjp,
    }),
    cases: cases::transform,
    mistakes: mistakes::TRANSFORM,
    special: Special { large: cases::large_transform, ..Special::NONE },
};

/// Pixel and depth to camera space.
pub(crate) const PIXEL_TO_CAMERA: Component = Component {
    name: "pixel_to_camera",
    folder: "camera",
    code: include_str!("honest.rs"),
    formula: "x_c = s K^-1 (u, v, 1) = s ((u - cx) / fx, (v - cy) / fy, 1)",
    source: "pinhole camera; Hartley and Zisserman 2004, section 6.1",
    inputs: &[K, UV, Port::smooth("s", "M", "depths along the camera's axis")],
    outputs: &[Port::smooth("x_c", "M,3", "points in camera space")],
    conventions: &["camera_axes"],
    forward: Direction {
        oracle: arrays::pixel_to_camera,
        bound: bound::pixel_to_camera,
        honest: honest::pixel_to_camera,
        wrong: mistakes::pixel_to_camera,
    },
    vjp: Some(Direction {
        oracle: arrays::pixel_to_camera_vjp,
        bound: bound::pixel_to_camera_vjp,
        honest: honest::pixel_to_camera_vjp,
        wrong: mistakes::pixel_to_camera_vjp,
    }),
    cases: cases::pixel_to_camera,
    mistakes: mistakes::PIXEL_TO_CAMERA,
    special: Special { large: cases::large_pixel_to_camera, ..Special::NONE },
};
