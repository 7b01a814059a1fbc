//! Choices of what is reported, and of the optimizer.

use serde::{Deserialize, Serialize};

/// Expected depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Depth {
    /// sum w t / sum w; far where all weights are 0.
    Divided,
    /// sum w t.
    Plain,
}

/// The depth of a ray without any weight, where depth is divided by the weights' sum A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EmptyDepth {
    /// far (jaxnerf).
    #[default]
    Far,
    /// 0: A is at least a small number, or one is added to it (nerfacc, nerfies).
    Zero,
    /// The first t: the same, clipped to the samples (nerfstudio).
    First,
    /// The last t: 0 / 0 is taken for infinity and clipped to the samples (mip-NeRF, multinerf).
    Last,
}

/// PSNR of several images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrOf {
    /// The mean of the images' PSNRs.
    Images,
    /// The PSNR of the mean squared error over all pixels of all images.
    MeanError,
}

/// What the mean squared error is kept away from 0 with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrFloor {
    /// Nothing: equal pictures have an infinite PSNR.
    #[default]
    None,
    /// A number up to 1e-6 of the squared peak is added to the error, or is its least; or equal pictures have a PSNR of their own. They
    /// have a finite one in any case.
    Small,
}

/// The largest color value that a PSNR is relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrPeak {
    /// As it is given.
    #[default]
    Given,
    /// 1: colors are taken to lie in [0, 1] (bmild/nerf's `mse2psnr`).
    One,
}

/// How [0, 1] becomes a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bytes {
    /// round(255 x).
    Round,
    /// floor(255 x).
    Truncate,
}

/// What Adam's eps is added to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AdamEps {
    /// The root of the corrected mean: m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + eps) (the paper's algorithm 1, PyTorch, optax).
    #[default]
    Corrected,
    /// The root of the mean as it is: lr sqrt(1 - b2^t) / (1 - b1^t) m / (sqrt(v) + eps) (the paper's shorter form, TensorFlow,
    /// tiny-cuda-nn).
    Uncorrected,
}
