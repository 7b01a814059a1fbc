//! What wrong networks make of the last layers' z.

use super::units::{LEAKY_COLOR_LAYER, LEAKY_DENSITY, SHARPENED, SHIFTED_DENSITY, WIDENED};
use crate::convention::Density;
use crate::field::{density, sigmoid, softplus};
use crate::math::{exp, expm1};

/// The hyperbolic tangent.
pub(super) fn tanh(z: f64) -> f64 {
    2.0 * sigmoid(2.0 * z) - 1.0
}

/// The output unit of the plain network, and of a color's channel.
pub(super) fn head(z: f64, wrong: &[&str]) -> f64 {
    let z = if wrong.contains(&"relu_before_sigmoid") { z.max(0.0) } else { z };
    let z = SHARPENED.among(wrong).map_or(z, |k| k * z);
    let y = match () {
        () if wrong.contains(&"sigmoid_missing") => z,
        () if wrong.contains(&"relu_color") => z.max(0.0),
        () if wrong.contains(&"clipped_color") => z.clamp(0.0, 1.0),
        () if wrong.contains(&"tanh_color") => tanh(z),
        () => sigmoid(z),
    };
    WIDENED.among(wrong).map_or(y, |e| (1.0 + 2.0 * e) * y - e)
}

/// The color head.
pub(super) fn color(z: &[f64], wrong: &[&str]) -> [f64; 3] {
    let all = z.iter().map(|&z| exp(z)).sum::<f64>();
    let softmax = wrong.contains(&"softmax_color");
    std::array::from_fn(|k| if softmax { exp(z[k]) / all } else { head(z[k], wrong) })
}

/// The density head.
pub(super) fn wrong_density(z: f64, activation: Density, wrong: &[&str]) -> f64 {
    let z = SHIFTED_DENSITY.among(wrong).map_or(z, |b| z - b);
    match () {
        () if wrong.contains(&"density_without_relu") => z,
        () if wrong.contains(&"sigmoid_density") => sigmoid(z),
        () if wrong.contains(&"size_as_density") => z.abs(),
        () if wrong.contains(&"squared_density") => z * z,
        () if wrong.contains(&"exponential_linear_density") => z.max(expm1(z.min(0.0))),
        () => match LEAKY_DENSITY.among(wrong) {
            Some(k) if z < 0.0 => k * z,
            Some(_) => z,
            None => density(z, activation),
        },
    }
}

/// What stands behind the feature where nothing should.
pub(super) fn feature(wrong: &[&str]) -> Option<fn(f64) -> f64> {
    match () {
        () if wrong.contains(&"sigmoid_on_feature") => Some(sigmoid),
        () if wrong.contains(&"softplus_on_feature") => Some(softplus),
        () if wrong.contains(&"tanh_on_feature") => Some(tanh),
        () => None,
    }
}

/// What stands between the two color layers alone.
pub(super) fn color_unit(z: f64, wrong: &[&str]) -> Option<f64> {
    match () {
        () if wrong.contains(&"color_layer_linear") => Some(z),
        () if wrong.contains(&"color_layer_decaying") => Some(exp(-z.abs())),
        () if wrong.contains(&"color_layer_sigmoid") => Some(sigmoid(z)),
        () if wrong.contains(&"color_layer_softplus") => Some(softplus(z)),
        () => LEAKY_COLOR_LAYER.among(wrong).map(|k| if z > 0.0 { z } else { k * z }),
    }
}
