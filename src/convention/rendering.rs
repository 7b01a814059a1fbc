//! Choices of the product of transmittances, of sampling by weights, and of how rays end.

use serde::{Deserialize, Serialize};

/// A number added to every factor 1 - alpha of the transmittance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
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

/// What is added to the weights of a coarse pass before samples are drawn by them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PdfDivision {
    /// The bin's share.
    #[default]
    AsItIs,
    /// The bin's share, or 1 where that is below 1e-5: samples in faint bins fall on the bin's edge (bmild/nerf).
    Snapped,
    /// The bin's share, but 1e-5 at least: faint bins' samples lie near its beginning (`denom.clamp(min = 1e-5)`).
    AtLeast,
}

impl PdfDivision {
    /// What a bin's share counts as where it is below 1e-5.
    pub(crate) fn faint(self) -> Option<f64> {
        match self {
            PdfDivision::AsItIs => None,
            PdfDivision::Snapped => Some(1.0),
            PdfDivision::AtLeast => Some(1e-5),
        }
    }
}

/// Which sample of a ray that stops early is the last to count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// The one behind which the transmittance is below the limit.
    #[default]
    Behind,
    /// The one in front of that: it isn't added (3D Gaussian splatting).
    InFront,
    /// One more: the transmittance in front of a sample is tested after it (torch-ngp's inference).
    OneMore,
}

/// What becomes of a ray behind whose last sample the transmittance is below the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// It is left as it is: what light there is goes on to the background.
    #[default]
    Left,
    /// Its color and its weights are divided by its opacity, and no light is left (instant-ngp, PlenOctrees).
    MadeOpaque,
}

/// The largest opacity of a sample or splat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
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

/// Whether a ray of given opacities ends where next to no light is left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AlphaStop {
    /// All samples count.
    #[default]
    None,
    /// In front of the first sample behind which T is below 1e-4: it isn't added, and none behind it (3D Gaussian splatting, gsplat).
    InFront,
}

/// Whether rendering passes densities through a ReLU, which those that are none of below 0 notice in their gradient alone: it is 0 at 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SigmaRelu {
    /// Densities come as they are used.
    #[default]
    None,
    /// max(sigma, 0) in the same function (bmild/nerf's `raw2outputs`).
    Inside,
}

/// What rendering puts behind a ray's last sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Backdrop {
    /// Nothing: the background is another function's.
    #[default]
    None,
    /// White, in the same function: C + (1 - A) (bmild/nerf's `white_bkgd`).
    White,
}

/// Which weights are a ray's opacity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OpacitySum {
    /// All of them.
    #[default]
    All,
    /// All but the last sample's, whose step leads to infinity: it is not what one calls opaque (nerfies).
    /// A backdrop shows through what all weights leave, all the same.
    WithoutLast,
}

/// What the last sample of a ray is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LastSample {
    /// One as all others are.
    #[default]
    AsItIs,
    /// Opaque, whatever its density: nothing is seen behind it (multinerf's `opaque_background`; the farthest plane of a multiplane image).
    Opaque,
}

/// What becomes of opacities below 1 / 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Faint {
    /// They count as all others do.
    #[default]
    Kept,
    /// They are skipped (3D Gaussian splatting, gsplat).
    Skipped,
}
