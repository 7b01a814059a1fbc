//! Registry rows of the camera.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};

/// The pose of each point or ray.
pub(crate) const C2W: Port =
    Port { name: "c2w", shape: "M,4,4", meaning: "camera to world; the upper 3x4 is used", gradient: true };

/// Intrinsic parameters.
pub(crate) const K: Port =
    Port { name: "K", shape: "3,3", meaning: "intrinsics in pixels: fx, fy, cx, cy alone", gradient: true };

/// Pixel positions.
pub(crate) const UV: Port =
    Port { name: "uv", shape: "M,2", meaning: "pixel positions, u right, v down", gradient: true };

/// Camera space to world space.
pub const TRANSFORM: Component = Component {
    name: "transform",
    folder: "camera",
    formula: "x_w = R x_c + o, with R and o the upper 3x4 of c2w",
    source: "homogeneous coordinates; Hartley and Zisserman 2004, section 6.1",
    inputs: &[C2W, Port { name: "x_c", shape: "M,3", meaning: "points in camera space", gradient: true }],
    outputs: &[Port { name: "x_w", shape: "M,3", meaning: "points in world space", gradient: true }],
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
};

/// Pixel and depth to camera space.
pub const PIXEL_TO_CAMERA: Component = Component {
    name: "pixel_to_camera",
    folder: "camera",
    formula: "x_c = s K^-1 (u, v, 1) = s ((u - cx) / fx, (v - cy) / fy, 1)",
    source: "pinhole camera; Hartley and Zisserman 2004, section 6.1",
    inputs: &[
        K,
        UV,
        Port { name: "s", shape: "M", meaning: "depths along the camera's axis", gradient: true },
    ],
    outputs: &[Port { name: "x_c", shape: "M,3", meaning: "points in camera space", gradient: true }],
    conventions: &[],
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
};
