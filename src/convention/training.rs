//! Choices of learning rates, of gradients that are clipped, and of losses that are scaled.

use serde::{Deserialize, Serialize};

/// What a schedule does after its last step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RateEnd {
    /// Its formula goes on: an exponential falls further, a cosine rises again (bmild/nerf, PyTorch, nerfstudio's cosine).
    #[default]
    GoesOn,
    /// It keeps the rate of its last step (optax's and Keras' cosine).
    Held,
}

/// Where the delay of a log-linear schedule lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RateDelay {
    /// Beside the decay, which begins with step 0 and is multiplied (jaxnerf, multinerf, 3D Gaussian Splatting).
    #[default]
    Beside,
    /// Before the decay, which begins after it and has fewer steps (nerfstudio).
    Before,
}

/// How a delayed rate rises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RateRamp {
    /// As a quarter of a sine (jaxnerf, multinerf, 3D Gaussian Splatting, nerfstudio's `cosine`).
    #[default]
    Sine,
    /// Evenly (nerfstudio's `linear`).
    Linear,
}

/// What is added to the norm that gradients are divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClipEps {
    /// Nothing (Pascanu et al. 2013, optax, TensorFlow).
    #[default]
    None,
    /// 1e-8, as what is written by hand has it.
    #[serde(rename = "1e-8")]
    TenToMinusEight,
    /// 1e-7 (jaxnerf).
    #[serde(rename = "1e-7")]
    TenToMinusSeven,
    /// 2^-23, the relative spacing of f32 (multinerf).
    Float32,
    /// 1e-6 (`torch.nn.utils.clip_grad_norm_`).
    #[serde(rename = "1e-6")]
    TenToMinusSix,
}

impl ClipEps {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            ClipEps::None => 0.0,
            ClipEps::TenToMinusEight => 1e-8,
            ClipEps::TenToMinusSeven => 1e-7,
            ClipEps::Float32 => f64::from(f32::EPSILON),
            ClipEps::TenToMinusSix => 1e-6,
        }
    }
}

/// What a loss scale doesn't shrink below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LossScaleFloor {
    /// Nothing (PyTorch; apex unless it is asked to).
    #[default]
    None,
    /// 1 (jmp, and apex' first scaler with its copies in mmdetection).
    One,
}

/// What a loss scale doesn't grow beyond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LossScaleCeiling {
    /// Nothing but the largest number (PyTorch, jmp).
    #[default]
    None,
    /// 2^16, with which PyTorch's scaler begins: some mixed precision written by hand doesn't go beyond.
    #[serde(rename = "2^16")]
    TwoTo16,
    /// 2^24 (apex).
    #[serde(rename = "2^24")]
    TwoTo24,
}

impl LossScaleCeiling {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            LossScaleCeiling::None => f64::INFINITY,
            LossScaleCeiling::TwoTo16 => 65_536.0,
            LossScaleCeiling::TwoTo24 => 16_777_216.0,
        }
    }
}
