//! Activations in f32.

use crate::approximate::{Grade, attenuation, exp};
use crate::convention::Density;

/// Density from the density head's output; see [`crate::field::density`].
pub(crate) fn density(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z < 0.0 => 0.0,
        Density::Relu => z,
        Density::Softplus => z.max(0.0) + libm::log1pf(attenuation(z.abs(), Grade::Full).0),
        Density::Exp => exp(z),
    }
}

/// d density / dz.
pub(crate) fn slope(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z <= 0.0 => 0.0,
        Density::Relu => 1.0,
        Density::Softplus => sigmoid(z),
        Density::Exp => exp(z),
    }
}

/// g times the slope: 0 where g is, even if the slope is infinite (an opaque sample's e^z).
pub(crate) fn density_backward(g: f32, z: f32, activation: Density) -> f32 {
    if g == 0.0 { g } else { g * slope(z, activation) }
}

/// 1 / (1 + e^-z), without overflow on either side.
pub(crate) fn sigmoid(z: f32) -> f32 {
    let e = attenuation(z.abs(), Grade::Full).0;
    if z < 0.0 { e / (1.0 + e) } else { 1.0 / (1.0 + e) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// VR6: e^89 is infinite in f32.
    #[test]
    fn an_infinite_density_passes_no_gradient() {
        assert_eq!(slope(89.0, Density::Exp), f32::INFINITY);
        assert_eq!(density_backward(0.0, 89.0, Density::Exp), 0.0);
        assert_eq!(density_backward(-0.5, 0.0, Density::Exp), -0.5);
    }
}
