//! Activations in f32.

use crate::convention::Density;
use crate::volume_rendering::fast::attenuation;

/// Density from the density head's output; see [`crate::field::density`].
pub(crate) fn density(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z < 0.0 => 0.0,
        Density::Relu => z,
        Density::Softplus => z.max(0.0) + libm::log1pf(attenuation(z.abs()).0),
        Density::Exp => libm::expf(z),
    }
}

/// d density / dz.
pub(crate) fn slope(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z <= 0.0 => 0.0,
        Density::Relu => 1.0,
        Density::Softplus => sigmoid(z),
        Density::Exp => libm::expf(z),
    }
}

/// 1 / (1 + e^-z), without overflow on either side.
pub(crate) fn sigmoid(z: f32) -> f32 {
    let e = attenuation(z.abs()).0;
    if z < 0.0 { e / (1.0 + e) } else { 1.0 / (1.0 + e) }
}
