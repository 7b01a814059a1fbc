//! Choices of what is reported, and of the optimizer.

use serde::{Deserialize, Serialize};

/// Expected depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Depth {
    /// sum w t / sum w; far where all weights are 0.
    Divided,
    /// sum w t.
    Plain,
    /// sum w t + (1 - A) far: what passes is met at far, as a background is.
    FarBehind,
}

/// The depth of a ray without any weight, where depth is divided by the weights' sum A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrOf {
    /// The mean of the images' PSNRs.
    Images,
    /// The PSNR of the mean squared error over all pixels of all images.
    MeanError,
}

/// What the mean squared error is kept away from 0 with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrFloor {
    /// Nothing: equal pictures have an infinite PSNR.
    #[default]
    None,
    /// A number up to 1e-6 of the squared peak is added to the error, or is its least; or equal pictures have a PSNR of their own. They
    /// have a finite one in any case.
    Small,
}

/// The largest color value that a PSNR or a similarity is relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PsnrPeak {
    /// As it is given.
    #[default]
    Given,
    /// 1: colors are taken to lie in [0, 1] (bmild/nerf's `mse2psnr`, 3D Gaussian Splatting's `ssim`).
    One,
}

/// The windows of structural similarity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SsimWindow {
    /// 11 x 11, weights of a Gaussian with standard deviation 1.5 (Wang et al. 2004, TensorFlow, dm_pix, torchmetrics, 3D Gaussian
    /// Splatting).
    #[default]
    Gaussian,
    /// 7 x 7, all alike (scikit-image's default).
    Uniform,
    /// 11 x 11, all alike (`avg_pool2d` of the published size).
    #[serde(rename = "uniform_11")]
    UniformEleven,
    /// 3 x 3, all alike (monodepth2 and depth networks after it).
    #[serde(rename = "uniform_3")]
    UniformThree,
}

/// What windows of structural similarity see beyond the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SsimPadding {
    /// There are none that reach beyond it (Wang et al. 2004, TensorFlow, dm_pix; scikit-image and torchmetrics, which cut off what they
    /// have padded).
    #[default]
    Valid,
    /// Zeros, about every pixel a window (3D Gaussian Splatting, fused-ssim's `same`).
    Zero,
    /// The picture once more, its edge not repeated (kornia's `same`).
    Reflect,
}

/// What the variances of structural similarity are divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SsimVariance {
    /// The sum of the weights (Wang et al. 2004 and most).
    #[default]
    Population,
    /// That times (n - 1) / n, n the pixels of a window (scikit-image's default, `use_sample_covariance`).
    Sample,
}

/// What a loss makes of its entries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LossReduction {
    /// Their mean (PyTorch's default, multinerf).
    #[default]
    Mean,
    /// Their sum (PyTorch's `reduction="sum"`).
    Sum,
}

/// The slope of Huber's loss where the error is large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HuberSlope {
    /// delta, and 1 times d inside (Huber 1964, `torch.nn.functional.huber_loss`, optax).
    #[default]
    Delta,
    /// 1, and 1 / delta times d inside (`torch.nn.functional.smooth_l1_loss`, instant-ngp).
    One,
}

/// What is added under the root of Charbonnier's loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CharbonnierEps {
    /// eps^2 (mip-NeRF 360, multinerf).
    #[default]
    Square,
    /// eps (nerficg).
    AsGiven,
}

/// Which intervals of a proposal the bound of an interval adds up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OuterEdges {
    /// Those that overlap it, and the one that begins where it ends: searches through edges, from the right (multinerf, nerfstudio,
    /// nerfacc).
    #[default]
    Touching,
    /// Those that overlap it in more than a point: equal histograms cover each other, interval by interval.
    Inside,
}

/// What is added to the weight that an interlevel loss is divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InterlevelEps {
    /// What the caller says.
    #[default]
    AsGiven,
    /// 2^-23, the relative spacing of f32 (multinerf).
    Float32,
    /// 1e-7 (nerfstudio, nerfacc).
    #[serde(rename = "1e-7")]
    TenToMinusSeven,
    /// 1e-8 (ports in PyTorch).
    #[serde(rename = "1e-8")]
    TenToMinusEight,
}

impl InterlevelEps {
    /// The number, where the caller says `given`.
    pub fn value(self, given: f64) -> f64 {
        match self {
            InterlevelEps::AsGiven => given,
            InterlevelEps::Float32 => f64::from(f32::EPSILON),
            InterlevelEps::TenToMinusSeven => 1e-7,
            InterlevelEps::TenToMinusEight => 1e-8,
        }
    }
}

/// How [0, 1] becomes a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bytes {
    /// round(255 x).
    Round,
    /// floor(255 x).
    Truncate,
}

/// What Adam does with a parameter whose gradient is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AdamZero {
    /// A step like any other: its means fade and move it (the paper, PyTorch, optax).
    #[default]
    Stepped,
    /// Nothing: parameter and means stay (tiny-cuda-nn with the parameters of its encodings, lazy and sparse forms).
    Left,
}

/// What Adam's eps is added to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AdamEps {
    /// The root of the corrected mean: m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + eps) (the paper's algorithm 1, PyTorch, optax).
    #[default]
    Corrected,
    /// The root of the mean as it is: lr sqrt(1 - b2^t) / (1 - b1^t) m / (sqrt(v) + eps) (the paper's shorter form, TensorFlow,
    /// tiny-cuda-nn).
    Uncorrected,
}
