//! Conventions: choices that differ between right implementations, as data.
//!
//! A convention is never a mistake. Every oracle function takes the choices it depends on as arguments; this file bundles
//! them so that a profile (`cs180`, `nerf2020`, ...) can be named, and lists the closed set of values that the judge
//! searches when no profile is pinned.

pub mod profiles;
mod spelling;

pub use spelling::american;

use serde::{Deserialize, Serialize};

/// Where the camera looks, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// x right, y down, z forward (OpenCV, COLMAP, CS180).
    #[default]
    Opencv,
    /// x right, y up, z backward (OpenGL, Blender, the original NeRF).
    Opengl,
}

/// Where pixel (i, j) has its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PixelCenter {
    /// (i + 0.5, j + 0.5): the center, when the picture spans [0, W] x [0, H].
    Half,
    /// (i, j).
    Integer,
}

/// The length of a ray's direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// Length 1: t is the distance from the camera.
    Unit,
    /// Depth 1 along the camera's axis: t is the depth.
    Depth,
}

/// How N samples are laid on [near, far], and what their `u` in [0, 1) scales. D = (far - near) / N, S = (far - near) / (N - 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grid {
    /// t_i = near + (i + u_i) D: one sample in each of N equal intervals.
    Intervals,
    /// t_i = near + i S + u_i D: both ends, jittered over D (the commonest CS180 pattern; t can pass far).
    EndsPlusWidth,
    /// t_i = near + (i + u_i) S: both ends, jittered over their spacing.
    EndsPlusSpacing,
    /// Both ends, bins between the midpoints of neighbors, half-width bins at the ends (bmild/nerf).
    EndsBetweenMidpoints,
}

/// The position of a sample in its interval when nothing is drawn (evaluation).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// u = 0.
    Left,
    /// u = 0.5.
    Mid,
    /// u = 1.
    Right,
}

/// The step length that belongs to sample i.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delta {
    /// D = (far - near) / N for every sample.
    Width,
    /// t_{i+1} - t_i; the last one is [`LastDelta`].
    Differences,
    /// The same times the direction's length, the last one too: a length where directions aren't unit (bmild/nerf). This is done where the
    /// direction is known: in a rendering, not in the steps of `t` alone.
    DifferencesTimesNorm,
}

/// The step of the last sample, where the others are differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LastDelta {
    /// D = (far - near) / N.
    Width,
    /// The one before.
    Repeated,
    /// The mean of the others.
    Mean,
    /// 1e10: the last sample is opaque if it has any density.
    #[serde(rename = "1e10")]
    TenToTen,
    /// 1e9.
    #[serde(rename = "1e9")]
    TenToNine,
    /// 1e-3.
    #[serde(rename = "1e-3")]
    Thousandth,
    /// far - t_{N-1}.
    ToFar,
}

/// A number added to every factor 1 - alpha of the transmittance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProductEps {
    /// Nothing is added: the formula.
    None,
    /// 1e-10 (bmild/nerf, kornia).
    #[serde(rename = "1e-10")]
    TenToMinusTen,
    /// 1e-9.
    #[serde(rename = "1e-9")]
    TenToMinusNine,
    /// 1e-8.
    #[serde(rename = "1e-8")]
    TenToMinusEight,
    /// 1e-7 (nerfstudio).
    #[serde(rename = "1e-7")]
    TenToMinusSeven,
}

impl ProductEps {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            ProductEps::None => 0.0,
            ProductEps::TenToMinusTen => 1e-10,
            ProductEps::TenToMinusNine => 1e-9,
            ProductEps::TenToMinusEight => 1e-8,
            ProductEps::TenToMinusSeven => 1e-7,
        }
    }
}

/// The factor in front of the encoding's bands: band k is sin(factor f_k x).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bands {
    /// 2^k.
    Octaves,
    /// L values evenly spaced from 1 to 2^(L-1) (kornia's default).
    Linear,
}

/// The order of the encoding's columns (after the identity, where it is kept). A matter of layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// For each band and each dimension: (sin, cos).
    BandInterleaved,
}

/// What turns the density head's output into a density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Density {
    /// max(z, 0).
    Relu,
    /// ln(1 + e^z).
    Softplus,
    /// e^z.
    Exp,
}

/// Whether the exponent of an exponential density is held to [-15, 15] in the forward pass. In the gradient it always is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Exponent {
    /// sigma = e^x; the gradient alone is held.
    #[default]
    Free,
    /// sigma = e^clamp(x, -15, 15): forward too.
    Clamped,
}

