//! Choices of Gaussian splatting.

use serde::{Deserialize, Serialize};

/// Where a quaternion has its real part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum QuaternionOrder {
    /// (w, x, y, z) (3D Gaussian splatting and its PLY files, gsplat, COLMAP).
    #[default]
    #[serde(rename = "wxyz")]
    RealFirst,
    /// (x, y, z, w) (glTF, ROS, scipy, Eigen's storage).
    #[serde(rename = "xyzw")]
    RealLast,
}

/// Whether the quaternion of a rotation is divided by its length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuaternionLength {
    /// Inside: every quaternion but 0 is a rotation (gsplat, PyTorch3D).
    #[default]
    Divided,
    /// It is taken as it is: whoever calls has divided it (the rasterizer of 3D Gaussian splatting).
    AsGiven,
}

/// What a Gaussian's scales are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatScale {
    /// Standard deviations along the axes (gsplat, the rasterizer of 3D Gaussian splatting).
    #[default]
    Plain,
    /// Their natural logarithms, as files and optimizers have them (fvdb-core).
    Log,
}

/// Where the pixels of a picture of splats have their centers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatCenter {
    /// At (i + 0.5, j + 0.5): a mean is f x/z + c (gsplat).
    #[default]
    Half,
    /// At (i, j): a mean is that less half a pixel (3D Gaussian splatting's `ndc2Pix`).
    Integer,
}

/// What is added to the variances of every splat, in square pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SplatDilation {
    /// 0.3 (3D Gaussian splatting, gsplat).
    #[default]
    #[serde(rename = "0.3")]
    ThreeTenths,
    /// 0.1 (Mip-Splatting's kernel).
    #[serde(rename = "0.1")]
    Tenth,
}

impl SplatDilation {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            SplatDilation::ThreeTenths => 0.3,
            SplatDilation::Tenth => 0.1,
        }
    }
}

/// How far beside the picture the Jacobian of a projection is taken; beyond, it is that of the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatClamp {
    /// 0.3 of the half picture beyond its edges, wherever the principal point is (gsplat from 1.1).
    #[default]
    Picture,
    /// 1.3 of the half picture to either side of the principal point (3D Gaussian splatting).
    Centered,
    /// Anywhere (Zwicker et al. 2001).
    None,
}

/// What is constant where the Jacobian is clamped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatClampGradient {
    /// The slope: t_x = z times the limit moves with z (gsplat; automatic differentiation).
    #[default]
    Through,
    /// t_x itself, whatever z (3D Gaussian splatting's backward pass).
    Held,
}

/// The least value under the root of a splat's larger eigenvalue, in pixels to the fourth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum RadiusFloor {
    /// 0.1 (3D Gaussian splatting).
    #[default]
    #[serde(rename = "0.1")]
    Tenth,
    /// 0.01 (gsplat).
    #[serde(rename = "0.01")]
    Hundredth,
    /// 0: the eigenvalue.
    #[serde(rename = "none")]
    None,
}

impl RadiusFloor {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            RadiusFloor::Tenth => 0.1,
            RadiusFloor::Hundredth => 0.01,
            RadiusFloor::None => 0.0,
        }
    }
}

/// What a projection says of a splat whose circle misses the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatCulling {
    /// What it says of any other.
    #[default]
    Kept,
    /// Zeros, a radius of 0 among them (3D Gaussian splatting, gsplat).
    Zero,
}

/// The least factor by which a splat becomes fainter as it is dilated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum CompensationFloor {
    /// 0 (gsplat).
    #[default]
    #[serde(rename = "none")]
    None,
    /// 0.005: the root of 0.000025 (3D Gaussian splatting).
    #[serde(rename = "0.005")]
    FiveThousandths,
    /// 1e-6 of both determinants, in pixels to the fourth (Gaussian opacity fields, RaDe-GS).
    #[serde(rename = "determinants_1e-6")]
    Millionth,
    /// 1e-12 of both.
    #[serde(rename = "determinants_1e-12")]
    Trillionth,
}

impl CompensationFloor {
    /// The least factor.
    pub fn value(self) -> f64 {
        match self {
            CompensationFloor::FiveThousandths => 0.005,
            _ => 0.0,
        }
    }

    /// The least determinant; below 0 where none is held up.
    pub fn determinant(self) -> f64 {
        match self {
            CompensationFloor::Millionth => 1e-6,
            CompensationFloor::Trillionth => 1e-12,
            _ => f64::NEG_INFINITY,
        }
    }
}

/// What becomes of a splat at a pixel where its exponent is above 0, as no positive conic has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PositivePower {
    /// It counts: the formula.
    #[default]
    Kept,
    /// It is skipped (3D Gaussian splatting, gsplat).
    Skipped,
}

/// Whether a splat whose opacity is capped learns at that pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CapGradient {
    /// No (gsplat; automatic differentiation).
    #[default]
    Stopped,
    /// As if it weren't capped (3D Gaussian splatting's backward pass).
    Through,
}

/// What the gradient of a conic's second number is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConicGradient {
    /// That of the number (gsplat; automatic differentiation).
    #[default]
    Number,
    /// That of one of the two matrix entries that it stands for: half (3D Gaussian splatting's backward pass).
    Entry,
}

/// What is made of the sum of a splat's coefficients times harmonics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SplatColor {
    /// max(sum + 1/2, 0): coefficients of 0 are gray (3D Gaussian splatting; gsplat's rasterization).
    #[default]
    Clamped,
    /// sum + 1/2.
    Shifted,
    /// The sum (gsplat's `spherical_harmonics`; the rest is the caller's).
    Sum,
}
