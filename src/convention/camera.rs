//! Choices of cameras and of the rays through their pixels.

use serde::{Deserialize, Serialize};

/// Where the camera looks, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// x right, y down, z forward (OpenCV, COLMAP, CS180).
    #[default]
    Opencv,
    /// x right, y up, z backward (OpenGL, Blender, the original NeRF).
    Opengl,
}

/// Where pixel (i, j) has its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PixelCenter {
    /// (i + 0.5, j + 0.5): the center, when the picture spans [0, W] x [0, H].
    Half,
    /// (i, j).
    Integer,
}

/// The length of a ray's direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// Length 1: t is the distance from the camera.
    Unit,
    /// Length 1 in the camera's frame, then rotated: the same for every rigid pose, but not its gradient.
    UnitInCamera,
    /// Depth 1 along the camera's axis: t is the depth.
    Depth,
}
