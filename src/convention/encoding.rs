//! Choices of the positional encoding.

use serde::{Deserialize, Serialize};

/// The factor in front of the encoding's bands: band k is sin(factor f_k x).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Frequency {
    /// pi, as in the paper.
    Pi,
    /// 1, as in the paper's code (bmild/nerf#12).
    One,
    /// 2 pi (nerfstudio).
    TwoPi,
}

/// How f_k grows with k = 0, ..., L - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bands {
    /// 2^k.
    Octaves,
    /// L values evenly spaced from 1 to 2^(L-1) (kornia's default).
    Linear,
    /// L values in even octaves from 1 to 2^(L-2) (nerfstudio's vanilla NeRF has ten from 1 to 2^8).
    Stretched,
    /// L values in even octaves from 1 to 2^L (nerfstudio's mip-NeRF has 16 from 1 to 2^16 for positions, and both of its models four from 1
    /// to 2^4 for directions).
    Widened,
}

/// The order of the encoding's columns (beside the identity, where it is kept). A matter of layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Columns {
    /// For each band: sin of all dimensions, then cos of all dimensions.
    BandSinCos,
    /// For each dimension: sin of all bands, then cos of all bands.
    DimSinCos,
    /// For each dimension: (sin, cos) of each band.
    DimInterleaved,
    /// sin of all (dimension, band) pairs, then cos of all of them.
    AllSinAllCos,
    /// sin of all (band, dimension) pairs, then cos of all of them.
    AllSinAllCosByBand,
    /// For each band and each dimension: (sin, cos).
    BandInterleaved,
}

/// Where x itself stands in the encoding, if it is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdentityPlace {
    /// In front of the bands.
    #[default]
    First,
    /// Behind them (nerfstudio, pytorch3d, multinerf).
    Last,
    /// Each coordinate in front of its own bands: (x, its bands, y, its bands, ...), where columns go by dimension; elsewhere in front of
    /// all.
    ByDimension,
}

/// How the cosine is computed: the same number, with fewer digits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cosine {
    /// By a cosine.
    #[default]
    Own,
    /// As sin(a + pi / 2), the sum rounded; large angles may be taken modulo some whole turns first (jaxnerf, mip-NeRF, multinerf,
    /// nerfstudio, nerfacc).
    ShiftedSine,
}
