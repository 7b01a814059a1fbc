//! Choices of how poses are written.

use serde::{Deserialize, Serialize};

/// What a quaternion's length means for the rotation that is made of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quaternion {
    /// Nothing: it is normalized first (COLMAP itself, scipy, gsplat).
    #[default]
    Normalized,
    /// It is taken for 1: 1 - 2 (y^2 + z^2), ..., a rotation for unit quaternions alone (COLMAP's `qvec2rotmat` in Python, and its copies in
    /// instant-ngp and nerfstudio).
    AsGiven,
}
