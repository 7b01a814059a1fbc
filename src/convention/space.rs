//! Choices of how unbounded scenes are laid into bounded ones, and of how much of space a ray is.

use serde::{Deserialize, Serialize};

/// The norm of a contraction, and so the shape that space is contracted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContractionNorm {
    /// The length: a ball (mip-NeRF 360, multinerf, nerfacc).
    #[default]
    L2,
    /// The largest coordinate, which scales all of them: a cube (nerfstudio's nerfacto).
    Linf,
    /// The largest coordinate by its own size, the others divided by it: a cube, and straight lines beyond stay straight (MERF, torch-ngp).
    Merf,
}

/// What a contraction's result is scaled to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContractionRange {
    /// [-2, 2], as the formula has it (mip-NeRF 360, multinerf).
    #[default]
    Two,
    /// [-1, 1]: y / 2 (K-Planes).
    One,
    /// [0, 1]: y / 4 + 1/2 (nerfacc, nerfstudio's nerfacto).
    Unit,
}

/// What a ray with a width is taken for, between two distances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RayShape {
    /// A cone from the camera: the radius grows with t (mip-NeRF, multinerf, nerfstudio).
    #[default]
    Cone,
    /// A cylinder: the radius is the same everywhere (mip-NeRF with `ray_shape = 'cylinder'`, for normalized device coordinates).
    Cylinder,
}

/// Where a scene lies that rays in normalized device coordinates look at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NdcDepth {
    /// At z < 0, as OpenGL's cameras look (bmild/nerf, jaxnerf, multinerf, nerf_pl).
    #[default]
    Negative,
    /// At z > 0, as OpenCV's do (TensoRF's `ndc_rays`).
    Positive,
}