/// Which cells of an occupancy grid fade at an update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridDecay {
    /// Those in which a density was found (nerfacc).
    #[default]
    Touched,
    /// Every cell that a camera sees (instant-ngp).
    EveryCell,
}

/// The density above which a cell of an occupancy grid is occupied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridThreshold {
    /// The smaller of the limit and the mean of the densities above 0; where no cell is denser, every cell that is seen is occupied.
    #[default]
    MeanOfDense,
    /// The smaller of the limit and the mean over all cells that are seen (nerfacc).
    MeanOfSeen,
    /// The limit.
    LimitAlone,
}

/// What is added to the weights of a coarse pass before samples are drawn by them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PdfPadding {
    /// What the caller says.
    #[default]
    AsGiven,
    /// Nothing, whatever the caller says: the paper.
    None,
    /// 1e-5 (bmild/nerf).
    #[serde(rename = "1e-5")]
    TenToMinusFive,
    /// 1e-6.
    #[serde(rename = "1e-6")]
    TenToMinusSix,
    /// 0.01 (nerfstudio).
    #[serde(rename = "0.01")]
    Hundredth,
}

impl PdfPadding {
    /// The number, where the caller says `given`.
    pub fn value(self, given: f64) -> f64 {
        match self {
            PdfPadding::AsGiven => given,
            PdfPadding::None => 0.0,
            PdfPadding::TenToMinusFive => 1e-5,
            PdfPadding::TenToMinusSix => 1e-6,
            PdfPadding::Hundredth => 0.01,
        }
    }
}

/// What the place inside a bin is divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PdfDivision {
    /// The bin's share.
    #[default]
    AsItIs,
    /// The bin's share, or 1 where that is below 1e-5: samples in faint bins fall on the bin's edge (bmild/nerf).
    Snapped,
}

/// Which sample of a ray that stops early is the last to count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// The one behind which the transmittance is below the limit.
    #[default]
    Behind,
    /// The one in front of that: it isn't added (3D Gaussian splatting).
    InFront,
}

/// The largest opacity of a sample or splat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AlphaCap {
    /// 1.
    #[default]
    None,
    /// 0.99 (3D Gaussian splatting).
    #[serde(rename = "0.99")]
    Hundredth,
    /// 0.999 (gsplat).
    #[serde(rename = "0.999")]
    Thousandth,
}

impl AlphaCap {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            AlphaCap::None => 1.0,
            AlphaCap::Hundredth => 0.99,
            AlphaCap::Thousandth => 0.999,
        }
    }
}

/// What becomes of opacities below 1 / 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Faint {
    /// They count as all others do.
    #[default]
    Kept,
    /// They are skipped (3D Gaussian splatting, gsplat).
    Skipped,
}

/// The order in which a skip connection is concatenated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SkipOrder {
    /// [h, encoding].
    HiddenFirst,
    /// [encoding, h].
    EncodingFirst,
}

/// Whether a layer has a ReLU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// max(z, 0).
    Relu,
    /// z.
    None,
}

/// Expected depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Depth {
    /// sum w t / sum w; far where all weights are 0.
    Divided,
    /// sum w t.
    Plain,
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

/// How [0, 1] becomes a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bytes {
    /// round(255 x).
    Round,
    /// floor(255 x).
    Truncate,
}

/// One assignment of all conventions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conventions {
    /// Camera axes.
    pub axes: Axes,
    /// Camera axes of points at a depth, which code may have otherwise than its rays.
    #[serde(default)]
    pub camera_axes: Axes,
    /// Pixel centers.
    #[serde(alias = "pixel_centre")]
    pub pixel_center: PixelCenter,
    /// Direction lengths.
    pub directions: Directions,
    /// Sample grid and what `u` scales.
    pub grid: Grid,
    /// Where samples rest at evaluation.
    pub rest: Rest,
    /// Step lengths.
    pub delta: Delta,
    /// Last step length.
    pub last_delta: LastDelta,
    /// Number added inside the product of transmittances.
    pub product_eps: ProductEps,
    /// Whether the encoding begins with x itself.
    pub identity: bool,
    /// Factor of the encoding's bands.
    pub frequency: Frequency,
    /// Spacing of the encoding's bands.
    pub bands: Bands,
    /// Column order of the encoding.
    pub columns: Columns,
    /// Density activation.
    pub density: Density,
    /// Where an exponential density's exponent is clamped.
    #[serde(default)]
    pub exponent: Exponent,
    /// Which cells of an occupancy grid fade.
    #[serde(default)]
    pub grid_decay: GridDecay,
    /// What an occupied cell is denser than.
    #[serde(default)]
    pub grid_threshold: GridThreshold,
    /// What is added to the weights of a coarse pass.
    #[serde(default)]
    pub pdf_padding: PdfPadding,
    /// What the place inside a bin is divided by.
    #[serde(default)]
    pub pdf_division: PdfDivision,
    /// Which sample of a ray that stops is the last.
    #[serde(default)]
    pub stop: Stop,
    /// The largest opacity.
    #[serde(default)]
    pub alpha_cap: AlphaCap,
    /// What becomes of faint samples.
    #[serde(default)]
    pub faint: Faint,
    /// Index (from 0) of the trunk layer whose input contains the encoding again.
    pub skip_layer: usize,
    /// Order of that concatenation.
    pub skip_order: SkipOrder,
    /// Activation after the last trunk layer.
    pub last_trunk: Activation,
    /// Activation of the feature layer.
    pub feature: Activation,
    /// Expected depth.
    pub depth: Depth,
    /// PSNR aggregation.
    pub psnr: PsnrOf,
    /// Quantization.
    pub bytes: Bytes,
}

