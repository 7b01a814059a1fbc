//! The field: encoded position and direction -> density and color; and the 2D field of an image.
//!
//! Letters: `w` weights (out, in), `b` biases (out), `x` input, `z` = w x + b before an activation, `h` after it.
//! `mlp` is the plain network of the 2D experiment, `nerf_mlp` the network of the NeRF paper (figure 7).

use ndarray::{Array1, Array2};

use crate::convention::Density;
use crate::math::{exp, ln_1p};
use crate::random::Key;
use crate::trunc_exp::trunc_exp;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
#[cfg(feature = "fast")]
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;
pub mod mlp;
pub mod nerf_mlp;
pub mod trunk;

#[cfg(test)]
mod tests;

#[doc(hidden)]
pub use bound::{mlp_kink, nerf_mlp_kink};
pub use judge::judge;
pub use mlp::Mlp;
pub use nerf_mlp::NerfMlp;

/// One affine layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Weights, (out, in).
    pub w: Array2<f64>,
    /// Biases, (out).
    pub b: Array1<f64>,
}

impl Layer {
    /// A layer of zeros.
    pub fn zeros(inputs: usize, outputs: usize) -> Self {
        Layer { w: Array2::zeros((outputs, inputs)), b: Array1::zeros(outputs) }
    }

    /// PyTorch's default: weights and biases uniform in (-1/sqrt(in), 1/sqrt(in)). Draw n of stream `layer` is entry n of the
    /// weights, row by row, and then of the biases.
    pub fn initial(inputs: usize, outputs: usize, key: &Key, layer: u64) -> Self {
        let bound = 1.0 / (inputs as f64).sqrt();
        let u = key.uniforms(0, layer, outputs * (inputs + 1));
        let value = |n: usize| bound * (2.0 * u[n] - 1.0);
        Layer {
            w: Array2::from_shape_fn((outputs, inputs), |(o, i)| value(o * inputs + i)),
            b: Array1::from_shape_fn(outputs, |o| value(outputs * inputs + o)),
        }
    }

    /// z = w x + b, one output after the other, terms from left to right.
    ///
    /// # Panics
    /// Where `x` doesn't have w's columns, or `b` w's rows.
    pub fn forward(&self, x: &[f64]) -> Vec<f64> {
        let (outputs, inputs) = self.w.dim();
        assert_eq!(x.len(), inputs, "x and the columns of w: one each an input");
        assert_eq!(self.b.len(), outputs, "b and the rows of w: one each an output");
        let mut z = Vec::with_capacity(outputs);
        for o in 0..outputs {
            let mut sum = self.b[o];
            for i in 0..inputs {
                sum += self.w[[o, i]] * x[i];
            }
            z.push(sum);
        }
        z
    }
}

/// max(z, 0) of each entry.
pub fn relu(z: &[f64]) -> Vec<f64> {
    z.iter().map(|&z| positive_part(z)).collect()
}

/// max(z, 0). A NaN stays NaN, where `f64::max` would return 0.
fn positive_part(z: f64) -> f64 {
    if z <= 0.0 { 0.0 } else { z }
}

/// 1 / (1 + e^-z), without overflow on either side.
///
/// ```
/// use nerf_oracle::field::sigmoid;
/// assert_eq!([sigmoid(-800.0), sigmoid(0.0), sigmoid(800.0)], [0.0, 0.5, 1.0]);
/// ```
pub fn sigmoid(z: f64) -> f64 {
    if z >= 0.0 {
        1.0 / (1.0 + exp(-z))
    } else {
        let e = exp(z);
        e / (1.0 + e)
    }
}

/// ln(1 + e^z) = max(z, 0) + ln(1 + e^-|z|).
pub fn softplus(z: f64) -> f64 {
    z.max(0.0) + ln_1p(exp(-z.abs()))
}

/// Density from the density head's output, by convention.
pub fn density(z: f64, activation: Density) -> f64 {
    match activation {
        Density::Relu => positive_part(z),
        Density::Softplus => softplus(z),
        Density::Exp => trunc_exp(z),
    }
}

/// d density / dz. At the kink of the ReLU the derivative is 0, as in PyTorch.
pub fn density_slope(z: f64, activation: Density) -> f64 {
    match activation {
        Density::Relu => f64::from(z > 0.0),
        Density::Softplus => sigmoid(z),
        Density::Exp => exp(z),
    }
}

/// d sigmoid / dz = s (1 - s), where 1 - s = sigmoid(-z) keeps its digits.
pub fn sigmoid_slope(z: f64) -> f64 {
    sigmoid(z) * sigmoid(-z)
}
