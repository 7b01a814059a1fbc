//! Choices of the components that save work: densities, occupancy grid, hash grid, spherical harmonics.

use serde::{Deserialize, Serialize};

/// Whether the exponent of an exponential density is held to [-15, 15] in the forward pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Exponent {
    /// sigma = e^x; the gradient alone is held.
    #[default]
    Free,
    /// sigma = e^clamp(x, -15, 15): forward too.
    Clamped,
}

/// Where the gradient of an exponential density stops to follow the exponential, whatever the forward pass does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExponentGradient {
    /// g e^clamp(x, -15, 15) (instant-ngp, torch-ngp, nerfstudio).
    #[default]
    BothEnds,
    /// g e^min(x, 15) (nerfacc's examples).
    Above,
    /// g e^min(x, 11): e^11 is about the largest that half precision holds (codes made from nerfacc's).
    Above11,
}

/// What is taken off the exponent of an exponential density.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExponentShift {
    /// Nothing: e^x.
    #[default]
    None,
    /// 1: e^(x - 1) (nerfacc's examples), so that a fresh network's density is lower.
    One,
}

/// Which cells of an occupancy grid fade at an update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridDecay {
    /// Those in which a density was found (nerfacc).
    #[default]
    Touched,
    /// Every cell that a camera sees (instant-ngp).
    EveryCell,
}

/// The density above which a cell of an occupancy grid is occupied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridThreshold {
    /// The smaller of the limit and the mean of the densities above 0; where no cell is denser, every cell that is seen is occupied.
    #[default]
    MeanOfDense,
    /// The smaller of the limit and the mean over all cells that are seen (nerfacc).
    MeanOfSeen,
    /// The smaller of the limit and the mean over all cells, those that no camera sees counted as 0 (instant-ngp, torch-ngp).
    MeanOverAll,
    /// The limit.
    LimitAlone,
}

/// What becomes of the cells whose density is below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridUnseen {
    /// No camera sees them: they stay as they are.
    #[default]
    Kept,
    /// The grid knows no such mark: they fade and rise as others do.
    Ordinary,
}

/// How a level of a hash grid lies on the box. With n = base growth^l, a point x is at x N of N cells along an axis, unless said otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HashLevels {
    /// N is n, rounded to nearest.
    #[default]
    Nearest,
    /// N = floor(n), as in the paper's equation 2 (nerfstudio, HashNeRF-pytorch).
    Floor,
    /// x (n - 1) + 1/2, not rounded; dense levels count ceil(n - 1) + 1 vertices along an edge (tiny-cuda-nn).
    TinyCudaNn,
    /// The same, but dense levels count one vertex more (torch-ngp).
    TorchNgp,
    /// x (n - 1), and vertices as in tiny-cuda-nn (torch-ngp's `align_corners`).
    AlignCorners,
}

/// Which levels of a hash grid have an entry for each vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HashIndex {
    /// Those whose vertices fit into the table.
    #[default]
    DenseWhereItFits,
    /// None: coarse levels are hashed too (nerfstudio, HashNeRF-pytorch).
    Hashed,
}

/// The factors of the hash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HashPrimes {
    /// 1, 2654435761, 805459861: the paper's, tiny-cuda-nn's `CoherentPrime`.
    #[default]
    Coherent,
    /// 1958374283, 2654435761, 805459861: tiny-cuda-nn's `Prime`.
    Prime,
    /// 2165219737, 1434869437, 2097192037: tiny-cuda-nn's `ReversedPrime`.
    Reversed,
}

/// What the fraction f of a point inside its cell becomes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HashWeights {
    /// f: trilinear interpolation.
    #[default]
    Linear,
    /// 3 f^2 - 2 f^3 (an option of tiny-cuda-nn, torch-ngp and nerfstudio).
    Smoothstep,
}

/// The sign of the harmonics of odd m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HarmonicSign {
    /// (-1)^m, of Condon and Shortley (tiny-cuda-nn, PlenOctrees, 3DGS).
    #[default]
    Alternating,
    /// None (nerfstudio's torch code).
    Plain,
}

/// Which polynomials are the harmonics: they agree where |d| = 1, and have other gradients there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HarmonicForm {
    /// With 1 for x^2 + y^2 + z^2: 3 z^2 - 1 (tiny-cuda-nn, nerfstudio).
    #[default]
    Sphere,
    /// In bands 2 and 3 homogeneous: 2 z^2 - x^2 - y^2 (PlenOctrees, svox2, 3DGS).
    Homogeneous,
    /// Of d / |d|, or of its angles: the gradient is tangential.
    Normalized,
}