/// The default: Berkeley's CS180 course, which is the paper's text taken literally.
pub const CS180: Conventions = Conventions {
    axes: Axes::Opencv,
    camera_axes: Axes::Opencv,
    pixel_center: PixelCenter::Half,
    directions: Directions::Unit,
    grid: Grid::Intervals,
    rest: Rest::Mid,
    delta: Delta::Width,
    last_delta: LastDelta::Width,
    product_eps: ProductEps::None,
    identity: true,
    frequency: Frequency::Pi,
    bands: Bands::Octaves,
    columns: Columns::BandSinCos,
    density: Density::Relu,
    exponent: Exponent::Free,
    grid_decay: GridDecay::Touched,
    grid_threshold: GridThreshold::MeanOfDense,
    pdf_padding: PdfPadding::AsGiven,
    pdf_division: PdfDivision::AsItIs,
    stop: Stop::Behind,
    alpha_cap: AlphaCap::None,
    faint: Faint::Kept,
    skip_layer: 4,
    skip_order: SkipOrder::HiddenFirst,
    last_trunk: Activation::Relu,
    feature: Activation::None,
    depth: Depth::Divided,
    psnr: PsnrOf::Images,
    bytes: Bytes::Round,
};

impl Default for Conventions {
    fn default() -> Self {
        CS180
    }
}

/// Every convention with the closed list of its values, as they are written in JSON.
pub const CHOICES: &[(&str, &[&str])] = &[
    ("axes", &["opencv", "opengl"]),
    ("camera_axes", &["opencv", "opengl"]),
    ("pixel_center", &["half", "integer"]),
    ("directions", &["unit", "depth"]),
    ("grid", &["intervals", "ends_plus_width", "ends_plus_spacing", "ends_between_midpoints"]),
    ("rest", &["left", "mid", "right"]),
    ("delta", &["width", "differences", "differences_times_norm"]),
    ("last_delta", &["width", "repeated", "mean", "1e10", "1e9", "1e-3", "to_far"]),
    ("product_eps", &["none", "1e-10", "1e-9", "1e-8", "1e-7"]),
    ("identity", &["true", "false"]),
    ("frequency", &["pi", "one", "two_pi"]),
    ("bands", &["octaves", "linear"]),
    ("columns", &["band_sin_cos", "dim_sin_cos", "dim_interleaved", "all_sin_all_cos", "band_interleaved"]),
    ("density", &["relu", "softplus", "exp"]),
    ("exponent", &["free", "clamped"]),
    ("grid_decay", &["touched", "every_cell"]),
    ("grid_threshold", &["mean_of_dense", "mean_of_seen", "limit_alone"]),
    ("pdf_padding", &["as_given", "none", "1e-5", "1e-6", "0.01"]),
    ("pdf_division", &["as_it_is", "snapped"]),
    ("stop", &["behind", "in_front"]),
    ("alpha_cap", &["none", "0.99", "0.999"]),
    ("faint", &["kept", "skipped"]),
    ("skip_layer", &["4", "5"]),
    ("skip_order", &["hidden_first", "encoding_first"]),
    ("last_trunk", &["relu", "none"]),
    ("feature", &["none", "relu"]),
    ("depth", &["divided", "plain"]),
    ("psnr", &["images", "mean_error"]),
    ("bytes", &["round", "truncate"]),
];
